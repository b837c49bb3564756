//! Trees of joints, solved exactly.
//!
//! Row by row, the impulse that a heavy load at the end of a chain needs travels up one joint a pass: a ball
//! a thousand times as heavy as the links tears such a chain apart. But points that join bodies without a
//! loop (chains, ragdolls, cars), with the rotation that is locked about them, are a linear system that is
//! solved without iteration. From the leaves to the root, each body's inertia takes in that of the bodies
//! that hang on it; then impulses are passed back from the root to the leaves (Featherstone 1983; with
//! impulses instead of forces and in the coordinates of the bodies, Baraff, *Linear-Time Dynamics using
//! Lagrange Multipliers*, 1996). Up to eight trees of the same shape share the lanes.

mod batch;
#[cfg(feature = "observe")]
mod pushes;

use super::contacts::TreeBody;
use super::damp::sum_impulses;
use super::node::{Node, TreeWidth, Turns, on_nodes};
use super::rattle::is_free;
use super::slots::TreeContacts;
use super::spatial::Twist;
use super::transfer::{predict_bend, read_velocities, save};
use crate::config::tuning::{LIGHTEST_LINK, THINNEST_LINK};
use crate::constraint::contact::row::Motion;
use crate::constraint::joint::ends::JointPass;
use crate::lanes::{Mask, Quat, Vec3};

pub(crate) use batch::TreeBatch;
#[cfg(feature = "observe")]
pub(crate) use pushes::TreePush;

impl<L: TreeWidth> TreeBatch<L> {
    /// Bodies whose mobility would be lost in the rounding of that of the bodies that hang on them count as
    /// heavier: as a share of that mass, which makes the tree heavier by as much. The same of rotations,
    /// where a hinge or a weld turns a load with a body: about its length a beam has next to no inertia.
    fn weigh(&mut self) {
        let mut weighted = 0;
        for node in &mut self.nodes {
            // The mass that hangs on it, and the inertia that turns with it.
            (node.pulled, node.carried) = (L::zero(), Twist::zero());
        }
        for i in (0..self.real).rev() {
            let (parent, node) = self.with_parent(i);
            let (load, mass) = (node.pulled, L::one() / node.inverse_mass);
            if let Some(parent) = parent {
                parent.pulled += load + mass;
                if node.turns != Turns::Freely {
                    let swung = (load + mass) * node.arm[0].length_squared();
                    let Vec3 { x, y, z } = node.drift.moments.inertia;
                    let turned = node.carried.angular.x + swung + x.max(y).max(z);
                    parent.carried.angular.x += turned;
                    let thin = node.thicken(parent, turned * L::splat(THINNEST_LINK));
                    weighted |= thin.bits() & parent.write;
                }
            }
            let least = load * L::splat(LIGHTEST_LINK);
            let light = least.gt(mass);
            let factor = L::select(light, least * node.inverse_mass, L::one());
            node.inverse_mass = node.inverse_mass / factor;
            node.inertia = node.inertia.scaled(factor);
            weighted |= light.bits() & node.write;
        }
        self.weighted = weighted;
    }

    /// Initialises arms and impulses at the start of a step.
    pub(crate) fn begin(&mut self, h: f32, unit: f32) {
        self.weigh();
        for node in &mut self.nodes {
            (node.arm_now, node.apart_now) = (node.arm, node.apart);
            (node.axis_now, node.error_now) = (node.axis, node.error);
            node.gained = Vec3::zero();
            (node.moved, node.turn) = (Twist::zero(), Quat { v: Vec3::zero(), w: L::one() });
        }
        (self.h, self.unit) = (h, unit);
        self.choose();
        self.add_geometric_stiffness();
    }

    /// Takes the contacts that are solved along with the trees, and prepares for solving.
    pub(crate) fn take_along(&mut self, contacts: (u32, u32)) {
        self.contacts = contacts;
        self.factor();
        self.fresh = true;
    }

