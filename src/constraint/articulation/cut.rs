//! Rows beside a tree: joints that close its loops, and motors of its hinges.
//!
//! Each loop is cut at one joint: a four-bar linkage, a ring or a bridge between two banks becomes a tree,
//! and the cut joint a few more rows (the cut-joint method of multibody dynamics). A motor is one more row,
//! with bounds. How the rows respond to each other through the whole tree follows from one exact solution per
//! row; then the rows are solved together, as a dense system, and the tree once more with their impulses (the
//! capacitance matrix method; Baraff, *Linear-Time Dynamics using Lagrange Multipliers*, 1996, treats loops
//! in this direction). Solved as an ordinary row, a motor knows the two bodies of its hinge and nothing of
//! the bodies that hang on them: the crank of a linkage had one and a half times its speed in the first step.
//!
//! A cut joint is a node after those of the bodies. It has its body a second time, and follows it.

use super::node::{TreeWidth, Turns, gather_up, pass_down};
use super::spatial::Twist;
use super::tree::TreeBatch;
use crate::config::tuning::JOINT_PUSH_SPEED;
use crate::constraint::joint::ends::NONE;
use crate::constraint::joint::spring::{ENDLESS, Spring, before_stops};
use crate::lanes::{Lanes, Mask, Vec3};

/// Maximum number of rows beside a tree: each is coupled to all others.
pub(crate) const MAX_ROWS: usize = 16;

/// Maximum bytes of a row, with its couplings to all others.
pub(crate) const ROW_BYTES: usize = {
    type L = crate::lanes::f32x8;
    size_of::<TreeMotor<L>>() + size_of::<Direction<L>>() + (2 + MAX_ROWS) * size_of::<L>()
};

/// A motor or a spring about the axis of a hinge, as the body of its node sees it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TreeMotor<L> {
    /// The row of each lane.
    pub(crate) owner: [u32; 8],
    pub(crate) node: u32,
    /// Angle less the target angle, at the start of the step [rad].
    pub(crate) off: L,
    /// Where the joint's own range stops it, beside `off` [rad].
    pub(crate) stops: [L; 2],
    pub(crate) spring: Spring<L>,
    /// Angular impulse on the body in the last substep [N m s].
    pub(crate) impulse: L,
    /// The impulse that the last solution subtracts from it.
    pub(crate) less: L,
}

impl<L: Lanes> TreeMotor<L> {
    pub(crate) fn new(node: u32) -> Self {
        TreeMotor { owner: [NONE; 8], node, stops: ENDLESS.map(L::splat), ..TreeMotor::default() }
    }

    #[inline(always)]
    fn bounded(&self, impulse: L) -> L {
        impulse.max(-self.spring.most).min(self.spring.most)
    }
}

/// A direction of relative motion of two bodies in which the tree alone does not meet the request.
#[derive(Clone, Copy, Debug)]
struct Direction<L> {
    /// Nodes; the second may be none.
    bodies: [u32; 2],
    arm: [Vec3<L>; 2],
    along: Twist<L>,
}

/// Which motors act.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) enum Drives {
    #[default]
    None,
    /// Those that do not yield: springs act once a substep.
    Rigid,
    All,
}

/// The rows of a batch of trees.
#[derive(Clone, Debug, Default)]
pub(crate) struct Extra<L> {
    pub(crate) motors: Vec<TreeMotor<L>>,
    /// Which motors act in this pass.
    pub(crate) drives: Drives,
    /// None acts, while a substep is solved in parts.
    pub(crate) idle: bool,
    /// The solution is for displacements, which hold only as far as directions do not change.
    pub(crate) shifts: bool,
    /// Those of cut joints, then those of motors.
    directions: Vec<Direction<L>>,
    /// Change of the speed along each row per impulse along another, row by row.
    answers: Vec<L>,
    /// The same for its own two bodies if nothing else held them, and the share of it that is uncertain.
    alone: Vec<[L; 2]>,
}

impl<L: Default> Extra<L> {
    /// Reserves memory for so many rows.
    pub(crate) fn new(motors: Vec<TreeMotor<L>>, rows: usize) -> Self {
        Extra {
            motors,
            directions: Vec::with_capacity(rows),
            answers: Vec::with_capacity(rows * rows),
            alone: Vec::with_capacity(rows),
            ..Extra::default()
        }
    }
}

impl<L> Extra<L> {
    pub(crate) fn reserved(&self) -> usize {
        size_of::<TreeMotor<L>>() * self.motors.capacity()
            + size_of::<Direction<L>>() * self.directions.capacity()
            + size_of::<L>() * (self.answers.capacity() + 2 * self.alone.capacity())
    }
}

