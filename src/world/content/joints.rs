//! Joints of the world: add, remove, change, look up.

use crate::body::{BodyDetails, BodyKind};
use crate::config::RowGroup;
use crate::error::Error;
use crate::handle::{BodyHandle, JointHandle};
use crate::joint::{Drive, Frame, JointAdditions, JointDesc, JointFrame, Limit};
use crate::math::Quat;
use crate::world::{Change, World};
use glam::{DVec3, Vec3};

impl World {
    /// Adds a joint.
    ///
    /// # Errors
    /// If a handle is stale, a number is out of range, both bodies are the same or neither is dynamic, or the
    /// budget does not allow it.
    pub fn add_joint(&mut self, desc: &JointDesc) -> Result<JointHandle, Error> {
        self.check_joint(desc)?;
        self.reserve_for_joints(JointAdditions::of_joint(desc), true)?;
        self.note(Change::AddJoint(desc));
        Ok(self.insert_joint(desc))
    }

    /// Adds many joints: all of them, or none.
    ///
    /// # Errors
    /// As for [`World::add_joint`].
    pub fn add_joints(&mut self, descs: &[JointDesc]) -> Result<Vec<JointHandle>, Error> {
        if descs.is_empty() {
            return Ok(Vec::new());
        }
        descs.iter().try_for_each(|desc| self.check_joint(desc))?;
        let more =
            descs.iter().map(JointAdditions::of_joint).fold(JointAdditions::default(), JointAdditions::and);
        self.reserve_for_joints(more, false)?;
        self.note(Change::AddJoints(descs));
        self.joints.reserve_total(more);
        Ok(descs.iter().map(|desc| self.insert_joint(desc)).collect())
    }

    fn check_joint(&self, desc: &JointDesc) -> Result<(), Error> {
        let bodies = [self.index(desc.bodies[0])?, self.index(desc.bodies[1])?];
        desc.validate()?;
        if bodies.iter().all(|&i| self.bodies.kind[i] != BodyKind::Dynamic) {
            return Err(Error::JointOfStill);
        }
        Ok(())
    }

    fn insert_joint(&mut self, desc: &JointDesc) -> JointHandle {
        self.wake_joined(desc.bodies.map(|body| body.slot));
        let bodies = desc.bodies.map(|body| self.bodies.slots.dense(body.slot) as usize);
        let frames = [0, 1].map(|side| {
            let (details, frame) = (&self.bodies.details[bodies[side]], &desc.frames[side]);
            JointFrame {
                position: details.axes.conjugate() * (frame.position - details.centre),
                rotation: (details.axes.conjugate() * Quat::from(frame.rotation).normalize()).normalize(),
            }
        });
        self.revisions.moving += 1;
        let joint = self.joints.add(desc, frames);
        self.look_up_pairs_of(bodies[0]);
        joint
    }

    /// Frames on two bodies that coincide at the bodies' current poses: at a point of the world, with the
    /// axes that a rotation gives x, y and z.
    ///
    /// # Errors
    /// If a handle is stale or a number not finite.
    pub fn frames_at(
        &self,
        bodies: [BodyHandle; 2],
        point: DVec3,
        rotation: glam::Quat,
    ) -> Result<[Frame; 2], Error> {
        crate::limits::position(point)?;
        let rotation = crate::shape::unit_quat("rotation", rotation)?;
        let mut frames = [Frame::default(); 2];
        for (frame, body) in frames.iter_mut().zip(bodies) {
            let (at, back) = (self.position(body)?, Quat::from(self.rotation(body)?).conjugate());
            let rotation = (back * rotation).normalize().into();
            *frame = Frame { position: back * (point - at).as_vec3(), rotation };
        }
        Ok(frames)
    }

