//! Changes of joints while a world runs.
//!
//! Where the rows of a joint keep their kind, and so their places in the batches, a change writes numbers in
//! place: nothing is arranged again, nothing is allocated, and impulses are warm-started as before. Other
//! changes replace the rows of the joint, and rows that keep their kind keep their impulses too.

use crate::config::RowGroup;
use crate::constraint::arranged_alike;
use crate::error::Error;
use crate::handle::JointHandle;
use crate::joint::{
    Axes, Axis, Frame, JointAdditions, Limit, Motion, Motor, Row, RowKind, STRENGTH, THRESHOLD, check_loads,
};
use crate::world::{Addition, Change, World};

/// # Joints: limits, motors, frames
impl World {
    /// Sets a motor of a joint: it replaces the first of the same motion and axis, or is added. A target that
    /// changes is cheaper set by [`World::set_joint_target`]; an equal motor wakes no body.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// # let frames = world.frames_about([ground, body], DVec3::Y * 2.0, Vec3::Z)?;
    /// let hinge = world.add_joint(&JointDesc::hinge([ground, body], frames))?;
    /// world.set_joint_motor(hinge, Motor::velocity(Motion::Angular, Axis::X, 1.0, 500.0))?;
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, a number out of range, or the budget does not allow it.
    pub fn set_joint_motor(&mut self, joint: JointHandle, drive: Motor) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        drive.validate()?;
        let row = self.joints.drive_row(slot, drive.motion, drive.axis);
        let change = Change::SetJointMotor(joint, drive);
        if row.is_some_and(|row| self.change_row(slot, row, drive.kind(), change)) {
            return Ok(());
        }
        let same = |other: &Motor| (other.motion, other.axis) == (drive.motion, drive.axis);
        let (limits, mut drives) = self.rows_of(slot);
        match drives.iter_mut().find(|other| same(other)) {
            Some(other) => *other = drive,
            None => drives.push(drive),
        }
        self.replace_joint_rows(slot, &limits, &drives, change)
    }

    /// Removes the motors of a joint along or about an axis. Returns whether there was any.
    ///
    /// # Errors
    /// If the handle is stale, or the budget does not allow the rows of the joint to be arranged again.
    pub fn remove_joint_motor(
        &mut self,
        joint: JointHandle,
        motion: Motion,
        axis: Axis,
    ) -> Result<bool, Error> {
        let slot = self.joint(joint)?;
        let (limits, mut drives) = self.rows_of(slot);
        let before = drives.len();
        drives.retain(|drive| (drive.motion, drive.axis) != (motion, axis));
        if drives.len() == before {
            return Ok(false);
        }
        self.replace_joint_rows(slot, &limits, &drives, Change::RemoveJointMotor(joint, motion, axis))?;
        Ok(true)
    }

    /// Sets the target of a motor that the joint has, the first of this motion and axis: a position [m] or
    /// [rad] and a velocity [m/s] or [rad/s]. Meant for targets that change in every step: it costs no more
    /// than looking up the row. An equal target wakes no body.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// # let frames = world.frames_about([ground, body], DVec3::Y * 2.0, Vec3::Z)?;
    /// let spring = Spring::Frequency { hertz: 3.0, ratio: 1.0 };
    /// let desc = JointDesc::hinge([ground, body], frames);
    /// let motor = Motor::position(Motion::Angular, Axis::X, 0.0, spring);
    /// let servo = world.add_joint(&desc.with_motor(motor))?;
    /// world.set_joint_target(servo, Motion::Angular, Axis::X, 0.5, 0.0)?;
    /// for _ in 0..120 {
    ///     world.step(1.0 / 60.0)?;
    /// }
    /// assert!((world.joint_position(servo, Motion::Angular, Axes::One(Axis::X))? - 0.5).abs() < 0.05);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, a number is out of range, or there is no such motor ([`Error::NoMotor`]).
    pub fn set_joint_target(
        &mut self,
        joint: JointHandle,
        motion: Motion,
        axis: Axis,
        position: f32,
        velocity: f32,
    ) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        let row = self.joints.drive_row(slot, motion, axis).ok_or(Error::NoMotor)?;
        let drive = self.joints.rows[row].drive().ok_or(Error::NoMotor)?.with_target(position, velocity);
        drive.validate()?;
        let change = Change::SetJointTarget(joint, motion, axis, [position, velocity]);
        self.change_row(slot, row, drive.kind(), change);
        Ok(())
    }

    /// Sets a limit of a joint: it replaces the first of the same motion and axes, or is added. A limit from
    /// minus infinity to infinity is taken away. An equal limit wakes no body.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// # let frames = world.frames_about([ground, body], DVec3::Y * 2.0, Vec3::Z)?;
    /// let door = world.add_joint(&JointDesc::hinge([ground, body], frames))?;
    /// world.set_joint_limit(door, Limit::new(Motion::Angular, Axes::One(Axis::X), -1.5, 0.0))?;
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, a number out of range, or the budget does not allow it.
    pub fn set_joint_limit(&mut self, joint: JointHandle, limit: Limit) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        limit.validate()?;
        let same = |other: &Limit| (other.motion, other.axes) == (limit.motion, limit.axes);
        let old = self.joints.limits_of(slot).find(same);
        if old == Some(limit) || (old.is_none() && limit.is_endless()) {
            return Ok(());
        }
        let change = Change::SetJointLimit(joint, limit);
        let row = self.joints.limit_row(slot, limit.motion, limit.axes);
        // A lock is solved as a block with others.
        let row = row.filter(|_| !limit.locks() && !limit.is_endless());
        if row.is_some_and(|row| self.change_row(slot, row, limit.kind(), change)) {
            return Ok(());
        }
        let (mut limits, drives) = self.rows_of(slot);
        match limits.iter_mut().find(|other| same(other)) {
            Some(other) => *other = limit,
            None => limits.push(limit),
        }
        self.replace_joint_rows(slot, &limits, &drives, change)
    }

    /// Removes the limits of a joint on a motion along or about axes, locks included. Returns whether there
    /// was any.
    ///
    /// # Errors
    /// If the handle is stale, or the budget does not allow the rows of the joint to be arranged again.
    pub fn remove_joint_limit(
        &mut self,
        joint: JointHandle,
        motion: Motion,
        axes: Axes,
    ) -> Result<bool, Error> {
        let slot = self.joint(joint)?;
        let (mut limits, drives) = self.rows_of(slot);
        let before = limits.len();
        limits.retain(|limit| (limit.motion, limit.axes) != (motion, axes));
        if limits.len() == before {
            return Ok(false);
        }
        self.replace_joint_rows(slot, &limits, &drives, Change::RemoveJointLimit(joint, motion, axes))?;
        Ok(true)
    }

    /// Replaces all limits of a joint, locks included; its motors stay. Here and below, a value equal to the
    /// present one changes nothing and wakes no body.
    ///
    /// # Errors
    /// If the handle is stale, a number out of range, or the budget does not allow it.
    pub fn set_joint_limits(&mut self, joint: JointHandle, limits: &[Limit]) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        limits.iter().try_for_each(Limit::validate)?;
        let (old, drives) = self.rows_of(slot);
        if old == limits {
            return Ok(());
        }
        self.replace_joint_rows(slot, limits, &drives, Change::SetJointLimits(joint, limits))
    }

    /// Replaces all motors of a joint; its limits stay.
    ///
    /// # Errors
    /// If the handle is stale, a number out of range, or the budget does not allow it.
    pub fn set_joint_motors(&mut self, joint: JointHandle, drives: &[Motor]) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        drives.iter().try_for_each(Motor::validate)?;
        let (limits, old) = self.rows_of(slot);
        if old == drives {
            return Ok(());
        }
        self.replace_joint_rows(slot, &limits, drives, Change::SetJointMotors(joint, drives))
    }

    /// Moves a joint on its bodies. Bodies stay where they are: the next steps close the gap.
    ///
    /// # Errors
    /// If the handle is stale or a number out of range.
    pub fn set_joint_frames(&mut self, joint: JointHandle, frames: [Frame; 2]) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        frames.iter().try_for_each(Frame::validate)?;
        if self.joint_local_frames(joint)? == frames {
            return Ok(());
        }
        self.note(Change::SetJointFrames(joint, frames));
        self.wake_joined(self.joints.all[slot as usize].bodies);
        self.revisions.moving += 1;
        let bodies = self.dense_bodies(&self.joints.all[slot as usize]);
        self.joints.all[slot as usize].frames = self.own_frames(bodies, &frames);
        self.joints.forget_turns(slot);
        Ok(())
    }

    /// Sets whether the two bodies of a joint may collide with each other.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_joint_collide(&mut self, joint: JointHandle, collide: bool) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        if self.joints.all[slot as usize].collide == collide {
            return Ok(());
        }
        self.note(Change::SetJointCollide(joint, collide));
        let bodies = self.joints.all[slot as usize].bodies;
        self.wake_joined(bodies);
        self.revisions.moving += 1;
        self.joints.all[slot as usize].collide = collide;
        // Whether it is in a tree depends on it.
        self.joints.changed = true;
        self.look_up_pairs_of(self.bodies.slots.dense(bodies[0]) as usize);
        Ok(())
    }

    /// Sets the force [N] and the torque [N m] above which a joint breaks; infinity for never. An equal one
    /// wakes no body.
    ///
    /// # Errors
    /// If the handle is stale, a number is not at least zero, or the budget does not allow it.
    pub fn set_joint_break_force(
        &mut self,
        joint: JointHandle,
        force: f32,
        torque: f32,
    ) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        check_loads(STRENGTH, [force, torque])?;
        if self.joints.all[slot as usize].strength == [force, torque] {
            return Ok(());
        }
        let never = [f32::INFINITY; 2];
        self.reserve(Addition::Joints(JointAdditions::of_events([force, torque], never), false))?;
        self.note(Change::SetJointBreakForce(joint, [force, torque]));
        self.wake_joined(self.joints.all[slot as usize].bodies);
        self.revisions.moving += 1;
        self.joints.set_strength(slot, [force, torque]);
        Ok(())
    }

    /// Sets the force [N] and the torque [N m] above which a joint is among [`World::strained_joints`];
    /// infinity for never.
    ///
    /// # Errors
    /// If the handle is stale, a number is not at least zero, or the budget does not allow it.
    pub fn set_joint_thresholds(&mut self, joint: JointHandle, force: f32, torque: f32) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        check_loads(THRESHOLD, [force, torque])?;
        let never = [f32::INFINITY; 2];
        self.reserve(Addition::Joints(JointAdditions::of_events(never, [force, torque]), false))?;
        self.note(Change::SetJointThresholds(joint, [force, torque]));
        self.revisions.moving += 1;
        self.joints.set_threshold(slot, [force, torque]);
        Ok(())
    }

    /// Sets the caller's number of a joint.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_joint_user_data(&mut self, joint: JointHandle, user_data: u64) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        self.note(Change::SetJointUserData(joint, user_data));
        self.revisions.moving += 1;
        self.joints.all[slot as usize].user_data = user_data;
        Ok(())
    }

    /// Has the rows of a joint solved right after those of a group, or in their own place again; see
    /// [`JointDesc::solved_after`].
    ///
    /// [`JointDesc::solved_after`]: crate::JointDesc::solved_after
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_joint_solved_after(
        &mut self,
        joint: JointHandle,
        above: Option<RowGroup>,
    ) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        if self.joints.all[slot as usize].solved_after == above {
            return Ok(());
        }
        self.note(Change::SetJointSolvedAfter(joint, above));
        self.revisions.moving += 1;
        self.joints.all[slot as usize].solved_after = above;
        self.joints.changed = true;
        Ok(())
    }

    /// Changes the numbers of a row of a joint. Returns whether it could: a row that has its place elsewhere
    /// then has to be arranged again.
    fn change_row(&mut self, joint: u32, row: usize, kind: RowKind, change: Change<'_>) -> bool {
        let old = self.joints.rows[row];
        if !arranged_alike(&old, &Row { kind, ..old }) {
            return false;
        }
        if old.kind == kind {
            return true;
        }
        self.note(change);
        self.wake_joined(self.joints.all[joint as usize].bodies);
        // Ends are part of the state that each snapshot has.
        self.revisions.moving += u64::from(old.kind.with_ends(kind.ends()) != kind);
        self.joints.rows[row].kind = kind;
        true
    }

    /// The rows that an angular motor about an axis, or its removal, makes anew if up to so many come to a
    /// joint.
    pub(in crate::world) fn more_for_drive(
        &self,
        joint: u32,
        axis: Axis,
        drive: Option<Motor>,
        most: usize,
    ) -> JointAdditions {
        let old = self.joints.drive_row(joint, Motion::Angular, axis).map(|row| self.joints.rows[row]);
        match (old, drive) {
            (None, None) => return JointAdditions::default(),
            (Some(old), Some(drive)) if arranged_alike(&old, &Row { kind: drive.kind(), ..old }) => {
                return JointAdditions::default();
            }
            _ => {}
        }
        let (limits, mut drives) = self.rows_of(joint);
        drives.extend(drive.map(|drive| vec![drive; most]).into_iter().flatten());
        JointAdditions::of(&limits, &drives)
    }

    fn rows_of(&self, joint: u32) -> (Vec<Limit>, Vec<Motor>) {
        (self.joints.limits_of(joint).collect(), self.joints.drives_of(joint).collect())
    }

    fn replace_joint_rows(
        &mut self,
        joint: u32,
        limits: &[Limit],
        drives: &[Motor],
        change: Change<'_>,
    ) -> Result<(), Error> {
        self.reserve(Addition::Joints(JointAdditions::of(limits, drives), true))?;
        self.note(change);
        self.wake_joined(self.joints.all[joint as usize].bodies);
        self.revisions.moving += 1;
        self.joints.replace_rows(joint, limits, drives);
        Ok(())
    }
}

#[cfg(test)]
#[path = "changes_tests.rs"]
mod tests;
