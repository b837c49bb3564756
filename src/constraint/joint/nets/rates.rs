//! Input of the check of nets from each batch of joints: the bodies it joins, how fast its directions turn,
//! the energy of its springs.

use crate::config::tuning::{FOLLOWED_IN_PARTS, FOLLOWED_TURN, LOCK_SPEED_LEFT};
use crate::constraint::articulation::node::{Node, TreeWidth, Turns, on_nodes, with_parent};
use crate::constraint::articulation::tree::TreeBatch;
use crate::constraint::contact::row::Motion;
use crate::constraint::joint::batch::{Link, Watched};
use crate::constraint::joint::ends::{Ends, NONE};
use crate::constraint::joint::kinds::{JointStage, JointType};
use crate::constraint::joint::line::LineBatch;
use crate::constraint::joint::lock::{PointBatch, TurnBatch};
use crate::constraint::joint::measure::Measure;
use crate::constraint::joint::row::RowBatch;
use crate::constraint::joint::run::JointViews;
use crate::lanes::{GatherLanes, Lanes, Mask, Record, gather, ones};
use glam::Vec3;

/// Calls `f` with each batch.
pub(crate) fn visit(views: &JointViews<'_>, stages: &[JointStage], f: &mut dyn FnMut(&mut dyn Watched)) {
    for stage in stages {
        for i in stage.start as usize..stage.end as usize {
            // SAFETY: between stages this thread is alone.
            unsafe { views.with(stage, i, f) };
        }
    }
}

impl<L: Lanes> Ends<L> {
    pub(in crate::constraint::joint) fn each(&self, f: &mut dyn FnMut(usize, Link)) {
        for lane in (0..L::N).filter(|&lane| self.owner[lane] != NONE) {
            let side = |i: usize| self.body[i][lane];
            let moves = self.write.map(|write| write >> lane & 1 != 0);
            f(lane, Link { bodies: [side(0), side(1)], moves });
        }
    }

    /// A dynamic body of a lane.
    pub(in crate::constraint::joint) fn one(&self, lane: usize) -> u32 {
        self.body[usize::from(self.write[0] >> lane & 1 == 0)][lane]
    }

    /// Lanes of some bodies.
    fn lanes_of(&self, of: &dyn Fn(u32) -> bool) -> L::Mask {
        let lanes = (0..L::N).filter(|&lane| self.owner[lane] != NONE && of(self.one(lane)));
        L::Mask::from_bits(lanes.map(|lane| 1 << lane).sum())
    }

    /// Calls `f` with a body of each lane in which more of a speed is left than tolerated.
    fn unsolved(
        &self,
        motion: &Motion<'_, '_>,
        left: &dyn Fn(usize, [Record; 2]) -> (Vec3, f32),
        f: &mut dyn FnMut(u32),
    ) {
        self.each(&mut |lane, link| {
            // SAFETY: between stages this thread is alone.
            let v = link.bodies.map(|body| unsafe { motion.velocity.read(body as usize) });
            let (left, of) = left(lane, v);
            if exceeds(left.length(), LOCK_SPEED_LEFT * of) {
                f(self.one(lane));
            }
        });
    }

    /// Calls `f` with a body of each lane that turns too far; `turn`: angular speed by the velocities of its
    /// bodies [rad/s].
    pub(in crate::constraint::joint) fn too_fast(
        &self,
        motion: &Motion<'_, '_>,
        h: f32,
        turn: &dyn Fn(usize, [Record; 2]) -> f32,
        f: &mut dyn FnMut(u32),
    ) {
        self.each(&mut |lane, link| {
            // SAFETY: between stages this thread is alone.
            let v = link.bodies.map(|body| unsafe { motion.velocity.read(body as usize) });
            // NaN counts as too far.
            if exceeds(turn(lane, v) * h, FOLLOWED_TURN) {
                f(self.one(lane));
            }
        });
    }
}

fn clear<L: Lanes, const N: usize>(lanes: L::Mask, all: [&mut crate::lanes::Vec3<L>; N]) {
    all.into_iter().for_each(|v| *v = crate::lanes::Vec3::select(lanes, crate::lanes::Vec3::zero(), *v));
}

