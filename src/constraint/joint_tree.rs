//! Trees of joints, solved exactly.
//!
//! Row by row, what a heavy load at the end of a chain needs travels up one joint a pass: a ball a thousand times as heavy as
//! the links tears such a chain apart. But points that join bodies without a loop (chains, ragdolls, cars), with what is
//! locked about them, are a linear system that needs no iteration. From the leaves to the root, each body's inertia takes in
//! what hangs on it; then impulses go back from the root to the leaves (Featherstone 1983; with impulses instead of forces, and in the
//! coordinates of the bodies, Baraff, *Linear-Time Dynamics using Lagrange Multipliers*, 1996). Up to eight trees of the
//! same shape share the lanes.

use super::contact_row::Motion;
use super::free_turn::{Moments, exp, log, log_near, moved_by};
use super::joint_ends::{JointPass, NONE, across, inverse};
use super::joint_fill::put;
use super::joint_tour::Toured;
use super::order::Place;
use super::seats::Seated;
use super::spatial::{Sym6, Twist, plus};
use crate::lanes::{GatherLanes, Lanes, Mask, Quat, Sym3, Vec3, gather, scatter};

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
    /// Whether there is a joint.
    pub(crate) jointed: bool,
    pub(crate) body: [u32; 8],
    /// What a root hangs on: a body that the joint can't move.
    pub(crate) anchor: [u32; 8],
    /// Bit per lane: there is a body.
    pub(crate) write: u32,
    /// The body's own.
    pub(crate) inverse_mass: L,
    pub(super) moments: Moments<L>,
    /// What pulls the body [m/s²].
    pub(crate) pull: Vec3<L>,
    /// From the centre of mass to the joint, of the body and of its parent, at the start of the step [m].
    pub(crate) arm: [Vec3<L>; 2],
    /// From the parent's point to the body's [m].
    pub(crate) apart: Vec3<L>,
    /// Of a hinge, on the body and on its parent; of what is welded, the rotation vector from the parent [rad].
    pub(crate) axis: [Vec3<L>; 2],
    pub(crate) error: Vec3<L>,
    /// The same after the last substep.
    pub(super) arm_now: [Vec3<L>; 2],
    pub(super) apart_now: Vec3<L>,
    axis_now: [Vec3<L>; 2],
    pub(super) error_now: Vec3<L>,
    /// How much faster the body leaves its parent in the mean over the next substep than it does at its start.
    bend: Twist<L>,
    /// Principal axes and displacement after the last substep.
    axes_now: Quat<L>,
    pub(super) moved: Twist<L>,
    /// On the body, of the last substep: at the joint [N s], and about it [N m s].
    pub(crate) impulse: Vec3<L>,
    pub(crate) twist: Vec3<L>,
    /// How much of the impulse at the joint is no blow [N s].
    pub(crate) steady: L,
    /// What pulls on the body, and what of that is added to its inertia; inertia with that, and its inverse.
    strain: Sym3<L>,
    brace: Sym3<L>,
    braced: Sym3<L>,
    pub(super) braced_inverse: Sym3<L>,
    /// Inverse of the inertia of the body with all that hangs on it.
    pub(super) free: Sym6<L>,
    /// Impulse at the joint per velocity that it doesn't allow.
    pub(super) stiff: Sym6<L>,
    /// The same of both bodies, the parent with what hangs on it but for this branch and those before it; and the velocity of
    /// that parent per impulse on it.
    joined: Sym6<L>,
    others: Sym6<L>,
    /// Velocity of the body per impulse on it, with the whole tree: if it has contacts that go along.
    pub(super) whole: Sym6<L>,
    /// How much of that is pulled, and how much it bears without more [kg m²].
    pulled: L,
    bears: L,
    /// The most pull that it is ready for [kg m²].
    expected: L,
    /// How far it may turn in a substep [rad].
    furthest: L,
    /// Of one pass.
    pub(super) velocity: Twist<L>,
    /// The velocity before the pass.
    before: Twist<L>,
    /// Velocity and impulse before what is foreseen.
    start: [Twist<L>; 2],
    /// Velocity and displacement of what a root hangs on.
    pub(super) anchored: Twist<L>,
    anchor_moved: Twist<L>,
    pub(super) carried: Twist<L>,
    pub(super) asked: Twist<L>,
    pub(super) change: Twist<L>,
    pub(super) pending: Twist<L>,
    /// What contacts that go along gave the body.
    pub(super) pushed: Twist<L>,
    /// The same with what its joints give it; and what of `carried` the parent had from the branches after this one.
    pushes: Twist<L>,
    beside: Twist<L>,
    /// Of the joint, taken from the body at its arm.
    force: Twist<L>,
    /// The turn of a substep, and what it adds to the angular velocity.
    turn: Quat<L>,
    more: Vec3<L>,
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
            jointed: false,
            body: [0; 8],
            anchor: [0; 8],
            write: 0,
            // Of something, so that an inert lane has numbers too.
            inverse_mass: one,
            moments: Moments::default(),
            pull: zero,
            arm: [zero; 2],
            apart: zero,
            axis: [Vec3::new(one, L::zero(), L::zero()); 2],
            error: zero,
            arm_now: [zero; 2],
            apart_now: zero,
            axis_now: [zero; 2],
            error_now: zero,
            bend: Twist::zero(),
            axes_now: Quat { v: zero, w: one },
            moved: Twist::zero(),
            impulse: zero,
            twist: zero,
            steady: L::zero(),
            strain: Sym3::default(),
            brace: Sym3::default(),
            braced: Sym3::default(),
            braced_inverse: Sym3::default(),
            free: Sym6::zero(),
            stiff: Sym6::zero(),
            whole: Sym6::zero(),
            pending: Twist::zero(),
            pushed: Twist::zero(),
            turn: Quat { v: zero, w: one },
            more: zero,
            pulled: L::zero(),
            bears: L::zero(),
            expected: L::zero(),
            furthest: L::splat(f32::INFINITY),
            joined: Sym6::zero(),
            others: Sym6::zero(),
            pushes: Twist::zero(),
            beside: Twist::zero(),
            force: Twist::zero(),
            velocity: Twist::zero(),
            before: Twist::zero(),
            start: [Twist::zero(); 2],
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
    pub(crate) nodes: Vec<Node<L>>,
    /// Share of an error that velocities take back within a substep.
    pub(crate) share: L,
    /// Half a substep, where nothing but joints and what pulls acts on the tree [s].
    pub(super) lag: L,
    /// Whether anything is braced.
    pub(super) braces: bool,
    /// Bodies will turn as they were last foreseen to.
    pub(super) foreseen: bool,
    /// A joint lets its bodies collide: a loop with their contact, of which the tree knows nothing. Contacts don't go along,
    /// and what is open is left to the velocities.
    pub(crate) loops: bool,
    /// Where it is solved among all rows.
    pub(crate) place: Place,
    /// Contacts that go along with the trees: their range among all such.
    pub(crate) contacts: (u32, u32),
    /// Substep [s].
    pub(crate) h: f32,
    /// Lanes in which a body counts as heavier than it is.
    pub(crate) weighted: u32,
}

