//! Fills the batches of joints in a step: positions and masses of the bodies, and the impulses of the step
//! before.

use super::batch::Filled;
use super::ends::{Ends, Lever, NONE, across, inverse};
use super::line::LineBatch;
use super::lock::{PointBatch, TurnBatch, mobility};
use super::measure::Measure;
use super::row::RowBatch;
use super::spring::{ENDLESS, Spring};
use crate::config::tuning::{LOCK_AWRY, TREE_RECOVERY, TREE_RECOVERY_TOUCHING};
use crate::constraint::articulation::cut::TreeMotor;
use crate::constraint::articulation::node::Node;
use crate::constraint::articulation::node::TreeWidth;
use crate::constraint::articulation::tree::TreeBatch;
use crate::constraint::contact::batch::lock_bits;
use crate::constraint::contact::input::PrepareInput;
use crate::joint::{Axes, Axis, Joint, Joints, LockKind, Motion, Placed, Row, RowKind};
use crate::lanes::{GatherLanes, Lanes, Sym3, Vec3};

/// Enters a joint's bodies into a lane and returns where its frames are.
pub(super) fn place<L: Lanes>(
    ends: &mut Ends<L>,
    lane: usize,
    owner: u32,
    joint: &Joint,
    input: &PrepareInput<'_>,
) -> Placed {
    let bodies = input.bodies;
    let (dynamic, movers) = (bodies.dynamic(), bodies.movers());
    let dense = joint.bodies.map(|slot| bodies.slots.dense(slot) as usize);
    for (side, &i) in dense.iter().enumerate() {
        // All static bodies share the record after those of moving ones, which is zero.
        ends.body[side][lane] = i.min(movers) as u32;
        let pushed = i < dynamic;
        ends.write[side] |= u32::from(pushed) << lane;
        ends.inverse_mass[side].set_lane(lane, if pushed { bodies.mass[i].inverse } else { 0.0 });
        if pushed && bodies.locked > 0 {
            ends.locks[side] |= lock_bits(bodies.traits[i].locks, lane);
        }
        let inertia = if pushed { input.forces.inverse_inertia[i] } else { Sym3::default() };
        ends.inverse_inertia[side].set_lane(lane, &inertia);
    }
    ends.owner[lane] = owner;
    Placed::new(dense.map(|i| &bodies.pose[i]), &joint.frames)
}

/// Gives inert lanes the bodies of the first lane.
fn close<L: Lanes>(ends: &mut Ends<L>) {
    for side in 0..2 {
        for lane in 1..8 {
            if ends.owner[lane] == NONE {
                ends.body[side][lane] = ends.body[side][0];
            }
        }
    }
}

impl<L: GatherLanes> Filled for PointBatch<L> {
    fn fill(&mut self, owners: &[u32], input: &PrepareInput<'_>) {
        *self = Self::default();
        for (lane, &owner) in owners.iter().enumerate().filter(|(_, o)| **o != NONE) {
            place_point(self, lane, owner, input);
        }
        close(&mut self.ends);
        (self.arm_now, self.apart_now) = (self.arm, self.apart);
        self.moment = [0, 1].map(|side| self.arm[side].cross(self.impulse));
        self.mass = inverse(&mobility(&self.ends, &self.arm));
    }
}

impl<L: GatherLanes> Filled for LineBatch<L> {
    fn fill(&mut self, owners: &[u32], input: &PrepareInput<'_>) {
        *self = Self::default();
        for (lane, &owner) in owners.iter().enumerate().filter(|(_, o)| **o != NONE) {
            let LockKind::Line(axis) = input.joints.locks[owner as usize].kind else { continue };
            let at = place_point(&mut self.point, lane, owner, input);
            self.axis.set_lane(lane, at.axis(0, axis));
        }
        close(&mut self.point.ends);
        self.begin();
    }
}

