//! Joints in a snapshot: their impulses, which change in every step, and their definitions, which seldom do.

use super::coupling::{CouplingRecords, SavedCouplings};
use super::desc::{axes_code, axes_of};
use super::frames::JointFrame;
use super::motion::{Axes, Axis, Motion, Spring};
use super::row::{Lock, LockKind, NONE, Row, RowKind};
use super::store::{COUPLING_ROWS, Joint, JointAdditions, Joints, is_bound};
use crate::config::RowGroup;
use crate::error::Error;
use crate::words::{Reader, all_loads, are_free, broken, record, words};
use glam::Vec3;

/// How many of each there are in a saved state.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct JointLists {
    joints: u32,
    locks: u32,
    rows: u32,
    couplings: u32,
}

/// The impulses of joints, as words.
#[derive(Clone, Copy)]
pub(crate) struct SavedJoints<'a> {
    lists: JointLists,
    joints: &'a [u32],
    locks: &'a [u32],
    rows: &'a [u32],
    couplings: SavedCouplings<'a>,
}

impl Joints {
    /// Writes the loads of joints.
    pub(crate) fn save(&self, out: &mut Vec<u32>) -> JointLists {
        let Joints {
            all,
            locks,
            rows,
            couplings,
            // Definitions: see `save_all`.
            slots: _,
            first: _,
            stale: _,
            // Known by the number of the arrangement.
            changed: _,
            // These follow from the others; two are memory that is promised.
            count: _,
            fresh: _,
            resting: _,
            breakable: _,
            reporting: _,
            // Of the last step.
            broken: _,
            strained: _,
        } = self;
        all.iter().for_each(|joint| out.extend_from_slice(&words::<6>([joint.force, joint.torque])));
        for lock in locks {
            let [x, y, z] = lock.impulse.to_array();
            out.extend_from_slice(&words::<6>([x, y, z, lock.lasting_impulse, lock.steady, lock.lag]));
        }
        for row in rows {
            let ([low, high], [a, b]) = (row.impulse, row.kind.ends());
            out.extend_from_slice(&words::<6>([low, high, row.lasting_impulse, row.turned, a, b]));
        }
        JointLists {
            joints: all.len() as u32,
            locks: locks.len() as u32,
            rows: rows.len() as u32,
            couplings: couplings.save(out),
        }
    }

    /// Restores the loads of joints.
    pub(crate) fn restore(&mut self, saved: &SavedJoints<'_>) {
        for (joint, words) in self.all.iter_mut().zip(saved.joints.as_chunks::<6>().0) {
            [joint.force, joint.torque] = record::<[Vec3; 2], 6>(words);
        }
        for (lock, words) in self.locks.iter_mut().zip(saved.locks.as_chunks::<6>().0) {
            let [x, y, z, lasting_impulse, steady, lag]: [f32; 6] = record::<_, 6>(words);
            (lock.impulse, lock.lasting_impulse) = (Vec3::new(x, y, z), lasting_impulse);
            (lock.steady, lock.lag) = (steady, lag);
        }
        for (row, words) in self.rows.iter_mut().zip(saved.rows.as_chunks::<6>().0) {
            let [low, high, lasting_impulse, turned, a, b]: [f32; 6] = record::<_, 6>(words);
            (row.impulse, row.lasting_impulse, row.turned) = ([low, high], lasting_impulse, turned);
            row.kind = row.kind.with_ends([a, b]);
        }
        self.couplings.restore(&saved.couplings);
        self.broken.clear();
        self.strained.clear();
    }

    /// Writes the definitions of joints.
    pub(crate) fn save_all(&self, out: &mut Vec<u32>) {
        // The list is as long as it ever had to be: its end is not state.
        let first = self.first.iter().rposition(|&joint| joint != NONE).map_or(0, |last| last + 1);
        let counts = [self.all.len(), self.locks.len(), self.rows.len(), first];
        out.extend(counts.map(|n| n as u32));
        out.push(u32::from(self.stale));
        for (slot, joint) in self.all.iter().enumerate() {
            out.extend(joint.bodies);
            if !joint.is_there() {
                continue;
            }
            out.push(self.slots.generation(slot as u32));
            for JointFrame { position, rotation } in joint.frames {
                out.extend_from_slice(&words::<3>(position));
                out.extend_from_slice(&words::<4>(rotation.to_array()));
            }
            out.extend(joint.strength.map(f32::to_bits));
            out.extend(joint.threshold.map(f32::to_bits));
            out.push(u32::from(joint.collide) | group_code(joint.solved_after) << 8);
            out.extend_from_slice(&words::<2>(joint.user_data));
            out.extend(joint.next);
        }
        for lock in &self.locks {
            out.extend([lock.joint, lock_code(Some(lock.kind)) | u32::from(lock.merged) << 8]);
        }
        self.rows.iter().for_each(|row| save_row(row, out));
        out.extend(&self.first[..first]);
        self.slots.save_free(out);
        self.couplings.save_all(out);
    }