/// What has less than this of the mass that hangs on it is a light link.
const LIGHT: f32 = 1e-3;

/// The least mass of a body for what hangs on it. Of mobilities in `f32` a part in ten million is left; of chains of twenty,
/// links of a 50,000th already lose some digits that they need, and of a millionth all.
const LIGHTEST: f32 = 5e-5;

/// Share of an error that velocities take back within a substep, of trees that touch something. Contacts see a tree body by
/// body: what both agree on they find slowly, and an error that is taken back faster makes what they do not agree on grow (see
/// [`Softness::stiffest`](super::contact_row::Softness::stiffest), with a load that does not yield).
pub(crate) const TOUCHING: f32 = 0.05;

impl<L> TreeBatch<L> {
    /// How many bodies there are in its trees.
    pub(super) fn bodies(&self) -> u32 {
        self.nodes.iter().map(|node| node.write.count_ones()).sum()
    }
}

impl<L: GatherLanes> TreeBatch<L> {
    /// A node, and its parent, which stands before it.
    #[inline(always)]
    pub(super) fn with_parent(&mut self, i: usize) -> (Option<&mut Node<L>>, &mut Node<L>) {
        let (before, rest) = self.nodes.split_at_mut(i);
        let node = &mut rest[0];
        // Of a root, no place at all.
        (before.get_mut(node.parent as usize), node)
    }

    /// Takes arms and impulses as they are at the start of a step.
    pub(crate) fn begin(&mut self, h: f32) {
        for node in &mut self.nodes {
            (node.arm_now, node.apart_now) = (node.arm, node.apart);
            (node.axis_now, node.error_now) = (node.axis, node.error);
            (node.axes_now, node.moved) = (node.moments.axes, Twist::zero());
        }
        self.h = h;
        self.burden();
        self.brace(h, self.is_alone());
        self.weigh();
    }

    /// Bodies so light that what hangs on them would drown them in rounding count as heavier: a share of that, at the cost of as
    /// much in what the tree weighs.
    fn burden(&mut self) {
        self.weighted = 0;
        for node in &mut self.nodes {
            // What hangs on it.
            node.pulled = L::zero();
        }
        for i in (0..self.nodes.len()).rev() {
            let (parent, node) = self.with_parent(i);
            let least = node.pulled * L::splat(LIGHTEST);
            let light = (least * node.inverse_mass).gt(L::one());
            let factor = L::select(light, least * node.inverse_mass, L::one());
            if let Some(parent) = parent {
                parent.pulled += node.pulled + L::one() / node.inverse_mass;
            }
            let much = (node.pulled * L::splat(LIGHT) * node.inverse_mass).gt(L::one());
            node.furthest = L::select(much, L::splat(MOST_PARTS * TURN), L::splat(f32::INFINITY));
            let less = L::one() / factor;
            node.inverse_mass = node.inverse_mass * less;
            node.moments.inertia = node.moments.inertia * factor;
            node.moments.inverse = node.moments.inverse * less;
            let bits = light.bits() & node.write;
            self.weighted |= bits;
        }
    }

