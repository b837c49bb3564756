//! The exact solution of a tree: from the leaves to the root and back.

use super::contacts::TreeBody;
use super::cut::Drives;
use super::node::{Node, TreeWidth};
use super::slots::TreeContacts;
use super::spatial::Twist;
use super::tree::TreeBatch;
use crate::constraint::joint::ends::JointPass;
use crate::lanes::Vec3;

impl<L: TreeWidth> TreeBatch<L> {
    /// From the leaves to the root: the mobility of each body with all that hangs on it.
    pub(crate) fn factor(&mut self) {
        L::factor(&mut self.nodes, self.real, self.contacts.0 < self.contacts.1);
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
        self.nodes.iter_mut().for_each(|node| node.pushed = Twist::zero());
        self.extra.drives = match (self.extra.idle, pass.relax) {
            (true, _) => Drives::None,
            (_, true) => Drives::Rigid,
            _ => Drives::All,
        };
        let rate = if pass.relax { L::zero() } else { self.share * L::splat(pass.inverse_h) };
        let requested = |node: &Node<L>, parent: Option<&Node<L>>| {
            let [arm, other] = node.arm_now;
            let mut requested = node.velocity.seen_at(arm);
            requested.subtract(parent.map_or(node.anchored, |parent| parent.velocity).seen_at(other));
            requested.linear += pass.linear_bias(node.apart_now, rate);
            requested.angular += pass.angular_bias(node.error_now, rate);
            if !pass.relax {
                requested.add(node.bend);
            }
            requested
        };
        self.gather_up(requested);
        if !contacts.is_empty() {
            self.traverse(contacts, touch);
            self.gather_up(requested);
        }
        self.answer_all();
        let zero = Vec3::zero();
        for node in &mut self.nodes {
            node.impulse -= Vec3::select(lanes, node.force.linear, zero);
            node.twist -= Vec3::select(lanes, node.force.angular, zero);
            let gained = node.change.angular - node.stiffened_inverse.mul(node.pushed.angular);
            node.gained += Vec3::select(lanes, gained, zero);
            node.velocity.linear += Vec3::select(lanes, node.change.linear, zero);
            node.velocity.angular += Vec3::select(lanes, node.change.angular, zero);
        }
        for motor in &mut self.extra.motors {
            motor.impulse -= L::select(lanes, motor.less, L::zero());
        }
        self.extra.drives = Drives::None;
    }

    /// The impulses of joints that meet what was requested, and the changes of velocity by them and by other
    /// impulses.
    pub(crate) fn answer_all(&mut self) {
        self.answer_bodies();
        if self.has_extra() {
            self.answer_extra();
        }
    }

    /// The same without cut joints.
    pub(crate) fn answer_bodies(&mut self) {
        L::pass_down(&mut self.nodes[..self.real]);
    }

    /// Collects what is requested of each joint, less what the joints below it do.
    #[inline(always)]
    pub(crate) fn gather_up(&mut self, requested: impl Fn(&Node<L>, Option<&Node<L>>) -> Twist<L>) {
        for i in self.real..self.nodes.len() {
            let (parent, node) = self.with_parent(i);
            node.requested = requested(node, parent.as_deref());
        }
        self.gather_up_bodies(requested);
    }

    /// From the leaves to the root, without cut joints.
    #[inline(always)]
    pub(crate) fn gather_up_bodies(&mut self, requested: impl Fn(&Node<L>, Option<&Node<L>>) -> Twist<L>) {
        self.nodes.iter_mut().for_each(|node| node.carried = Twist::zero());
        for i in (0..self.real).rev() {
            let (parent, node) = self.with_parent(i);
            if !node.jointed {
                continue;
            }
            let mut carried = node.carried;
            carried.add(node.pushed);
            let carried = node.free.mul(&carried);
            let mut all = carried.seen_at(node.arm_now[0]);
            all.add(requested(node, parent.as_deref()));
            node.requested = node.unspun(all);
            if let Some(parent) = parent {
                node.beside = parent.carried;
                parent.carried.add(node.stiff.mul(&node.requested).moved(node.arm_now[1]));
            }
        }
    }
}