impl<L: GatherLanes, const HINGE: bool> Filled for TurnBatch<L, HINGE> {
    fn fill(&mut self, owners: &[u32], input: &PrepareInput<'_>) {
        *self = Self::default();
        for (lane, &owner) in owners.iter().enumerate().filter(|(_, o)| **o != NONE) {
            let lock = &input.joints.locks[owner as usize];
            let at = place(&mut self.ends, lane, owner, &input.joints.all[lock.joint as usize], input);
            let mut impulse = lock.impulse;
            let error = if let LockKind::Hinge(axis) = lock.kind {
                let axes = [0, 1].map(|side| at.axis(side, axis));
                self.axis[0].set_lane(lane, axes[0]);
                self.axis[1].set_lane(lane, axes[1]);
                // A hinge transmits nothing about its axis, which has turned since.
                impulse -= axes[0] * axes[0].dot(impulse);
                axes[0].cross(axes[1])
            } else {
                at.turn()
            };
            self.impulse.set_lane(lane, impulse * input.lengths.ratio());
            self.lasting
                .set_lane(lane, impulse.normalize_or_zero() * (lock.lasting_impulse * input.lengths.ratio()));
            self.error.set_lane(lane, error);
        }
        close(&mut self.ends);
        (self.axis_now, self.error_now) = (self.axis[0], self.error);
        let turning = self.ends.turning();
        self.mass = if HINGE { across(&turning, self.axis_now) } else { inverse(&turning) };
    }
}

impl<L: GatherLanes, M: Measure<L>> Filled for RowBatch<L, M> {
    fn fill(&mut self, owners: &[u32], input: &PrepareInput<'_>) {
        *self = Self::default();
        let h = input.lengths.now();
        let mut placed = [None; 8];
        for (lane, &owner) in owners.iter().enumerate().filter(|(_, o)| **o != NONE) {
            let row = &input.joints.rows[owner as usize];
            let at = place(&mut self.ends, lane, owner, &input.joints.all[row.joint as usize], input);
            let mut value = self.measure.place(lane, &at, row.axes);
            self.arm[0].set_lane(lane, at.arm[0] + at.apart);
            self.arm[1].set_lane(lane, at.arm[1]);
            placed[lane] = Some(at);
            if row.motion == Motion::Angular && matches!(row.axes, Axes::One(_)) {
                value = with_turns(row, value, input.joints);
            }
            self.value.set_lane(lane, value);
        }
        close(&mut self.ends);
        self.begin();
        for (lane, at) in placed.iter().enumerate() {
            let Some(at) = at else { continue };
            let row = &input.joints.rows[owners[lane] as usize];
            if !row.is_guided() || at.turned_by(row.beside[1]) > LOCK_AWRY {
                continue;
            }
            let [force, torque] = borne(&self.ends, &self.lever, lane, at, &row.beside);
            self.borne[0].set_lane(lane, force);
            self.borne[1].set_lane(lane, torque);
        }
        self.begin();
        let mobility = self.ends.mobility(&self.lever);
        for (lane, &owner) in owners.iter().enumerate().filter(|(_, o)| **o != NONE) {
            let row = &input.joints.rows[owner as usize];
            let mobility = mobility.lane(lane);
            if mobility <= 0.0 {
                continue;
            }
            let (mut most, mut target) = (f32::INFINITY, 0.0);
            let (min, max, spring) = match row.kind {
                RowKind::Limit { min, max } => (min, max, None),
                RowKind::Yielding { min, max, spring } => (min, max, Some(spring)),
                RowKind::Motor { position, velocity, spring, max_force } => {
                    (most, target) = (max_force * h, velocity);
                    (position, position, Some(spring))
                }
            };
            let drive = matches!(row.kind, RowKind::Motor { .. });
            if let Some([low, high]) = stops(row, self.value.lane(lane), input) {
                self.stops[0].set_lane(lane, low);
                self.stops[1].set_lane(lane, high);
            }
            let own = match spring {
                Some(spring) => Spring::new(&spring.coefficients().with_mobility(mobility), target, most, h),
                None => Some(Spring { most, ..Spring::default() }),
            };
            let Some(own) = own else { continue };
            self.spring.set_lane(lane, &own);
            self.min.set_lane(lane, min);
            self.max.set_lane(lane, max);
            self.drives |= u32::from(drive) << lane;
            self.springs |= u32::from(spring.is_some() && !drive) << lane;
            self.both |= u32::from(!drive && spring.is_none() && min == max) << lane;
            self.lasting.set_lane(lane, row.lasting_impulse * input.lengths.ratio());
            for (impulse, old) in self.impulse.iter_mut().zip(row.impulse) {
                impulse.set_lane(lane, old * input.lengths.ratio());
            }
        }
        self.resume();
    }
}

