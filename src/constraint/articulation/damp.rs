//! Trees that whip: their substep is solved again by backward Euler, and their energy bounded.
//!
//! When light bodies between a load and its anchor straighten, the load stops within a substep, and its
//! energy would turn them at hundreds of radians per second and more. No velocities at the start of that
//! substep leave the tree closed at its end, however its joints are linearised; if they are solved for all
//! the same, bodies end up anywhere. So such a substep is taken back. The bodies are placed where all joints
//! are closed, as near as possible, weighted by inertia, to where they would be without joints: backward
//! Euler (Baraff and Witkin, *Large Steps in Cloth Simulation*, 1998), with the directions of forces at the
//! end of the substep. Such a configuration always exists. The displacement to it gives the new velocities;
//! the energy of the jerk is lost.
//!
//! It is found by Newton's method with the exact solution of the tree and with geometric stiffness
//! ([`TreeBatch::add_geometric_stiffness`]), which keeps light bodies from overshooting. If it is not found,
//! the tree moves on as one rigid piece without rotation, closed as it was.

use super::free_rotation::{exp, log};
use super::node::{Node, TreeWidth, gather_up, on_nodes, with_parent};
use super::spatial::Twist;
use super::transfer::{read_displacements, read_velocities};
use super::tree::TreeBatch;
use crate::config::tuning::{JOINT_OPEN, TREE_CLOSED, TREE_ENERGY_BAND, TREE_STRAIN};
use crate::constraint::contact::row::Motion;
use crate::constraint::joint::ends::NONE;
use crate::lanes::{Mask, Vec3, scatter};

/// Maximum number of Newton rounds, and the largest rotation of a body in one [rad].
const ROUNDS: u32 = 24;
// Guard: Newton's method goes no further at once.
const FURTHEST: f32 = 0.5;

impl<L: TreeWidth> TreeBatch<L> {
    /// Returns those of the watched lanes in which velocities open joints wide or gain energy. Stores where
    /// their bodies were at the start of the substep.
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees.
    pub(crate) unsafe fn strained(&mut self, motion: &Motion<'_, '_>) -> L::Mask {
        // SAFETY: by the contract.
        unsafe { read_velocities(&mut self.nodes, motion) };
        sum_impulses(&mut self.nodes, self.real);
        let watched = L::Mask::from_bits(self.watched);
        for node in &mut self.nodes {
            let (mut own, start) = (node.velocity, &mut node.start);
            let given = Twist { linear: node.pushed.linear * node.inverse_mass, angular: node.gained };
            own.subtract(given);
            start.moved = Twist::select(watched, node.moved, start.moved);
            start.free = Twist::select(watched, own, start.free);
            start.driven = Vec3::zero();
        }
        let mut strained = L::zero().gt(L::zero());
        if self.extra.motors.is_empty() {
            let [now, free] = [self.energy(|node| node.velocity), self.energy(|node| node.start.free)];
            strained = !now.lt(free * self.tolerated()) & self.hangs_still();
        } else {
            self.add_motors(|node| &mut node.start.driven);
            for node in &mut self.nodes {
                node.start.driven = node.stiffened_inverse.mul(node.start.driven);
            }
        }
        // SAFETY: by the contract.
        unsafe { read_displacements(&mut self.nodes, motion, self.exact) };
        self.place(0.0);
        for node in self.nodes.iter().filter(|node| node.jointed) {
            let [a, b] = node.arm_now;
            let reach = a.length_squared() + b.length_squared();
            let most = reach * L::splat(TREE_STRAIN * TREE_STRAIN);
            strained = strained | !(node.apart_now.length_squared().lt(most));
        }
        strained & watched
    }

    /// Solves the substep of some lanes again.
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees.
    #[cold]
    #[inline(never)]
    pub(crate) unsafe fn damp(&mut self, motion: &Motion<'_, '_>, lanes: L::Mask) {
        self.damped |= lanes.bits();
        let inverse_h = L::splat(1.0 / self.h);
        for node in &mut self.nodes {
            node.moved = Twist::select(lanes, node.start.moved, node.moved);
        }
        self.place(0.0);
        self.find_closed(lanes);
        let held = self.open_by(JOINT_OPEN) & lanes;
        if held.any() {
            self.hold(held);
        }
        for node in &mut self.nodes {
            let turn = log(exp(node.moved.angular).compose(exp(node.start.moved.angular).conjugate()));
            let linear = (node.moved.linear - node.start.moved.linear) * inverse_h;
            node.velocity = Twist { linear, angular: turn * inverse_h };
        }
        let most = self.energy(|node| {
            let Twist { linear, angular } = node.start.free;
            Twist { linear, angular: angular + node.start.driven }
        });
        self.bound_energy(most, lanes);
        sum_impulses(&mut self.nodes, self.real);
        self.add_motors(|node| &mut node.pushed.angular);
        self.add_geometric_stiffness();
        for node in &mut self.nodes {
            let gained = node.stiffened_inverse.mul(node.pushed.angular);
            node.gained = Vec3::select(lanes, gained, node.gained);
            // The change of the velocities before rows acted: beside the impulses of other rows, the joints
            // are to be warm-started with these impulses.
            node.change = node.velocity;
            node.change.subtract(node.start.free);
            node.change.subtract(Twist { linear: node.pushed.linear * node.inverse_mass, angular: gained });
        }
        // SAFETY: by the contract.
        unsafe {
            self.shift(motion, lanes.bits());
            self.put_back(motion, lanes, held);
        }
    }

