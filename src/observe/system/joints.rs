//! Rows of joints, measured where the bodies are.

use super::couplings;
use super::frames::Frames;
use super::*;
use crate::joint::{Axes, Axis, Lock, Motion, Row, RowKind, Spring};
use std::f64::consts::TAU;

/// Where an impulse comes from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// A lock by its index.
    Lock(usize),
    /// Another row, and which end of it: 0 the lower, 1 the upper, 2 both.
    Row(usize, usize),
    /// A coupling by its slot, and which end of it.
    Coupling(usize, usize),
}

/// A row of a joint, without its impulse.
#[derive(Clone, Copy, Debug)]
pub struct JointRow {
    pub(super) joint: u32,
    pub(super) source: Source,
    /// Force on the second body and torque.
    pub(super) direction: [DVec3; 2],
    /// Each joint of a coupling, with force and torque on the second body.
    pub(super) coupled: [Option<(u32, [DVec3; 2])>; 2],
    /// The row.
    pub row: SystemRow,
    pub(super) law: Law,
    /// Distance to the end of a range [m] or [rad].
    pub gap: Option<f64>,
    /// Error of a rigid direction [m] or [rad].
    pub error: f64,
    pub(super) yields: bool,
    pub(super) drives: bool,
}

impl System {
    pub(super) fn take_joints(&mut self, world: &World) {
        each_joint_row(world, &mut |one| {
            let joint = |slot: u32| JointHandle { slot, generation: world.joints.slots.generation(slot) };
            let owner = match one.source {
                Source::Coupling(slot, _) => Owner::Coupling(world.joints.couplings.handle(slot as u32)),
                Source::Lock(_) | Source::Row(..) => Owner::Joint(joint(one.joint)),
            };
            let law = SystemLaw {
                gap: one.gap,
                off: if one.law == Law::LOCKED && !one.drives { one.error } else { 0.0 },
                yields: one.yields,
                drives: one.drives,
                ..SystemLaw::new(one.law, owner)
            };
            self.push(law, &[one.row]);
        });
    }
}

/// The rows of the joints of awake bodies, then of couplings, at the present poses, in the order of the laws
/// of a system. Their number does not depend on the poses.
pub fn joint_rows(world: &World) -> Vec<JointRow> {
    let mut rows = Vec::new();
    each_joint_row(world, &mut |row| rows.push(*row));
    rows
}

/// Calls `f` with each row of the joints of awake bodies, then of couplings, at the present poses. Their
/// number and order do not depend on the poses.
pub(in crate::observe) fn each_joint_row(world: &World, f: &mut dyn FnMut(&JointRow)) {
    let (joints, bodies) = (&world.joints, &world.bodies);
    let enabled = |joint: u32| {
        let own = &joints.all[joint as usize];
        if !own.is_there() {
            return None;
        }
        let dense = own.bodies.map(|slot| bodies.slots.dense(slot) as usize);
        if dense.iter().any(|&i| bodies.traits[i].disabled) {
            return None;
        }
        let to = Joined {
            joint,
            bodies: dense.map(|i| (i < bodies.movers()).then_some(i)),
            at: Frames::new(dense.map(|i| &bodies.pose[i]), &own.frames),
            dt: world.buffers.dt.into(),
            mobility: [0, 1].map(|side| {
                let i = dense[side];
                if i < bodies.dynamic() { bodies.mass[i].inverse.into() } else { 0.0 }
            }),
            inertia: [0, 1].map(|side| {
                let i = dense[side];
                if i < bodies.dynamic() { inverse_inertia(bodies, i) } else { DMat3::ZERO }
            }),
        };
        Some((to, dense.iter().any(|&i| i < bodies.dynamic())))
    };
    let place = |joint: u32| enabled(joint).filter(|(_, acts)| *acts).map(|(to, _)| to);
    for (i, lock) in joints.locks.iter().enumerate() {
        if let Some(to) = place(lock.joint) {
            to.lock(i, lock, f);
        }
    }
    for (i, row) in joints.rows.iter().enumerate() {
        if let Some(to) = place(row.joint) {
            to.row(i, row, f);
        }
    }
    for (slot, coupling) in joints.couplings.live() {
        let [Some((a, acts)), Some((b, also))] = coupling.joints().map(enabled) else { continue };
        if acts || also {
            couplings::each_end(slot as usize, coupling, [&a, &b], f);
        }
    }
}