/// Puts the points of a lock, and the impulse of the last step on them, into a lane.
fn place_point<L: GatherLanes>(
    batch: &mut PointBatch<L>,
    lane: usize,
    owner: u32,
    input: &PrepareInput<'_>,
) -> Placed {
    let lock = &input.joints.locks[owner as usize];
    let at = place(&mut batch.ends, lane, owner, &input.joints.all[lock.joint as usize], input);
    batch.impulse.set_lane(lane, lock.impulse * input.lengths.ratio());
    batch
        .lasting
        .set_lane(lane, lock.impulse.normalize_or_zero() * (lock.lasting_impulse * input.lengths.ratio()));
    batch.arm[0].set_lane(lane, at.arm[0]);
    batch.arm[1].set_lane(lane, at.arm[1]);
    batch.apart.set_lane(lane, at.apart);
    at
}

/// An angle of a row with its whole turns: a motor has those that the limit of its hinge knows.
fn with_turns(row: &Row, angle: f32, joints: &Joints) -> f32 {
    let drive = matches!(row.kind, RowKind::Motor { .. });
    let known = if drive { joints.with_turns(row.joint, row.axes, angle) } else { None };
    known.unwrap_or_else(|| row.with_turns(angle))
}

/// Where rigid ends of a range of its joint stop a motor that does not yield, beside its own displacement.
fn stops(row: &Row, value: f32, input: &PrepareInput<'_>) -> Option<[f32; 2]> {
    let RowKind::Motor { velocity, spring, .. } = row.kind else { return None };
    // Friction goes nowhere.
    if velocity == 0.0 || spring.coefficients().damping != f32::INFINITY {
        return None;
    }
    let (joints, mut stops) = (input.joints, None);
    for other in &joints.rows[joints.row_range(row.joint)] {
        let RowKind::Limit { min, max } = other.kind else { continue };
        if (other.motion, other.axes) != (row.motion, row.axes) {
            continue;
        }
        // The limit may count other turns than the motor.
        let turns = match row.motion {
            Motion::Angular => other.with_turns(value) - value,
            Motion::Linear => 0.0,
        };
        let [low, high] = stops.unwrap_or(ENDLESS);
        stops = Some([(min - turns).max(low), (max - turns).min(high)]);
    }
    stops
}

