//! Trees that conserve energy: RATTLE with torque-free rotation (Andersen, 1983).
//!
//! A substep of such a tree: before any row, the impulses with which all joints are closed at the end of the
//! substep are found by Newton's method with the exact solution; after rows and contacts it is solved once
//! more, if any of them acted; then the bodies move, each rotating freely with its angular momentum; and
//! velocities are projected onto the joints where they are then. Nothing is warm-started: impulses at arms
//! that have turned since would add energy.
//!
//! This is for trees that touch nothing and in which no light link bears a heavy load: that is a string whose
//! frequency is too high for the substep ([`choose`](TreeBatch::choose)). Other trees are linearised at the
//! start of the substep, warm-started and stiffened.

use super::close::squares;
use super::contacts::{Request, TreeBody};
use super::damp::sum_impulses;
use super::free_rotation::{exp, log, log_near, moved_by};
use super::node::{Node, TreeWidth, Turns, gather_up, on_nodes, with_parent};
use super::slots::TreeContacts;
use super::spatial::Twist;
use super::transfer::{read_displacements, read_velocities, save};
use super::tree::TreeBatch;
use crate::config::tuning::{
    JOINT_OPEN, RATTLE_HEAVY, RATTLE_LADEN, RATTLE_PARTS, RATTLE_SWING, RATTLE_TAUT, RATTLE_TURN,
};
use crate::constraint::contact::row::Motion;
use crate::constraint::joint::ends::JointPass;
use crate::joint::Lock;
use crate::lanes::{Mask, Vec3, gather};

/// Maximum number of Newton rounds in a substep, and the error at which they end [length units], [rad].
const ROUNDS: u32 = 6;
// Rounding: of the solution of a substep.
const MISS: f32 = 5e-8;
// Rounding: beyond it the method did not converge.
/// With a larger error no solution was found, and the substep is solved in parts.
const LOST: f32 = 1e-5;
// Rounding: of closed joints.
/// Share of [`JOINT_OPEN`] that is no more than rounding.
const MISSED: f32 = 0.004;

/// How the tree of a body moved in a substep, apart from the impulses of its joints.
#[cfg(feature = "observe")]
pub(crate) struct Aside {
    /// By how much gravity and forces brought up the body's velocity [m/s].
    pub(crate) caught: glam::Vec3,
    /// Whether bodies count as heavier than they are, or the substep was solved again.
    pub(crate) unconserved: bool,
    /// Whether joints acted once more while bodies moved, in parts of the substep.
    pub(crate) whirled: bool,
}

impl<L: TreeWidth> TreeBatch<L> {
    /// Decides which trees conserve energy in this step: those that touch nothing, and in which no body bears
    /// a load that is too heavy for it or that swings it too fast for the substep. The load is the impulse of
    /// the last substep, or the weight of the bodies that hang there if that is more.
    pub(crate) fn choose(&mut self) {
        let h = L::splat(self.h);
        for node in &mut self.nodes {
            node.pulled = L::zero();
        }
        let mut others = !self.is_alone() | L::Mask::from_bits(self.weighted);
        let (mut laden, mut heavy) = (L::zero().gt(L::zero()), L::zero().gt(L::zero()));
        for i in (0..self.real).rev() {
            let (parent, node) = self.with_parent(i);
            if !node.jointed {
                continue;
            }
            let load = node.pulled + L::one() / node.inverse_mass;
            let weight = load * node.drift.pull.length();
            let most = node.impulse.length().max(weight * (L::splat(RATTLE_SWING) * h));
            let [own, above] = node.arm_now.map(|arm| arm.length_squared());
            let mut check = |arm: L, body: &Node<L>, gives: L| {
                let Vec3 { x, y, z } = body.drift.moments.inertia;
                // To turn about its joint, the body or the one it hangs on has to move.
                let bears = L::splat(0.5) * (x + y + z) + arm / (body.inverse_mass + gives);
                // A substep in parts has a shorter time step.
                let parts = body.velocity.angular.length() * h * L::splat(1.0 / RATTLE_TURN);
                let parts = parts.max(L::one()).min(L::splat(RATTLE_PARTS));
                let times = load * body.inverse_mass;
                laden = laden | times.gt(L::splat(RATTLE_LADEN));
                heavy = heavy | times.gt(L::splat(RATTLE_HEAVY));
                others = others | (most * arm.sqrt() * h).gt(bears * (L::splat(RATTLE_TAUT) * parts * parts));
            };
            let mobility = |arm: L, body: &Node<L>| {
                let Vec3 { x, y, z } = body.drift.moments.inverse;
                body.inverse_mass + arm * x.max(y).max(z)
            };
            match &parent {
                // Welded bodies turn as one under any load between them.
                _ if node.turns == Turns::Not => {}
                Some(parent) => {
                    check(own, node, mobility(above, parent));
                    check(above, parent, mobility(own, node));
                }
                None => check(own, node, L::zero()),
            }
            if let Some(parent) = parent {
                parent.pulled += load;
            }
        }
        let write = self.nodes.first().map_or(0, |root| root.write);
        self.exact = write & !(others | heavy).bits();
        let watched = heavy | (laden & self.is_alone());
        (self.laden, self.watched, self.damped) = (laden.bits(), watched.bits() & write & !self.exact, 0);
        self.share = L::select(self.exact(), L::zero(), self.share);
        (self.known, self.lost, self.calm, self.lag) = (0, 0, 0, L::zero());
    }

