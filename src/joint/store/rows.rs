//! The locks and rows of joints: made out of limits and motors, found, changed, and read as they were given.

use super::Joints;
use crate::joint::motion::{Axes, Axis, Limit, Motion, Motor};
use crate::joint::row::{Lock, LockKind, NONE, Row, RowKind};
use glam::Vec3;
use std::ops::Range;

impl Limit {
    /// The kind of lock, if it locks more than one direction and is solved by a block.
    pub(crate) fn locked(&self) -> Option<LockKind> {
        match (self.motion, self.axes) {
            _ if !self.locks() => None,
            (Motion::Linear, Axes::All) => Some(LockKind::Point),
            (Motion::Linear, Axes::Perpendicular(axis)) => Some(LockKind::Line(axis)),
            (Motion::Angular, Axes::All) => Some(LockKind::Weld),
            (Motion::Angular, Axes::Perpendicular(axis)) => Some(LockKind::Hinge(axis)),
            // One direction is a row.
            (_, Axes::One(_)) => None,
        }
    }

    /// Whether it restricts nothing, so that it has no row.
    pub(crate) fn is_endless(&self) -> bool {
        self.min == f32::NEG_INFINITY && self.max == f32::INFINITY
    }

    /// As the row of a limit that does not lock more than one direction.
    pub(crate) fn kind(&self) -> RowKind {
        let Limit { min, max, .. } = *self;
        self.spring.map_or(RowKind::Limit { min, max }, |spring| RowKind::Yielding { min, max, spring })
    }
}

impl Motor {
    /// As a row.
    pub(crate) fn kind(&self) -> RowKind {
        let Motor { position, velocity, spring, max_force, .. } = *self;
        RowKind::Motor { position, velocity, spring, max_force }
    }
}

impl RowKind {
    /// The numbers that may change in every step: the ends of a range, or the target of a motor. Snapshots
    /// keep them with the state.
    pub(crate) fn ends(&self) -> [f32; 2] {
        match *self {
            RowKind::Limit { min, max } | RowKind::Yielding { min, max, .. } => [min, max],
            RowKind::Motor { position, velocity, .. } => [position, velocity],
        }
    }

    /// The same with other ends.
    pub(crate) fn with_ends(self, [a, b]: [f32; 2]) -> RowKind {
        match self {
            RowKind::Limit { .. } => RowKind::Limit { min: a, max: b },
            RowKind::Yielding { spring, .. } => RowKind::Yielding { min: a, max: b, spring },
            RowKind::Motor { spring, max_force, .. } => {
                RowKind::Motor { position: a, velocity: b, spring, max_force }
            }
        }
    }

    /// Whether impulses of the one mean the same to the other.
    fn is_alike(&self, other: &RowKind) -> bool {
        let locks = |kind: &RowKind| matches!(kind, RowKind::Limit { min, max } if min == max);
        std::mem::discriminant(self) == std::mem::discriminant(other) && locks(self) == locks(other)
    }
}

impl LockKind {
    /// Whether it locks rotation.
    fn turns(&self) -> bool {
        matches!(self, LockKind::Weld | LockKind::Hinge(_))
    }
}

impl Lock {
    /// A lock that bears nothing yet.
    pub(in crate::joint) fn new(joint: u32, kind: LockKind, merged: bool) -> Lock {
        let impulse = Vec3::ZERO;
        Lock { joint, kind, merged, impulse, lasting_impulse: 0.0, steady: 0.0, lag: -1.0 }
    }

    /// The limits that it stands for.
    fn limits(&self) -> impl Iterator<Item = Limit> + use<> {
        let (motion, axes) = match self.kind {
            LockKind::Point => (Motion::Linear, Axes::All),
            LockKind::Line(axis) => (Motion::Linear, Axes::Perpendicular(axis)),
            LockKind::Weld => (Motion::Angular, Axes::All),
            LockKind::Hinge(axis) => (Motion::Angular, Axes::Perpendicular(axis)),
        };
        let (merged, free) =
            (self.merged, if let Axes::Perpendicular(axis) = axes { Some(axis) } else { None });
        let single = Axis::ALL.into_iter().filter(move |&axis| merged && Some(axis) != free).map(Axes::One);
        let whole = (!merged).then_some(axes);
        single.chain(whole).map(move |axes| Limit::lock(motion, axes))
    }
}

impl Row {
    fn new(joint: u32, motion: Motion, axes: Axes, kind: RowKind, beside: [Option<LockKind>; 2]) -> Row {
        Row {
            joint,
            motion,
            axes,
            kind,
            beside,
            impulse: [0.0; 2],
            lasting_impulse: 0.0,
            turned: f32::INFINITY,
        }
    }

