//! Where shapes and bodies are in the world, and the boxes around them.

use crate::broad_phase::{self, aabb_of};
use crate::error::Error;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::shape::{Collider, ShapeDesc};
use crate::world::World;
use glam::DVec3;

/// A box along the axes of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Aabb {
    /// Its low corner [m].
    pub min: DVec3,
    /// Its high corner [m].
    pub max: DVec3,
}

impl Aabb {
    /// Its centre [m].
    pub fn centre(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// Half of each of its sides [m].
    pub fn half_extents(&self) -> DVec3 {
        (self.max - self.min) * 0.5
    }

    /// Whether a point is in it, or on its surface.
    pub fn contains(&self, point: DVec3) -> bool {
        (self.min.cmple(point) & self.max.cmpge(point)).all()
    }

    /// Whether it has a point in common with another one.
    pub fn overlaps(&self, other: &Aabb) -> bool {
        (self.min.cmple(other.max) & self.max.cmpge(other.min)).all()
    }

    /// A box around a body's centre, moved to where that is: as small far from the origin as near it.
    fn around(centre: DVec3, own: broad_phase::Aabb) -> Aabb {
        Aabb { min: centre + own.min.as_dvec3(), max: centre + own.max.as_dvec3() }
    }

    fn join(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
}

impl ShapeDesc {
    /// The box around it on a body that is at `position` [m] with `rotation`, to within rounding.
    /// That of a plane is infinite.
    pub fn aabb(&self, position: DVec3, rotation: glam::Quat) -> Aabb {
        Aabb::around(position, aabb_of(&Collider::of(self), DVec3::ZERO, rotation.into()))
    }
}

/// # Bounds
impl World {
    /// The box around a shape where it is now, to within rounding. That of a plane is infinite.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn shape_aabb(&self, shape: ShapeHandle) -> Result<Aabb, Error> {
        Ok(self.aabb_of_collider(self.collider(shape)?))
    }

    /// The box around all shapes of a body where it is now, to within rounding; `None` if it has none.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn aabb(&self, body: BodyHandle) -> Result<Option<Aabb>, Error> {
        let own = self.bodies.colliders[self.index(body)?].as_slice();
        Ok(own.iter().map(|&c| self.aabb_of_collider(c)).reduce(Aabb::join))
    }

    /// Where a shape's frame is in the world [m], and how it is turned there.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn shape_world_pose(&self, shape: ShapeHandle) -> Result<(DVec3, glam::Quat), Error> {
        let pose = self.collider_pose(self.collider(shape)?);
        Ok((pose.position, pose.rotation.into()))
    }

    pub(crate) fn aabb_of_collider(&self, collider: u32) -> Aabb {
        let collider = &self.colliders.all[collider as usize];
        let pose = &self.bodies.pose[collider.body as usize];
        Aabb::around(pose.position, aabb_of(collider, DVec3::ZERO, pose.rotation))
    }
}
