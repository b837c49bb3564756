//! Adds ragdolls to the world.

use crate::body::BodyDesc;
use crate::error::Error;
use crate::joint::{JointDesc, Ragdoll, Skeleton};
use crate::math::Quat;
use crate::world::World;
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
        let bodies = world.add_bodies(&descs)?;
        let mut joints = Vec::new();
        for (bone, &body) in self.bones.iter().zip(&bodies) {
            let Some(parent) = bone.parent else { continue };
            let point = position + (rotation * bone.joint_at).as_dvec3();
            let added = world
                .frames_at([bodies[parent], body], point, (rotation * bone.axes()).normalize().into())
                .and_then(|frames| {
                    world.add_joint(&self.joint(bone, JointDesc::ball([bodies[parent], body], frames)))
                });
            match added {
                Ok(joint) => joints.push(joint),
                Err(error) => {
                    // Removing a body removes its joints.
                    for body in bodies {
                        world.remove_body(body)?;
                    }
                    return Err(error);
                }
            }
        }
        Ok(Ragdoll { bodies, joints })
    }
}
