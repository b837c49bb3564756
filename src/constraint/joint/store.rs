//! Impulses of joints, handed back to the joints they belong to.

use super::arrange::JointRows;
use super::batch::{Report, RowImpulse};
use super::ends::NONE;
use crate::body::Bodies;
use crate::config::tuning::JOINT_LOAD_SHARE;
use crate::constraint::articulation::tree::TreeBatch;
use crate::joint::{Joint, Joints, Lock, LockKind, Row};
use crate::lanes::Lanes;
use glam::Vec3;

/// Writes impulses to the joints of a world.
struct Store<'a> {
    all: &'a mut [Joint],
    locks: &'a mut [Lock],
    rows: &'a mut [Row],
    /// 1 / substep [1/s].
    inverse_h: f32,
    /// Weight of this step's load in the lasting one.
    hold: f32,
}

impl Report for Store<'_> {
    fn lock(&mut self, owner: u32, impulse: Vec3) {
        // The impulses of joints that contradict each other may not be finite.
        let impulse = if impulse.is_finite() { impulse } else { Vec3::ZERO };
        let lock = &mut self.locks[owner as usize];
        lock.steady = impulse.length().min(lock.impulse.length());
        lock.impulse = impulse;
        // A load that disappears is dropped at once.
        let bears = impulse.length() * JOINT_LOAD_SHARE;
        let lasting = lock.lasting_impulse.min(bears);
        lock.lasting_impulse = lasting + (bears - lasting) * self.hold;
        let joint = &mut self.all[lock.joint as usize];
        match lock.kind {
            LockKind::Point | LockKind::Line(_) => joint.force += impulse * self.inverse_h,
            _ => joint.torque += impulse * self.inverse_h,
        }
    }

    fn row(&mut self, owner: u32, RowImpulse { ends, force, torque, now }: RowImpulse) {
        let row = &mut self.rows[owner as usize];
        if let Some(angle) = now.filter(|angle| angle.is_finite() && row.counts_turns()) {
            row.turned = angle;
        }
        let impulse = ends.map(|one| if one.is_finite() { one } else { 0.0 });
        row.impulse = impulse;
        row.lasting_impulse = lasting(row.lasting_impulse, impulse, self.hold);
        let (joint, p) = (&mut self.all[row.joint as usize], (impulse[0] - impulse[1]) * self.inverse_h);
        joint.force += force * p;
        joint.torque += torque * p;
    }
}

/// The lasting part of an impulse at the ends of a range, given that before.
fn lasting(before: f32, impulse: [f32; 2], hold: f32) -> f32 {
    let bears = (impulse[0] - impulse[1]) * JOINT_LOAD_SHARE;
    let lasting = if bears * before <= 0.0 { 0.0 } else { before.max(-bears.abs()).min(bears.abs()) };
    lasting + (bears - lasting) * hold
}

impl JointRows {
    /// Writes impulses back, and the load of each joint. `inverse_h`: 1 / substep [1/s]; `hold`: weight of
    /// this step's load in the lasting one.
    pub(crate) fn store(&self, joints: &mut Joints, bodies: &Bodies, inverse_h: f32, hold: f32) {
        if self.stages.is_empty() {
            return;
        }
        let awake = |slot: &u32| *slot != NONE && (bodies.slots.dense(*slot) as usize) < bodies.dynamic();
        for joint in joints.all.iter_mut().filter(|joint| joint.bodies.iter().any(awake)) {
            (joint.force, joint.torque) = (Vec3::ZERO, Vec3::ZERO);
        }
        let Joints { all, locks, rows, couplings, .. } = joints;
        let mut coupled = |slot: u32, displacements: [f64; 2], impulse: [f32; 2]| {
            let coupling = &mut couplings.all[slot as usize];
            let impulse = impulse.map(|one| if one.is_finite() { one } else { 0.0 });
            coupling.displacements = displacements;
            coupling.impulse = impulse;
            coupling.lasting_impulse = lasting(coupling.lasting_impulse, impulse, hold);
            let p = (impulse[0] - impulse[1]) * inverse_h;
            coupling.load = coupling.scaled().map(|factor| factor * p);
        };
        self.couplings.iter().for_each(|block| block.report(&mut coupled));
        let mut store = Store { all, locks, rows, inverse_h, hold };
        self.tables.report(true, &mut store);
        self.trees.iter().for_each(|batch| report_locks(batch, &mut store));
        self.single_trees.iter().for_each(|batch| report_locks(batch, &mut store));
        let mut late = |owner: u32, lag: f32| store.locks[owner as usize].lag = lag;
        self.trees.iter().for_each(|batch| batch.each_lag(&mut late));
        self.single_trees.iter().for_each(|batch| batch.each_lag(&mut late));
        self.tables.report(false, &mut store);
        self.trees.iter().for_each(|batch| report_motors(batch, &mut store));
        self.single_trees.iter().for_each(|batch| report_motors(batch, &mut store));
        self.couplings.iter().for_each(|block| block.report_drives(&mut store));
    }
}

/// Reports the locks of a batch of trees.
pub(crate) fn report_locks<L: Lanes>(batch: &TreeBatch<L>, to: &mut impl Report) {
    for node in batch.nodes.iter().filter(|node| node.jointed) {
        let sign = if node.side == 1 { 1.0 } else { -1.0 };
        for (lane, owner) in node.owner.into_iter().enumerate().filter(|(_, owner)| *owner != NONE) {
            to.lock(owner, node.impulse.lane(lane) * sign);
            if node.turn_owner[lane] != NONE {
                to.lock(node.turn_owner[lane], node.twist.lane(lane) * sign);
            }
        }
    }
}

/// Reports the motors of a batch of trees.
pub(crate) fn report_motors<L: Lanes>(batch: &TreeBatch<L>, to: &mut impl Report) {
    for motor in &batch.extra.motors {
        let node = &batch.nodes[motor.node as usize];
        let sign = if node.side == 1 { 1.0 } else { -1.0 };
        for (lane, owner) in motor.owner.into_iter().enumerate().filter(|(_, owner)| *owner != NONE) {
            let (impulse, torque) = (motor.impulse.lane(lane) * sign, node.axis_now[0].lane(lane));
            to.row(owner, RowImpulse { ends: [impulse, 0.0], force: Vec3::ZERO, torque, now: None });
        }
    }
}
