//! Mass, centre and inertia out of shapes and densities.

use glam::{DMat3, DVec3, Mat3, Vec3};

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

/// The same in f64.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    pub(crate) mass: f64,
    pub(crate) centre: DVec3,
    pub(crate) inertia: DMat3,
}

impl Moments {
    pub(super) fn of_polyhedron(_vertices: &[Vec3], _faces: &[Vec<u16>]) -> Moments {
        Moments::default()
    }
}