// Rounding: other joints may leave little of a row's mobility.
/// Share of the mobility of its two bodies below which a row is held by others already. In a planar linkage
/// this is so for most rows of the last joint, and the mobility that remains is rounding.
const LEAST: f32 = 1e-4;
// Rounding: the same of a motor.
/// The same for a motor, which its bounds limit anyway.
const ROUNDING: f32 = 1e-7;
// Rounding: the same of displacements.
/// The same for displacements, during which directions turn.
const SHIFTED: f32 = 1e-2;
/// Maximum number of rounds in which the bounds of motors are applied.
const ROUNDS: usize = 8;

/// Number of rows of a cut joint.
pub(crate) fn rows_of(turns: Turns) -> usize {
    3 + match turns {
        Turns::Freely => 0,
        Turns::AboutAxis => 2,
        Turns::Not => 3,
    }
}

impl<L: TreeWidth> TreeBatch<L> {
    /// Sets up the rows for the current positions, and their responses to each other.
    pub(crate) fn factor_extra(&mut self) {
        let (real, mut extra) = (self.real, std::mem::take(&mut self.extra));
        extra.directions.clear();
        let axes = [Vec3::splat(glam::Vec3::X), Vec3::splat(glam::Vec3::Y), Vec3::splat(glam::Vec3::Z)];
        let zero = Vec3::zero();
        for node in &self.nodes[real..] {
            let mut direction = |linear, angular| {
                let along = Twist { linear, angular };
                extra.directions.push(Direction {
                    bodies: [node.own, node.parent],
                    arm: node.arm_now,
                    along,
                });
            };
            axes.into_iter().for_each(|axis| direction(axis, zero));
            match node.turns {
                Turns::Freely => {}
                Turns::AboutAxis => {
                    let (t, s) = node.axis_now[0].tangents();
                    direction(zero, t);
                    direction(zero, s);
                }
                Turns::Not => axes.into_iter().for_each(|axis| direction(zero, axis)),
            }
        }
        for motor in &extra.motors {
            let node = &self.nodes[motor.node as usize];
            let own = self.body_of(motor.node as usize) as u32;
            let along = Twist { linear: zero, angular: node.axis_now[0] };
            extra.directions.push(Direction { bodies: [own, node.parent], arm: node.arm_now, along });
        }
        extra.answers.clear();
        extra.alone.clear();
        let cut = extra.directions.len() - extra.motors.len();
        for (i, direction) in extra.directions.iter().enumerate() {
            self.push_along(std::iter::once((direction, L::one())));
            let answers = extra.directions.iter().map(|other| -self.change_along(other));
            extra.answers.extend(answers);
            let unknown = if i < cut { self.unknown_of(direction) } else { L::splat(ROUNDING) };
            extra.alone.push([self.alone_along(direction), unknown]);
        }
        self.nodes.iter_mut().for_each(|node| node.pushed = Twist::zero());
        self.extra = extra;
    }

