//! Trees of joints, solved exactly.
//!
//! Row by row, what a heavy load at the end of a chain needs travels up one joint a pass: a ball a thousand times as heavy as
//! the links tears such a chain apart. But points that join bodies without a loop (chains, ragdolls, cars), with what is
//! locked about them, are a linear system that needs no iteration. From the leaves to the root, each body's inertia takes in
//! what hangs on it; then impulses go back from the root to the leaves (Featherstone 1983; with impulses instead of forces, and in the
//! coordinates of the bodies, Baraff, *Linear-Time Dynamics using Lagrange Multipliers*, 1996). Up to eight trees of the
//! same shape share the lanes.

use super::contacts::Toured;
use super::cut::{Drives, Extra};
use super::damp::Start;
use super::free_rotation::{exp, log, log_near, moved_by};
use super::rattle::Drift;
use super::slots::Seated;
use super::spatial::{Sym6, Twist, plus, scaled};
use crate::constraint::contact::row::Motion;
use crate::constraint::joint::ends::{JointPass, NONE, across, bend, inverse, swerve};
use crate::constraint::joint::fill::put;
use crate::constraint::schedule::order::Place;
use crate::lanes::{GatherLanes, Lanes, Mask, Quat, Record, Sym3, Vec3, gather, scatter};

/// How a body turns on its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Turns {
    Freely,
    AboutAxis,
    Not,
}

/// A body and the joint between it and its parent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<L> {
    /// The lock of the joint's point in each lane, and that of its rotation; of a root that hangs on nothing, a lock of its
    /// body.
    pub(crate) owner: [u32; 8],
    pub(crate) turn_owner: [u32; 8],
    /// What of the rotation is locked.
    pub(crate) turns: Turns,
    /// Which side of the joint the body is, the same in all lanes.
    pub(crate) side: u8,
    /// The parent's place in the tree; of a root, none.
    pub(crate) parent: u32,
    /// Of a cut joint, the place of its body.
    pub(crate) own: u32,
    /// Whether there is a joint.
    pub(crate) jointed: bool,
    pub(crate) body: [u32; 8],
    /// What a root hangs on: a body that the joint can't move.
    pub(crate) anchor: [u32; 8],
    /// Bit per lane: there is a body.
    pub(crate) write: u32,
    /// The body's own, or more: see [`TreeBatch::weigh`].
    pub(crate) inverse_mass: L,
    pub(crate) inertia: Sym3<L>,
    /// From the centre of mass to the joint, of the body and of its parent, at the start of the step [m].
    pub(crate) arm: [Vec3<L>; 2],
    /// From the parent's point to the body's [m].
    pub(crate) apart: Vec3<L>,
    /// Of a hinge, on the body and on its parent; of what is welded, the rotation vector from the parent [rad].
    pub(crate) axis: [Vec3<L>; 2],
    pub(crate) error: Vec3<L>,
    /// The same after the last substep.
    pub(crate) arm_now: [Vec3<L>; 2],
    pub(crate) apart_now: Vec3<L>,
    pub(crate) axis_now: [Vec3<L>; 2],
    pub(crate) error_now: Vec3<L>,
    /// How much faster the body leaves its parent in the mean over the next substep than it does at its start.
    pub(crate) bend: Twist<L>,
    /// How it goes on by itself.
    pub(crate) drift: Drift<L>,
    /// Displacement since the start of the step, and the rotation of that; or while it is predicted, that of the substep.
    pub(crate) moved: Twist<L>,
    pub(crate) turn: Quat<L>,
    /// On the body, of the last substep: at the joint [N s], and about it [N m s].
    pub(crate) impulse: Vec3<L>,
    pub(crate) twist: Vec3<L>,
    /// How much of the impulse at the joint is no blow [N s].
    pub(crate) steady: L,
    /// Inertia with what pulls on the body, its inverse, and the angular velocity that the tree gave in the last substep.
    pub(crate) braced: Sym3<L>,
    pub(crate) braced_inverse: Sym3<L>,
    pub(crate) gained: Vec3<L>,
    /// Inverse of the inertia of the body with all that hangs on it.
    pub(crate) free: Sym6<L>,
    /// Impulse at the joint per velocity that it doesn't allow.
    pub(crate) stiff: Sym6<L>,
    /// The same of both bodies, the parent with what hangs on it but for this branch and those before it; and the velocity of
    /// that parent per impulse on it.
    joined: Sym6<L>,
    rest: Sym6<L>,
    /// Velocity of the body per impulse on it, with the whole tree: if it has contacts that go along.
    pub(crate) whole: Sym6<L>,
    /// How much of the inertia is pulled [kg m²]; before that is known, what hangs on the body.
    pub(crate) pulled: L,
    /// Of one pass.
    pub(crate) velocity: Twist<L>,
    /// Velocity and displacement of what a root hangs on.
    pub(crate) anchored: Twist<L>,
    pub(crate) anchor_moved: Twist<L>,
    pub(crate) carried: Twist<L>,
    pub(crate) asked: Twist<L>,
    pub(crate) change: Twist<L>,
    pub(crate) pending: Twist<L>,
    /// What contacts that go along push the body by; with what its joints do; and what of `carried` the parent had from the
    /// branches after this one.
    pub(crate) pushed: Twist<L>,
    pushes: Twist<L>,
    beside: Twist<L>,
    /// Of the joint, taken from the body at its arm.
    pub(crate) force: Twist<L>,
    /// Change, force and push of the tree without the rows beside it.
    pub(crate) before: (Twist<L>, Twist<L>),
    pub(crate) pushed_before: Twist<L>,
    /// Of a substep that is done again.
    pub(crate) start: Start<L>,
}