    /// The limit that it is.
    pub(crate) fn limit(&self) -> Option<Limit> {
        let Row { motion, axes, .. } = *self;
        match self.kind {
            RowKind::Limit { min, max } => Some(Limit::new(motion, axes, min, max)),
            RowKind::Yielding { min, max, spring } => {
                Some(Limit::new(motion, axes, min, max).with_spring(spring))
            }
            RowKind::Motor { .. } => None,
        }
    }

    /// The motor that it is.
    pub(crate) fn drive(&self) -> Option<Motor> {
        let (
            Row { motion, axes: Axes::One(axis), .. },
            RowKind::Motor { position, velocity, spring, max_force },
        ) = (*self, self.kind)
        else {
            return None;
        };
        Some(Motor { motion, axis, position, velocity, spring, max_force })
    }

    /// Whether it turns the bodies of a hinge by a torque that does not depend on masses: a motor, friction,
    /// a spring.
    pub(crate) fn drives_hinge(&self) -> bool {
        self.motion == Motion::Angular
            && self.is_guided()
            && matches!(self.kind, RowKind::Motor { spring, .. } if !spring.coefficients().per_mass)
    }

    /// Whether the joint's locks leave its bodies only the motion along or about it: a slide in a direction
    /// that can't turn, and motors of a hinge.
    pub(crate) fn is_guided(&self) -> bool {
        let may = self.motion == Motion::Linear || matches!(self.kind, RowKind::Motor { .. });
        may && is_guided(self.motion, self.axes, self.beside[1])
    }
}

/// Whether the rotations that a joint locks leave its bodies only the motion along or about axes, in a
/// direction that can't turn.
pub(crate) fn is_guided(motion: Motion, axes: Axes, turns: Option<LockKind>) -> bool {
    match (motion, axes, turns) {
        (Motion::Linear, Axes::One(_), turns) => turns.is_some(),
        (Motion::Angular, Axes::One(axis), Some(LockKind::Hinge(about))) => axis == about,
        _ => false,
    }
}

impl Joints {
    pub(super) fn add_rows(&mut self, joint: u32, limits: &[Limit], drives: &[Motor]) {
        let limits = locked_together(limits);
        self.all[joint as usize].start = [self.locks.len() as u32, self.rows.len() as u32];
        self.fresh += limits.len() + drives.len();
        let locks = || limits.iter().filter_map(|(limit, _)| limit.locked());
        let beside = [locks().find(|kind| !kind.turns()), locks().find(|kind| kind.turns())];
        for (limit, merged) in &limits {
            if let Some(kind) = limit.locked() {
                self.locks.push(Lock::new(joint, kind, *merged));
            } else if !limit.is_endless() {
                self.rows.push(Row::new(joint, limit.motion, limit.axes, limit.kind(), beside));
            }
        }
        for drive in drives {
            self.rows.push(Row::new(joint, drive.motion, Axes::One(drive.axis), drive.kind(), beside));
        }
    }

    /// Replaces limits and motors. Rows that keep their kind keep their impulses, and all have the place that
    /// the joint had: the order of joints, in which rows are solved, does not depend on which of them were
    /// changed.
    pub(crate) fn replace_rows(&mut self, joint: u32, limits: &[Limit], drives: &[Motor]) {
        let (own_locks, own_rows) = (self.lock_range(joint), self.row_range(joint));
        let mut locks: Vec<Lock> = self.locks.drain(own_locks.clone()).collect();
        let mut rows: Vec<Row> = self.rows.drain(own_rows.clone()).collect();
        let others = [self.locks.len(), self.rows.len()];
        self.add_rows(joint, limits, drives);
        if !own_locks.is_empty() {
            let added = self.locks.len() - others[0];
            self.locks[own_locks.start..].rotate_right(added);
        }
        if !own_rows.is_empty() {
            let added = self.rows.len() - others[1];
            self.rows[own_rows.start..].rotate_right(added);
        }
        self.find_starts();
        let [new_locks, new_rows] = [self.lock_range(joint), self.row_range(joint)];
        for new in &mut self.locks[new_locks] {
            let old = locks.iter().position(|old| old.kind == new.kind).map(|i| locks.remove(i));
            if let Some(old) = old {
                *new = Lock { merged: new.merged, ..old };
            }
        }
        for new in &mut self.rows[new_rows] {
            let alike =
                |old: &Row| (old.motion, old.axes) == (new.motion, new.axes) && old.kind.is_alike(&new.kind);
            let old = rows.iter().position(alike).map(|i| rows.remove(i));
            if let Some(old) = old {
                (new.impulse, new.lasting_impulse) = (old.impulse, old.lasting_impulse);
                new.turned = if new.counts_turns() { old.turned } else { f32::INFINITY };
            }
        }
        // The load of a joint without rows is not measured any more.
        let joint = &mut self.all[joint as usize];
        (joint.force, joint.torque) = (Vec3::ZERO, Vec3::ZERO);
        self.changed = true;
    }