    /// Velocities that are accelerated before bodies move lag half a substep behind. A tree that changes from
    /// one method to the other must account for that: a lever that passed near an obstacle gained 0.15 % each
    /// time.
    pub(crate) fn look_back(&mut self, locks: &[Lock]) {
        self.late = L::zero();
        let Some(root) = self.nodes.first() else { return };
        for lane in (0..L::N).filter(|lane| root.write >> lane & 1 != 0) {
            let was = locks[root.owner[lane] as usize].lag;
            let late = match self.exact >> lane & 1 {
                0 if was == 0.0 => -0.5 * self.h,
                1 => was.max(0.0),
                _ => 0.0,
            };
            self.late.set_lane(lane, late);
        }
    }

    /// Calls `f` with the lock of each body and the time by which velocities lag [s].
    pub(crate) fn each_lag(&self, f: &mut impl FnMut(u32, f32)) {
        for node in self.of_bodies() {
            for lane in (0..L::N).filter(|lane| node.write >> lane & 1 != 0) {
                f(node.owner[lane], if self.exact >> lane & 1 != 0 { 0.0 } else { 0.5 * self.h });
            }
        }
    }

    /// See [`look_back`](TreeBatch::look_back).
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    unsafe fn catch_up(&mut self, motion: &Motion<'_, '_>) {
        for node in self.of_bodies() {
            let more = node.drift.pull * self.late;
            for lane in (0..L::N).filter(|lane| node.write >> lane & 1 != 0) {
                let body = node.body[lane] as usize;
                // SAFETY: by the contract; no body is twice in a batch.
                let (v, base) = unsafe { (motion.velocity.get(body), motion.base.get(body)) };
                v.linear += more.lane(lane);
                base.linear += more.lane(lane);
            }
        }
        (self.late, self.caught) = (L::zero(), self.late);
    }

    /// Calls `f` with each body and with how its tree moved in the last substep.
    #[cfg(feature = "observe")]
    pub(crate) fn each_aside(&self, f: &mut dyn FnMut(u32, Aside)) {
        for node in self.of_bodies() {
            let more = node.drift.pull * self.caught;
            for lane in (0..L::N).filter(|lane| node.write >> lane & 1 != 0) {
                let is = |bits: u32| bits >> lane & 1 != 0;
                let aside = Aside {
                    caught: more.lane(lane),
                    unconserved: is(self.weighted | self.damped),
                    whirled: is(self.whirled),
                };
                f(node.body[lane], aside);
            }
        }
    }

