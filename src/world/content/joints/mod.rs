//! Joints of the world: add, remove, look up; changed, read and coupled in files of their own.

mod changes;
mod couplings;
mod readings;

use crate::body::{BodyDetails, BodyKind};
use crate::error::{Error, each};
use crate::handle::{BodyHandle, JointHandle};
use crate::joint::{Frame, JointAdditions, JointDesc, JointEvent, JointFrame};
use crate::math::Quat;
use crate::world::{Addition, Change, World};
use glam::{DVec3, Vec3};

/// # Joints
impl World {
    /// Adds a joint.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// # let frames = world.frames_about([ground, body], DVec3::Y * 2.0, Vec3::Z)?;
    /// let desc = JointDesc::hinge([ground, body], frames).with_motor(Motor::velocity(
    ///     Motion::Angular,
    ///     Axis::X,
    ///     2.0,
    ///     1e6,
    /// ));
    /// let hinge = world.add_joint(&desc)?;
    /// world.step(1.0 / 60.0)?;
    /// assert!((world.joint_velocity(hinge, Motion::Angular, Axis::X)? - 2.0).abs() < 1e-3);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If a handle is stale, a number is out of range, both bodies are the same or neither is dynamic, or the
    /// budget does not allow it.
    pub fn add_joint(&mut self, desc: &JointDesc) -> Result<JointHandle, Error> {
        self.check_joint(desc)?;
        self.reserve(Addition::Joints(JointAdditions::of_joint(desc), true))?;
        self.note(Change::AddJoint(desc));
        Ok(self.insert_joint(desc))
    }

    /// Adds many joints: all of them, or none.
    ///
    /// # Errors
    /// As for [`World::add_joint`], and which of several it is ([`Error::One`]).
    pub fn add_joints(&mut self, descs: &[JointDesc]) -> Result<Vec<JointHandle>, Error> {
        if descs.is_empty() {
            return Ok(Vec::new());
        }
        each("joint", descs, |desc| self.check_joint(desc))?;
        let more =
            descs.iter().map(JointAdditions::of_joint).fold(JointAdditions::default(), JointAdditions::and);
        self.reserve(Addition::Joints(more, false))?;
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
        let frames = self.own_frames(bodies, &desc.frames);
        self.revisions.moving += 1;
        let joint = self.joints.add(desc, frames);
        self.look_up_pairs_of(bodies[0]);
        joint
    }

    /// Frames as the columns have them: from centres of mass, in principal axes. `bodies`: dense indices.
    pub(super) fn own_frames(&self, bodies: [usize; 2], frames: &[Frame; 2]) -> [JointFrame; 2] {
        [0, 1].map(|side| {
            let (details, frame) = (&self.bodies.details[bodies[side]], &frames[side]);
            JointFrame {
                position: details.axes.conjugate() * (frame.position - details.centre),
                rotation: (details.axes.conjugate() * Quat::from(frame.rotation).normalize()).normalize(),
            }
        })
    }

    /// Frames on two bodies that coincide at the bodies' current poses: at a point of the world, with the
    /// axes that a rotation gives x, y and z.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let frames = world.frames_at([ground, body], DVec3::Y * 2.5, Quat::IDENTITY)?;
    /// let ball_joint = world.add_joint(&JointDesc::ball([ground, body], frames))?;
    /// # Ok::<(), Error>(())
    /// ```
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
        let rotation = crate::limits::unit_quat("rotation", rotation)?;
        let mut frames = [Frame::default(); 2];
        for (frame, body) in frames.iter_mut().zip(bodies) {
            let (at, back) = (self.position(body)?, Quat::from(self.rotation(body)?).conjugate());
            let rotation = (back * rotation).normalize().into();
            *frame = Frame { position: back * (point - at).as_vec3(), rotation };
        }
        Ok(frames)
    }

    /// Frames of a joint of two bodies at a point of the world [m] whose x axes are along an axis of the
    /// world, of any length: a hinge turns about it, a slider slides along it.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let post = world.add_body(&BodyDesc::fixed())?;
    /// # let panel = ShapeDesc::new(Geometry::cuboid(0.5, 1.0, 0.02));
    /// # let door = world.add_body(&BodyDesc::dynamic().with_position(Vec3::X * 0.5).with_shape(panel))?;
    /// let frames = world.frames_about([post, door], DVec3::ZERO, Vec3::Y)?;
    /// let hinge = world.add_joint(&JointDesc::hinge([post, door], frames))?;
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If a handle is stale, the point is out of range, or the axis is zero or not finite.
    pub fn frames_about(
        &self,
        bodies: [BodyHandle; 2],
        point: DVec3,
        axis: Vec3,
    ) -> Result<[Frame; 2], Error> {
        let axis = crate::limits::direction("axis", axis)?;
        self.frames_at(bodies, point, Quat::from_rotation_arc(Vec3::X, axis).into())
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

    /// Number of joints.
    pub fn joint_count(&self) -> usize {
        self.joints.count
    }

    /// Whether the handle is not stale.
    pub fn contains_joint(&self, joint: JointHandle) -> bool {
        self.joint(joint).is_ok()
    }

    /// The joints of a body, the last that was added first.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joints_of(&self, body: BodyHandle) -> Result<impl Iterator<Item = JointHandle> + '_, Error> {
        self.index(body)?;
        Ok(self.joints.of_body(body.slot).map(|slot| self.joint_handle(slot)))
    }

    /// Joints that broke in the last step. Their handles are stale.
    pub fn broken_joints(&self) -> &[JointHandle] {
        &self.joints.broken
    }

    /// Joints that bore more than one of their thresholds in the last step, in the order of their handles'
    /// slots. Only those that ask for it are looked at ([`JointDesc::with_thresholds`]), and of those none
    /// that sleep or that broke in that step.
    pub fn strained_joints(&self) -> &[JointEvent] {
        &self.joints.strained
    }

    fn joint_handle(&self, slot: u32) -> JointHandle {
        JointHandle { slot, generation: self.joints.slots.generation(slot) }
    }

    pub(super) fn joint(&self, joint: JointHandle) -> Result<u32, Error> {
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
                self.joints.broken.push(self.joint_handle(slot));
                self.drop_joint(slot);
            }
        }
    }

    /// Lists the joints that bear more than they may without being reported.
    pub(crate) fn list_strained_joints(&mut self) {
        for slot in 0..self.joints.all.len() as u32 {
            let joint = &self.joints.all[slot as usize];
            let awake = |&body: &u32| (self.bodies.slots.dense(body) as usize) < self.bodies.dynamic();
            if joint.is_there() && joint.is_strained() && joint.bodies.iter().any(awake) {
                let (force, torque) = (joint.force, joint.torque);
                self.joints.strained.push(JointEvent { joint: self.joint_handle(slot), force, torque });
            }
        }
    }

    pub(super) fn wake_joined(&mut self, slots: [u32; 2]) {
        for slot in slots {
            self.wake_body(self.bodies.slots.dense(slot) as usize);
        }
    }

    /// Has the pairs of a body searched for again: joints decide which bodies collide.
    pub(super) fn look_up_pairs_of(&mut self, body: usize) {
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