    /// Solves the trees for impulses along some rows; positive ones act against the first body.
    fn push_along<'a>(&mut self, pushes: impl Iterator<Item = (&'a Direction<L>, L)>)
    where
        L: 'a,
    {
        self.nodes.iter_mut().for_each(|node| node.pushed = Twist::zero());
        for (direction, push) in pushes {
            let push = direction.along.scaled(push);
            let [own, other] = direction.bodies;
            self.nodes[own as usize].pushed.subtract(push.moved(direction.arm[0]));
            if let Some(other) = self.nodes.get_mut(other as usize) {
                other.pushed.add(push.moved(direction.arm[1]));
            }
        }
        self.nodes[..self.real].iter_mut().for_each(|node| node.requested = Twist::zero());
        gather_up(&mut self.nodes[..self.real]);
        pass_down(&mut self.nodes[..self.real]);
    }

    /// Change of the speed along a row in the last solution.
    fn change_along(&self, direction: &Direction<L>) -> L {
        let [own, other] = direction.bodies;
        let mut change = self.nodes[own as usize].change.seen_at(direction.arm[0]);
        if let Some(other) = self.nodes.get(other as usize) {
            change.subtract(other.change.seen_at(direction.arm[1]));
        }
        change.dot(&direction.along)
    }

    /// The share of [`alone_along`](TreeBatch::alone_along) that is uncertain for a row: rounding, and the
    /// rotation of directions within a substep. A ring of rods that folds flat has, for a moment, a direction
    /// in which nothing yields.
    fn unknown_of(&self, direction: &Direction<L>) -> L {
        let turned = direction.bodies.into_iter().filter_map(|body| self.nodes.get(body as usize));
        let most = turned.fold(L::zero(), |most, node| most.max(node.velocity.angular.length_squared()));
        (most * L::splat(self.h * self.h)).max(L::splat(LEAST))
    }

    /// Speed along a row per impulse along it, of its two bodies if nothing else held them.
    fn alone_along(&self, direction: &Direction<L>) -> L {
        let of = |side: usize| {
            self.nodes.get(direction.bodies[side] as usize).map_or(L::zero(), |node| {
                let push = direction.along.moved(direction.arm[side]);
                push.linear.length_squared() * node.inverse_mass
                    + push.angular.dot(node.stiffened_inverse.mul(push.angular))
            })
        };
        of(0) + of(1)
    }

    /// Solves the rows beside the trees and adds their effect to the solution of the trees.
    pub(crate) fn answer_extra(&mut self) {
        let (real, mut extra) = (self.real, std::mem::take(&mut self.extra));
        let mut rest = [L::zero(); MAX_ROWS];
        let cut = extra.directions.len() - extra.motors.len();
        let mut row = 0;
        for node in &self.nodes[real..] {
            for _ in 0..rows_of(node.turns) {
                let direction = &extra.directions[row];
                rest[row] = node.requested.dot(&direction.along) + self.change_along(direction);
                row += 1;
            }
        }
        if extra.drives != Drives::None {
            let over = L::splat(1.0 / self.h);
            // Where velocities relax, nothing is taken back.
            let rate = if extra.drives == Drives::All { over } else { L::zero() };
            for (motor, row) in extra.motors.iter().zip(cut..) {
                let (node, direction) = (&self.nodes[motor.node as usize], &extra.directions[row]);
                let above = self.nodes.get(node.parent as usize);
                let axis = direction.along.angular;
                let turns = above.map_or(node.anchored, |above| above.velocity).angular;
                let speed = axis.dot(node.velocity.angular - turns) + self.change_along(direction);
                let turned = above.map_or(node.anchor_moved, |above| above.moved).angular;
                let off = motor.off + (node.axis[0] + axis).dot(node.moved.angular - turned) * L::splat(0.5);
                let Spring { pull, speed: target, give, .. } = motor.spring;
                let requested =
                    before_stops(target, off, &motor.stops, over, [rate, L::splat(JOINT_PUSH_SPEED)]);
                rest[row] = speed - (requested - off * pull) + give * motor.impulse;
            }
        }
        let push = extra.solve(&rest, cut);
        for node in &mut self.nodes[..real] {
            (node.before, node.pushed_before) = ([node.change, node.force], node.pushed);
        }
        self.push_along(extra.directions.iter().zip(push));
        for node in &mut self.nodes[..real] {
            let [change, force] = node.before;
            node.change.add(change);
            node.force.add(force);
            node.pushed = node.pushed_before;
        }
        let (bodies, cuts) = self.nodes.split_at_mut(real);
        let mut row = 0;
        for node in cuts {
            node.change = bodies[node.own as usize].change;
            node.force = Twist::zero();
            for _ in 0..rows_of(node.turns) {
                node.force.add(extra.directions[row].along.scaled(push[row]));
                row += 1;
            }
        }
        for (motor, push) in extra.motors.iter_mut().zip(&push[cut..]) {
            motor.less = *push;
        }
        self.extra = extra;
    }

    /// The row of each cut joint and motor in turn, or none if its directions are those where bodies are now.
    /// Displacements that close joints come after trees that conserve energy are factored, and trees are
    /// factored again before velocities relax only if some in the batch do not.
    #[cfg(feature = "observe")]
    fn row_as_factored(&self, row: usize) -> Option<&Direction<L>> {
        self.extra.directions.get(row).filter(|_| self.all_exact())
    }

    /// The arms at which the joint of a node acts.
    #[cfg(feature = "observe")]
    pub(crate) fn arms_of(&self, node: usize) -> [Vec3<L>; 2] {
        let now = self.nodes[node].arm_now;
        if node < self.real {
            return now;
        }
        let row = self.nodes[self.real..node].iter().map(|cut| rows_of(cut.turns)).sum();
        self.row_as_factored(row).map_or(now, |row| row.arm)
    }

    /// The axis about which a motor acts, as its body sees it.
    #[cfg(feature = "observe")]
    pub(crate) fn axis_of(&self, motor: usize) -> Vec3<L> {
        let now = self.nodes[self.extra.motors[motor].node as usize].axis_now[0];
        let row = self.extra.directions.len().saturating_sub(self.extra.motors.len()) + motor;
        self.row_as_factored(row).map_or(now, |row| row.along.angular)
    }

    /// The node that represents the body of a node.
    pub(crate) fn body_of(&self, node: usize) -> usize {
        if node < self.real { node } else { self.nodes[node].own as usize }
    }
}

impl<L: Lanes> Extra<L> {
    /// Forgets the impulses of its motors: the rest is made anew in each substep.
    pub(in crate::constraint::articulation) fn forget(&mut self) {
        for motor in &mut self.motors {
            *motor = TreeMotor { owner: motor.owner, ..TreeMotor::new(motor.node) };
        }
    }

