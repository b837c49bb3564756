//! Contents of a trial, and common parts of trials.

use super::super::measures::{Boundary, Gauge};
use backstop::BodyDesc;
use backstop::Geometry;
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