    /// Applies the impulses of the last step.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    pub(crate) unsafe fn warm_start(&mut self, motion: &Motion<'_, '_>) {
        if self.all_exact() {
            return;
        }
        // SAFETY: by the contract; earlier velocities are not written while rows are solved.
        unsafe {
            predict_bend(&mut self.nodes, motion, self.h, self.exact);
            read_velocities(&mut self.nodes, motion);
        }
        let exact = self.exact();
        for i in 0..self.nodes.len() {
            let (parent, node) = self.with_parent(i);
            let impulse = Vec3::select(exact, Vec3::zero(), node.impulse);
            if let Some(parent) = parent {
                parent.velocity.linear -= impulse * parent.inverse_mass;
            }
            let own = self.body_of(i);
            let body = &mut self.nodes[own];
            body.velocity.linear += impulse * body.inverse_mass;
        }
        self.turn_along();
        self.fresh = false;
        // SAFETY: by the contract.
        unsafe { save(&mut self.nodes[..self.real], motion, !self.exact, self.exact) };
    }

    /// Recomputes the angular velocities that bodies get from impulses and external forces, at the current
    /// arms: warm starting adds impulses as if bodies had not turned, and a pendulum would gain energy.
    fn turn_along(&mut self) {
        clear_hinges(&mut self.nodes);
        sum_impulses(&mut self.nodes, self.real);
        self.add_motors(|node| &mut node.pushed.angular);
        turn_along(&mut self.nodes, self.exact);
        self.repeat_bodies();
    }

    /// Adds the angular impulses of motors.
    #[inline(always)]
    pub(crate) fn add_motors(&mut self, to: impl Fn(&mut Node<L>) -> &mut Vec3<L>) {
        let motors = std::mem::take(&mut self.extra.motors);
        for motor in &motors {
            let (own, node) = (self.body_of(motor.node as usize), &self.nodes[motor.node as usize]);
            let (parent, moment) = (node.parent, node.axis_now[0] * motor.impulse);
            *to(&mut self.nodes[own]) += moment;
            if let Some(parent) = self.nodes.get_mut(parent as usize) {
                *to(parent) -= moment;
            }
        }
        self.extra.motors = motors;
    }

    /// Copies velocities of bodies to the nodes of cut joints.
    pub(crate) fn repeat_bodies(&mut self) {
        let (bodies, cuts) = self.nodes.split_at_mut(self.real);
        for cut in cuts {
            cut.velocity = bodies[cut.own as usize].velocity;
        }
    }

    /// One exact solution for all joints of the trees; `touch` solves the contacts of a body along with them.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    pub(crate) unsafe fn solve(
        &mut self,
        motion: &Motion<'_, '_>,
        pass: &JointPass,
        contacts: &[TreeContacts],
        touch: impl FnMut(&TreeContacts, &mut TreeBody<'_, L>),
    ) {
        let warm = !self.all_exact();
        if pass.moved && warm {
            if self.is_alone().any() {
                // A load may arrive within a substep.
                self.add_geometric_stiffness();
            }
            self.factor();
            self.fresh = true;
        }
        let fresh = warm && !pass.relax && std::mem::take(&mut self.fresh);
        if fresh {
            // SAFETY: these velocities are not written while rows are solved.
            unsafe { predict_bend(&mut self.nodes, motion, 1.0 / pass.inverse_h, self.exact) };
        }
        // SAFETY: by the contract.
        unsafe { read_velocities(&mut self.nodes, motion) };
        let mut lanes = L::zero().eq(L::zero());
        if self.exact != 0 && !pass.relax {
            // Where nothing has acted since the joints did, they are solved already.
            // SAFETY: by the contract.
            let free = unsafe { is_free(&mut self.nodes, motion) };
            lanes = !(self.exact() & L::Mask::from_bits(free));
            self.calm &= !lanes.bits();
            if !warm && lanes.bits() & self.exact == 0 {
                return;
            }
        }
        if fresh {
            self.turn_along();
        }
        self.known &= !lanes.bits();
        let own = &contacts[self.contacts.0 as usize..self.contacts.1 as usize];
        self.sweep(pass, lanes, own, touch);
        if pass.relax && self.calm != 0 {
            self.keep_energy();
        }
        // SAFETY: by the contract.
        unsafe { save(&mut self.nodes[..self.real], motion, lanes.bits(), self.exact) };
    }
}

impl<L: TreeWidth> Node<L> {
    /// Raises the inertia of the parent about the axes that the joint locks, where it is less than `least`.
    /// Returns where it is.
    fn thicken(&self, parent: &mut Node<L>, least: L) -> L::Mask {
        // A weld locks all axes.
        let (axis, thinnest) = if self.turns == Turns::Not {
            let Vec3 { x, y, z } = parent.drift.moments.inertia;
            (Vec3::zero(), x.min(y).min(z))
        } else {
            let (t, s) = self.axis[1].tangents();
            let (mt, ms) = (parent.inertia.mul(t), parent.inertia.mul(s));
            let (a, b, d) = (t.dot(mt), t.dot(ms), s.dot(ms));
            let (half, apart) = (L::splat(0.5), a - d);
            (self.axis[1], half * (a + d - (apart * apart + L::splat(4.0) * b * b).sqrt()))
        };
        let lacks = (least - thinnest).max(L::zero());
        let inertia = &mut parent.inertia;
        inertia.xx += lacks - lacks * axis.x * axis.x;
        inertia.yy += lacks - lacks * axis.y * axis.y;
        inertia.zz += lacks - lacks * axis.z * axis.z;
        inertia.xy -= lacks * axis.x * axis.y;
        inertia.xz -= lacks * axis.x * axis.z;
        inertia.yz -= lacks * axis.y * axis.z;
        lacks.gt(L::zero())
    }
}

on_nodes! {
    /// Removes from hinges the impulses that they do not transmit: those about their axes, which have turned.
    fn clear_hinges<'a, L>(nodes) {
        for node in nodes {
            if node.turns == Turns::AboutAxis {
                node.twist -= node.axis_now[0] * node.axis_now[0].dot(node.twist);
            }
        }
    }
}

on_nodes! {
    /// Gives bodies the angular velocities by the sums of angular impulses, where trees are warm-started.
    fn turn_along<'a, L>(nodes, exact: u32) {
        let exact = L::Mask::from_bits(exact);
        for node in nodes {
            let own = node.velocity.angular - node.gained;
            let now = node.stiffened_inverse.mul(node.inertia.mul(own) + node.pushed.angular);
            node.velocity.angular = Vec3::select(exact, node.velocity.angular, now);
            node.gained = now - own;
        }
    }
}