    /// The impulses that cancel `rest`. Rows from `cut` on are bounded: those that would exceed their bounds
    /// are fixed there, and the others solved again.
    #[expect(clippy::needless_range_loop, reason = "indices as in the formulas")]
    fn solve(&self, rest: &[L; MAX_ROWS], cut: usize) -> [L; MAX_ROWS] {
        let count = self.directions.len();
        let zero = L::zero();
        let mut fixed = [zero.gt(zero); MAX_ROWS];
        for (motor, fixed) in self.motors.iter().zip(&mut fixed[cut..]) {
            *fixed = match self.drives {
                Drives::None => zero.eq(zero),
                Drives::Rigid => motor.spring.give.gt(zero),
                Drives::All => zero.gt(zero),
            };
        }
        let idle = fixed;
        let mut least = [zero; MAX_ROWS];
        for (least, &[alone, unknown]) in least.iter_mut().zip(&self.alone) {
            *least = alone * if self.shifts { unknown.max(L::splat(SHIFTED)) } else { unknown };
        }
        let mut push = [zero; MAX_ROWS];
        let mut matrix = [[zero; MAX_ROWS]; MAX_ROWS];
        for _ in 0..ROUNDS {
            let mut right = [zero; MAX_ROWS];
            for i in 0..count {
                let mut sum = rest[i];
                for k in 0..count {
                    let answer = self.answers[i * count + k];
                    sum -= L::select(fixed[k], answer * push[k], zero);
                    matrix[i][k] = L::select(fixed[i] | fixed[k], zero, answer);
                }
                let own = if i >= cut { self.motors[i - cut].spring.give } else { zero };
                // A fixed row keeps its impulse below.
                matrix[i][i] = L::select(fixed[i], self.alone[i][0], matrix[i][i] + own);
                right[i] = L::select(fixed[i], zero, sum);
            }
            factorise(&mut matrix, &least[..count]);
            substitute(&matrix, &mut right, count);
            for ((push, right), fixed) in push.iter_mut().zip(right).zip(fixed) {
                *push = L::select(fixed, *push, right);
            }
            let mut changed = zero.gt(zero);
            for (motor, i) in self.motors.iter().zip(cut..) {
                let new = motor.impulse - push[i];
                let bounded = motor.bounded(new);
                let over = !(new.eq(bounded) | fixed[i]);
                // A row stays at its bound as long as it would exceed it.
                let mut more = rest[i] - motor.spring.give * push[i];
                for k in 0..count {
                    more -= self.answers[i * count + k] * push[k];
                }
                let back = fixed[i] & !idle[i] & (more * new).gt(zero);
                push[i] = L::select(over, motor.impulse - bounded, push[i]);
                fixed[i] = (fixed[i] | over) & !back;
                changed = changed | over | back;
            }
            if !changed.any() {
                break;
            }
        }
        for (motor, i) in self.motors.iter().zip(cut..) {
            let bounded = motor.bounded(motor.impulse - push[i]);
            push[i] = L::select(idle[i], zero, motor.impulse - bounded);
        }
        push
    }
}

/// L D Lᵀ factorisation of a symmetric matrix, in place: L in the lower triangle, and the inverse of D on the
/// diagonal, damped: for pivots below `least` the inverse goes to zero instead of growing.
#[expect(clippy::needless_range_loop, reason = "indices as in the formulas")]
fn factorise<L: Lanes>(m: &mut [[L; MAX_ROWS]; MAX_ROWS], least: &[L]) {
    for (i, &least) in least.iter().enumerate() {
        for k in 0..i {
            let mut sum = m[i][k];
            for j in 0..k {
                // Rows above hold L times D until they are done.
                sum -= m[i][j] * m[k][j];
            }
            m[i][k] = sum;
        }
        let mut own = m[i][i];
        for k in 0..i {
            let scaled = m[i][k] * m[k][k];
            own -= scaled * m[i][k];
            m[i][k] = scaled;
        }
        // Not squared: for very heavy bodies the squares would underflow.
        let some = own.gt(L::zero());
        let own = L::select(some, own, L::one());
        m[i][i] = L::select(some, L::one() / (own + least * (least / own)), L::zero());
    }
}

fn substitute<L: Lanes>(m: &[[L; MAX_ROWS]; MAX_ROWS], x: &mut [L; MAX_ROWS], count: usize) {
    for i in 0..count {
        for k in 0..i {
            x[i] -= m[i][k] * x[k];
        }
    }
    for i in 0..count {
        x[i] = x[i] * m[i][i];
    }
    for i in (0..count).rev() {
        for k in i + 1..count {
            x[i] -= m[k][i] * x[k];
        }
    }
}
