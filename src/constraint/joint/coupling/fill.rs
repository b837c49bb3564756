//! Fills the row of a coupling in a step.

use super::{Coupled, CouplingRow, Gauge};
use crate::config::tuning::LOCK_AWRY;
use crate::constraint::joint::arrange::JointInput;
use crate::constraint::joint::ends::{Ends, Lever};
use crate::constraint::joint::fill::{borne, place, put};
use crate::constraint::joint::measure::Measure;
use crate::joint::{Axes, LockKind, Motion, Placed, Term};
use crate::lanes::Vec3;

impl CouplingRow {
    /// The row of a coupling, by its slot: where its bodies are, and with what it bore.
    pub(in crate::constraint::joint) fn new(owner: u32, input: &JointInput<'_>) -> CouplingRow {
        let coupling = &input.joints.couplings.all[owner as usize];
        let (factors, mut displacements) = (coupling.scaled(), coupling.displacements);
        let motions = [0, 1].map(|i| {
            let (motion, value) = coupled(owner, &coupling.terms[i], factors[i], input);
            displacements[i] = coupling.terms[i].unwrapped(value, displacements[i]);
            motion
        });
        let (sum, scale) = (coupling.sum(displacements), coupling.scale());
        let room = [sum - coupling.range[0], coupling.range[1] - sum].map(|room| (room / scale) as f32);
        let mut row = CouplingRow {
            owner,
            motions,
            displacements,
            room,
            gap: room,
            equality: coupling.is_equality(),
            mobility: 0.0,
            impulse: coupling.impulse.map(|impulse| impulse * input.warm),
            lasting: coupling.lasting_impulse * input.warm,
        };
        row.measure();
        if row.mobility <= 0.0 {
            (row.impulse, row.lasting) = ([0.0; 2], 0.0);
        }
        let p = row.impulse[0] - row.impulse[1];
        for motion in &mut row.motions {
            (motion.acted, motion.moment) = motion.parts(p);
        }
        row
    }
}

/// A motion, and its displacement without whole turns.
fn coupled(owner: u32, term: &Term, factor: f32, input: &JointInput<'_>) -> (Coupled, f32) {
    let mut ends = Ends::default();
    let joint = &input.joints.all[term.joint as usize];
    let at = place(&mut ends, 0, owner, joint, input);
    let gauge = match (term.motion, term.axes) {
        (Motion::Angular, _) => Gauge::Twist(placed(&at, term.axes)),
        (Motion::Linear, Axes::One(_)) => Gauge::Slide(placed(&at, term.axes)),
        (Motion::Linear, _) => Gauge::Distance(placed(&at, term.axes)),
    };
    let (mut arm, zero) = ([Vec3::zero(); 2], Vec3::zero());
    put(&mut arm[0], 0, at.arm[0] + at.apart);
    put(&mut arm[1], 0, at.arm[1]);
    let value = at.displacement(term.motion, term.axes);
    let mut motion = Coupled {
        ends,
        gauge,
        factor,
        arm,
        borne: [zero; 2],
        lever: Lever::zero(),
        start: value,
        now: value,
        speed: 0.0,
        acted: zero,
        moment: [zero; 2],
    };
    motion.begin();
    let beside = input.joints.locked_by(term.joint);
    if is_guided(term, beside[1]) && at.turned_by(beside[1]) <= LOCK_AWRY {
        let [force, torque] = borne(&motion.ends, &motion.lever, 0, &at, &beside);
        put(&mut motion.borne[0], 0, force);
        put(&mut motion.borne[1], 0, torque);
        motion.begin();
    }
    (motion, value)
}

fn placed<M: Measure<f32>>(at: &Placed, axes: Axes) -> M {
    let mut measure = M::default();
    measure.place(0, at, axes);
    measure
}

/// Whether the joint's locks leave its bodies no other way to go than along or about the axis, in a direction
/// that can't turn.
fn is_guided(term: &Term, turns: Option<LockKind>) -> bool {
    match (term.motion, term.axes, turns) {
        (Motion::Linear, Axes::One(_), turns) => turns.is_some(),
        (Motion::Angular, Axes::One(axis), Some(LockKind::Hinge(about))) => axis == about,
        _ => false,
    }
}