    /// Trees that touch nothing: what pulls in them is no blow.
    fn is_alone(&self) -> L::Mask {
        !self.share.gt(L::zero())
    }

    /// Takes contacts along, and is ready to be solved.
    pub(crate) fn take_along(&mut self, contacts: (u32, u32)) {
        self.contacts = contacts;
        self.factor();
    }

    /// From the leaves to the root: what each body is like with all that hangs on it.
    pub(super) fn factor(&mut self) {
        for node in &mut self.nodes {
            let mass = node.inverse_mass;
            let mass = Sym3 { xx: mass, yy: mass, zz: mass, ..Sym3::default() };
            node.free = Sym6 { linear: mass, mixed: [Vec3::zero(); 3], angular: node.braced_inverse };
        }
        for i in (0..self.nodes.len()).rev() {
            let (parent, node) = self.with_parent(i);
            if !node.jointed {
                continue;
            }
            let [arm, above] = node.arm_now;
            let mut mobility = node.free.mobility_at(arm);
            node.stiff = node.held_by(&mobility);
            if let Some(parent) = parent {
                node.others = parent.free;
                mobility.add(&node.others.mobility_at(above));
                node.joined = node.held_by(&mobility);
                parent.free = node.others.joined_at(above, &node.joined);
            }
        }
        if self.contacts.0 < self.contacts.1 {
            self.answer();
        }
    }

    /// What pulls at an arm turns a body back, the faster the lighter the body is: a chain that bears a thousand times its
    /// own weight is a string with a note too high for the substep, and would tear itself apart. Where that is so, the
    /// pull is taken into the inertia, as if it were followed through the substep (Andrews, Teichmann and Kry,
    /// *Geometric Stiffness for Real-time Constrained Multibody Dynamics*, 2017).
    fn brace(&mut self, h: f32, lasting: L::Mask) {
        for node in &mut self.nodes {
            let Vec3 { x, y, z } = node.moments.inertia;
            (node.strain, node.pulled, node.bears) = (Sym3::default(), L::zero(), x + y + z);
        }
        let h = L::splat(h);
        for i in 0..self.nodes.len() {
            let (parent, node) = self.with_parent(i);
            if !node.jointed || node.turns == Turns::Not {
                // What is welded turns as one, whatever pulls within.
                continue;
            }
            let size = node.impulse.length();
            let blow = size.gt(node.steady) & !lasting;
            let steady = L::select(blow, node.steady / L::select(blow, size, L::one()), L::one());
            let impulse = node.impulse * steady;
            node.pull(impulse, node.arm_now[0], h);
            let mut gives = L::zero();
            if let Some(parent) = parent {
                parent.pull(-impulse, node.arm_now[1], h);
                let Vec3 { x, y, z } = parent.moments.inverse;
                gives = parent.inverse_mass + node.arm_now[1].length_squared() * x.max(y).max(z);
            }
            // To turn about its joint it has to move, or the joint.
            node.bears += L::splat(2.0) * node.arm_now[0].length_squared() / (node.inverse_mass + gives);
        }
        self.brace_for(1.0);
    }

    /// Braces for a substep that is followed in parts.
    fn brace_for(&mut self, parts: f32) {
        // In a shorter time what pulls turns a body back by less.
        let less = L::splat(1.0 / (parts * parts));
        self.braces = false;
        for node in &mut self.nodes {
            let (pull, own) = (node.pulled * less, L::splat(0.5 * SAFE) * node.bears);
            let much = pull.gt(own);
            self.braces |= much.any();
            let share = L::select(much, L::one() - own / L::select(much, pull, L::one()), L::zero()) * less;
            let s = &node.strain;
            node.brace = Sym3 {
                xx: s.xx * share,
                yy: s.yy * share,
                zz: s.zz * share,
                xy: s.xy * share,
                xz: s.xz * share,
                yz: s.yz * share,
            };
        }
    }

    /// Inertias as bodies are turned now.
    fn weigh(&mut self) {
        for node in &mut self.nodes {
            [node.braced, node.braced_inverse] = node.moments.in_world(node.axes_now);
            if self.braces {
                node.braced = plus(&node.braced, &node.brace);
                node.braced_inverse = inverse(&node.braced);
            }
        }
    }