    /// Finds the impulses of joints that close them at the end of the substep, given external forces and the
    /// impulses that rows start with.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    pub(crate) unsafe fn predict(&mut self, motion: &Motion<'_, '_>, pass: &JointPass) {
        (self.caught, self.whirled) = (L::zero(), 0);
        if self.late.abs().gt(L::zero()).any() {
            // SAFETY: by the contract.
            unsafe { self.catch_up(motion) };
        }
        if self.exact == 0 {
            return;
        }
        // SAFETY: by the contract.
        let free = unsafe {
            read_velocities(&mut self.nodes, motion);
            L::Mask::from_bits(is_free(&mut self.nodes, motion))
        };
        let (exact, zero) = (self.exact(), Vec3::zero());
        let alone = exact & free;
        // A load that a motor holds would rise by g h²/2 in each substep if half of the acceleration came
        // after it.
        let half = if self.extra.motors.is_empty() { 0.5 } else { 0.0 };
        self.lag = L::select(alone, L::splat(half * self.h), L::zero());
        self.calm = if self.extra.motors.is_empty() { alone.bits() & self.laden } else { 0 };
        for node in &mut self.nodes {
            let Twist { linear, angular } = node.drift.before;
            node.start.free = Twist { linear: linear - node.drift.pull * L::splat(self.h), angular };
            node.start.moved = node.moved;
        }
        // SAFETY: by the contract.
        unsafe { self.guess(motion, alone) };
        self.predict_turns(exact);
        for node in &mut self.nodes {
            node.impulse = Vec3::select(exact, zero, node.impulse);
            node.twist = Vec3::select(exact, zero, node.twist);
            node.velocity = node.drift.before;
        }
        for motor in &mut self.extra.motors {
            motor.impulse = L::select(exact, L::zero(), motor.impulse);
        }
        let (known, lost) = self.close_ahead(pass, exact, alone);
        (self.known, self.lost, self.astray) = (known, lost.bits(), 0);
        // SAFETY: by the contract.
        unsafe { save(&mut self.nodes[..self.real], motion, self.exact, self.exact) };
    }

    /// First guess of the angular velocities at the start of the substep. Where nothing else acts, those that
    /// half of the joints' impulses of the last substep give: the other half acts at the end, so this is
    /// close to the solution. Otherwise those before rows acted: rows whose requests can't be met would turn
    /// bodies arbitrarily within the substep.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    unsafe fn guess(&mut self, motion: &Motion<'_, '_>, alone: L::Mask) {
        sum_impulses(&mut self.nodes, self.real);
        self.add_motors(|node| &mut node.pushed.angular);
        // SAFETY: by the contract.
        unsafe { guess(&mut self.nodes, motion, alone.bits()) };
        self.repeat_bodies();
    }

    /// Finds the impulses that close the joints of some lanes at the end of the substep; where nothing else
    /// acts, to the last digit. Returns the lanes whose last prediction holds, and those in which no solution
    /// was found: their velocities fit the joints where they are.
    fn close_ahead(&mut self, pass: &JointPass, lanes: L::Mask, alone: L::Mask) -> (u32, L::Mask) {
        self.nodes.iter_mut().for_each(|node| node.drift.from = node.velocity);
        self.sweep(pass, lanes, &[], |_, _| {});
        let mut open = alone;
        for _ in 0..ROUNDS {
            self.predict_turns(open);
            open = open & self.misses(MISS);
            if !open.any() {
                return (alone.bits(), open);
            }
            self.sweep(pass, open, &[], |_, _| {});
        }
        let known = alone & !open;
        self.predict_turns(open);
        let lost = open & self.misses(LOST);
        if lost.any() {
            self.give_up(lost);
        }
        (known.bits(), lost)
    }

    /// Takes back the attempt in some lanes. Where a linkage folds flat, or light links between bodies that
    /// part, there may be no solution: each round asks for more, and its result is no motion. Velocities that
    /// fit the joints where they are add no energy.
    #[cold]
    fn give_up(&mut self, lanes: L::Mask) {
        // In parts of a substep motors are idle, and joints keep the impulses of the parts before.
        let whole = !self.extra.idle;
        for node in &mut self.nodes {
            let borne = if whole { Twist::zero() } else { node.drift.borne };
            node.velocity = Twist::select(lanes, node.drift.from, node.velocity);
            node.impulse = Vec3::select(lanes, borne.linear, node.impulse);
            node.twist = Vec3::select(lanes, borne.angular, node.twist);
        }
        for motor in self.extra.motors.iter_mut().filter(|_| whole) {
            motor.impulse = L::select(lanes, L::zero(), motor.impulse);
        }
        self.sweep(&JointPass::relaxing(1.0 / self.h), lanes, &[], |_, _| {});
    }

    /// Predicts where the velocities take the bodies in the substep, with free rotation.
    fn predict_turns(&mut self, lanes: L::Mask) {
        predict_turns(&mut self.nodes, lanes.bits(), self.h, &self.lag.eight());
    }

    /// Lanes in which a joint would be open by more than this at the end of the substep [m] or [rad].
    fn misses(&mut self, by: f32) -> L::Mask {
        L::Mask::from_bits(misses(&mut self.nodes, self.h, squares(self.unit, by)))
    }

    /// Moves the bodies on by a substep and closes joints that are open then. In trees that are warm-started
    /// the bodies have moved already.
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees.
    pub(crate) unsafe fn go(
        &mut self,
        motion: &Motion<'_, '_>,
        slop: f32,
        contacts: &[TreeContacts],
        touch: impl FnMut(&TreeContacts, Request<'_>, &mut TreeBody<'_, L>),
    ) {
        if self.watched == 0 {
            // SAFETY: by the contract.
            return unsafe { self.go_on(motion, slop, contacts, touch) };
        }
        // SAFETY: by the contract.
        unsafe {
            let strained = self.strained(motion);
            self.go_on(motion, slop, contacts, touch);
            let open = self.open_by(JOINT_OPEN) & L::Mask::from_bits(self.watched);
            if (strained | open).any() {
                self.damp(motion, strained | open);
            }
        }
    }

    /// The same without a check for whipping.
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees.
    unsafe fn go_on(
        &mut self,
        motion: &Motion<'_, '_>,
        slop: f32,
        contacts: &[TreeContacts],
        touch: impl FnMut(&TreeContacts, Request<'_>, &mut TreeBody<'_, L>),
    ) {
        if self.exact == 0 {
            // SAFETY: by the contract.
            return unsafe { self.close(motion, slop, contacts, touch) };
        }
        // SAFETY: by the contract.
        unsafe { self.advance(motion) };
        if self.is_open(JOINT_OPEN) {
            // SAFETY: by the contract.
            unsafe {
                self.shift(motion, self.exact);
                self.close(motion, slop, contacts, touch);
            }
        }
        self.factor();
        if self.is_open(MISSED * JOINT_OPEN) {
            // Velocities need not correct the remaining error.
            self.settle();
        }
        // SAFETY: by the contract.
        unsafe { self.shift(motion, self.exact) };
    }

    /// Moves the bodies on by a substep, each with torque-free rotation. All other bodies turn by their
    /// angular velocities at the start of the substep, which loses angular momentum at high spin.
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees.
    unsafe fn advance(&mut self, motion: &Motion<'_, '_>) {
        // SAFETY: by the contract.
        unsafe {
            read_velocities(&mut self.nodes, motion);
            read_displacements(&mut self.nodes, motion, self.exact);
        }
        let parts = self.parts();
        if parts > 1.0 {
            self.whirl(parts);
            self.whirled = self.exact;
        } else {
            self.drift(self.lag);
        }
        // SAFETY: by the contract.
        unsafe { save(&mut self.nodes[..self.real], motion, self.exact, self.exact) };
        self.place(0.0);
    }

    /// Number of parts in which the next substep is followed.
    fn parts(&self) -> f32 {
        let fastest = |most: L, node: &Node<L>| most.max(node.velocity.angular.length_squared());
        let fastest = self.nodes.iter().fold(L::zero(), fastest);
        let fastest = L::select(self.exact(), fastest, L::zero());
        if self.lost != 0 {
            return RATTLE_PARTS;
        }
        let fastest = (0..L::N).map(|lane| fastest.lane(lane)).fold(0.0, f32::max).sqrt();
        (fastest * self.h * (1.0 / RATTLE_TURN)).ceil().clamp(1.0, RATTLE_PARTS)
    }

    /// Free motion over `self.h`.
    fn drift(&mut self, lag: L) {
        let known = self.known == self.exact;
        drift(&mut self.nodes, self.exact, known, self.h, &lag.eight());
    }

    /// The same in parts, where a body spins so fast that the impulses of joints would not be found. Each
    /// part is solved like a substep, for the joints alone.
    #[cold]
    #[inline(never)]
    fn whirl(&mut self, parts: f32) {
        let (whole, lag, exact) = (self.h, self.lag, self.exact());
        // Half of the acceleration is applied afterwards.
        self.nodes.iter_mut().for_each(|node| node.velocity.linear -= node.drift.pull * lag);
        let still = JointPass::relaxing(1.0 / whole);
        let solving = JointPass { relax: false, ..still };
        (self.h, self.lag) = (whole / parts, L::zero());
        self.extra.idle = true;
        self.sweep(&still, exact, &[], |_, _| {});
        for part in 1..=parts as u32 {
            for node in &mut self.nodes {
                node.drift.borne = Twist { linear: node.impulse, angular: node.twist };
            }
            self.predict_turns(exact);
            let (known, lost) = self.close_ahead(&solving, exact, exact);
            self.known = known;
            self.astray |= lost.bits();
            self.drift(L::zero());
            self.place(whole - self.h * part as f32);
            self.factor();
            self.settle();
            self.sweep(&still, exact, &[], |_, _| {});
        }
        (self.h, self.lag) = (whole, lag);
        self.extra.idle = false;
        self.nodes.iter_mut().for_each(|node| node.velocity.linear += node.drift.pull * lag);
    }

    /// Closes joints that are open after free motion.
    fn settle(&mut self) {
        let exact = self.exact();
        self.request_closing();
        gather_up(&mut self.nodes[..self.real]);
        self.extra.shifts = true;
        self.answer_all();
        self.extra.shifts = false;
        for node in &mut self.nodes {
            node.shift(Twist::select(exact, node.change, Twist::zero()));
        }
        self.place(0.0);
    }
}