/// A joint at its bodies.
pub(super) struct Joined {
    pub(super) joint: u32,
    pub(super) bodies: [Option<usize>; 2],
    pub(super) at: Frames,
    dt: f64,
    /// Inverse masses [1/kg] and inertias [1/(kg m²)].
    mobility: [f64; 2],
    inertia: [DMat3; 2],
}

impl Joined {
    /// A row whose impulse is a force on the second body and a torque, with arms from the centres of mass.
    pub(super) fn rigid(&self, source: Source, [force, torque]: [DVec3; 2], arms: [DVec3; 2]) -> JointRow {
        let moments = arms.map(|arm| torque + arm.cross(force));
        let row = SystemRow::of_two(self.bodies, [-force, force], [-moments[0], moments[1]]);
        JointRow {
            joint: self.joint,
            source,
            direction: [force, torque],
            coupled: [None; 2],
            row,
            law: Law::LOCKED,
            gap: None,
            error: 0.0,
            yields: false,
            drives: false,
        }
    }

    fn lock(&self, i: usize, lock: &Lock, f: &mut dyn FnMut(&JointRow)) {
        use crate::joint::LockKind::{Hinge, Line, Point, Weld};
        let at = &self.at;
        let arms = if let Line(_) = lock.kind { [at.arm[0] + at.apart, at.arm[1]] } else { at.arm };
        for (direction, error) in at.locked(lock.kind) {
            let direction = match lock.kind {
                Point | Line(_) => [direction, DVec3::ZERO],
                Weld | Hinge(_) => [DVec3::ZERO, direction],
            };
            f(&JointRow { error, ..self.rigid(Source::Lock(i), direction, arms) });
        }
    }

    /// The direction in which a row's displacement grows, and the displacement.
    pub(super) fn measure(&self, motion: Motion, axes: Axes) -> ([DVec3; 2], f64) {
        let at = &self.at;
        let some = |v: DVec3, aside: DVec3| if v.length() > 1e-12 { v.normalize() } else { aside };
        let next = |axis: Axis| at.axis(0, Axis::ALL[(axis as usize + 1) % 3]);
        match (motion, axes) {
            (Motion::Linear, Axes::One(axis)) => {
                let axis = at.axis(0, axis);
                ([axis, DVec3::ZERO], axis.dot(at.apart))
            }
            (Motion::Linear, axes) => {
                let (across, aside) = match axes {
                    Axes::Perpendicular(axis) => {
                        let along = at.axis(0, axis);
                        (at.apart - along * along.dot(at.apart), next(axis))
                    }
                    _ => (at.apart, at.axis(0, Axis::X)),
                };
                ([some(across, aside), DVec3::ZERO], across.length())
            }
            (Motion::Angular, Axes::One(axis)) => {
                let [a, b] = [0, 1].map(|side| at.axis(side, axis));
                let middle = 1.0 + a.dot(b);
                let about = if middle > 1e-3 { (a + b) / middle } else { a };
                ([DVec3::ZERO, about], at.twist(axis))
            }
            (Motion::Angular, Axes::Perpendicular(axis)) => {
                let [a, b] = [0, 1].map(|side| at.axis(side, axis));
                let sine = a.cross(b);
                ([DVec3::ZERO, some(sine, next(axis))], libm::atan2(sine.length(), a.dot(b)))
            }
            (Motion::Angular, Axes::All) => {
                let turn = at.turn();
                ([DVec3::ZERO, some(turn, at.axis(0, Axis::X))], turn.length())
            }
        }
    }

