//! Joint columns: frames once a joint, and a row for each limit and motor, by type.

use super::coupling::{Coupling, Couplings};
use super::desc::JointDesc;
use super::frames::JointFrame;
use super::motion::{Limit, Motor};
use super::row::{Lock, NONE, Row, RowKind};
use crate::body::Bodies;
use crate::config::RowGroup;
use crate::handle::{CouplingHandle, JointHandle, Slots};
use crate::limits::MAX_LOAD;
use crate::memory::{buffers, bytes_of};
use glam::Vec3;

/// A joint that bore more than one of its thresholds in the last step
/// ([`JointDesc::with_thresholds`](crate::JointDesc::with_thresholds)), and did not break.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct JointEvent {
    /// The joint.
    pub joint: JointHandle,
    /// Its force on the second body in the last substep, in world axes [N].
    pub force: Vec3,
    /// Its torque on the second body about the joint, the same [N m].
    pub torque: Vec3,
}

/// Rows that a coupling may add to the batches of a step: its own, and motors of its motions, which go along.
pub(super) const COUPLING_ROWS: usize = 3;

/// A joint. Its slot is its index: it never moves.
#[derive(Clone, Debug)]
pub(crate) struct Joint {
    /// Slots of the bodies; [`NONE`] in a joint that was removed.
    pub(crate) bodies: [u32; 2],
    pub(crate) frames: [JointFrame; 2],
    /// Force [N] and torque [N m] at which it breaks.
    pub(crate) strength: [f32; 2],
    /// Force [N] and torque [N m] above which it is reported.
    pub(crate) threshold: [f32; 2],
    pub(crate) collide: bool,
    /// Which rows its own come after.
    pub(crate) solved_after: Option<RowGroup>,
    pub(crate) user_data: u64,
    /// On the second body, in the last substep [N], [N m].
    pub(crate) force: Vec3,
    pub(crate) torque: Vec3,
    /// The next joint of either body.
    pub(super) next: [u32; 2],
    /// Its first lock and its first row; the others follow. Of a joint without any it says nothing.
    pub(super) start: [u32; 2],
}

/// How many joints, locks and rows are about to be added.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JointAdditions {
    pub(super) joints: usize,
    pub(super) breakable: usize,
    pub(super) reporting: usize,
    pub(super) locks: usize,
    pub(super) rows: usize,
    pub(super) couplings: usize,
    /// The list of bodies must be this long.
    pub(super) bodies: usize,
}

impl JointAdditions {
    pub(crate) fn of(limits: &[Limit], drives: &[Motor]) -> JointAdditions {
        let limits = locked_together(limits);
        let locks = limits.iter().filter(|(limit, _)| limit.locked().is_some()).count();
        JointAdditions { locks, rows: limits.len() - locks + drives.len(), ..JointAdditions::default() }
    }

    pub(crate) fn of_joint(desc: &JointDesc) -> JointAdditions {
        let bodies = desc.bodies[0].slot.max(desc.bodies[1].slot) as usize + 1;
        let [strength, threshold] =
            [[desc.break_force, desc.break_torque], [desc.force_threshold, desc.torque_threshold]];
        let rows = JointAdditions::of(&desc.limits, &desc.motors);
        let events = JointAdditions::of_events(strength, threshold);
        JointAdditions { joints: 1, bodies, ..rows.and(events) }
    }

    /// Whether no joint is added.
    pub(crate) fn is_empty(&self) -> bool {
        self.joints == 0
    }

    /// The same between bodies that are yet to come: their slots are below `slots`.
    pub(crate) fn between(self, slots: usize) -> JointAdditions {
        JointAdditions { bodies: slots, ..self }
    }

    /// For the lists of joints that break and of those that are reported.
    pub(crate) fn of_events(strength: [f32; 2], threshold: [f32; 2]) -> JointAdditions {
        let [breakable, reporting] = [strength, threshold].map(|bounds| usize::from(is_bound(bounds)));
        JointAdditions { breakable, reporting, ..JointAdditions::default() }
    }

    /// For a coupling.
    pub(crate) fn of_coupling() -> JointAdditions {
        JointAdditions { couplings: 1, ..JointAdditions::default() }
    }

    /// Locks, and other rows.
    pub(crate) fn rows(&self) -> (usize, usize) {
        (self.locks, self.rows)
    }

    /// Both.
    pub(crate) fn and(self, other: JointAdditions) -> JointAdditions {
        JointAdditions {
            joints: self.joints + other.joints,
            breakable: self.breakable + other.breakable,
            reporting: self.reporting + other.reporting,
            locks: self.locks + other.locks,
            rows: self.rows + other.rows,
            couplings: self.couplings + other.couplings,
            bodies: self.bodies.max(other.bodies),
        }
    }
}