    /// What joints do in a substep to what pulls, and to the impulses that rows and contacts start with: those with which
    /// they are closed at its end (SHAKE, by Newton's method). An exact solution needs no warm start, and what acted at arms
    /// that turn would be a wrong one: it makes a pendulum swing ever higher.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    pub(crate) unsafe fn predict(&mut self, motion: &Motion<'_, '_>, pass: &JointPass) {
        // SAFETY: by the contract.
        let alone = unsafe {
            self.load(motion);
            self.is_free(motion)
        };
        self.lag = L::select(alone, L::splat(0.5 * self.h), L::zero());
        if self.is_alone().any() {
            // A load may come within a substep.
            let braced = self.braces;
            self.brace(self.h, self.is_alone());
            if braced || self.braces {
                self.weigh();
                self.factor();
            }
        }
        if all(alone) {
            self.guess();
        } else {
            // Not as rows want bodies to turn: what can't have what it wants would turn them any way within the substep.
            // SAFETY: by the contract.
            unsafe { self.take_base(motion) };
        }
        self.foresee(L::zero().eq(L::zero()));
        for node in &mut self.nodes {
            (node.impulse, node.twist) = (Vec3::zero(), Vec3::zero());
            node.velocity = node.before;
        }
        if self.parts() <= 1.0 {
            self.calm();
        }
        self.foreseen = self.close_ahead(pass, alone) && all(alone);
        if self.is_taken_aback() {
            self.weigh();
            self.factor();
            for node in &mut self.nodes {
                (node.impulse, node.twist) = (Vec3::zero(), Vec3::zero());
                node.velocity = node.before;
            }
            self.foresee(L::zero().eq(L::zero()));
            self.calm();
            self.foreseen = self.close_ahead(pass, alone) && all(alone);
        }
        // SAFETY: by the contract.
        unsafe { self.save(motion) };
    }

    /// A load may come within a substep, of a chain that gets taut, or go, after a blow. Whether a tree that touches nothing is
    /// pulled by much more or less than it is braced for; then it is braced for that.
    fn is_taken_aback(&mut self) -> bool {
        let alone = self.is_alone();
        if !alone.any() {
            return false;
        }
        for node in &mut self.nodes {
            node.expected = node.pulled;
        }
        self.brace(self.h, alone);
        let other = |node: &Node<L>| {
            let own = L::splat(0.5 * SAFE) * node.bears;
            let more = node.pulled.gt(node.expected.max(own) * L::splat(MORE));
            let gone = node.expected.gt(node.pulled.max(own) * L::splat(MORE));
            ((more | gone) & alone).bits() & node.write != 0
        };
        self.nodes.iter().any(other)
    }

    /// How fast bodies turn with half of what joints bore in the last substep: the other half acts at its end. What all this
    /// is for is next to solved then, as long as nothing changes much.
    fn guess(&mut self) {
        self.nodes.iter_mut().for_each(|node| node.carried.angular = Vec3::zero());
        for i in 0..self.nodes.len() {
            let (parent, node) = self.with_parent(i);
            node.carried.angular += node.arm_now[0].cross(node.impulse) + node.twist;
            if let Some(parent) = parent {
                parent.carried.angular -= node.arm_now[1].cross(node.impulse) + node.twist;
            }
        }
        for node in &mut self.nodes {
            node.velocity.angular += node.braced_inverse.mul(node.carried.angular * L::splat(0.5));
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
        // SAFETY: by the contract.
        unsafe { self.load(motion) };
        let own = &contacts[self.contacts.0 as usize..self.contacts.1 as usize];
        // SAFETY: by the contract.
        if !pass.relax && own.is_empty() && all(unsafe { self.is_free(motion) }) {
            // Nothing has acted since.
            return;
        }
        self.foreseen = false;
        self.sweep(pass, own, touch);
        if pass.relax {
            self.tame(self.h);
        }
        // SAFETY: by the contract.
        unsafe { self.save(motion) };
    }

    /// The impulses with which joints are closed at the end of the substep, in some lanes by further rounds of Newton's method.
    /// Says whether what was foreseen last is what is.
    ///
    /// Where light links lie folded between heavy bodies that part, there may be none, and what is found in their place throws the
    /// tree about. Joints that are closed add next to no energy. So what adds much is not taken: there velocities are made
    /// to fit the joints where they are, which adds none, and what is open at the end is closed on the displacements.
    fn close_ahead(&mut self, pass: &JointPass, lanes: L::Mask) -> bool {
        self.nodes.iter_mut().for_each(|node| {
            node.start = [node.velocity, Twist { linear: node.impulse, angular: node.twist }]
        });
        let before = self.energy();
        self.sweep(pass, &[], |_, _| {});
        let known = lanes.any() && self.refine(pass, lanes);
        let after = self.energy();
        let wild = lanes & !((before * L::splat(MOST_GAIN)).gt(after) | after.eq(L::zero()));
        if wild.bits() & self.nodes.iter().fold(0, |all, node| all | node.write) == 0 {
            return known;
        }
        for node in &mut self.nodes {
            let [velocity, impulse] = node.start;
            let back = |old: Vec3<L>, new: &mut Vec3<L>| *new = Vec3::select(wild, old, *new);
            back(velocity.linear, &mut node.velocity.linear);
            back(velocity.angular, &mut node.velocity.angular);
            back(impulse.linear, &mut node.impulse);
            back(impulse.angular, &mut node.twist);
            back(Vec3::zero(), &mut node.bend.linear);
            back(Vec3::zero(), &mut node.bend.angular);
        }
        self.sweep(pass, &[], |_, _| {});
        for node in &mut self.nodes {
            // Nor do they whirl.
            let angle = node.velocity.angular.length() * L::splat(self.h);
            let less = L::splat(FAR) / angle.max(L::splat(FAR));
            node.velocity.angular = Vec3::select(wild, node.velocity.angular * less, node.velocity.angular);
        }
        false
    }

    /// Light links that lie folded between heavy bodies that part would turn ever faster, to an end that no substep follows.
    fn tame(&mut self, h: f32) {
        for node in &mut self.nodes {
            let angle = node.velocity.angular.length() * L::splat(h);
            let far = angle.gt(node.furthest);
            let less = L::select(far, node.furthest / L::select(far, angle, L::one()), L::one());
            node.velocity.angular = node.velocity.angular * less;
        }
    }

    /// Twice the kinetic energy, of what is braced with that.
    fn energy(&self) -> L {
        let own = |sum: L, node: &Node<L>| {
            let Twist { linear, angular } = node.velocity;
            sum + linear.length_squared() / node.inverse_mass + angular.dot(node.braced.mul(angular))
        };
        self.nodes.iter().fold(L::zero(), own)
    }

    /// Further rounds of Newton's method, in some lanes. Says whether what was foreseen last is what is.
    fn refine(&mut self, pass: &JointPass, lanes: L::Mask) -> bool {
        for _ in 1..ROUNDS {
            self.foresee(lanes);
            if !self.misses(lanes) {
                return true;
            }
            self.sweep(pass, &[], |_, _| {});
        }
        false
    }

    /// From the leaves to the root and back.
    fn sweep(
        &mut self,
        pass: &JointPass,
        contacts: &[Seated],
        touch: impl FnMut(&Seated, &mut Toured<'_, L>),
    ) {
        self.nodes.iter_mut().for_each(Node::rest);
        let rate = if pass.relax { L::zero() } else { self.share * L::splat(pass.inverse_h) };
        let asked = |node: &Node<L>, parent: Option<&Node<L>>| {
            let [arm, other] = node.arm_now;
            let mut asked = node.velocity.seen_at(arm);
            asked.subtract(parent.map_or(node.anchored, |parent| parent.velocity).seen_at(other));
            asked.linear += pass.bias(node.apart_now, rate);
            asked.angular += pass.bias(node.error_now, rate);
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
        for node in &mut self.nodes {
            node.impulse -= node.force.linear;
            node.twist -= node.force.angular;
            node.velocity.add(node.change);
        }
    }

    /// From the root to the leaves: impulses of joints that answer what is asked for, and the changes of velocity by them and
    /// by what pushes.
    ///
    /// A joint's impulse follows from the mobility of both its bodies, and a body's change from its own inertia: what a light
    /// body between heavy ones bears is a small difference of what is carried past it, and would be lost in that.
    pub(super) fn answer_all(&mut self) {
        for i in 0..self.nodes.len() {
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
                    asked.subtract(node.others.mul(&node.beside).seen_at(other));
                    let force = node.unspun(node.joined.mul(&asked));
                    parent.pushes.add(force.moved(other));
                    force
                }
                None => node.unspun(node.stiff.mul(&node.asked)),
            };
            node.pushes.subtract(node.force.moved(arm));
        }
        for node in &mut self.nodes {
            let Twist { linear, angular } = node.pushes;
            node.change =
                Twist { linear: linear * node.inverse_mass, angular: node.braced_inverse.mul(angular) };
        }
    }

    /// From the leaves to the root: what is `asked` of each joint, and of what that leaves to it.
    #[inline(always)]
    pub(super) fn gather_up(&mut self, asked: impl Fn(&Node<L>, Option<&Node<L>>) -> Twist<L>) {
        self.nodes.iter_mut().for_each(|node| node.carried = Twist::zero());
        for i in (0..self.nodes.len()).rev() {
            let (parent, node) = self.with_parent(i);
            if !node.jointed {
                continue;
            }
            let mut carried = node.carried;
            carried.add(node.pushed);
            let carried = node.free.mul(&carried);
            node.asked = carried.seen_at(node.arm_now[0]);
            node.asked.add(asked(node, parent.as_deref()));
            if node.turns == Turns::AboutAxis {
                // What spins about its hinge fast would leave some of that to rounding.
                node.asked = node.unspun(node.asked);
            }
            if let Some(parent) = parent {
                node.beside = parent.carried;
                parent.carried.add(node.stiff.mul(&node.asked).moved(node.arm_now[1]));
            }
        }
    }

    /// Whether nothing but joints and what pulls acts on the trees: then they fall as what is free does, along parabolas.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    unsafe fn is_free(&self, motion: &Motion<'_, '_>) -> L::Mask {
        // SAFETY: by the contract.
        let read = |i| unsafe { motion.base.read(i) };
        let mut same = L::zero().eq(L::zero());
        for node in &self.nodes {
            let (v, w): (Vec3<L>, Vec3<L>) = gather(read, &node.body);
            let own = &node.velocity;
            same = same & v.x.eq(own.linear.x) & v.y.eq(own.linear.y) & v.z.eq(own.linear.z);
            same = same & w.x.eq(own.angular.x) & w.y.eq(own.angular.y) & w.z.eq(own.angular.z);
        }
        same
    }

    /// What is braced turns as if what pulls had been followed through the substep: light links under a load follow it, and
    /// don't whirl.
    fn calm(&mut self) {
        for node in self.nodes.iter_mut().filter(|_| self.braces) {
            let more = node.brace.mul(node.velocity.angular);
            node.velocity.angular -= node.braced_inverse.mul(more);
        }
    }

    /// Velocities as they were before rows acted.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    unsafe fn take_base(&mut self, motion: &Motion<'_, '_>) {
        for node in &mut self.nodes {
            // SAFETY: by the contract.
            let (linear, angular) = gather(|i| unsafe { motion.base.read(i) }, &node.body);
            node.velocity = Twist { linear, angular };
        }
    }

    /// Where the velocities take bodies in the substep, turning freely.
    fn foresee(&mut self, lanes: L::Mask) {
        let (h, over) = (L::splat(self.h), L::splat(1.0 / self.h));
        for i in 0..self.nodes.len() {
            let lag = self.lag;
            let (parent, node) = self.with_parent(i);
            let own = node.velocity;
            (node.turn, node.more) = node.moments.flow(node.axes_now, own.angular, h);
            if !node.jointed {
                continue;
            }
            let (above, turn, pull) = match parent {
                Some(parent) => (parent.velocity, parent.turn, parent.pull),
                None => (node.anchored, exp(node.anchored.angular * h), Vec3::zero()),
            };
            let [arm, other] = node.arm_now;
            let (at, there) = (moved_by(node.turn, arm), moved_by(turn, other));
            let bend = (at - there) * over
                - (own.angular.cross(arm) - above.angular.cross(other))
                - (node.pull - pull) * lag;
            node.bend.linear = Vec3::select(lanes, bend, node.bend.linear);
            let faster = own.angular - above.angular;
            match node.turns {
                Turns::Freely => {}
                Turns::AboutAxis => {
                    let [a, b] = node.axis_now;
                    let (at, there) = (moved_by(node.turn, a), moved_by(turn, b));
                    // (b + there) x (a + at) - b x a
                    let more = b.cross(at) + there.cross(a + at);
                    node.bend.angular = Vec3::select(lanes, more * over - faster, node.bend.angular);
                }
                Turns::Not => {
                    let error = log(node.turn.compose(exp(node.error_now)).compose(turn.conjugate()));
                    let bend = (error - node.error_now) * over - faster;
                    node.bend.angular = Vec3::select(lanes, bend, node.bend.angular);
                }
            }
        }
    }

    /// Whether a joint would be open by more than rounding at the end of the substep.
    fn misses(&self, lanes: L::Mask) -> bool {
        let h = L::splat(self.h);
        let most = L::select(lanes, L::splat(MISS * MISS), L::splat(f32::INFINITY));
        (0..self.nodes.len()).any(|i| {
            let node = &self.nodes[i];
            if !node.jointed {
                return false;
            }
            let above = self.nodes.get(node.parent as usize).map_or(node.anchored, |parent| parent.velocity);
            let [arm, other] = node.arm_now;
            let apart = node.velocity.at(arm) - above.at(other) + node.bend.linear;
            let mut off = (apart * h).length_squared();
            if node.turns != Turns::Freely {
                let mut error = node.velocity.angular - above.angular + node.bend.angular;
                if node.turns == Turns::AboutAxis {
                    error -= node.axis_now[0] * node.axis_now[0].dot(error);
                }
                off = off.max((error * h).length_squared());
            }
            off.gt(most).bits() & node.write != 0
        })
    }

    /// Moves the bodies on by a substep: each turns freely, with its angular momentum. What all other bodies do in a substep,
    /// which is to turn by their angular velocities at its start, loses the momentum of what spins fast.
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees.
    pub(super) unsafe fn advance(&mut self, motion: &Motion<'_, '_>) {
        // SAFETY: by the contract.
        unsafe {
            self.load(motion);
            self.fetch_anchors(motion);
        }
        let parts = self.parts();
        if parts > 1.0 {
            self.whirl(parts);
        } else {
            self.drift(self.lag);
        }
        // SAFETY: by the contract.
        unsafe { self.save(motion) };
        self.place(L::zero());
    }

    /// In how many parts the next substep is followed.
    fn parts(&self) -> f32 {
        if self.contacts.0 < self.contacts.1 {
            // Contacts know only of the whole.
            return 1.0;
        }
        let fastest = |most: L, node: &Node<L>| most.max(node.velocity.angular.length_squared());
        let fastest = self.nodes.iter().fold(L::zero(), fastest);
        let fastest = (0..L::N).map(|lane| fastest.lane(lane)).fold(0.0, f32::max).sqrt();
        let parts = (fastest * self.h * (1.0 / TURN)).ceil().clamp(1.0, MOST_PARTS);
        if !self.braces || fastest * self.h < 0.5 * TURN {
            return parts;
        }
        // What whirls pulls by its own spin: better than to be braced is not to need it, if few parts are enough.
        let mut taut = 0.0_f32;
        for node in &self.nodes {
            let ratio = node.pulled / (L::splat(0.5 * SAFE) * node.bears);
            taut = (0..L::N).map(|lane| ratio.lane(lane)).fold(taut, f32::max);
        }
        let strung = taut.sqrt().ceil();
        if strung > FEW_PARTS { parts } else { parts.max(strung) }
    }

    /// One free drift over `self.h`.
    fn drift(&mut self, lag: L) {
        let (h, known) = (L::splat(self.h), self.foreseen);
        for node in &mut self.nodes {
            let Twist { linear, angular } = node.velocity;
            if !known {
                (node.turn, node.more) = node.moments.flow(node.axes_now, angular, h);
            }
            let (turn, more) = (node.turn, node.more);
            node.moved.linear += (linear - node.pull * lag) * h;
            let near = node.moved.angular + angular * h;
            node.moved.angular = log_near(turn.compose(exp(node.moved.angular)), near);
            node.velocity.angular += more;
        }
    }

    /// The same in parts, where something spins so fast that the impulses of joints would not be found: each part is solved as
    /// a substep is, of what is joined alone.
    #[cold]
    #[inline(never)]
    fn whirl(&mut self, parts: f32) {
        let (whole, lag) = (self.h, self.lag);
        // Half of what pulls comes after.
        self.nodes.iter_mut().for_each(|node| node.velocity.linear -= node.pull * lag);
        let braces = self.braces;
        if braces {
            self.brace_for(parts);
            self.weigh();
            self.factor();
        }
        let every = L::zero().eq(L::zero());
        let still = JointPass::relaxing(1.0 / whole);
        let solving = JointPass { relax: false, inverse_h: 0.0, ..still };
        (self.h, self.lag) = (whole / parts, L::zero());
        self.sweep(&still, &[], |_, _| {});
        self.tame(whole);
        for part in 1..=parts as u32 {
            self.foresee(every);
            self.calm();
            self.foreseen = self.close_ahead(&solving, every);
            self.drift(L::zero());
            self.place(L::splat(whole - self.h * part as f32));
            self.factor();
            self.settle();
            self.sweep(&still, &[], |_, _| {});
            self.tame(whole);
        }
        (self.h, self.lag) = (whole, lag);
        self.nodes.iter_mut().for_each(|node| node.velocity.linear += node.pull * lag);
        if braces {
            self.brace_for(1.0);
        }
    }

    /// What is open after a drift is closed, but where there are contacts, which know nothing of it.
    pub(super) fn settle(&mut self) {
        let share = L::select(self.share.gt(L::zero()), L::zero(), L::one());
        self.nodes.iter_mut().for_each(Node::rest);
        self.gather_up(|node, _| node.open());
        self.answer_all();
        for node in &mut self.nodes {
            node.shift(node.change.scaled(share));
        }
        self.place(L::zero());
    }

    /// Displacements after all bodies moved.
    ///
    /// # Safety
    /// No thread writes displacements of the trees.
    unsafe fn fetch(&mut self, motion: &Motion<'_, '_>) {
        // SAFETY: by the contract.
        let read = |i| unsafe { motion.delta.read(i) };
        for node in &mut self.nodes {
            let (linear, angular) = gather(read, &node.body);
            node.moved = Twist { linear, angular };
        }
        // SAFETY: by the contract.
        unsafe { self.fetch_anchors(motion) };
    }

    /// # Safety
    /// No thread writes displacements.
    unsafe fn fetch_anchors(&mut self, motion: &Motion<'_, '_>) {
        for node in self.nodes.iter_mut().filter(|node| node.parent == NONE) {
            // SAFETY: by the contract.
            let (linear, angular) = gather(|i| unsafe { motion.delta.read(i) }, &node.anchor);
            node.anchor_moved = Twist { linear, angular };
        }
    }

    /// Arms, separations and inertias after displacements, some time before what trees hang on is where it is to be [s].
    fn place(&mut self, left: L) {
        for i in 0..self.nodes.len() {
            let (parent, node) = self.with_parent(i);
            node.turn = exp(node.moved.angular);
            node.axes_now = node.turn.compose(node.moments.axes);
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
        self.weigh();
    }

    /// The same after displacements that others wrote.
    ///
    /// # Safety
    /// No thread writes displacements of the trees.
    pub(super) unsafe fn follow(&mut self, motion: &Motion<'_, '_>) {
        // SAFETY: by the contract.
        unsafe { self.fetch(motion) };
        self.place(L::zero());
    }

    /// Writes displacements. Where there is no number any more, bodies go as they would without the tree.
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees.
    pub(super) unsafe fn shift(&mut self, motion: &Motion<'_, '_>) {
        for node in &mut self.nodes {
            let delta = scatter(node.moved.linear, node.moved.angular);
            for lane in (0..L::N).filter(|lane| node.write >> lane & 1 != 0) {
                // SAFETY: by the contract; no body is twice in a batch.
                let to = unsafe { motion.delta.get(node.body[lane] as usize) };
                // Something acted on it, and it is turned already.
                (to.pad0, to.pad1) = (1.0, 1.0);
                if delta[lane].linear.is_finite() && delta[lane].angular.is_finite() {
                    (to.linear, to.angular) = (delta[lane].linear, delta[lane].angular);
                } else {
                    put(&mut node.moved.linear, lane, to.linear);
                    put(&mut node.moved.angular, lane, to.angular);
                }
            }
        }
    }

    /// Velocities.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    unsafe fn load(&mut self, motion: &Motion<'_, '_>) {
        // SAFETY: by the contract. One by one: a slice of all would include those that other threads write.
        let read = |i| unsafe { motion.velocity.read(i) };
        for node in &mut self.nodes {
            let (linear, angular) = gather(read, &node.body);
            node.velocity = Twist { linear, angular };
            node.before = node.velocity;
            if node.parent == NONE {
                let (linear, angular) = gather(read, &node.anchor);
                node.anchored = Twist { linear, angular };
            }
            node.pushed = Twist::zero();
        }
    }

    /// What joints changed is no warm start for the next substep: rows see it as if it had been there before them.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    unsafe fn save(&mut self, motion: &Motion<'_, '_>) {
        let pushed = self.contacts.0 < self.contacts.1;
        for node in &mut self.nodes {
            let mut own = node.velocity;
            own.subtract(node.before);
            own.linear -= node.pushed.linear * node.inverse_mass;
            own.angular -= node.braced_inverse.mul(node.pushed.angular);
            let all = scatter(node.velocity.linear, node.velocity.angular);
            let own = scatter(own.linear, own.angular);
            for lane in (0..L::N).filter(|lane| node.write >> lane & 1 != 0) {
                let (body, new) = (node.body[lane] as usize, all[lane]);
                let fastest = new.linear.abs().max(new.angular.abs()).max_element();
                if fastest >= RUNAWAY || !new.linear.is_finite() || !new.angular.is_finite() {
                    // No number any more, or as good as none.
                    put(&mut node.impulse, lane, glam::Vec3::ZERO);
                    put(&mut node.twist, lane, glam::Vec3::ZERO);
                    continue;
                }
                // SAFETY: by the contract; no body is twice in a batch.
                let (v, base) = unsafe { (motion.velocity.get(body), motion.base.get(body)) };
                if !pushed && v.linear == base.linear && v.angular == base.angular {
                    // To the last bit: that is how it is told that nothing else acts.
                    (base.linear, base.angular) = (new.linear, new.angular);
                } else {
                    base.linear += own[lane].linear;
                    base.angular += own[lane].angular;
                }
                (v.linear, v.angular) = (new.linear, new.angular);
            }
        }
    }
}