    /// Moves the bodies of some lanes to where all joints are closed, by Newton's method.
    fn find_closed(&mut self, lanes: L::Mask) {
        let (h, inverse_h) = (L::splat(self.h), L::splat(1.0 / self.h));
        let mut left = lanes;
        for _ in 0..ROUNDS {
            self.add_geometric_stiffness_where(lanes);
            for node in &mut self.nodes {
                let spin = node.start.free.angular + node.start.driven;
                let goal = exp(spin * h).compose(exp(node.start.moved.angular));
                let turn = log(goal.compose(node.turn.conjugate()));
                node.velocity = Twist {
                    linear: node.start.moved.linear + node.start.free.linear * h - node.moved.linear,
                    angular: node.stiffened_inverse.mul(node.inertia.mul(turn)),
                };
                node.pushed = Twist::zero();
            }
            self.repeat_bodies();
            self.factor();
            // The anchor has moved already.
            for i in 0..self.nodes.len() {
                let (parent, node) = self.with_parent(i);
                let [arm, other] = node.arm_now;
                node.requested = node.velocity.seen_at(arm);
                if let Some(parent) = parent {
                    node.requested.subtract(parent.velocity.seen_at(other));
                }
                node.requested.add(node.open());
            }
            gather_up(&mut self.nodes[..self.real]);
            self.extra.shifts = true;
            self.answer_all();
            self.extra.shifts = false;
            let mut most = L::one();
            for node in &mut self.nodes {
                node.change.add(node.velocity);
                most = most.max(node.change.angular.length_squared() * L::splat(1.0 / (FURTHEST * FURTHEST)));
            }
            let share = L::one() / most.sqrt();
            for node in &mut self.nodes {
                node.shift(Twist::select(left, node.change.scaled(share), Twist::zero()));
                let force = node.force.scaled(-inverse_h);
                node.impulse = Vec3::select(left, force.linear, node.impulse);
                node.twist = Vec3::select(left, force.angular, node.twist);
            }
            self.place(0.0);
            left = left & (self.open_by(TREE_CLOSED * JOINT_OPEN) | most.gt(L::one()));
            if !left.any() {
                break;
            }
        }
    }

    /// Writes the velocities of some lanes, and those before rows acted; where trees move on as one piece,
    /// nothing is warm-started.
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees.
    unsafe fn put_back(&self, motion: &Motion<'_, '_>, lanes: L::Mask, held: L::Mask) {
        for node in self.of_bodies() {
            let new = scatter(node.velocity.linear, node.velocity.angular);
            let more = scatter(node.change.linear, node.change.angular);
            for lane in (0..L::N).filter(|lane| (node.write & lanes.bits()) >> lane & 1 != 0) {
                let body = node.body[lane] as usize;
                // SAFETY: by the contract; no body is twice in a batch.
                let (v, base) = unsafe { (motion.velocity.get(body), motion.base.get(body)) };
                (v.linear, v.angular) = (new[lane].linear, new[lane].angular);
                base.linear += more[lane].linear;
                base.angular += more[lane].angular;
                if held.bits() >> lane & 1 != 0 || !(base.linear.is_finite() && base.angular.is_finite()) {
                    (base.linear, base.angular) = (v.linear, v.angular);
                }
            }
        }
    }