/// All joints of a world.
#[derive(Debug, Default)]
pub(crate) struct Joints {
    pub(crate) slots: Slots,
    pub(crate) all: Vec<Joint>,
    pub(crate) locks: Vec<Lock>,
    pub(crate) rows: Vec<Row>,
    /// Couplings between two of their motions.
    pub(crate) couplings: Couplings,
    /// By body slot: the first of its joints. As long as it has to be.
    pub(super) first: Vec<u32>,
    /// How many there are.
    pub(crate) count: usize,
    /// Joints came or went since rows were last arranged.
    pub(crate) changed: bool,
    /// Joints were removed, and their rows are still there.
    pub(super) stale: bool,
    /// Locks, rows and couplings that came since batches were last arranged.
    pub(super) fresh: usize,
    /// Bytes of batches that joints of bodies at rest gave back, and need again once these wake.
    pub(super) resting: usize,
    /// How many can break.
    pub(crate) breakable: u32,
    /// How many ask to be reported.
    pub(crate) reporting: u32,
    /// Joints that broke in the last step.
    pub(crate) broken: Vec<JointHandle>,
    /// Joints that bore more than their thresholds in the last step.
    pub(crate) strained: Vec<JointEvent>,
}

buffers! {
    Joints {
        /// For so many in all.
        each(n: JointAdditions) {
            all(n.joints),
            slots(n.joints),
            locks(n.locks),
            rows(n.rows),
            couplings(n.couplings),
            first(n.bodies),
            broken(n.breakable),
            strained(n.reporting),
        }
    }
}

impl Joints {
    /// Joints whose loads are NaN or out of range begin the next step without them.
    pub(crate) fn forget_unsound(&mut self) {
        let sound = |loads: &[f32]| loads.iter().all(|load| load.abs() <= MAX_LOAD);
        for lock in &mut self.locks {
            if !sound(&lock.impulse.to_array()) || !sound(&[lock.lasting_impulse, lock.steady, lock.lag]) {
                (lock.impulse, lock.lasting_impulse, lock.steady, lock.lag) = (Vec3::ZERO, 0.0, 0.0, -1.0);
            }
        }
        for joint in &mut self.all {
            if !sound(&joint.force.to_array()) || !sound(&joint.torque.to_array()) {
                (joint.force, joint.torque) = (Vec3::ZERO, Vec3::ZERO);
            }
        }
        for row in &mut self.rows {
            if !sound(&[row.impulse[0], row.impulse[1], row.lasting_impulse]) {
                (row.impulse, row.lasting_impulse) = ([0.0; 2], 0.0);
            }
        }
        self.couplings.forget_unsound();
    }

    pub(crate) fn add(&mut self, desc: &JointDesc, frames: [JointFrame; 2]) -> JointHandle {
        if self.stale && self.slots.spare() > 0 {
            // The slot will be used again.
            self.drop_stale();
        }
        let bodies = desc.bodies.map(|b| b.slot);
        let most = bodies[0].max(bodies[1]) as usize + 1;
        if self.first.len() < most {
            self.first.resize(most, NONE);
        }
        let joint = Joint {
            bodies,
            frames,
            strength: [desc.break_force, desc.break_torque],
            threshold: [desc.force_threshold, desc.torque_threshold],
            collide: desc.collide,
            solved_after: desc.solved_after,
            user_data: desc.user_data,
            force: Vec3::ZERO,
            torque: Vec3::ZERO,
            next: bodies.map(|b| self.first[b as usize]),
            start: [NONE; 2],
        };
        self.breakable += u32::from(is_bound(joint.strength));
        self.reporting += u32::from(is_bound(joint.threshold));
        let (slot, generation) = self.slots.place(joint, &mut self.all);
        bodies.into_iter().for_each(|b| self.first[b as usize] = slot);
        self.add_rows(slot, &desc.limits, &desc.motors);
        self.count += 1;
        self.changed = true;
        JointHandle { slot, generation }
    }

    pub(crate) fn remove(&mut self, slot: u32) {
        let Joint { bodies, .. } = self.all[slot as usize];
        for body in bodies {
            self.unlink(body, slot);
        }
        let joint = &mut self.all[slot as usize];
        self.breakable -= u32::from(is_bound(joint.strength));
        self.reporting -= u32::from(is_bound(joint.threshold));
        (joint.bodies, self.stale) = ([NONE; 2], true);
        self.couplings.remove_of(slot);
        self.slots.remove(slot);
        self.count -= 1;
        self.changed = true;
    }

