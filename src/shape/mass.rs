//! Mass, centre and inertia out of shapes and densities.

use glam::{Mat3, Vec3};

/// Mass, centre of mass and inertia about it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MassProperties {
    /// [kg]
    pub mass: f32,
    /// In the frame of the shape or body [m].
    pub center: Vec3,
    /// About the centre, in the axes of the shape or body [kg m²].
    pub inertia: Mat3,
}