/// The force and torque that the locks of a joint add to an impulse of one of its rows so that it moves
/// nothing they hold: the row with the locks of its joint eliminated. Solved alone, an end stop far from the
/// centre of mass turns the body first, and the weld has to turn it back.
///
/// Only for rows with a fixed linear direction. Cones and twists on balls improve by a tenth at rest, but in
/// two of six throws of a hundred figures one was torn apart (tests/joints/ragdolls.rs, by 2 m and 12 m):
/// trees know their mobility already.
pub(super) fn borne<L: GatherLanes>(
    ends: &Ends<L>,
    lever: &Lever<L>,
    lane: usize,
    at: &Placed,
    beside: &[Option<LockKind>; 2],
) -> [glam::Vec3; 2] {
    let inertia = [0, 1].map(|side| {
        let Sym3 { xx, yy, zz, xy, xz, yz } = ends.inverse_inertia[side].lane(lane);
        glam::Mat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
    });
    let moving = ends.moving(Vec3::splat(glam::Vec3::ONE)).map(|on| on.lane(lane));
    let mass = moving[0] * ends.inverse_mass[0].lane(lane) + moving[1] * ends.inverse_mass[1].lane(lane);
    let arm = lever.arm.map(|arm| arm.lane(lane));
    // Change along one direction by an impulse along another.
    let moments = |[f, t]: [glam::Vec3; 2]| arm.map(|arm| t + arm.cross(f));
    let change = |a: [glam::Vec3; 2], b: [glam::Vec3; 2]| {
        let (m, n) = (moments(a), moments(b));
        (mass * a[0]).dot(b[0]) + m[0].dot(inertia[0] * n[0]) + m[1].dot(inertia[1] * n[1])
    };
    let own = [lever.force.lane(lane), lever.torque.lane(lane)];
    let zero = glam::Vec3::ZERO;
    // Gram-Schmidt: the directions of the locks, each without its components along those before it, and then
    // the rest of the row.
    let (mut locks, mut count) = ([([zero; 2], 0.0); 6], 0);
    let less = |mut v: [glam::Vec3; 2], locks: &[([glam::Vec3; 2], f32)]| {
        for (lock, mobility) in locks {
            let share = change(v, *lock) / mobility;
            v = [v[0] - lock[0] * share, v[1] - lock[1] * share];
        }
        v
    };
    for kind in beside.iter().flatten() {
        for axis in Axis::ALL {
            let n = at.axis(0, axis);
            let direction = match kind {
                LockKind::Line(free) | LockKind::Hinge(free) if *free == axis => continue,
                LockKind::Line(_) | LockKind::Point => [n, zero],
                LockKind::Hinge(_) | LockKind::Weld => [zero, n],
            };
            let rest = less(direction, &locks[..count]);
            let mobility = change(rest, rest);
            // Directions that can't move or are locked already add nothing.
            if mobility > GONE * change(direction, direction) {
                locks[count] = (rest, mobility);
                count += 1;
            }
        }
    }
    let rest = less(own, &locks[..count]);
    // A row along a locked direction is left to fight its lock.
    if change(rest, rest) > GONE * change(own, own) {
        [rest[0] - own[0], rest[1] - own[1]]
    } else {
        [zero; 2]
    }
}

// Rounding: of a mobility.
/// Share of a mobility below which the rest is rounding.
const GONE: f32 = 1e-4;