    pub(crate) fn add_coupling(&mut self, coupling: Coupling) -> CouplingHandle {
        self.fresh += COUPLING_ROWS;
        self.changed = true;
        self.couplings.add(coupling)
    }

    pub(crate) fn remove_coupling(&mut self, slot: u32) {
        self.couplings.remove(slot);
        self.changed = true;
    }

    fn unlink(&mut self, body: u32, slot: u32) {
        let mut at = self.first[body as usize];
        let after = self.all[slot as usize].next_of(body);
        if at == slot {
            self.first[body as usize] = after;
            return;
        }
        while at != NONE {
            let joint = &mut self.all[at as usize];
            let side = usize::from(joint.bodies[1] == body);
            if joint.next[side] == slot {
                joint.next[side] = after;
                return;
            }
            at = joint.next[side];
        }
    }

    /// Frees everything when no joint is left, except for the generations that tell stale handles.
    pub(crate) fn release(&mut self) {
        self.compact();
        (self.locks, self.rows, self.first) = (Vec::new(), Vec::new(), Vec::new());
        (self.broken, self.strained) = (Vec::new(), Vec::new());
        self.couplings.broken = Vec::new();
    }

    /// Limits with a width, motors, and how many of both are springs.
    pub(crate) fn kinds_of_rows(&self) -> [u32; 3] {
        let mut counts = [0; 3];
        for row in self.rows.iter().filter(|row| self.all[row.joint as usize].is_there()) {
            let (kind, spring) = match row.kind {
                RowKind::Limit { .. } => (0, false),
                RowKind::Yielding { .. } => (0, true),
                RowKind::Motor { spring, .. } => (1, spring.coefficients().stiffness > 0.0),
            };
            counts[kind] += 1;
            counts[2] += u32::from(spring);
        }
        counts
    }

    /// How many name a group to be solved after.
    pub(crate) fn solved_after(&self) -> u32 {
        self.all.iter().filter(|joint| joint.is_there() && joint.solved_after.is_some()).count() as u32
    }

    /// Reserved bytes of joints themselves, of their locks and of their rows, without the handles that were
    /// given out.
    pub(crate) fn parts(&self) -> [usize; 3] {
        let handles = if self.count > 0 { bytes_of(&self.all).1 } else { 0 };
        let lists = bytes_of(&self.first).1 + bytes_of(&self.broken).1 + bytes_of(&self.strained).1;
        let own = handles + lists;
        [own, bytes_of(&self.locks).1, bytes_of(&self.rows).1]
    }

    /// Drops the rows of removed joints and keeps the order of the others; called before batches are
    /// arranged.
    pub(crate) fn compact(&mut self) {
        self.drop_stale();
        (self.changed, self.fresh) = (false, 0);
    }

    fn drop_stale(&mut self) {
        let all = &self.all;
        let there = |joint: u32| all[joint as usize].is_there();
        self.locks.retain(|l| there(l.joint));
        self.rows.retain(|r| there(r.joint));
        self.stale = false;
        self.find_starts();
    }

    /// Bytes that more takes: in the columns, and in the batches of a step, of which each row may have one
    /// for itself, of so many bytes.
    pub(crate) fn missing(&mut self, more: JointAdditions, batch: usize) -> usize {
        (more.locks + more.rows + COUPLING_ROWS * more.couplings) * batch + self.missing_columns(more)
    }

    /// The most bytes that the rows take for which no batches are arranged: they are promised to the step
    /// that will do so, and nothing else may have them.
    pub(crate) fn promised(&self, batch: usize) -> usize {
        self.fresh * batch + self.resting
    }

    /// Batches were arranged for all joints but those of bodies that are asleep or disabled. `left`: bytes
    /// that remain of the memory that all of them held or were promised.
    pub(crate) fn note_resting(&mut self, left: usize, batch: usize, bodies: &Bodies) {
        let awake = |slot: u32| (bodies.slots.dense(slot) as usize) < bodies.dynamic();
        let rests = |joint: u32| !self.all[joint as usize].bodies.into_iter().any(awake);
        let rows = self.locks.iter().map(|lock| lock.joint).chain(self.rows.iter().map(|row| row.joint));
        let coupled = self.couplings.live().filter(|(_, one)| one.joints().into_iter().any(rests));
        let rows = rows.filter(|&joint| rests(joint)).count() + COUPLING_ROWS * coupled.count();
        self.resting = left.min(rows * batch);
    }

    /// Promises so many bytes to the rows that are arranged next, and no others.
    pub(crate) fn promise(&mut self, bytes: usize) {
        (self.fresh, self.resting) = (0, bytes);
    }