/// The most rounds of Newton's method in which a substep looks for the impulses of joints, and what is near enough [m], [rad].
const ROUNDS: u32 = 6;
const MISS: f32 = 5e-8;
/// What turns further than this in a substep is followed in parts [rad], and in how many at most.
const TURN: f32 = 0.25;
const MOST_PARTS: f32 = 16.0;
/// By how much more or less than what a tree is braced for it may be pulled.
const MORE: f32 = 1.5;
/// By how much joints that are closed may multiply the kinetic energy in a substep.
const MOST_GAIN: f32 = 2.0;
/// How far what would be thrown about turns at most [rad].
const FAR: f32 = 0.5;
/// Into how many parts a substep is cut at most for what pulls.
const FEW_PARTS: f32 = 3.0;
/// What is faster than this [m/s] or [rad/s] goes on as if the tree had not acted.
const RUNAWAY: f32 = 1e6;

/// The square of the frequency times the substep, of a body that turns on its joints, up to which it is integrated as it is.
const SAFE: f32 = 1.0;

/// Whether it holds in all lanes.
#[inline(always)]
fn all<M: Mask>(mask: M) -> bool {
    !(!mask).any()
}

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

    /// Nothing has come from other bodies yet.
    #[inline(always)]
    pub(super) fn rest(&mut self) {
        (self.carried, self.change, self.pushed) = (Twist::zero(), Twist::zero(), Twist::zero());
    }

    /// How far the joint is open.
    #[inline(always)]
    pub(super) fn open(&self) -> Twist<L> {
        Twist { linear: self.apart_now, angular: self.error_now }
    }

    /// Moves the body a little.
    #[inline(always)]
    pub(super) fn shift(&mut self, by: Twist<L>) {
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
        let b = &mut self.strain;
        b.xx += k - over * arm.x * arm.x;
        b.yy += k - over * arm.y * arm.y;
        b.zz += k - over * arm.z * arm.z;
        b.xy += -(over * arm.x * arm.y);
        b.xz += -(over * arm.x * arm.z);
        b.yz += -(over * arm.y * arm.z);
    }
}