on_nodes! {
    /// See [`TreeBatch::guess`].
    ///
    /// # Safety
    /// As there.
    unsafe fn guess<'a, L>(nodes, motion: &'a Motion<'a, 'a>, alone: u32) {
        let alone = L::Mask::from_bits(alone);
        for node in nodes {
            // SAFETY: by the contract.
            let (linear, angular) = gather(|i| unsafe { motion.base.read(i) }, &node.body);
            let mut own = node.velocity;
            own.angular += node.stiffened_inverse.mul(node.pushed.angular * L::splat(0.5));
            node.velocity = Twist::select(alone, own, Twist { linear, angular });
        }
    }
}

on_nodes! {
    /// Lanes in which only joints and external forces act on the trees: these fall as free bodies do, along
    /// parabolas.
    ///
    /// # Safety
    /// The bodies of the trees are in no other batch of the stage.
    pub(super) unsafe fn is_free<'a, L>(nodes, motion: &'a Motion<'a, 'a>) -> u32 {
        // SAFETY: by the contract.
        let read = |i| unsafe { motion.base.read(i) };
        let mut same = L::zero().eq(L::zero());
        for node in nodes {
            let (v, w): (Vec3<L>, Vec3<L>) = gather(read, &node.body);
            let own = &node.velocity;
            same = same & v.x.eq(own.linear.x) & v.y.eq(own.linear.y) & v.z.eq(own.linear.z);
            same = same & w.x.eq(own.angular.x) & w.y.eq(own.angular.y) & w.z.eq(own.angular.z);
        }
        same.bits()
    }
}

