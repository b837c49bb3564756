//! Fills the rows of couplings and of motors in a step.

use super::{Coupled, CouplingRow, Gauge, Owner};
use crate::config::tuning::LOCK_AWRY;
use crate::constraint::contact::input::PrepareInput;
use crate::constraint::joint::ends::{Ends, Lever};
use crate::constraint::joint::fill::{borne, place};
use crate::constraint::joint::measure::Measure;
use crate::constraint::joint::spring::Spring;
use crate::joint::{Axes, Motion, Placed, RowKind, Spring as Coefficients, Term, is_guided};
use crate::lanes::Vec3;
use std::f32::consts::TAU;

impl CouplingRow {
    /// The row of a coupling or a motor, at the poses of its bodies and with its last load.
    pub(super) fn new(owner: Owner, input: &PrepareInput<'_>) -> CouplingRow {
        let mut row = match owner {
            Owner::Coupling(slot) => of_coupling(slot, input),
            Owner::Motor(index) => of_drive(index, input),
        };
        let p = row.impulse[0] - row.impulse[1];
        for motion in row.motions_mut() {
            (motion.acted, motion.moment) = motion.parts(p);
        }
        row
    }
}

fn of_coupling(slot: u32, input: &PrepareInput<'_>) -> CouplingRow {
    let coupling = &input.joints.couplings.all[slot as usize];
    let (factors, mut displacements) = (coupling.scaled(), coupling.displacements);
    let motions = [0, 1].map(|i| {
        let (motion, value) = coupled(slot, &coupling.terms[i], factors[i], input);
        displacements[i] = coupling.terms[i].unwrapped(value, displacements[i]);
        motion
    });
    let (sum, scale) = (coupling.sum(displacements), coupling.scale());
    let room = [sum - coupling.range[0], coupling.range[1] - sum].map(|room| (room / scale) as f32);
    let mut row = CouplingRow {
        owner: Owner::Coupling(slot),
        motions,
        drive: None,
        displacements,
        room,
        gap: room,
        equality: coupling.is_equality(),
        mobility: 0.0,
        impulse: coupling.impulse.map(|impulse| impulse * input.lengths.ratio()),
        lasting: coupling.lasting_impulse * input.lengths.ratio(),
    };
    row.measure();
    if row.mobility <= 0.0 {
        (row.impulse, row.lasting) = ([0.0; 2], 0.0);
    }
    row
}

fn of_drive(index: u32, input: &PrepareInput<'_>) -> CouplingRow {
    let row = &input.joints.rows[index as usize];
    let term = Term { joint: row.joint, motion: row.motion, axes: row.axes };
    let (motion, value) = coupled(index, &term, 1.0, input);
    let (position, velocity, spring, max_force) = match row.kind {
        RowKind::Motor { position, velocity, spring, max_force } => (position, velocity, spring, max_force),
        RowKind::Limit { .. } | RowKind::Yielding { .. } => (0.0, 0.0, RIGID, 0.0),
    };
    let mut off = value - position;
    if row.motion == Motion::Angular && off.is_finite() {
        // Whole turns don't matter.
        off -= TAU * (off / TAU).round();
    }
    let mut made = CouplingRow {
        owner: Owner::Motor(index),
        motions: [motion; 2],
        drive: Some(Spring::default()),
        displacements: [0.0; 2],
        room: [off, 0.0],
        gap: [off, 0.0],
        equality: false,
        mobility: 0.0,
        impulse: [row.impulse[0] * input.lengths.ratio(), 0.0],
        lasting: 0.0,
    };
    made.measure();
    let spring = spring.coefficients();
    // Without spring and damper it does nothing.
    let numbers = (made.mobility > 0.0).then(|| spring.with_mobility(made.mobility));
    let h = input.lengths.now();
    match numbers.and_then(|spring| Spring::new(&spring, velocity, max_force * h, h)) {
        Some(spring) => made.drive = Some(spring),
        None => made.impulse = [0.0; 2],
    }
    made
}

/// Marks a row that is no motor.
const RIGID: Coefficients = Coefficients::Coefficients { stiffness: 0.0, damping: 0.0 };

/// A motion, and its displacement without whole turns.
fn coupled(owner: u32, term: &Term, factor: f32, input: &PrepareInput<'_>) -> (Coupled, f32) {
    let mut ends = Ends::default();
    let joint = &input.joints.all[term.joint as usize];
    let at = place(&mut ends, 0, owner, joint, input);
    let gauge = match (term.motion, term.axes) {
        (Motion::Angular, _) => Gauge::Twist(placed(&at, term.axes)),
        (Motion::Linear, Axes::One(_)) => Gauge::Slide(placed(&at, term.axes)),
        (Motion::Linear, _) => Gauge::Distance(placed(&at, term.axes)),
    };
    let (mut arm, zero) = ([Vec3::zero(); 2], Vec3::zero());
    arm[0].set_lane(0, at.arm[0] + at.apart);
    arm[1].set_lane(0, at.arm[1]);
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
    if is_guided(term.motion, term.axes, beside[1]) && at.turned_by(beside[1]) <= LOCK_AWRY {
        let [force, torque] = borne(&motion.ends, &motion.lever, 0, &at, &beside);
        motion.borne[0].set_lane(0, force);
        motion.borne[1].set_lane(0, torque);
        motion.begin();
    }
    (motion, value)
}

fn placed<M: Measure<f32>>(at: &Placed, axes: Axes) -> M {
    let mut measure = M::default();
    measure.place(0, at, axes);
    measure
}
