//! Ragdolls of the world: added, and driven to poses.

use crate::body::BodyDesc;
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::joint::{
    Axis, Bone, JointAdditions, JointDesc, Link, Motion, Motor, Ragdoll, Skeleton, Spring, twist_of,
};
use crate::limits::unit_quat;
use crate::math::Quat;
use crate::world::{Addition, World};
use glam::{DVec3, Vec3};

impl Skeleton {
    /// Adds its bodies and joints to a world: all of them, or none.
    ///
    /// # Errors
    /// As for [`Skeleton::validate`], [`World::add_bodies`] and [`World::add_joint`].
    pub fn add_to(
        &self,
        world: &mut World,
        position: DVec3,
        rotation: glam::Quat,
        velocity: Vec3,
    ) -> Result<Ragdoll, Error> {
        self.validate()?;
        let rotation = Quat::from(rotation);
        let descs: Vec<BodyDesc> =
            self.bones.iter().map(|bone| self.body(bone, (position, rotation), velocity)).collect();
        let jointed = || self.bones.iter().enumerate().filter_map(|(i, bone)| Some((i, bone, bone.parent?)));
        // How many rows a joint has does not depend on where it is.
        let nobody = [BodyHandle::from_bits(0); 2];
        let somewhere = |bone| self.joint(bone, JointDesc::ball(nobody, Default::default()));
        let joints: Vec<JointDesc> = jointed().map(|(_, bone, _)| somewhere(bone)).collect();
        world.allow(&descs, &joints, 0)?;
        let bodies = world.add_bodies(&descs)?;
        let joint = |(i, bone, parent): (usize, &Bone, usize)| {
            let (own, point) =
                ([bodies[parent], bodies[i]], position + (rotation * bone.joint_at).as_dvec3());
            let frames = world.frames_at(own, point, (rotation * bone.axes()).normalize().into())?;
            Ok(self.joint(bone, JointDesc::ball(own, frames)))
        };
        let joints = jointed().map(joint).collect::<Result<Vec<JointDesc>, Error>>();
        match joints.and_then(|joints| world.add_joints(&joints)) {
            Ok(joints) => {
                let links = jointed().map(|(i, bone, parent)| Link::new(bone, i, parent)).collect();
                Ok(Ragdoll { bodies, joints, links, friction: self.friction })
            }
            Err(error) => {
                world.remove_bodies(&bodies)?;
                Err(error)
            }
        }
    }
}

impl Ragdoll {
    /// Drives its joints to a pose: a spring about each axis that a joint turns about, with at most so much
    /// torque [N m], in the place of the friction there. Meant to be called with each frame of an animation:
    /// after the first call it changes targets in place ([`World::set_joint_target`]). Nothing holds the
    /// figure as a whole, which falls and is pushed as before. Joints that broke are left out.
    ///
    /// `pose`: of each bone the rotation from where it is in the skeleton, in the skeleton's axes; the
    /// identity for all is the skeleton itself. Of the rotations of a hinge's two bones only the twist about
    /// its axis counts. `spring`: [`Spring::Frequency`] moves light bones as fast as heavy ones, but knows
    /// only the two bodies of a joint and not the bodies joined to them.
    ///
    /// # Errors
    /// If there is not one rotation for each bone, a number is out of range, or the budget does not allow the
    /// motors.
    pub fn drive_to(
        &self,
        world: &mut World,
        pose: &[glam::Quat],
        spring: Spring,
        max_torque: f32,
    ) -> Result<(), Error> {
        if pose.len() != self.bodies.len() {
            return Err(Error::Incomplete { what: "a pose", expected: "a rotation for each bone" });
        }
        let pose = pose.iter().map(|&turn| unit_quat("rotation of a bone", turn));
        let pose = pose.collect::<Result<Vec<Quat>, Error>>()?;
        self.set_drives(world, |link, axis| {
            let target = twist_of(link.relative(pose[link.parent], pose[link.bone]), axis);
            Some(Motor::position(Motion::Angular, axis, target, spring).with_max_force(max_torque))
        })
    }

    /// Takes the springs of [`Ragdoll::drive_to`] away: the figure is limp again, with the friction of its
    /// skeleton.
    ///
    /// # Errors
    /// If the budget does not allow the friction.
    pub fn relax(&self, world: &mut World) -> Result<(), Error> {
        let friction = self.friction;
        self.set_drives(world, |_, axis| {
            (friction > 0.0).then(|| Motor::friction(Motion::Angular, axis, friction))
        })
    }

    /// Sets or removes the motor about each axis: all of them, or none.
    fn set_drives(
        &self,
        world: &mut World,
        drive: impl Fn(&Link, Axis) -> Option<Motor>,
    ) -> Result<(), Error> {
        let mut more = JointAdditions::default();
        let mut all = Vec::new();
        for (&joint, link) in self.joints.iter().zip(&self.links) {
            let Ok(slot) = world.joint(joint) else { continue };
            for &axis in link.free_axes() {
                let drive = drive(link, axis);
                drive.map_or(Ok(()), |drive| drive.validate())?;
                more = more.and(world.more_for_drive(slot, axis, drive, link.free_axes().len()));
                all.push((joint, axis, drive));
            }
        }
        world.reserve(Addition::Joints(more, false))?;
        for (joint, axis, drive) in all {
            match drive {
                Some(drive) => world.set_joint_motor(joint, drive)?,
                None => drop(world.remove_joint_motor(joint, Motion::Angular, axis)?),
            }
        }
        Ok(())
    }
}