impl<L: Lanes> Default for Node<L> {
    fn default() -> Self {
        let (zero, one) = (Vec3::zero(), L::one());
        Node {
            owner: [NONE; 8],
            turn_owner: [NONE; 8],
            turns: Turns::Freely,
            side: 0,
            parent: NONE,
            own: NONE,
            jointed: false,
            body: [0; 8],
            anchor: [0; 8],
            write: 0,
            // Of something, so that an inert lane has numbers too.
            inverse_mass: one,
            inertia: Sym3 { xx: one, yy: one, zz: one, ..Sym3::default() },
            arm: [zero; 2],
            apart: zero,
            axis: [Vec3::new(one, L::zero(), L::zero()); 2],
            error: zero,
            arm_now: [zero; 2],
            apart_now: zero,
            axis_now: [zero; 2],
            error_now: zero,
            bend: Twist::zero(),
            drift: Drift::default(),
            moved: Twist::zero(),
            turn: Quat { v: zero, w: one },
            impulse: zero,
            twist: zero,
            steady: L::zero(),
            braced: Sym3::default(),
            braced_inverse: Sym3::default(),
            gained: zero,
            free: Sym6::zero(),
            stiff: Sym6::zero(),
            whole: Sym6::zero(),
            pending: Twist::zero(),
            pushed: Twist::zero(),
            pushes: Twist::zero(),
            beside: Twist::zero(),
            force: Twist::zero(),
            before: (Twist::zero(), Twist::zero()),
            pushed_before: Twist::zero(),
            start: Start::default(),
            joined: Sym6::zero(),
            rest: Sym6::zero(),
            pulled: L::zero(),
            velocity: Twist::zero(),
            anchored: Twist::zero(),
            anchor_moved: Twist::zero(),
            carried: Twist::zero(),
            asked: Twist::zero(),
            change: Twist::zero(),
        }
    }
}