/// The relative velocity of two points, and the sum of the speeds it consists of.
fn slip(v: [Record; 2], arms: [Vec3; 2]) -> (Vec3, f32) {
    let round = [0, 1].map(|i| v[i].angular.cross(arms[i]));
    let apart = v[1].linear - v[0].linear;
    (apart + round[1] - round[0], apart.length() + round[0].length() + round[1].length())
}

/// The same for angular velocities.
fn turn_apart(v: [Record; 2]) -> (Vec3, f32) {
    (v[1].angular - v[0].angular, v[0].angular.length() + v[1].angular.length())
}

/// Angular speed of the arms, relative to the longer one [rad/s].
fn turn_of_arms(v: [Record; 2], arms: [Vec3; 2]) -> f32 {
    let longest = arms[0].length().max(arms[1].length());
    let speed = v[0].angular.cross(arms[0]).length().max(v[1].angular.cross(arms[1]).length());
    if longest > 0.0 { speed / longest } else { 0.0 }
}

impl<L: GatherLanes> Watched for PointBatch<L> {
    fn links(&self, f: &mut dyn FnMut(Link)) {
        self.ends.each(&mut |_, link| f(link));
    }
    fn unsolved(&self, motion: &Motion<'_, '_>, f: &mut dyn FnMut(u32)) {
        self.ends.unsolved(motion, &|lane, v| slip(v, self.arm_now.map(|arm| arm.lane(lane))), f);
    }
    fn forget(&mut self, of: &dyn Fn(u32) -> bool) {
        let lanes = self.ends.lanes_of(of);
        clear(lanes, [&mut self.impulse, &mut self.lasting]);
        clear(lanes, self.moment.each_mut());
    }
    fn turning(&mut self, motion: &Motion<'_, '_>, h: f32, f: &mut dyn FnMut(u32)) {
        let turn = |lane: usize, v| turn_of_arms(v, self.arm_now.map(|arm| arm.lane(lane)));
        self.ends.too_fast(motion, h, &turn, f);
    }
}

impl<L: GatherLanes> Watched for LineBatch<L> {
    fn links(&self, f: &mut dyn FnMut(Link)) {
        self.point.links(f);
    }
    fn unsolved(&self, motion: &Motion<'_, '_>, f: &mut dyn FnMut(u32)) {
        let left = |lane: usize, v| {
            let (slip, of) = slip(v, self.point.arm_now.map(|arm| arm.lane(lane)));
            let axis = self.axis_now.lane(lane).normalize_or_zero();
            (slip - axis * axis.dot(slip), of)
        };
        self.point.ends.unsolved(motion, &left, f);
    }
    fn forget(&mut self, of: &dyn Fn(u32) -> bool) {
        self.point.forget(of);
    }
    fn turning(&mut self, motion: &Motion<'_, '_>, h: f32, f: &mut dyn FnMut(u32)) {
        let turn = |lane: usize, v: [Record; 2]| {
            let arms = turn_of_arms(v, self.point.arm_now.map(|arm| arm.lane(lane)));
            arms.max(v[0].angular.cross(self.axis_now.lane(lane)).length())
        };
        self.point.ends.too_fast(motion, h, &turn, f);
    }
}

impl<L: GatherLanes, const HINGE: bool> Watched for TurnBatch<L, HINGE> {
    fn links(&self, f: &mut dyn FnMut(Link)) {
        self.ends.each(&mut |_, link| f(link));
    }
    fn unsolved(&self, motion: &Motion<'_, '_>, f: &mut dyn FnMut(u32)) {
        let left = |lane: usize, v| {
            let (turn, of) = turn_apart(v);
            let axis = self.axis_now.lane(lane).normalize_or_zero();
            (if HINGE { turn - axis * axis.dot(turn) } else { turn }, of)
        };
        self.ends.unsolved(motion, &left, f);
    }
    fn forget(&mut self, of: &dyn Fn(u32) -> bool) {
        let lanes = self.ends.lanes_of(of);
        clear(lanes, [&mut self.impulse, &mut self.lasting]);
    }
    fn turning(&mut self, motion: &Motion<'_, '_>, h: f32, f: &mut dyn FnMut(u32)) {
        let turn = |lane: usize, v: [Record; 2]| {
            let axis = self.axis_now.lane(lane);
            // Welded bodies turn as one: only the difference counts.
            if HINGE {
                v[0].angular.cross(axis).length().max(v[1].angular.cross(axis).length())
            } else {
                (v[0].angular - v[1].angular).length()
            }
        };
        self.ends.too_fast(motion, h, &turn, f);
    }
}