on_nodes! {
    /// See [`TreeBatch::predict_turns`].
    fn predict_turns<'a, L>(nodes, lanes: u32, h: f32, lag: &'a [f32; 8]) {
        let (h, over, lag) = (L::splat(h), L::splat(1.0 / h), L::load(lag));
        let lanes = L::Mask::from_bits(lanes);
        for i in 0..nodes.len() {
            let (parent, node) = with_parent(nodes, i);
            let own = node.velocity;
            (node.turn, node.drift.more) = node.drift.moments.flow(node.drift.axes_now, own.angular, h);
            if !node.jointed {
                continue;
            }
            let (above, turn, pull) = match parent {
                Some(parent) => (parent.velocity, parent.turn, parent.drift.pull),
                None => (node.anchored, exp(node.anchored.angular * h), Vec3::zero()),
            };
            let [arm, other] = node.arm_now;
            let (at, there) = (moved_by(node.turn, arm), moved_by(turn, other));
            let linear = (at - there) * over
                - (own.angular.cross(arm) - above.angular.cross(other))
                - (node.drift.pull - pull) * lag;
            node.bend.linear = Vec3::select(lanes, linear, node.bend.linear);
            let faster = own.angular - above.angular;
            let angular = match node.turns {
                Turns::Freely => continue,
                Turns::AboutAxis => {
                    let [a, b] = node.axis_now;
                    let (at, there) = (moved_by(node.turn, a), moved_by(turn, b));
                    // (b + there) x (a + at) - b x a
                    (b.cross(at) + there.cross(a + at)) * over - faster
                }
                Turns::Not => {
                    let error = log(node.turn.compose(exp(node.error_now)).compose(turn.conjugate()));
                    (error - node.error_now) * over - faster
                }
            };
            node.bend.angular = Vec3::select(lanes, angular, node.bend.angular);
        }
    }
}