/// Fills a batch of trees. `touching`: dynamic bodies that have contacts.
pub(crate) fn fill_tree<L: TreeWidth>(
    batch: &mut TreeBatch<L>,
    input: &PrepareInput<'_>,
    inverse_inertia: &[Sym3<f32>],
    touching: &[bool],
) {
    batch.forget();
    let mut share = [TREE_RECOVERY; 8];
    let bodies = input.bodies;
    let (dynamic, movers) = (bodies.dynamic(), bodies.movers());
    for node in &mut batch.nodes {
        let side = usize::from(node.side);
        // Identity, so that inert lanes stay finite.
        let mut own_inverse = Sym3 { xx: L::one(), yy: L::one(), zz: L::one(), ..Sym3::default() };
        for (lane, share) in share.iter_mut().enumerate().take(L::N) {
            let owner = node.owner[lane];
            if owner == NONE {
                (node.body[lane], node.anchor[lane]) = (node.body[0], node.anchor[0]);
                continue;
            }
            let lock = &input.joints.locks[owner as usize];
            let joint = &input.joints.all[lock.joint as usize];
            let dense = joint.bodies.map(|slot| bodies.slots.dense(slot) as usize);
            let (own, other) = (dense[side], dense[1 - side]);
            node.body[lane] = own as u32;
            // Used only for roots.
            node.anchor[lane] = if other < dynamic { own } else { other.min(movers) } as u32;
            node.write |= 1 << lane;
            if touching[own] {
                *share = TREE_RECOVERY_TOUCHING;
            }
            let inverse = bodies.mass[own].inverse;
            node.inverse_mass.set_lane(lane, inverse);
            own_inverse.set_lane(lane, &inverse_inertia[own]);
            let (mass, drift) = (&bodies.mass[own], &mut node.drift);
            drift.moments.put(lane, bodies.pose[own].rotation, mass.inertia, mass.inverse_inertia);
            let pull = input.forces.acceleration.get(own).map_or(glam::Vec3::ZERO, |pull| pull.linear);
            drift.pull.set_lane(lane, pull);
            node.velocity.angular.set_lane(lane, bodies.velocity[own].angular);
            if node.jointed {
                let at = Placed::new(dense.map(|i| &bodies.pose[i]), &joint.frames);
                let sign = if side == 1 { 1.0 } else { -1.0 };
                node.arm[0].set_lane(lane, at.arm[side]);
                node.arm[1].set_lane(lane, at.arm[1 - side]);
                node.apart.set_lane(lane, at.apart * sign);
                node.impulse.set_lane(lane, lock.impulse * (sign * input.lengths.ratio()));
                node.steady.set_lane(lane, lock.steady * input.lengths.ratio());
                if node.turn_owner[lane] != NONE {
                    let lock = &input.joints.locks[node.turn_owner[lane] as usize];
                    node.twist.set_lane(lane, lock.impulse * (sign * input.lengths.ratio()));
                    if let LockKind::Hinge(axis) = lock.kind {
                        let axes = [at.axis(side, axis), at.axis(1 - side, axis)];
                        node.axis[0].set_lane(lane, axes[0]);
                        node.axis[1].set_lane(lane, axes[1]);
                        node.error.set_lane(lane, axes[1].cross(axes[0]));
                    } else {
                        node.error.set_lane(lane, at.turn() * sign);
                    }
                }
            }
        }
        node.inertia = inverse(&own_inverse);
    }
    let nodes = &batch.nodes;
    batch.extra.motors.iter_mut().for_each(|motor| fill_motor(motor, &nodes[motor.node as usize], input));
    batch.share = L::load(&share);
    batch.begin(input.lengths.now(), input.measures.unit);
    batch.look_back(&input.joints.locks);
}

/// Fills the motor of a hinge, as seen from the body of its node.
fn fill_motor<L: Lanes>(motor: &mut TreeMotor<L>, node: &Node<L>, input: &PrepareInput<'_>) {
    let sign = if node.side == 1 { 1.0 } else { -1.0 };
    for lane in (0..L::N).filter(|&lane| motor.owner[lane] != NONE) {
        let row = &input.joints.rows[motor.owner[lane] as usize];
        let RowKind::Motor { position, velocity, spring, max_force } = row.kind else { continue };
        let joint = &input.joints.all[row.joint as usize];
        let dense = joint.bodies.map(|slot| input.bodies.slots.dense(slot) as usize);
        let at = Placed::new(dense.map(|i| &input.bodies.pose[i]), &joint.frames);
        let Axes::One(axis) = row.axes else { continue };
        let off = with_turns(row, at.twist(axis), input.joints) - position;
        let off = if off.is_finite() { off } else { 0.0 };
        if let Some(ends) = stops(row, position + off, input) {
            let [low, high] = ends.map(|end| (end - position) * sign);
            motor.stops[0].set_lane(lane, low.min(high));
            motor.stops[1].set_lane(lane, low.max(high));
        }
        // Without spring and damper it does nothing.
        let h = input.lengths.now();
        let own = Spring::new(&spring.coefficients(), velocity, max_force * h, h).unwrap_or_default();
        motor.off.set_lane(lane, off * sign);
        motor.spring.set_lane(lane, &Spring { speed: own.speed * sign, ..own });
        motor.impulse.set_lane(lane, row.impulse[0] * (input.lengths.ratio() * sign));
    }
}