/// Up to eight trees of one shape, parents before children.
#[derive(Clone, Debug, Default)]
pub(crate) struct TreeBatch<L> {
    /// A node for each body, then those of cut joints, whose bodies are in front of them.
    pub(crate) nodes: Vec<Node<L>>,
    /// How many bodies a tree has.
    pub(crate) real: usize,
    /// Rows of cut joints and motors.
    pub(crate) extra: Extra<L>,
    /// Bodies turned since the last solution.
    pub(crate) fresh: bool,
    /// Share of an error that velocities take back within a substep.
    pub(crate) share: L,
    /// Lanes of trees that keep their energy (see `joint_rattle`). Those of the others are warm-started.
    pub(crate) exact: u32,
    /// Lanes of trees in which a body bears several times its mass; of those that are warm-started, the ones of which it is
    /// looked at what a substep did; and those on which nothing but joints and what pulls acts in the substep.
    pub(crate) laden: u32,
    pub(crate) watched: u32,
    pub(crate) calm: u32,
    /// Lanes of which a substep was done again (see `joint_damp`).
    pub(crate) damped: u32,
    /// Lanes whose bodies turn as was predicted last.
    pub(crate) known: u32,
    /// Lanes for which no impulses were found that close joints.
    pub(crate) lost: u32,
    /// The same in any part of the substep.
    pub(crate) astray: u32,
    /// What pulls acts for so much longer in the first substep [s].
    pub(crate) late: L,
    /// Half a substep, where nothing but joints and what pulls acts on the tree [s].
    pub(crate) lag: L,
    /// A joint lets its bodies collide: a loop with their contact, of which the tree knows nothing. Contacts don't go along,
    /// and what is open is left to the velocities.
    pub(crate) loops: bool,
    /// Where it is solved among all rows.
    pub(crate) place: Place,
    /// Contacts that go along with the trees: their range among all such.
    pub(crate) contacts: (u32, u32),
    /// Substep [s].
    pub(crate) h: f32,
    /// The length unit [m].
    pub(crate) unit: f32,
    /// Lanes in which a body counts as heavier than it is.
    pub(crate) weighted: u32,
}

/// The least mass of a body for what hangs on it. Of mobilities in `f32` a part in ten million is left; of chains of twenty,
/// links of a 50,000th already lose some digits that they need, and of a millionth all.
const LIGHTEST: f32 = 5e-5;

/// Share of an error that is taken back within a substep. Contacts see a tree body by body: what both agree on they find
/// slowly, and an error that is taken back faster makes what they do not agree on grow (see
/// [`Softness::stiffest`](crate::constraint::contact::row::Softness::stiffest), with a load that does not yield).
pub(crate) const ALONE: f32 = 0.2;
pub(crate) const TOUCHING: f32 = 0.05;

impl<L> TreeBatch<L> {
    pub(crate) fn of_bodies(&self) -> &[Node<L>] {
        &self.nodes[..self.real]
    }
    /// Whether loops of its own were cut.
    pub(crate) fn is_cut(&self) -> bool {
        self.real < self.nodes.len()
    }
    /// How many bodies there are in its trees.
    pub(crate) fn bodies(&self) -> u32 {
        self.of_bodies().iter().map(|node| node.write.count_ones()).sum()
    }
}

impl<L: GatherLanes> TreeBatch<L> {
    /// A node, and its parent, which stands before it.
    #[inline(always)]
    pub(crate) fn with_parent(&mut self, i: usize) -> (Option<&mut Node<L>>, &mut Node<L>) {
        let (before, rest) = self.nodes.split_at_mut(i);
        let node = &mut rest[0];
        // Of a root, no place at all.
        (before.get_mut(node.parent as usize), node)
    }

    /// Bodies so light that what hangs on them would drown them in rounding count as heavier: a share of that, at the cost of as
    /// much in what the tree weighs.
    fn weigh(&mut self) {
        self.weighted = 0;
        for node in &mut self.nodes {
            // What hangs on it.
            node.pulled = L::zero();
        }
        for i in (0..self.real).rev() {
            let (parent, node) = self.with_parent(i);
            let least = node.pulled * L::splat(LIGHTEST);
            let light = (least * node.inverse_mass).gt(L::one());
            let factor = L::select(light, least * node.inverse_mass, L::one());
            if let Some(parent) = parent {
                parent.pulled += node.pulled + L::one() / node.inverse_mass;
            }
            node.inverse_mass = node.inverse_mass / factor;
            node.inertia = scaled(&node.inertia, factor);
            let bits = light.bits() & node.write;
            self.weighted |= bits;
        }
    }