    /// Removes a joint.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn remove_joint(&mut self, joint: JointHandle) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        self.note(Change::RemoveJoint(joint));
        self.drop_joint(slot);
        Ok(())
    }

    /// Replaces the limits and drives of a joint.
    ///
    /// # Errors
    /// If the handle is stale, a number out of range, or the budget does not allow it.
    pub fn set_joint(&mut self, joint: JointHandle, limits: &[Limit], drives: &[Drive]) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        limits.iter().try_for_each(Limit::validate)?;
        drives.iter().try_for_each(Drive::validate)?;
        self.reserve_for_joints(JointAdditions::of(limits, drives), true)?;
        self.note(Change::SetJoint(joint, limits, drives));
        self.wake_joined(self.joints.all[slot as usize].bodies);
        self.revisions.moving += 1;
        self.joints.replace_rows(slot, limits, drives);
        Ok(())
    }

    /// Has the rows of a joint solved right after those of a group, or in their own place again; see
    /// [`JointDesc::solved_after`].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn solve_joint_after(&mut self, joint: JointHandle, above: Option<RowGroup>) -> Result<(), Error> {
        let slot = self.joint(joint)?;
        self.note(Change::SolveJointAfter(joint, above));
        self.revisions.moving += 1;
        self.joints.all[slot as usize].solved_after = above;
        self.joints.changed = true;
        Ok(())
    }

    /// Number of joints.
    pub fn joint_count(&self) -> usize {
        self.joints.count
    }

    /// Whether the handle is not stale.
    pub fn contains_joint(&self, joint: JointHandle) -> bool {
        self.joint(joint).is_ok()
    }

    /// The two bodies of a joint.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_bodies(&self, joint: JointHandle) -> Result<[BodyHandle; 2], Error> {
        let bodies = self.joints.all[self.joint(joint)? as usize].bodies;
        Ok(bodies.map(|slot| BodyHandle { slot, generation: self.bodies.slots.generation(slot) }))
    }

    /// Force [N] and torque [N m] of a joint on its second body in the last substep, in world axes; the first
    /// body gets the opposite. The torque is about the joint.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_force(&self, joint: JointHandle) -> Result<(Vec3, Vec3), Error> {
        let joint = &self.joints.all[self.joint(joint)? as usize];
        Ok((joint.force, joint.torque))
    }

    /// Poses of a joint's two frames in the world: their origins [m] and the rotations of their axes.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_frames(&self, joint: JointHandle) -> Result<[(DVec3, glam::Quat); 2], Error> {
        let joint = &self.joints.all[self.joint(joint)? as usize];
        Ok([0, 1].map(|side| {
            let pose = &self.bodies.pose[self.bodies.slots.dense(joint.bodies[side]) as usize];
            let frame = &joint.frames[side];
            (
                pose.position + (pose.rotation * frame.position).as_dvec3(),
                (pose.rotation * frame.rotation).into(),
            )
        }))
    }

    /// The caller's number of a joint.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_user_data(&self, joint: JointHandle) -> Result<u64, Error> {
        Ok(self.joints.all[self.joint(joint)? as usize].user_data)
    }

    /// Joints that broke in the last step. Their handles are stale.
    pub fn broken_joints(&self) -> &[JointHandle] {
        &self.joints.broken
    }

    fn joint(&self, joint: JointHandle) -> Result<u32, Error> {
        self.joints.slots.get(joint.slot, joint.generation).ok_or(Error::StaleJoint)
    }

    fn drop_joint(&mut self, slot: u32) {
        let bodies = self.joints.all[slot as usize].bodies;
        self.wake_joined(bodies);
        let body = bodies[0];
        self.revisions.moving += 1;
        self.joints.remove(slot);
        self.look_up_pairs_of(self.bodies.slots.dense(body) as usize);
    }

    pub(in crate::world) fn remove_joints_of(&mut self, body: BodyHandle) {
        while let Some(slot) = { self.joints.of_body(body.slot).next() } {
            self.drop_joint(slot);
        }
    }

    /// Removes the joints whose load exceeded their strength.
    pub(crate) fn break_joints(&mut self) {
        for slot in 0..self.joints.all.len() as u32 {
            let joint = &self.joints.all[slot as usize];
            if joint.is_there() && joint.is_overloaded() {
                let generation = self.joints.slots.generation(slot);
                self.joints.broken.push(JointHandle { slot, generation });
                self.drop_joint(slot);
            }
        }
    }

    fn wake_joined(&mut self, slots: [u32; 2]) {
        for slot in slots {
            self.wake_body(self.bodies.slots.dense(slot) as usize);
        }
    }

    /// Has the pairs of a body searched for again: joints decide which bodies collide.
    fn look_up_pairs_of(&mut self, body: usize) {
        for &c in self.bodies.colliders[body].as_slice() {
            self.broad.touch(c);
        }
    }

    /// Keeps joints in place when a body's centre of mass and axes change.
    pub(in crate::world) fn recentre_joints(&mut self, index: usize, old: &BodyDetails) {
        let (slot, new) = (self.bodies.slot[index], self.bodies.details[index]);
        let own: Vec<u32> = self.joints.of_body(slot).collect();
        for joint in own {
            let joint = &mut self.joints.all[joint as usize];
            let frame = &mut joint.frames[usize::from(joint.bodies[1] == slot)];
            frame.position = new.axes.conjugate() * (old.centre + old.axes * frame.position - new.centre);
            frame.rotation = (new.axes.conjugate() * old.axes * frame.rotation).normalize();
        }
    }
}