    /// How many locks, rows and couplings a snapshot has beyond those that batches were arranged for.
    pub(crate) fn rows_missing_for(&self, records: &JointRecords) -> usize {
        records.row_count().saturating_sub(self.row_count().saturating_sub(self.fresh))
    }

    /// Replaces all joints.
    pub(crate) fn restore_all(&mut self, records: &JointRecords) {
        let JointRecords { all, generations, locks, rows, first, stale, free, couplings } = records;
        self.all.clone_from(all);
        self.locks.clone_from(locks);
        self.rows.clone_from(rows);
        self.first.clone_from(first);
        let there = |joint: &&Joint| joint.is_there();
        self.count = all.iter().filter(there).count();
        let bound = |bounds: &dyn Fn(&Joint) -> [f32; 2]| {
            all.iter().filter(there).filter(|joint| is_bound(bounds(joint))).count() as u32
        };
        self.breakable = bound(&|joint| joint.strength);
        self.reporting = bound(&|joint| joint.threshold);
        self.find_starts();
        self.couplings.restore_all(couplings);
        self.stale = *stale;
        let taken = (0u32..).zip(all).filter(|(_, joint)| joint.is_there());
        let taken = taken.map(|(slot, _)| (slot, generations[slot as usize], slot));
        self.slots.rebuild(all.len(), taken, free);
    }

    /// Whether rows of joints that were removed are still there.
    pub(crate) fn is_stale(&self) -> bool {
        self.stale
    }
}

impl<'a> SavedJoints<'a> {
    pub(crate) fn read(from: &mut Reader<'a>, lists: JointLists) -> Result<SavedJoints<'a>, Error> {
        Ok(SavedJoints {
            lists,
            joints: from.table(lists.joints, 6)?,
            locks: from.table(lists.locks, 6)?,
            rows: from.table(lists.rows, 6)?,
            couplings: SavedCouplings::read(from, lists.couplings)?,
        })
    }

    /// Whether there are as many as the world will have, with loads that a step can begin with. A joint may
    /// bear more than it can: its strength was lowered, and the next step breaks it.
    pub(crate) fn check(&self, records: &JointRecords) -> Result<(), Error> {
        let [joints, locks, rows] = [records.all.len(), records.locks.len(), records.rows.len()];
        [self.joints, self.locks].into_iter().try_for_each(all_loads)?;
        for (row, words) in records.rows.iter().zip(self.rows.as_chunks::<6>().0) {
            let [loads @ .., turned, a, b] = words;
            all_loads(loads)?;
            let turned = f32::from_bits(*turned);
            if !(turned.is_finite() && row.counts_turns() || turned == f32::INFINITY) {
                return Err(broken("an angle"));
            }
            let kind = row.kind.with_ends([*a, *b].map(f32::from_bits));
            let row = Row { kind, ..*row };
            row.limit().map_or(Ok(()), |limit| limit.validate())?;
            row.drive().map_or(Ok(()), |drive| drive.validate())?;
        }
        self.couplings.check(&records.couplings)?;
        let counts = [self.lists.joints, self.lists.locks, self.lists.rows].map(|n| n as usize);
        if counts == [joints, locks, rows] { Ok(()) } else { Err(broken("the number of joints")) }
    }
}

/// All joints of a snapshot.
#[derive(Debug, Default)]
pub(crate) struct JointRecords {
    all: Vec<Joint>,
    generations: Vec<u32>,
    locks: Vec<Lock>,
    rows: Vec<Row>,
    first: Vec<u32>,
    stale: bool,
    free: Vec<(u32, u32)>,
    couplings: CouplingRecords,
}

/// A joint of which nothing but its bodies is known yet.
fn nothing_between(bodies: [u32; 2]) -> Joint {
    Joint {
        bodies,
        frames: [JointFrame::default(); 2],
        strength: [f32::INFINITY; 2],
        threshold: [f32::INFINITY; 2],
        collide: false,
        solved_after: None,
        user_data: 0,
        force: Vec3::ZERO,
        torque: Vec3::ZERO,
        next: [NONE; 2],
        start: [NONE; 2],
    }
}

impl JointRecords {
    /// Whether there is any.
    pub(crate) fn any(&self) -> bool {
        self.all.iter().any(Joint::is_there)
    }

    pub(crate) fn row_count(&self) -> usize {
        self.locks.len() + self.rows.len() + COUPLING_ROWS * self.couplings.len()
    }

