//! Readings of joints: descriptions, positions, loads.

use crate::error::Error;
use crate::handle::{BodyHandle, JointHandle};
use crate::joint::{Axes, Axis, Frame, Joint, Limit, Motion, Motor, Placed};
use crate::world::World;
use glam::{DVec3, Vec3};

/// # Joints: positions and loads
impl World {
    /// The two bodies of a joint.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_bodies(&self, joint: JointHandle) -> Result<[BodyHandle; 2], Error> {
        let bodies = self.joint_of(joint)?.bodies;
        Ok(bodies.map(|slot| BodyHandle { slot, generation: self.bodies.slots.generation(slot) }))
    }

    /// The limits of a joint, locks included: first those that lock more than one direction, then the others.
    /// A limit that restricts nothing, from minus infinity to infinity, is not kept, and of locks of the same
    /// single axis one is.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_limits(&self, joint: JointHandle) -> Result<impl Iterator<Item = Limit> + '_, Error> {
        Ok(self.joints.limits_of(self.joint(joint)?))
    }

    /// The motors of a joint, in the order in which they were given.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_motors(&self, joint: JointHandle) -> Result<impl Iterator<Item = Motor> + '_, Error> {
        Ok(self.joints.drives_of(self.joint(joint)?))
    }

    /// How far the second frame of a joint is from the first, the quantity that a limit of the same motion
    /// and axes restricts [m] or [rad]. The angle of a hinge with a limit has its whole turns, counted from
    /// the first step on. Any other twist about one axis is in `-pi..=pi`; limits and motors take it with the
    /// whole turns that bring it nearest to the middle of the range or to the target.
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
    /// let angle = world.joint_position(hinge, Motion::Angular, Axes::One(Axis::X))?;
    /// assert!(angle.abs() < 1e-6);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_position(&self, joint: JointHandle, motion: Motion, axes: Axes) -> Result<f32, Error> {
        let slot = self.joint(joint)?;
        let displacement = self.placed(self.joint_of(joint)?).displacement(motion, axes);
        let turns = motion == Motion::Angular && matches!(axes, Axes::One(_));
        let known = if turns { self.joints.with_turns(slot, axes, displacement) } else { None };
        Ok(known.unwrap_or(displacement))
    }

    /// How fast the displacement along an axis, or the twist about it, grows [m/s] or [rad/s], the quantity
    /// that a motor of the same motion and axis brings to its target velocity. It is the second body's
    /// velocity as seen from the first, whose axes turn with it.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_velocity(&self, joint: JointHandle, motion: Motion, axis: Axis) -> Result<f32, Error> {
        let joint = self.joint_of(joint)?;
        let velocity = self.dense_bodies(joint).map(|body| self.bodies.velocity[body]);
        Ok(self.placed(joint).speed(motion, axis, velocity))
    }

    /// Force [N] and torque [N m] of a joint on its second body in the last substep, in world axes; the first
    /// body gets the opposite. The torque is about the joint.
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
    /// world.step(1.0 / 60.0)?;
    /// let (force, _torque) = world.joint_force(hinge)?;
    /// let weight = 9.81 * world.mass(body)?;
    /// assert!((force.length() - weight).abs() < 0.01 * weight);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_force(&self, joint: JointHandle) -> Result<(Vec3, Vec3), Error> {
        let joint = self.joint_of(joint)?;
        Ok((joint.force, joint.torque))
    }

    /// Poses of a joint's two frames in the world: their origins [m] and the rotations of their axes.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_frames(&self, joint: JointHandle) -> Result<[(DVec3, glam::Quat); 2], Error> {
        let joint = self.joint_of(joint)?;
        let bodies = self.dense_bodies(joint);
        Ok([0, 1].map(|side| {
            let (pose, frame) = (&self.bodies.pose[bodies[side]], &joint.frames[side]);
            (
                pose.position + (pose.rotation * frame.position).as_dvec3(),
                (pose.rotation * frame.rotation).into(),
            )
        }))
    }

    /// A joint's two frames on its bodies, in their axes and from their origins, as [`JointDesc::frames`] and
    /// [`World::set_joint_frames`] have them, to rounding.
    ///
    /// [`JointDesc::frames`]: crate::JointDesc::frames
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_local_frames(&self, joint: JointHandle) -> Result<[Frame; 2], Error> {
        let joint = self.joint_of(joint)?;
        let bodies = self.dense_bodies(joint);
        Ok([0, 1].map(|side| {
            let (details, frame) = (&self.bodies.details[bodies[side]], &joint.frames[side]);
            Frame {
                position: details.centre + details.axes * frame.position,
                rotation: (details.axes * frame.rotation).into(),
            }
        }))
    }

    /// Whether the two bodies of a joint may collide with each other. If several join them, all must allow
    /// it.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_collide(&self, joint: JointHandle) -> Result<bool, Error> {
        Ok(self.joint_of(joint)?.collide)
    }

    /// Force [N] and torque [N m] above which a joint breaks; infinite if it does not.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_break_force(&self, joint: JointHandle) -> Result<(f32, f32), Error> {
        let [force, torque] = self.joint_of(joint)?.strength;
        Ok((force, torque))
    }

    /// Force [N] and torque [N m] above which a joint is among [`World::strained_joints`]; infinite if it
    /// never is.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_thresholds(&self, joint: JointHandle) -> Result<(f32, f32), Error> {
        let [force, torque] = self.joint_of(joint)?.threshold;
        Ok((force, torque))
    }

    /// The caller's number of a joint.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn joint_user_data(&self, joint: JointHandle) -> Result<u64, Error> {
        Ok(self.joint_of(joint)?.user_data)
    }

    fn joint_of(&self, joint: JointHandle) -> Result<&Joint, Error> {
        Ok(&self.joints.all[self.joint(joint)? as usize])
    }

    pub(super) fn dense_bodies(&self, joint: &Joint) -> [usize; 2] {
        joint.bodies.map(|slot| self.bodies.slots.dense(slot) as usize)
    }

    fn placed(&self, joint: &Joint) -> Placed {
        Placed::new(self.dense_bodies(joint).map(|body| &self.bodies.pose[body]), &joint.frames)
    }
}
