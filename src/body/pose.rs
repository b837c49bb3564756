//! Where a body or a collider is.

use crate::math::Quat;
use glam::DVec3;

/// Pose of the centre of mass, in the principal axes of inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    pub(crate) position: DVec3,
    pub(crate) rotation: Quat,
}

impl Pose {
    pub(crate) fn is_finite(&self) -> bool {
        self.position.is_finite() && self.rotation.is_finite()
    }
}