    /// Bytes needed to hold all of them.
    pub(crate) fn more(&self) -> JointAdditions {
        let live = self.all.iter().filter(|joint| joint.is_there());
        let events = live.map(|joint| JointAdditions::of_events(joint.strength, joint.threshold));
        JointAdditions {
            joints: self.all.len(),
            locks: self.locks.len(),
            rows: self.rows.len(),
            bodies: self.first.len(),
            couplings: self.couplings.len(),
            ..events.fold(JointAdditions::default(), JointAdditions::and)
        }
    }

    /// Slots of the two bodies of each joint.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.all.iter().filter(|joint| joint.is_there()).map(|joint| joint.bodies)
    }

    /// Slots of the bodies of both joints of each coupling.
    pub(crate) fn coupled_bodies(&self) -> impl Iterator<Item = [[u32; 2]; 2]> + '_ {
        self.couplings.joints().map(|joints| joints.map(|joint| self.all[joint as usize].bodies))
    }

    /// Reads the output of [`Joints::save_all`]. `is_dynamic`: of each body slot in use, whether the body is
    /// dynamic.
    pub(crate) fn read(
        from: &mut Reader<'_>,
        is_dynamic: impl Fn(u32) -> Option<bool>,
    ) -> Result<JointRecords, Error> {
        let [joints, locks, rows, first, stale]: [u32; 5] = from.record::<_, 5>()?;
        let mut records = JointRecords { stale: stale != 0, ..JointRecords::default() };
        let mut live = 0;
        for _ in 0..joints {
            let bodies: [u32; 2] = from.record::<_, 2>()?;
            let mut joint = nothing_between(bodies);
            let mut generation = 0;
            if joint.is_there() {
                generation = from.one()?;
                for frame in &mut joint.frames {
                    frame.position = from.finite::<Vec3, 3>()?;
                    crate::limits::lever("joint frame position", frame.position)?;
                    frame.rotation = from.rotation("a rotation")?;
                }
                joint.strength = from.record::<_, 2>()?;
                joint.threshold = from.record::<_, 2>()?;
                let flags = from.one()?;
                joint.collide = flags & 1 != 0;
                joint.solved_after = group_of(flags >> 8)?;
                joint.user_data = from.long()?;
                joint.next = from.record::<_, 2>()?;
                let dynamic = bodies.map(&is_dynamic);
                let strong = joint.strength.iter().chain(&joint.threshold).all(|s| *s >= 0.0);
                if dynamic.contains(&None)
                    || !dynamic.contains(&Some(true))
                    || bodies[0] == bodies[1]
                    || !strong
                {
                    return Err(broken("a joint"));
                }
                live += 1;
            } else if bodies != [NONE; 2] {
                return Err(broken("a joint"));
            }
            records.all.push(joint);
            records.generations.push(generation);
        }
        let known = |joint: u32, all: &[Joint]| {
            all.get(joint as usize).is_some_and(|joint| joint.is_there() || stale != 0)
        };
        for _ in 0..locks {
            let [joint, code]: [u32; 2] = from.record::<_, 2>()?;
            let kind = lock_of(code & 255)?.filter(|_| known(joint, &records.all) && code >> 8 < 2);
            let kind = kind.ok_or_else(|| broken("a lock"))?;
            records.locks.push(Lock::new(joint, kind, code >> 8 == 1));
        }
        for _ in 0..rows {
            let row = read_row(from)?;
            if !known(row.joint, &records.all) {
                return Err(broken("a row of a joint"));
            }
            records.rows.push(row);
        }
        let of_locks = records.locks.iter().map(|lock| lock.joint);
        let of_rows = records.rows.iter().map(|row| row.joint);
        if !is_grouped(of_locks, records.all.len()) || !is_grouped(of_rows, records.all.len()) {
            return Err(broken("the order of a joint's rows"));
        }
        records.first.extend(from.table(first, 1)?);
        records.free = from.free_slots()?;
        records.check_lists(live)?;
        let exists = |joint: u32| records.all.get(joint as usize).is_some_and(Joint::is_there);
        records.couplings = CouplingRecords::read(from, exists)?;
        Ok(records)
    }

    /// Whether the lists of bodies lead to each of their joints once, and the free slots are those that are
    /// not taken.
    fn check_lists(&self, live: usize) -> Result<(), Error> {
        let mut visits = 0;
        for (body, &first) in (0u32..).zip(&self.first) {
            let mut at = first;
            while at != NONE {
                let joint = self.all.get(at as usize).filter(|joint| joint.bodies.contains(&body));
                let joint = joint.ok_or_else(|| broken("a list of joints"))?;
                visits += 1;
                if visits > 2 * live {
                    return Err(broken("a list of joints"));
                }
                at = joint.next_of(body);
            }
        }
        let dead = (0u32..).zip(&self.all).filter(|(_, joint)| !joint.is_there()).map(|(slot, _)| slot);
        let whole = visits == 2 * live && are_free(&self.free, dead);
        if whole { Ok(()) } else { Err(broken("a list of joints")) }
    }
}