on_nodes! {
    /// See [`TreeBatch::misses`]; with the squares of the errors that may remain, of lengths and of angles.
    fn misses<'a, L>(nodes, h: f32, most: [f32; 2]) -> u32 {
        let (h, mut hits) = (L::splat(h), L::zero().eq(L::zero()));
        for i in 0..nodes.len() {
            let (parent, node) = with_parent(nodes, i);
            if !node.jointed {
                continue;
            }
            let above = match parent {
                Some(parent) => parent.velocity,
                None => node.anchored,
            };
            let [arm, other] = node.arm_now;
            let apart = node.velocity.at(arm) - above.at(other) + node.bend.linear;
            hits = hits & (apart * h).length_squared().le(L::splat(most[0]));
            if node.turns != Turns::Freely {
                let mut error = node.velocity.angular - above.angular + node.bend.angular;
                if node.turns == Turns::AboutAxis {
                    error -= node.axis_now[0] * node.axis_now[0].dot(error);
                }
                hits = hits & (error * h).length_squared().le(L::splat(most[1]));
            }
        }
        !hits.bits()
    }
}

on_nodes! {
    /// See [`TreeBatch::drift`].
    fn drift<'a, L>(nodes, exact: u32, known: bool, h: f32, lag: &'a [f32; 8]) {
        let (h, lag, exact, zero) = (L::splat(h), L::load(lag), L::Mask::from_bits(exact), Vec3::zero());
        for node in nodes {
            let Twist { linear, angular } = node.velocity;
            if !known {
                (node.turn, node.drift.more) = node.drift.moments.flow(node.drift.axes_now, angular, h);
            }
            let (turn, more) = (node.turn, node.drift.more);
            node.moved.linear += Vec3::select(exact, (linear - node.drift.pull * lag) * h, zero);
            let near = node.moved.angular + angular * h;
            let turned = log_near(turn.compose(exp(node.moved.angular)), near);
            node.moved.angular = Vec3::select(exact, turned, node.moved.angular);
            node.velocity.angular += Vec3::select(exact, more, zero);
        }
    }
}
