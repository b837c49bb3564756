//! Data that a tree reads from its bodies and writes back: velocities and displacements.

use super::free_rotation::{exp, log, moved_by};
use super::node::{TreeWidth, Turns, on_nodes, with_parent};
use super::spatial::Twist;
use super::tree::TreeBatch;
use crate::constraint::contact::row::Motion;
use crate::constraint::joint::ends::{NONE, bend, swerve};
use crate::lanes::{Mask, Record, Vec3, gather, ones, scatter};

// Guard: beyond, the numbers are no motion.
/// Bodies that are faster than this [m/s] or [rad/s] move on as if the tree had not acted.
const RUNAWAY: f32 = 1e6;

impl<L: TreeWidth> TreeBatch<L> {
    /// Arms and separations after displacements that others wrote.
    ///
    /// # Safety
    /// No thread writes displacements of the trees.
    pub(crate) unsafe fn follow(&mut self, motion: &Motion<'_, '_>) {
        // SAFETY: by the contract.
        unsafe { read_displacements(&mut self.nodes, motion, 0) };
        self.place(0.0);
    }

    /// Arms and separations after displacements, `left` seconds before the anchors reach the ends of theirs.
    pub(crate) fn place(&mut self, left: f32) {
        place(&mut self.nodes, left);
        self.turn_inertias();
    }

    /// Writes the displacements of some lanes. Bodies whose displacement is not finite move as they would
    /// without the tree.
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees.
    pub(crate) unsafe fn shift(&mut self, motion: &Motion<'_, '_>, lanes: u32) {
        for node in &mut self.nodes[..self.real] {
            let delta = scatter(node.moved.linear, node.moved.angular);
            for lane in (0..L::N).filter(|lane| (node.write & lanes) >> lane & 1 != 0) {
                // SAFETY: by the contract; no body is twice in a batch.
                let to = unsafe { motion.delta.get(node.body[lane] as usize) };
                if self.exact >> lane & 1 != 0 {
                    // Joints acted on it, and it is turned already.
                    to.set_touched();
                    to.set_turned();
                }
                if delta[lane].linear.is_finite() && delta[lane].angular.is_finite() {
                    (to.linear, to.angular) = (delta[lane].linear, delta[lane].angular);
                } else {
                    node.moved.linear.set_lane(lane, to.linear);
                    node.moved.angular.set_lane(lane, to.angular);
                }
            }
        }
        let (bodies, cuts) = self.nodes.split_at_mut(self.real);
        cuts.iter_mut().for_each(|cut| cut.moved = bodies[cut.own as usize].moved);
    }
}

on_nodes! {
    /// Predicts by how much velocities at the joints change in a substep as bodies turn, in trees that are
    /// warm-started. Uses the angular velocities before rows acted: rows whose requests can't be met, and
    /// light links under a load, would turn arbitrarily within the substep.
    ///
    /// # Safety
    /// No thread writes these velocities.
    pub(super) unsafe fn predict_bend<'a, L>(nodes, motion: &'a Motion<'a, 'a>, h: f32, exact: u32) {
        // SAFETY: by the contract.
        let read = |i| unsafe { motion.base.read(i) };
        let (exact, h) = (L::Mask::from_bits(exact), L::splat(h));
        for i in 0..nodes.len() {
            let (parent, node) = with_parent(nodes, i);
            let own = gather(read, &node.body).1;
            node.change.angular = own;
            if !node.jointed {
                continue;
            }
            let above = match parent {
                Some(parent) => parent.change.angular,
                // SAFETY: no row writes a body that stands still or is moved by the caller.
                None => gather(|i| unsafe { motion.velocity.read(i) }, &node.anchor).1,
            };
            let [arm, other] = node.arm_now;
            let linear = bend(own, arm, h) - bend(above, other, h);
            node.bend.linear = Vec3::select(exact, node.bend.linear, linear);
            if node.turns == Turns::AboutAxis {
                let axis = node.axis_now[0];
                let angular = swerve(own, axis, h) - swerve(above, axis, h);
                node.bend.angular = Vec3::select(exact, node.bend.angular, angular);
            }
        }
    }
}

