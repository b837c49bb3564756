//! The exact solution of a tree: from the leaves to the root and back.

use super::contacts::TreeBody;
use super::cut::Drives;
use super::node::{TreeWidth, factor, gather_up, on_nodes, pass_down, with_parent};
use super::slots::TreeContacts;
use super::spatial::Twist;
use super::tree::TreeBatch;
use crate::constraint::joint::ends::JointPass;
use crate::lanes::{Mask, Vec3};

impl<L: TreeWidth> TreeBatch<L> {
    /// From the leaves to the root: the mobility of each body with all that hangs on it.
    pub(crate) fn factor(&mut self) {
        factor(&mut self.nodes, self.real, self.contacts.0 < self.contacts.1);
        if self.has_extra() {
            self.factor_extra();
        }
    }

    /// Solves the trees of some lanes, from the leaves to the root and back.
    pub(crate) fn sweep(
        &mut self,
        pass: &JointPass,
        lanes: L::Mask,
        contacts: &[TreeContacts],
        touch: impl FnMut(&TreeContacts, &mut TreeBody<'_, L>),
    ) {
        self.extra.drives = match (self.extra.idle, pass.relax) {
            (true, _) => Drives::None,
            (_, true) => Drives::Rigid,
            _ => Drives::All,
        };
        let rate = if pass.relax { L::zero() } else { self.share * L::splat(pass.inverse_h) };
        request_velocities(&mut self.nodes, pass, &rate.eight());
        gather_up(&mut self.nodes[..self.real]);
        if !contacts.is_empty() {
            self.traverse(contacts, touch);
        }
        self.answer_all();
        apply(&mut self.nodes, lanes.bits());
        for motor in &mut self.extra.motors {
            motor.impulse -= L::select(lanes, motor.less, L::zero());
        }
        self.extra.drives = Drives::None;
    }

    /// The impulses of joints that meet the requests, and the changes of velocity by them and by other
    /// impulses.
    pub(crate) fn answer_all(&mut self) {
        pass_down(&mut self.nodes[..self.real]);
        if self.has_extra() {
            self.answer_extra();
        }
    }

    /// Requests that all open joints close. Nothing else pushes.
    pub(crate) fn request_closing(&mut self) {
        for node in &mut self.nodes {
            (node.requested, node.pushed) = (node.open(), Twist::zero());
        }
    }
}

on_nodes! {
    /// Requests velocities that the joints allow, and those that correct their errors. Nothing pushes yet.
    fn request_velocities<'a, L>(nodes, pass: &'a JointPass, rate: &'a [f32; 8]) {
        let rate = L::load(rate);
        for i in 0..nodes.len() {
            let (parent, node) = with_parent(nodes, i);
            node.pushed = Twist::zero();
            let [arm, other] = node.arm_now;
            let mut requested = node.velocity.seen_at(arm);
            let above = match parent {
                Some(parent) => parent.velocity,
                None => node.anchored,
            };
            requested.subtract(above.seen_at(other));
            requested.linear += pass.linear_bias(node.apart_now, rate);
            requested.angular += pass.angular_bias(node.error_now, rate);
            if !pass.relax {
                requested.add(node.bend);
            }
            node.requested = requested;
        }
    }
}

on_nodes! {
    /// Adds the solution to velocities and impulses, in some lanes.
    fn apply<'a, L>(nodes, lanes: u32) {
        let (lanes, zero) = (L::Mask::from_bits(lanes), Vec3::zero());
        for node in nodes {
            node.impulse -= Vec3::select(lanes, node.force.linear, zero);
            node.twist -= Vec3::select(lanes, node.force.angular, zero);
            let gained = node.change.angular - node.stiffened_inverse.mul(node.pushed.angular);
            node.gained += Vec3::select(lanes, gained, zero);
            node.velocity.linear += Vec3::select(lanes, node.change.linear, zero);
            node.velocity.angular += Vec3::select(lanes, node.change.angular, zero);
        }
    }
}