    /// All rows are about to be arranged in another way.
    pub(crate) fn arrange_anew(&mut self) {
        (self.changed, self.fresh) = (true, self.row_count());
    }

    /// The most rows that batches are arranged for.
    pub(crate) fn row_count(&self) -> usize {
        self.locks.len() + self.rows.len() + COUPLING_ROWS * self.couplings.all.len()
    }

    /// The same in the columns alone.
    pub(crate) fn missing_columns(&mut self, more: JointAdditions) -> usize {
        let mut bytes = 0;
        self.each(self.with(more), &mut |buffer, len| bytes += buffer.missing(len));
        bytes
    }

    /// Makes place for it in the columns.
    pub(crate) fn reserve_total(&mut self, more: JointAdditions) {
        self.each(self.with(more), &mut |buffer, len| buffer.reserve_total(len));
    }

    /// As many in all as there will be with more.
    fn with(&self, more: JointAdditions) -> JointAdditions {
        JointAdditions {
            joints: self.all.len() + more.joints.saturating_sub(self.slots.spare()),
            breakable: self.breakable as usize + more.breakable,
            reporting: self.reporting as usize + more.reporting,
            locks: self.locks.len() + more.locks,
            rows: self.rows.len() + more.rows,
            couplings: self.couplings.slots_for(more.couplings),
            bodies: self.first.len().max(more.bodies),
        }
    }

    /// A quarter more than there are.
    pub(crate) fn ahead(&self, more: JointAdditions) -> JointAdditions {
        JointAdditions {
            joints: more.joints + self.all.len() / 4,
            locks: more.locks + self.locks.len() / 4,
            rows: more.rows + self.rows.len() / 4,
            couplings: more.couplings + self.couplings.all.len() / 4,
            ..more
        }
    }

    /// The joints of a body.
    pub(crate) fn of_body(&self, body: u32) -> impl Iterator<Item = u32> + '_ {
        let mut at = self.first.get(body as usize).copied().unwrap_or(NONE);
        std::iter::from_fn(move || {
            let this = at;
            (this != NONE).then(|| {
                at = self.all[this as usize].next_of(body);
                this
            })
        })
    }

    /// Whether a body, by its slot, has joints.
    pub(crate) fn has_any(&self, body: u32) -> bool {
        self.count > 0 && self.of_body(body).next().is_some()
    }

    /// Whether a joint keeps two bodies, by slots, from colliding.
    pub(crate) fn keep_apart(&self, a: u32, b: u32) -> bool {
        self.count > 0
            && self.of_body(a).any(|j| {
                let joint = &self.all[j as usize];
                !joint.collide && joint.bodies.contains(&b)
            })
    }

    /// Whether there are events of the last step.
    pub(crate) fn has_events(&self) -> bool {
        !(self.broken.is_empty() && self.strained.is_empty() && self.couplings.broken.is_empty())
    }

    /// Sets at which force and torque a joint breaks.
    pub(crate) fn set_strength(&mut self, joint: u32, strength: [f32; 2]) {
        let old = std::mem::replace(&mut self.all[joint as usize].strength, strength);
        self.breakable = self.breakable - u32::from(is_bound(old)) + u32::from(is_bound(strength));
    }

    /// Sets above which force and torque a joint is reported.
    pub(crate) fn set_threshold(&mut self, joint: u32, threshold: [f32; 2]) {
        let old = std::mem::replace(&mut self.all[joint as usize].threshold, threshold);
        self.reporting = self.reporting - u32::from(is_bound(old)) + u32::from(is_bound(threshold));
    }
}

/// Whether a force or a torque is bounded.
pub(super) fn is_bound(bounds: [f32; 2]) -> bool {
    bounds.iter().any(|bound| bound.is_finite())
}

impl Joint {
    pub(super) fn next_of(&self, body: u32) -> u32 {
        self.next[usize::from(self.bodies[1] == body)]
    }
    pub(crate) fn is_there(&self) -> bool {
        self.bodies[0] != NONE
    }
    /// Whether it bears more than one of two bounds.
    fn exceeds(&self, [force, torque]: [f32; 2]) -> bool {
        self.force.length() > force || self.torque.length() > torque
    }
    pub(crate) fn is_overloaded(&self) -> bool {
        self.exceeds(self.strength)
    }
    pub(crate) fn is_strained(&self) -> bool {
        self.exceeds(self.threshold)
    }
}

mod rows;

pub(crate) use rows::is_guided;
use rows::locked_together;

#[cfg(test)]
mod tests;