impl<L: GatherLanes, M: Measure<L>> Watched for RowBatch<L, M> {
    fn links(&self, f: &mut dyn FnMut(Link)) {
        self.ends.each(&mut |_, link| f(link));
    }
    fn unsolved(&self, motion: &Motion<'_, '_>, f: &mut dyn FnMut(u32)) {
        let left = |lane: usize, v: [Record; 2]| {
            let (force, torque) = (self.lever.force.lane(lane), self.lever.torque.lane(lane));
            let (along, turn) = (slip(v, self.lever.arm.map(|arm| arm.lane(lane))), turn_apart(v));
            // Only a range without width is a lock.
            let locked = if self.both >> lane & 1 != 0 { 1.0 } else { 0.0 };
            let speed = force.dot(along.0) + torque.dot(turn.0);
            (Vec3::X * (locked * speed), along.1 * force.length() + turn.1 * torque.length())
        };
        self.ends.unsolved(motion, &left, f);
    }
    fn forget(&mut self, of: &dyn Fn(u32) -> bool) {
        let lanes = self.ends.lanes_of(of);
        self.impulse = self.impulse.map(|impulse| L::select(lanes, L::zero(), impulse));
        self.lasting = L::select(lanes, L::zero(), self.lasting);
        self.resume();
    }
    fn turning(&mut self, motion: &Motion<'_, '_>, h: f32, f: &mut dyn FnMut(u32)) {
        self.ends.too_fast(motion, h, &|lane, v| self.measure.turns(lane, &self.lever, v), f);
    }
    fn stored(&self, h: f32, f: &mut dyn FnMut(u32, [f32; 2])) {
        for lane in (0..L::N).filter(|lane| (self.drives | self.springs) >> lane & 1 != 0) {
            let [now, min, max] = [self.now, self.min, self.max].map(|x| x.lane(lane));
            let drive = self.drives >> lane & 1 != 0;
            let over = if drive { (now - min).abs() } else { (now - max).max(min - now).max(0.0) };
            let (impulse, mobility) = (self.impulse[0].lane(lane), self.mobility.lane(lane));
            f(self.ends.one(lane), self.spring.lane(lane).energy(over, impulse, h, mobility));
        }
    }
}

impl<L: TreeWidth> Watched for TreeBatch<L> {
    fn links(&self, f: &mut dyn FnMut(Link)) {
        for (i, node) in self.nodes.iter().enumerate().filter(|(_, node)| node.jointed) {
            let own = &self.nodes[self.body_of(i)];
            let above = self.nodes.get(node.parent as usize);
            for lane in (0..L::N).filter(|lane| own.write >> lane & 1 != 0) {
                let other = above.map_or(node.anchor[lane], |above| above.body[lane]);
                f(Link { bodies: [own.body[lane], other], moves: [true, above.is_some()] });
            }
        }
    }
    fn forget(&mut self, of: &dyn Fn(u32) -> bool) {
        let Some(root) = self.nodes.first() else { return };
        let lanes = (0..L::N).filter(|&lane| root.write >> lane & 1 != 0 && of(root.body[lane]));
        let lanes = L::Mask::from_bits(lanes.map(|lane| 1 << lane).sum());
        for node in &mut self.nodes {
            clear(lanes, [&mut node.impulse, &mut node.twist, &mut node.gained]);
        }
        for motor in &mut self.extra.motors {
            motor.impulse = L::select(lanes, L::zero(), motor.impulse);
        }
    }
    fn turning(&mut self, motion: &Motion<'_, '_>, h: f32, f: &mut dyn FnMut(u32)) {
        let in_parts = if self.is_cut() { FOLLOWED_TURN } else { FOLLOWED_IN_PARTS };
        let most = [FOLLOWED_TURN, in_parts].map(|turn| turn / h);
        // SAFETY: between stages this thread is alone.
        let [warm, exact] = unsafe { turning(&mut self.nodes, motion, most) };
        // Watched trees lose energy in a way of their own (see
        // [`damp`](crate::constraint::articulation::damp)).
        self.each_root((exact & self.exact | warm & !self.exact) & !self.watched, f);
    }
    fn lost(&mut self, motion: &Motion<'_, '_>, h: f32, f: &mut dyn FnMut(u32)) {
        if self.astray != 0 {
            // SAFETY: between stages this thread is alone.
            let [lost, _] = unsafe { turning(&mut self.nodes, motion, [FOLLOWED_TURN / h; 2]) };
            self.each_root(lost & self.astray, f);
        }
    }
    fn stored(&self, h: f32, f: &mut dyn FnMut(u32, [f32; 2])) {
        for motor in &self.extra.motors {
            let (own, node) =
                (&self.nodes[self.body_of(motor.node as usize)], &self.nodes[motor.node as usize]);
            let above = self.nodes.get(node.parent as usize);
            let axis = node.axis_now[0];
            let turned = above.map_or(node.anchor_moved, |above| above.moved).angular;
            let off = motor.off + (node.axis[0] + axis).dot(node.moved.angular - turned) * L::splat(0.5);
            let gives = |of: &Node<L>| axis.dot(of.stiffened_inverse.mul(axis));
            let mobility = gives(own) + above.map_or(L::zero(), gives);
            for lane in (0..L::N).filter(|lane| own.write >> lane & 1 != 0) {
                let [off, impulse, mobility] = [off, motor.impulse, mobility].map(|x| x.lane(lane));
                f(own.body[lane], motor.spring.lane(lane).energy(off.abs(), impulse, h, mobility));
            }
        }
    }
}