    /// Finds the first lock and row of each joint again, after some went or all came anew.
    pub(in crate::joint) fn find_starts(&mut self) {
        let Joints { all, locks, rows, .. } = self;
        all.iter_mut().for_each(|joint| joint.start = [NONE; 2]);
        for (i, lock) in locks.iter().enumerate().rev() {
            all[lock.joint as usize].start[0] = i as u32;
        }
        for (i, row) in rows.iter().enumerate().rev() {
            all[row.joint as usize].start[1] = i as u32;
        }
    }

    /// The locks of a joint.
    fn lock_range(&self, joint: u32) -> Range<usize> {
        let start = self.all[joint as usize].start[0] as usize;
        let own = self.locks.iter().skip(start).take_while(|lock| lock.joint == joint).count();
        if own == 0 { 0..0 } else { start..start + own }
    }

    /// The locks of a joint: of its point, and of its rotation.
    pub(crate) fn locked_by(&self, joint: u32) -> [Option<LockKind>; 2] {
        let kinds = || self.locks[self.lock_range(joint)].iter().map(|lock| lock.kind);
        [kinds().find(|kind| !kind.turns()), kinds().find(|kind| kind.turns())]
    }

    /// The rows of a joint.
    pub(crate) fn row_range(&self, joint: u32) -> Range<usize> {
        let start = self.all[joint as usize].start[1] as usize;
        let own = self.rows.iter().skip(start).take_while(|row| row.joint == joint).count();
        if own == 0 { 0..0 } else { start..start + own }
    }

    /// Forgets in which turn a joint is.
    pub(crate) fn forget_turns(&mut self, joint: u32) {
        let own = self.row_range(joint);
        self.rows[own].iter_mut().for_each(|row| row.turned = f32::INFINITY);
    }

    /// An angle about an axis of a joint with the whole turns that the limit of its hinge knows.
    pub(crate) fn with_turns(&self, joint: u32, axes: Axes, angle: f32) -> Option<f32> {
        let rows = &self.rows[self.row_range(joint)];
        let limit = rows.iter().find(|row| row.counts_turns() && row.axes == axes)?;
        Some(limit.with_turns(angle))
    }

    /// The limits of a joint: locks of more than one direction, then the others, each as they were given.
    pub(crate) fn limits_of(&self, joint: u32) -> impl Iterator<Item = Limit> + '_ {
        let locks = self.locks[self.lock_range(joint)].iter().flat_map(Lock::limits);
        locks.chain(self.rows[self.row_range(joint)].iter().filter_map(Row::limit))
    }

    /// The motors of a joint, as they were given.
    pub(crate) fn drives_of(&self, joint: u32) -> impl Iterator<Item = Motor> + '_ {
        self.rows[self.row_range(joint)].iter().filter_map(Row::drive)
    }

    /// The row of the first motor of a motion along or about an axis.
    pub(crate) fn drive_row(&self, joint: u32, motion: Motion, axis: Axis) -> Option<usize> {
        let wanted =
            |row: &Row| matches!(row.kind, RowKind::Motor { .. }) && is_of(row, motion, Axes::One(axis));
        self.row_range(joint).find(|&i| wanted(&self.rows[i]))
    }

    /// The row of the first limit of a motion, unless it locks more than one direction.
    pub(crate) fn limit_row(&self, joint: u32, motion: Motion, axes: Axes) -> Option<usize> {
        let wanted = |row: &Row| !matches!(row.kind, RowKind::Motor { .. }) && is_of(row, motion, axes);
        self.row_range(joint).find(|&i| wanted(&self.rows[i]))
    }
}

fn is_of(row: &Row, motion: Motion, axes: Axes) -> bool {
    (row.motion, row.axes) == (motion, axes)
}

/// Locks of single axes as the one lock that they make: solved as a block they hold better, and two of
/// rotation have no half turn at which each of them for itself has no direction. With each: whether it stands
/// for locks of single axes.
pub(super) fn locked_together(limits: &[Limit]) -> Vec<(Limit, bool)> {
    let mut out = Vec::with_capacity(limits.len());
    let mut locked = [[false; 3]; 2];
    for limit in limits {
        match limit.axes {
            Axes::One(axis) if limit.locks() => locked[limit.motion as usize][axis as usize] = true,
            _ => out.push((*limit, false)),
        }
    }
    for motion in [Motion::Linear, Motion::Angular] {
        let locked = locked[motion as usize];
        let axes = |wanted: bool| Axis::ALL.into_iter().filter(move |&axis| locked[axis as usize] == wanted);
        out.extend(match (axes(true).count(), axes(true).next(), axes(false).next()) {
            (1, Some(axis), _) => Some((Limit::lock(motion, Axes::One(axis)), false)),
            (2, _, Some(axis)) => Some((Limit::lock(motion, Axes::Perpendicular(axis)), true)),
            (3, ..) => Some((Limit::lock(motion, Axes::All), true)),
            _ => None,
        });
    }
    out
}