    /// Moves trees on as one rigid piece without rotation: closed joints stay closed.
    fn hold(&mut self, lanes: L::Mask) {
        let (h, zero) = (L::splat(self.h), Vec3::zero());
        let (mut mass, mut momentum) = (L::zero(), zero);
        for node in &self.nodes[..self.real] {
            let own = L::one() / node.inverse_mass;
            mass += own;
            momentum += node.start.free.linear * own;
        }
        let root = &self.nodes[0];
        let velocity =
            if root.jointed { root.anchored.at(root.arm_now[1]) } else { momentum * (L::one() / mass) };
        let path = velocity * h;
        let is_finite = path.length_squared().lt(L::splat(f32::MAX));
        let path = Vec3::select(is_finite, path, zero);
        for node in &mut self.nodes {
            let mut moved = node.start.moved;
            moved.linear += path;
            node.moved = Twist::select(lanes, moved, node.moved);
            node.impulse = Vec3::select(lanes, zero, node.impulse);
            node.twist = Vec3::select(lanes, zero, node.twist);
        }
        self.place(0.0);
    }

    /// Kinetic energy [J].
    pub(crate) fn energy(&self, of: impl Fn(&Node<L>) -> Twist<L>) -> L {
        self.of_bodies().iter().fold(L::zero(), |sum, node| {
            let Twist { linear, angular } = of(node);
            let own = linear.length_squared() / node.inverse_mass + angular.dot(node.inertia.mul(angular));
            sum + L::splat(0.5) * own
        })
    }

    /// Factor by which energy may seem to grow in a substep in which directions turn.
    fn tolerated(&self) -> L {
        let fastest = |most: L, node: &Node<L>| most.max(node.velocity.angular.length_squared());
        let fastest = self.of_bodies().iter().fold(L::zero(), fastest);
        L::splat(TREE_ENERGY_BAND) + fastest * L::splat(self.h * self.h)
    }

    /// Trees whose anchor does not move: their joints do no work.
    fn hangs_still(&self) -> L::Mask {
        let mut still = L::zero().eq(L::zero());
        for node in self.nodes.iter().filter(|node| node.jointed && node.parent == NONE) {
            let Twist { linear, angular } = node.anchored;
            still = still & !(linear.length_squared() + angular.length_squared()).gt(L::zero());
        }
        still
    }

    /// Where only external forces do work, the tree must not have more energy at the end of a substep than
    /// before. RATTLE closes joints at any cost: two links that fold between heavy bodies gained up to a
    /// sixth.
    #[inline(never)]
    pub(crate) fn keep_energy(&mut self) {
        let [now, before] = [self.energy(|node| node.velocity), self.energy(|node| node.start.free)];
        let work = self.of_bodies().iter().fold(L::zero(), |work, node| {
            work + node.drift.pull.dot(node.moved.linear - node.start.moved.linear) / node.inverse_mass
        });
        let gained = now.gt((before + work.max(L::zero())) * self.tolerated() + work.min(L::zero()))
            & L::Mask::from_bits(self.calm)
            & self.hangs_still();
        if gained.any() {
            self.damped |= gained.bits();
            self.bound_energy((before + work).max(L::zero()), gained);
        }
    }

    /// Limits the kinetic energy of some lanes: above the limit all velocities are scaled down, except for
    /// the motion of the centre of mass.
    pub(crate) fn bound_energy(&mut self, most: L, lanes: L::Mask) {
        let now = self.energy(|node| node.velocity);
        let over = now.gt(most) & lanes & self.hangs_still();
        if !over.any() {
            return;
        }
        let (mut mass, mut momentum) = (L::zero(), Vec3::zero());
        for node in self.of_bodies() {
            let own = L::one() / node.inverse_mass;
            mass += own;
            momentum += node.velocity.linear * own;
        }
        let hangs = self.nodes.iter().any(|node| node.jointed && node.parent == NONE);
        let mean = if hangs { Vec3::zero() } else { momentum * (L::one() / mass) };
        let whole = L::splat(0.5) * mass * mean.length_squared();
        let some = over & (now - whole).gt(L::zero());
        let share = (most - whole).max(L::zero()) / L::select(some, now - whole, L::one());
        let share = L::select(some, share.sqrt(), L::one());
        for node in &mut self.nodes {
            let Twist { linear, angular } = node.velocity;
            let slower = Twist { linear: mean + (linear - mean) * share, angular: angular * share };
            node.velocity = Twist::select(over, slower, node.velocity);
        }
    }
}

on_nodes! {
    /// Sums the impulses of joints on each body, at the current arms.
    pub(super) fn sum_impulses<'a, L>(nodes, real: usize) {
        for node in &mut *nodes {
            node.pushed = Twist::zero();
        }
        for i in 0..nodes.len() {
            let (parent, node) = with_parent(nodes, i);
            let force = Twist { linear: node.impulse, angular: node.twist };
            let [arm, above] = node.arm_now;
            let own = force.moved(arm);
            if let Some(parent) = parent {
                parent.pushed.subtract(force.moved(above));
            }
            let body = if i < real { i } else { node.own as usize };
            nodes[body].pushed.add(own);
        }
    }
}