    /// Takes arms and impulses as they are at the start of a step.
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
        self.brace();
    }

    /// Trees that keep their energy.
    pub(crate) fn exact(&self) -> L::Mask {
        L::Mask::from_bits(self.exact)
    }

    /// Whether all do.
    pub(crate) fn all_exact(&self) -> bool {
        self.nodes.first().is_none_or(|root| root.write == self.exact)
    }

    /// Takes contacts along, and is ready to be solved.
    pub(crate) fn take_along(&mut self, contacts: (u32, u32)) {
        self.contacts = contacts;
        self.factor();
        self.fresh = true;
    }

    /// From the leaves to the root: what each body is like with all that hangs on it.
    pub(crate) fn factor(&mut self) {
        for node in &mut self.nodes {
            let mass = node.inverse_mass;
            let mass = Sym3 { xx: mass, yy: mass, zz: mass, ..Sym3::default() };
            node.free = Sym6 { linear: mass, mixed: [Vec3::zero(); 3], angular: node.braced_inverse };
        }
        for i in (0..self.real).rev() {
            let (parent, node) = self.with_parent(i);
            if !node.jointed {
                continue;
            }
            let [arm, above] = node.arm_now;
            let mut mobility = node.free.mobility_at(arm);
            node.stiff = node.held_by(&mobility);
            if let Some(parent) = parent {
                node.rest = parent.free;
                mobility.add(&node.rest.mobility_at(above));
                node.joined = node.held_by(&mobility);
                parent.free = node.rest.joined_at(above, &node.joined);
            }
        }
        if self.contacts.0 < self.contacts.1 {
            self.answer();
        }
        if self.has_extra() {
            self.factor_extra();
        }
    }

    /// Whether there are rows beside the tree.
    #[inline(always)]
    pub(crate) fn has_extra(&self) -> bool {
        self.is_cut() || !self.extra.motors.is_empty()
    }

    /// Trees that touch nothing, and are warm-started: what pulls in them is no blow.
    pub(crate) fn is_alone(&self) -> L::Mask {
        self.share.gt(L::splat(TOUCHING))
    }

    /// What pulls at an arm turns a body back, the faster the lighter the body is: a chain that bears a thousand times its
    /// own weight is a string with a note too high for the substep, and would tear itself apart. Where that is so, the
    /// pull is taken into the inertia, as if it were followed through the substep (Andrews, Teichmann and Kry,
    /// *Geometric Stiffness for Real-time Constrained Multibody Dynamics*, 2017).
    pub(crate) fn brace(&mut self) {
        self.brace_by(self.is_alone());
    }

    /// The same; in some lanes nothing is a blow.
    pub(crate) fn brace_by(&mut self, alone: L::Mask) {
        for node in &mut self.nodes {
            (node.braced, node.pulled) = (Sym3::default(), L::zero());
        }
        let h = L::splat(self.h);
        for i in 0..self.nodes.len() {
            let (parent, node) = self.with_parent(i);
            if !node.jointed {
                continue;
            }
            let size = node.impulse.length();
            let blow = size.gt(node.steady) & !alone;
            let steady = L::select(blow, node.steady / L::select(blow, size, L::one()), L::one());
            let impulse = node.impulse * steady;
            let [arm, other] = node.arm_now;
            if let Some(parent) = parent {
                parent.pull(-impulse, other, h);
            }
            let own = self.body_of(i);
            self.nodes[own].pull(impulse, arm, h);
        }
        for node in &mut self.nodes {
            let Sym3 { xx, yy, zz, .. } = node.inertia;
            let (pull, own) = (node.pulled, L::splat(0.5 * SAFE) * (xx + yy + zz));
            let share = L::select(pull.gt(own), L::one() - own / pull, L::zero());
            node.braced = plus(&node.inertia, &scaled(&node.braced, share));
            node.braced_inverse = inverse(&node.braced);
        }
        self.turn_inertias();
    }

    /// Applies the impulses of the last step.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    pub(crate) unsafe fn warm_start(&mut self, motion: &Motion<'_, '_>) {
        if self.all_exact() {
            return;
        }
        // SAFETY: by the contract; what velocities were is not written while rows are solved.
        unsafe {
            self.predict_bend(motion, self.h);
            self.load(motion);
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
        unsafe { self.save(motion, !self.exact) };
    }

    /// The angular velocities that bodies get from the impulses, and from what pulls, at arms as they are now: what warm
    /// starting adds to the velocities is as if bodies had not turned, and a pendulum would gain energy.
    fn turn_along(&mut self) {
        for node in self.nodes.iter_mut().filter(|node| node.turns == Turns::AboutAxis) {
            // A hinge bears nothing about its axis, which has turned.
            node.twist -= node.axis_now[0] * node.axis_now[0].dot(node.twist);
        }
        self.nodes.iter_mut().for_each(|node| node.asked = Twist::zero());
        for i in 0..self.nodes.len() {
            let (parent, node) = self.with_parent(i);
            let [own, other] = node.arm_now.map(|arm| arm.cross(node.impulse) + node.twist);
            if let Some(parent) = parent {
                parent.asked.angular -= other;
            }
            let body = self.body_of(i);
            self.nodes[body].asked.angular += own;
        }
        self.add_motors(|node| &mut node.asked.angular);
        let exact = self.exact();
        for node in &mut self.nodes {
            let own = node.velocity.angular - node.gained;
            let now = node.braced_inverse.mul(node.inertia.mul(own) + node.asked.angular);
            node.velocity.angular = Vec3::select(exact, node.velocity.angular, now);
            node.gained = now - own;
        }
        self.repeat_bodies();
    }

    /// Adds what motors turn bodies by.
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

    /// Velocities of bodies that stand in nodes of cut joints too.
    pub(crate) fn repeat_bodies(&mut self) {
        let (bodies, cuts) = self.nodes.split_at_mut(self.real);
        for cut in cuts {
            cut.velocity = bodies[cut.own as usize].velocity;
        }
    }

    /// One exact solution for all joints of the trees; `touch` solves what contacts of a body go along.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    pub(crate) unsafe fn solve(
        &mut self,
        motion: &Motion<'_, '_>,
        pass: &JointPass,
        contacts: &[Seated],
        touch: impl FnMut(&Seated, &mut Toured<'_, L>),
    ) {
        let warm = !self.all_exact();
        if pass.moved && warm {
            // SAFETY: displacements are not written while rows are solved.
            unsafe { self.follow(motion) };
            if self.is_alone().any() {
                // A load may come within a substep.
                self.brace();
            }
            self.factor();
            self.fresh = true;
        }
        let fresh = warm && !pass.relax && std::mem::take(&mut self.fresh);
        if fresh {
            // SAFETY: these velocities are not written while rows are solved.
            unsafe { self.predict_bend(motion, 1.0 / pass.inverse_h) };
        }
        // SAFETY: by the contract.
        unsafe { self.load(motion) };
        let mut lanes = L::zero().eq(L::zero());
        if self.exact != 0 && !pass.relax {
            // Where nothing has acted since joints did, all is solved.
            // SAFETY: by the contract.
            lanes = !(self.exact() & unsafe { self.is_free(motion) });
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
        unsafe { self.save(motion, lanes.bits()) };
    }

    /// From the leaves to the root and back, for the trees in some lanes.
    pub(crate) fn sweep(
        &mut self,
        pass: &JointPass,
        lanes: L::Mask,
        contacts: &[Seated],
        touch: impl FnMut(&Seated, &mut Toured<'_, L>),
    ) {
        self.nodes.iter_mut().for_each(|node| node.pushed = Twist::zero());
        self.extra.drives = match (self.extra.idle, pass.relax) {
            (true, _) => Drives::None,
            (_, true) => Drives::Rigid,
            _ => Drives::All,
        };
        let rate = if pass.relax { L::zero() } else { self.share * L::splat(pass.inverse_h) };
        let asked = |node: &Node<L>, parent: Option<&Node<L>>| {
            let [arm, other] = node.arm_now;
            let mut asked = node.velocity.seen_at(arm);
            asked.subtract(parent.map_or(node.anchored, |parent| parent.velocity).seen_at(other));
            asked.linear += pass.linear_bias(node.apart_now, rate);
            asked.angular += pass.angular_bias(node.error_now, rate);
            if !pass.relax {
                asked.add(node.bend);
            }
            asked
        };
        self.gather_up(asked);
        if !contacts.is_empty() {
            self.tour(contacts, touch);
            self.gather_up(asked);
        }
        self.answer_all();
        let zero = Vec3::zero();
        for node in &mut self.nodes {
            node.impulse -= Vec3::select(lanes, node.force.linear, zero);
            node.twist -= Vec3::select(lanes, node.force.angular, zero);
            let gained = node.change.angular - node.braced_inverse.mul(node.pushed.angular);
            node.gained += Vec3::select(lanes, gained, zero);
            node.velocity.linear += Vec3::select(lanes, node.change.linear, zero);
            node.velocity.angular += Vec3::select(lanes, node.change.angular, zero);
        }
        for motor in &mut self.extra.motors {
            motor.impulse -= L::select(lanes, motor.less, L::zero());
        }
        self.extra.drives = Drives::None;
    }

    /// Impulses of joints that answer what is asked for, and the changes of velocity by them and by what pushes.
    pub(crate) fn answer_all(&mut self) {
        self.answer_bodies();
        if self.has_extra() {
            self.answer_extra();
        }
    }

    /// From the root to the leaves: impulses of joints that answer what is asked for, and the changes of velocity by them and
    /// by what pushes.
    ///
    /// A joint's impulse follows from the mobility of both its bodies, and a body's change from its own inertia: what a light
    /// body between heavy ones bears is a small difference of what is carried past it, and would be lost in that.
    pub(crate) fn answer_bodies(&mut self) {
        for i in 0..self.real {
            let (parent, node) = self.with_parent(i);
            node.pushes = node.pushed;
            if !node.jointed {
                continue;
            }
            let [arm, other] = node.arm_now;
            node.force = match parent {
                Some(parent) => {
                    let mut asked = node.asked;
                    node.beside.add(parent.pushes);
                    asked.subtract(node.rest.mul(&node.beside).seen_at(other));
                    let force = node.unspun(node.joined.mul(&asked));
                    parent.pushes.add(force.moved(other));
                    force
                }
                None => node.unspun(node.stiff.mul(&node.asked)),
            };
            node.pushes.subtract(node.force.moved(arm));
        }
        for node in &mut self.nodes[..self.real] {
            let Twist { linear, angular } = node.pushes;
            node.change =
                Twist { linear: linear * node.inverse_mass, angular: node.braced_inverse.mul(angular) };
        }
    }

    /// What is `asked` of each joint, and what of that is left to it.
    #[inline(always)]
    pub(crate) fn gather_up(&mut self, asked: impl Fn(&Node<L>, Option<&Node<L>>) -> Twist<L>) {
        for i in self.real..self.nodes.len() {
            let (parent, node) = self.with_parent(i);
            node.asked = asked(node, parent.as_deref());
        }
        self.gather_up_bodies(asked);
    }

    /// From the leaves to the root, without cut joints.
    #[inline(always)]
    pub(crate) fn gather_up_bodies(&mut self, asked: impl Fn(&Node<L>, Option<&Node<L>>) -> Twist<L>) {
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
            all.add(asked(node, parent.as_deref()));
            node.asked = node.unspun(all);
            if let Some(parent) = parent {
                node.beside = parent.carried;
                parent.carried.add(node.stiff.mul(&node.asked).moved(node.arm_now[1]));
            }
        }
    }

    /// Where bodies go in a substep as they turn at its start. Not as the rows before want them to turn: what can't have what
    /// it wants, and light links under a load, would turn any way within it.
    ///
    /// # Safety
    /// No thread writes these velocities.
    unsafe fn predict_bend(&mut self, motion: &Motion<'_, '_>, h: f32) {
        // SAFETY: by the contract.
        let read = |i| unsafe { motion.base.read(i) };
        let exact = self.exact();
        for i in 0..self.nodes.len() {
            let (parent, node) = self.with_parent(i);
            let own = gather(read, &node.body).1;
            node.change.angular = own;
            if !node.jointed {
                continue;
            }
            let above = match parent {
                Some(parent) => parent.change.angular,
                // SAFETY: what stands still or is moved by the caller is written by no row.
                None => gather(|i| unsafe { motion.velocity.read(i) }, &node.anchor).1,
            };
            let ([arm, other], h) = (node.arm_now, L::splat(h));
            let linear = bend(own, arm, h) - bend(above, other, h);
            node.bend.linear = Vec3::select(exact, node.bend.linear, linear);
            if node.turns == Turns::AboutAxis {
                let axis = node.axis_now[0];
                let angular = swerve(own, axis, h) - swerve(above, axis, h);
                node.bend.angular = Vec3::select(exact, node.bend.angular, angular);
            }
        }
    }

    /// Arms and separations after displacements that others wrote.
    ///
    /// # Safety
    /// No thread writes displacements of the trees.
    pub(crate) unsafe fn follow(&mut self, motion: &Motion<'_, '_>) {
        // SAFETY: by the contract.
        unsafe { self.fetch(motion, 0) };
        self.place(L::zero());
    }

    /// Displacements, but for the lanes that know theirs.
    ///
    /// # Safety
    /// No thread writes displacements of the trees.
    pub(crate) unsafe fn fetch(&mut self, motion: &Motion<'_, '_>, known: u32) {
        // SAFETY: by the contract.
        let read = |i| unsafe { motion.delta.read(i) };
        let known = L::Mask::from_bits(known);
        for node in &mut self.nodes {
            let (linear, angular) = gather(read, &node.body);
            node.moved.linear = Vec3::select(known, node.moved.linear, linear);
            node.moved.angular = Vec3::select(known, node.moved.angular, angular);
            if node.parent == NONE {
                let (linear, angular) = gather(read, &node.anchor);
                node.anchor_moved = Twist { linear, angular };
            }
        }
    }

    /// Arms and separations after displacements, some time before what trees hang on is where it is to be [s].
    pub(crate) fn place(&mut self, left: L) {
        for i in 0..self.nodes.len() {
            let (parent, node) = self.with_parent(i);
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
        self.turn_inertias();
    }

    /// Inertias of what keeps its energy, as it is turned now. The others' stay as they were at the start of the step.
    fn turn_inertias(&mut self) {
        if self.exact == 0 {
            return;
        }
        let exact = self.exact();
        for node in &mut self.nodes {
            let [inertia, inverse] = node.drift.turned(node.turn);
            node.braced = Sym3::select(exact, inertia, node.braced);
            node.braced_inverse = Sym3::select(exact, inverse, node.braced_inverse);
        }
    }

    /// Writes displacements of some lanes. Where there is no number any more, bodies go as they would without the tree.
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
                    // Something acted on it, and it is turned already.
                    (to.pad0, to.pad1) = (1.0, 1.0);
                }
                if delta[lane].linear.is_finite() && delta[lane].angular.is_finite() {
                    (to.linear, to.angular) = (delta[lane].linear, delta[lane].angular);
                } else {
                    put(&mut node.moved.linear, lane, to.linear);
                    put(&mut node.moved.angular, lane, to.angular);
                }
            }
        }
        let (bodies, cuts) = self.nodes.split_at_mut(self.real);
        cuts.iter_mut().for_each(|cut| cut.moved = bodies[cut.own as usize].moved);
    }

    /// Velocities.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    pub(crate) unsafe fn load(&mut self, motion: &Motion<'_, '_>) {
        // SAFETY: by the contract. One by one: a slice of all would include those that other threads write.
        let read = |i| unsafe { motion.velocity.read(i) };
        for node in &mut self.nodes {
            let (linear, angular) = gather(read, &node.body);
            node.velocity = Twist { linear, angular };
            node.drift.before = node.velocity;
            if node.parent == NONE {
                let (linear, angular) = gather(read, &node.anchor);
                node.anchored = Twist { linear, angular };
            }
        }
    }

    /// Writes the velocities of some lanes. Where trees keep their energy, what joints changed is no warm start for the next
    /// substep: rows see it as if it had been there before them.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    pub(crate) unsafe fn save(&mut self, motion: &Motion<'_, '_>, lanes: u32) {
        for node in self.of_bodies() {
            let before = &node.drift.before;
            let all = scatter(node.velocity.linear, node.velocity.angular);
            let mut own = [Record::default(); 8];
            if self.exact != 0 {
                let (linear, angular) = (node.velocity.linear, node.velocity.angular);
                own = scatter(linear - before.linear, angular - before.angular);
            }
            for lane in (0..L::N).filter(|lane| (node.write & lanes) >> lane & 1 != 0) {
                let body = node.body[lane] as usize;
                // SAFETY: by the contract; no body is twice in a batch.
                let (v, base) = unsafe { (motion.velocity.get(body), motion.base.get(body)) };
                let new = all[lane];
                if self.exact >> lane & 1 != 0 {
                    let fastest = new.linear.abs().max(new.angular.abs()).max_element();
                    if !(fastest < RUNAWAY && new.linear.is_finite() && new.angular.is_finite()) {
                        // No number any more, or as good as none.
                        continue;
                    }
                    if v.linear == base.linear && v.angular == base.angular {
                        // To the last bit: that is how it is told that nothing else acts.
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

/// What is faster than this [m/s] or [rad/s] goes on as if the tree had not acted.
const RUNAWAY: f32 = 1e6;

/// The square of the frequency times the substep, of a body that turns on its joints, up to which it is integrated as it is.
const SAFE: f32 = 0.5;

impl<L: Lanes> Node<L> {
    /// Impulse at the joint per velocity that it doesn't allow, of what has such a mobility there.
    #[inline(always)]
    fn held_by(&self, mobility: &Sym6<L>) -> Sym6<L> {
        mobility.inverse_with(match self.turns {
            Turns::Freely => Sym3::default(),
            Turns::AboutAxis => across(&mobility.angular, self.axis_now[0]),
            Turns::Not => inverse(&mobility.angular),
        })
    }

    /// Of a hinge, without what is about its axis. Rounding leaves some of that, by which a rotor would spin ever faster: so
    /// twice.
    #[inline(always)]
    fn unspun(&self, mut of: Twist<L>) -> Twist<L> {
        if self.turns == Turns::AboutAxis {
            let axis = self.axis_now[0];
            for _ in 0..2 {
                of.angular -= axis * axis.dot(of.angular);
            }
        }
        of
    }

    /// How far the joint is open.
    #[inline(always)]
    pub(crate) fn open(&self) -> Twist<L> {
        Twist { linear: self.apart_now, angular: self.error_now }
    }

    /// Moves the body a little.
    #[inline(always)]
    pub(crate) fn shift(&mut self, by: Twist<L>) {
        self.moved.linear += by.linear;
        self.moved.angular = log_near(exp(by.angular).compose(exp(self.moved.angular)), self.moved.angular);
    }

    /// Adds the stiffness that an impulse at an arm makes, if it pulls.
    #[inline(always)]
    fn pull(&mut self, impulse: Vec3<L>, arm: Vec3<L>, h: L) {
        let along = impulse.dot(arm);
        let pulls = along.gt(L::zero());
        let k = L::select(pulls, along * h, L::zero());
        let over = k / L::select(pulls, arm.length_squared(), L::one());
        self.pulled += k;
        let b = &mut self.braced;
        b.xx += k - over * arm.x * arm.x;
        b.yy += k - over * arm.y * arm.y;
        b.zz += k - over * arm.z * arm.z;
        b.xy += -(over * arm.x * arm.y);
        b.xz += -(over * arm.x * arm.z);
        b.yz += -(over * arm.y * arm.z);
    }
}