impl<L: TreeWidth> TreeBatch<L> {
    /// Calls `f` with a body of each tree in some lanes.
    fn each_root(&self, lanes: u32, f: &mut dyn FnMut(u32)) {
        if let Some(root) = self.nodes.first() {
            ones(root.write & lanes).for_each(|lane| f(root.body[lane]));
        }
    }
}

on_nodes! {
    /// Lanes in which the arms or the axis of a joint turn faster than each of two speeds [rad/s], or at an
    /// unknown rate. Where arms move by the rotation of their bodies, the longer one counts.
    ///
    /// # Safety
    /// No thread writes velocities.
    unsafe fn turning<'a, L>(nodes, motion: &'a Motion<'a, 'a>, most: [f32; 2]) -> [u32; 2] {
        // SAFETY: by the contract.
        let read = |i| unsafe { motion.velocity.read(i) };
        let most = [L::splat(most[0]), L::splat(most[1])];
        let mut within = [L::zero().eq(L::zero()); 2];
        for i in 0..nodes.len() {
            let (parent, node) = with_parent(nodes, i);
            let own = gather(read, &node.body).1;
            node.change.angular = own;
            if !node.jointed {
                continue;
            }
            let above = match parent {
                Some(parent) => parent.change.angular,
                None => gather(read, &node.anchor).1,
            };
            let [arm, other] = node.arm_now;
            let longest = arm.length().max(other.length());
            let some = longest.gt(L::zero());
            let speed = own.cross(arm).length().max(above.cross(other).length());
            let mut turn = L::select(some, speed / L::select(some, longest, L::one()), L::zero());
            if node.turns == Turns::AboutAxis {
                turn = turn.max(own.cross(node.axis_now[0]).length());
            }
            within = [within[0] & turn.le(most[0]), within[1] & turn.le(most[1])];
        }
        [!within[0].bits(), !within[1].bits()]
    }
}

impl JointViews<'_> {
    /// # Safety
    /// No other thread works on the batch.
    unsafe fn with(&self, stage: &JointStage, i: usize, f: &mut dyn FnMut(&mut dyn Watched)) {
        // SAFETY: by the contract.
        unsafe {
            match (stage.kind, stage.single) {
                (JointType::Tree, false) => f(self.trees.get(i)),
                (JointType::Tree, true) => f(self.single_trees.get(i)),
                (JointType::Coupling, _) => f(self.couplings.get(i)),
                _ => self.tables.watch(stage, i, f),
            }
        }
    }
}

/// Whether a value exceeds a bound; NaN does.
fn exceeds(value: f32, most: f32) -> bool {
    value > most || value.is_nan()
}