/// Whether equal items come one after another; there are `count` items.
fn is_grouped(joints: impl Iterator<Item = u32>, count: usize) -> bool {
    let (mut seen, mut last) = (vec![false; count], NONE);
    for joint in joints {
        if joint != std::mem::replace(&mut last, joint) && std::mem::replace(&mut seen[joint as usize], true)
        {
            return false;
        }
    }
    true
}

/// 0 for none.
pub(crate) fn group_code(group: Option<RowGroup>) -> u32 {
    group.map_or(0, |group| group as u32 + 1)
}

pub(crate) fn group_of(code: u32) -> Result<Option<RowGroup>, Error> {
    let all = crate::config::Order::default().0;
    match code {
        0 => Ok(None),
        _ => {
            all.into_iter().find(|&g| g as u32 + 1 == code).map(Some).ok_or_else(|| broken("a group of rows"))
        }
    }
}

fn lock_code(kind: Option<LockKind>) -> u32 {
    match kind {
        None => 0,
        Some(LockKind::Point) => 1,
        Some(LockKind::Weld) => 2,
        Some(LockKind::Line(axis)) => 3 + axis as u32,
        Some(LockKind::Hinge(axis)) => 6 + axis as u32,
    }
}

fn lock_of(code: u32) -> Result<Option<LockKind>, Error> {
    Ok(match code {
        0 => None,
        1 => Some(LockKind::Point),
        2 => Some(LockKind::Weld),
        3..=5 => Some(LockKind::Line(Axis::ALL[code as usize - 3])),
        6..=8 => Some(LockKind::Hinge(Axis::ALL[code as usize - 6])),
        _ => return Err(broken("a lock")),
    })
}

/// Without its ends, which are part of the state.
fn save_row(row: &Row, out: &mut Vec<u32>) {
    let (kind, spring, most) = match row.kind {
        RowKind::Limit { .. } => (0, None, 0.0),
        RowKind::Yielding { spring, .. } => (1, Some(spring), 0.0),
        RowKind::Motor { spring, max_force, .. } => (2, Some(spring), max_force),
    };
    let (how, numbers) = match spring {
        None => (0, [0.0; 2]),
        Some(Spring::Coefficients { stiffness, damping }) => (1, [stiffness, damping]),
        Some(Spring::Frequency { hertz, ratio }) => (2, [hertz, ratio]),
        Some(Spring::Acceleration { stiffness, damping }) => (3, [stiffness, damping]),
    };
    let [first, second] = row.beside.map(lock_code);
    let code = [row.motion as u32, axes_code(row.axes), kind, how, first, second];
    out.push(row.joint);
    out.push(code.iter().rev().fold(0, |all, code| all << 4 | code));
    out.extend_from_slice(&words::<3>([numbers[0], numbers[1], most]));
}

fn read_row(from: &mut Reader<'_>) -> Result<Row, Error> {
    let [joint, code]: [u32; 2] = from.record::<_, 2>()?;
    let [p, q, most]: [f32; 3] = from.record::<_, 3>()?;
    let part = |i: u32| code >> (4 * i) & 15;
    let no = || broken("a row of a joint");
    let motion = [Motion::Linear, Motion::Angular].into_iter().nth(part(0) as usize).ok_or_else(no)?;
    let axes = axes_of(part(1)).ok_or_else(no)?;
    let spring = match part(3) {
        0 => None,
        1 => Some(Spring::Coefficients { stiffness: p, damping: q }),
        2 => Some(Spring::Frequency { hertz: p, ratio: q }),
        3 => Some(Spring::Acceleration { stiffness: p, damping: q }),
        _ => return Err(no()),
    };
    // The ends come with the state, and all numbers are checked together.
    let (a, b) = (0.0, 0.0);
    let kind = match (part(2), spring, axes) {
        (0, None, _) => RowKind::Limit { min: a, max: b },
        (1, Some(spring), _) => RowKind::Yielding { min: a, max: b, spring },
        // One direction each, as it is measured.
        (2, Some(spring), Axes::One(_)) => {
            RowKind::Motor { position: a, velocity: b, spring, max_force: most }
        }
        _ => return Err(no()),
    };
    let beside = [lock_of(part(4))?, lock_of(part(5))?];
    Ok(Row {
        joint,
        motion,
        axes,
        kind,
        beside,
        impulse: [0.0; 2],
        lasting_impulse: 0.0,
        turned: f32::INFINITY,
    })
}
