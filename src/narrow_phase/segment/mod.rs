//! Entry of a segment into a shape: for the guard against tunnelling, and for ray queries.
//!
//! All in `f64`, from `f32` ends: a few roots a query, and cancellation is not a topic.

#[cfg(test)]
mod tests;

use crate::shape::{Collider, Ground};
use glam::{DVec3, Vec3};

// Rounding: grazing segments hit.
/// Shapes are enlarged by this share of their size for segments from outside, so that grazing ones hit.
const GENEROSITY: f64 = 1e-6;

/// Where a segment enters a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SegmentHit {
    /// Fraction of the segment, 0..=1.
    pub(crate) fraction: f32,
    /// Unit, out of the shape (of a mesh: against the segment), in the shape's frame.
    pub(crate) normal: Vec3,
}

/// First entry of the segment into a shape, in the shape's frame. A segment that starts inside a solid shape,
/// or in the half-space of a plane, doesn't enter it: None. Triangles are met from both sides.
pub(crate) fn segment_hits(shape: &Collider, from: Vec3, to: Vec3) -> Option<SegmentHit> {
    if let Some(ground) = shape.geometry.ground() {
        return segment_hits_triangles(ground, from, to);
    }
    let (start, path) = (from.as_dvec3(), to.as_dvec3() - from.as_dvec3());
    let extra = GENEROSITY * f64::from(shape.radius);
    // Once with the larger shape; and once as it is, for a start between the two surfaces.
    let found = shape.geometry.enter(start, path, extra).or_else(|| shape.geometry.enter(start, path, 0.0));
    found.map(|(fraction, normal)| SegmentHit {
        fraction: fraction as f32,
        normal: normal.normalize_or(DVec3::Y).as_vec3(),
    })
}

/// The same over triangles.
pub(crate) fn segment_hits_triangles(ground: Ground<'_>, from: Vec3, to: Vec3) -> Option<SegmentHit> {
    let (fraction, index) = ground.segment_hit(from, to)?;
    let [a, b, c] = ground.triangle(index).map(Vec3::as_dvec3);
    let path = to.as_dvec3() - from.as_dvec3();
    let normal = (b - a).cross(c - a).normalize_or(-path.normalize_or(-DVec3::Y));
    let normal = if normal.dot(path) > 0.0 { -normal } else { normal };
    Some(SegmentHit { fraction, normal: normal.as_vec3() })
}