on_nodes! {
    /// Reads displacements, except in lanes that know theirs.
    ///
    /// # Safety
    /// No thread writes displacements of the trees.
    pub(super) unsafe fn read_displacements<'a, L>(nodes, motion: &'a Motion<'a, 'a>, known: u32) {
        // SAFETY: by the contract.
        let read = |i| unsafe { motion.delta.read(i) };
        let known = L::Mask::from_bits(known);
        for node in nodes {
            let (linear, angular) = gather(read, &node.body);
            node.moved = Twist::select(known, node.moved, Twist { linear, angular });
            if node.parent == NONE {
                let (linear, angular) = gather(read, &node.anchor);
                node.anchor_moved = Twist { linear, angular };
            }
        }
    }
}

on_nodes! {
    /// See [`TreeBatch::place`].
    fn place<'a, L>(nodes, left: f32) {
        let left = L::splat(left);
        for i in 0..nodes.len() {
            let (parent, node) = with_parent(nodes, i);
            node.turn = exp(node.moved.angular);
            if !node.jointed {
                continue;
            }
            let (above, turn) = match parent {
                Some(parent) => (parent.moved.linear, parent.turn),
                None => {
                    let (end, v) = (node.anchor_moved, node.anchored);
                    (end.linear - v.linear * left, exp(end.angular - v.angular * left))
                }
            };
            let [arm, other] = node.arm;
            let [at, there] = [moved_by(node.turn, arm), moved_by(turn, other)];
            node.arm_now = [arm + at, other + there];
            node.apart_now = node.apart + (node.moved.linear - above) + (at - there);
            match node.turns {
                Turns::Freely => {}
                Turns::AboutAxis => {
                    node.axis_now = [node.turn.rotate(node.axis[0]), turn.rotate(node.axis[1])];
                    node.error_now = node.axis_now[1].cross(node.axis_now[0]);
                }
                Turns::Not => {
                    node.error_now = log(node.turn.compose(exp(node.error)).compose(turn.conjugate()));
                }
            }
        }
    }
}

on_nodes! {
    /// Reads velocities.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    pub(super) unsafe fn read_velocities<'a, L>(nodes, motion: &'a Motion<'a, 'a>) {
        // SAFETY: by the contract. One by one: a slice of all would include those that other threads write.
        let read = |i| unsafe { motion.velocity.read(i) };
        for node in nodes {
            let (linear, angular) = gather(read, &node.body);
            node.velocity = Twist { linear, angular };
            node.drift.before = node.velocity;
            if node.parent == NONE {
                let (linear, angular) = gather(read, &node.anchor);
                node.anchored = Twist { linear, angular };
            }
        }
    }
}

on_nodes! {
    /// Writes the velocities of some lanes. In trees that conserve energy, the change by joints is no warm
    /// start for the next substep: it is added to the velocities before rows acted too.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    pub(super) unsafe fn save<'a, L>(bodies, motion: &'a Motion<'a, 'a>, lanes: u32, exact: u32) {
        for node in bodies {
            let before = &node.drift.before;
            let all = scatter(node.velocity.linear, node.velocity.angular);
            let mut own = [Record::default(); 8];
            if exact != 0 {
                let (linear, angular) = (node.velocity.linear, node.velocity.angular);
                own = scatter(linear - before.linear, angular - before.angular);
            }
            for lane in ones(node.write & lanes) {
                let body = node.body[lane] as usize;
                // SAFETY: by the contract; no body is twice in a batch.
                let (v, base) = unsafe { (motion.velocity.get(body), motion.base.get(body)) };
                let new = all[lane];
                if exact >> lane & 1 != 0 {
                    let fastest = new.linear.abs().max(new.angular.abs()).max_element();
                    if !(fastest < RUNAWAY && new.linear.is_finite() && new.angular.is_finite()) {
                        // Not finite, or as good as that.
                        continue;
                    }
                    if v.linear == base.linear && v.angular == base.angular {
                        // Bit for bit: equality is how it is told that nothing else acts.
                        (base.linear, base.angular) = (new.linear, new.angular);
                    } else {
                        base.linear += own[lane].linear;
                        base.angular += own[lane].angular;
                    }
                }
                *v = new;
            }
        }
    }
}
