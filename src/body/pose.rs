//! Where a body or a collider is.

use crate::math::Quat;
use glam::{DVec3, Vec3};

/// Pose of the centre of mass, in the principal axes of inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    pub(crate) position: DVec3,
    pub(crate) rotation: Quat,
}

impl Pose {
    /// World pose of a frame at `position` and `rotation` in the frame of this one.
    #[inline]
    pub(crate) fn of_part(&self, position: Vec3, rotation: Quat) -> Pose {
        Pose {
            position: self.position + (self.rotation * position).as_dvec3(),
            rotation: self.rotation * rotation,
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.position.is_finite() && self.rotation.is_finite()
    }
}