    fn row(&self, i: usize, row: &Row, f: &mut dyn FnMut(&JointRow)) {
        let at = &self.at;
        let (direction, mut value) = self.measure(row.motion, row.axes);
        if row.motion == Motion::Angular && matches!(row.axes, Axes::One(_)) {
            // Angles are periodic: take the turn that is nearest to the target.
            let middle = match row.kind {
                RowKind::Limit { min, max } | RowKind::Yielding { min, max, .. } => 0.5 * (min + max),
                RowKind::Motor { position, .. } => position,
            };
            if middle.is_finite() {
                let middle = f64::from(middle);
                value -= TAU * ((value - middle) / TAU).round();
            }
        }
        let arms = [at.arm[0] + at.apart, at.arm[1]];
        let both = self.rigid(Source::Row(i, 2), direction, arms);
        match row.kind {
            RowKind::Limit { min, max } if min == max => {
                f(&JointRow { error: value - f64::from(min), ..both });
            }
            RowKind::Limit { min, max } => self.ends(i, &both, value, [min, max], None, f),
            RowKind::Yielding { min, max, spring } => {
                self.ends(i, &both, value, [min, max], Some(spring), f);
            }
            RowKind::Motor { position, velocity, spring, max_force } => {
                let off = value - f64::from(position);
                let [pull, give, speed] = self.implicit(&both, spring, velocity.into());
                let most = if give == f64::INFINITY { 0.0 } else { f64::from(max_force) * self.dt };
                let mut drive = JointRow { yields: give > 0.0, drives: true, ..both };
                drive.law = Law::Bounds { min: -most, max: most };
                drive.row.bias = pull * off - speed;
                drive.row.compliance = if give.is_finite() { give } else { 0.0 };
                f(&drive);
            }
        }
    }

    /// Both ends of a range.
    fn ends(
        &self,
        i: usize,
        both: &JointRow,
        value: f64,
        [min, max]: [f32; 2],
        spring: Option<Spring>,
        f: &mut dyn FnMut(&JointRow),
    ) {
        for (end, limit, sign) in [(0, min, 1.0), (1, max, -1.0)] {
            if !limit.is_finite() {
                continue;
            }
            let gap = sign * (value - f64::from(limit));
            let mut row = *both;
            row.source = Source::Row(i, end);
            row.direction = row.direction.map(|d| d * sign);
            row.row = row.row.times(sign);
            row.law = Law::AT_LEAST_ZERO;
            if let Some(spring) = spring {
                let [pull, give, _] = self.implicit(both, spring, 0.0);
                row.yields = true;
                row.row.bias = pull * gap;
                row.row.compliance = if give.is_finite() { give } else { 0.0 };
            } else {
                row.gap = Some(gap);
                row.error = (-gap).max(0.0);
            }
            f(&row);
        }
    }

    /// Implicit coefficients of a spring and a damper over the whole step: target speed per displacement,
    /// compliance, and the additional target speed.
    fn implicit(&self, row: &JointRow, spring: Spring, target: f64) -> [f64; 3] {
        let spring = spring.coefficients();
        let (mut k, mut c) = (f64::from(spring.stiffness), f64::from(spring.damping));
        if spring.per_mass {
            let row = &row.row;
            let side = |i: usize| {
                row.linear[i].length_squared() * self.mobility[i]
                    + row.angular[i].dot(self.inertia[i] * row.angular[i])
            };
            let mobility = side(0) + side(1);
            (k, c) = (k / mobility, c / mobility);
        }
        let d = self.dt * k + c;
        if d == f64::INFINITY {
            [0.0, 0.0, target]
        } else if d > 0.0 {
            [k / d, 1.0 / (self.dt * d), c / d * target]
        } else {
            [0.0, f64::INFINITY, 0.0]
        }
    }
}
