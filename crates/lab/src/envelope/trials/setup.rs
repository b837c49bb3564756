//! Contents of a trial, and common parts of trials.

use super::super::measures::{Boundary, Gauge};
use backstop::BodyDesc;
use backstop::Geometry;
use backstop::math::Quat;
use backstop_scene::Scene;
use backstop_scene::builtin::fixed;
use glam::{DVec3, Vec3};

/// A scene and its measures.
#[derive(Clone, Debug)]
pub(in crate::envelope) struct Setup {
    pub(in crate::envelope) scene: Scene,
    pub(in crate::envelope) boundaries: Vec<Boundary>,
    pub(in crate::envelope) gauges: Vec<Gauge>,
}

/// The velocities that a body is given for a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Index of the body in the scene.
    pub body: usize,
    /// Of its origin [m/s].
    pub linear: Vec3,
    /// About the world's axes [rad/s].
    pub angular: Vec3,
}

/// A rotation by an angle about z, the axis of all hinges here (x of their frames).
pub(super) fn about_z(angle: f32) -> Quat {
    Quat::from_xyzw(0.0, 0.0, libm::sinf(0.5 * angle), libm::cosf(0.5 * angle))
}

/// Adds a floor whose top is at height 0. `half`: half its side length; `size`: the length unit.
pub(super) fn floor(scene: &mut Scene, half: f32, size: f32) -> Vec<Boundary> {
    // If it were as thick as it is long, rounding of the heights of its faces would be as large as what the
    // ball trial measures.
    let thick = half.min(1e3 * size).max(0.01 * half);
    scene.add("floor", fixed(Geometry::cuboid(half, thick, half), Vec3::new(0.0, -thick, 0.0)));
    vec![Boundary { point: DVec3::ZERO, normal: Vec3::Y }]
}

/// Makes a body so many times heavier.
pub(super) fn weight(body: &mut BodyDesc, ratio: f32) {
    body.shapes.iter_mut().for_each(|shape| shape.density *= ratio);
}
