//! A cylinder against triangles, one triangle at a time, once boxes around them are found to be near.

use super::RawPoint;
use super::clip::Cloud;
use super::convex::collide_triangle;
use super::cylinder::over_triangle;
use super::mesh::Triangles;
use super::mesh_found::{Found, named, outline};
use super::mesh_patch::{Patches, Verdict};
use super::nearby::Ground;
use crate::lanes::{Lanes, Mask, f32x8};
use crate::shape::{Collider, Geometry};
use glam::Vec3;

/// Adds a patch for every triangle that is nearer than its margin. `around`: middle and half extents of the box around
/// the cylinder.
pub(super) fn touch(
    a: &Collider,
    (middle, half): (Vec3, Vec3),
    triangles: &Triangles,
    margins: f32x8,
    ground: &Ground,
    patches: &mut Patches,
) {
    let (_, axis, _) = triangles.separate(middle, half);
    let mut bits = axis.le(margins).bits() & triangles.valid;
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        // Deepest below the face, of all of the shape.
        let (front, height) = (triangles.front.lane(lane), triangles.height.lane(lane));
        let margin = margins.lane(lane);
        let face = height - extent(a, -front);
        if face > margin {
            continue;
        }
        let touch = triangles.touch(lane, ground);
        let manifold = collide_triangle(a, touch.corners, margin);
        if manifold.count == 0 {
            continue;
        }
        let apart = manifold.points().iter().map(|p| p.separation).fold(f32::MAX, f32::min);
        // A way out through the triangle is none.
        let verdict = if manifold.normal.dot(front) > 1e-3 && apart < 0.0 {
            Verdict::Face(f32::MIN)
        } else {
            touch.judge(manifold.normal, apart, face, a.radius)
        };
        let found = Found { normal: manifold.normal, apart, face, margin, verdict };
        let own = |points: &mut Vec<RawPoint>| points.extend(named(&touch, manifold.points()));
        let over = |points: &mut Vec<RawPoint>| {
            let mut cloud = Cloud::new();
            over_triangle(a, &outline(&touch), front, margin, &mut cloud);
            points.extend(named(&touch, cloud.points()));
        };
        found.add(&touch, (middle, half), own, over, patches);
    }
}

/// How far a cylinder reaches along a direction from its centre [m].
fn extent(a: &Collider, d: Vec3) -> f32 {
    let Geometry::Cylinder { half_height: h, radius_bottom, radius_top } = a.geometry else {
        return f32::MAX;
    };
    let flat = (d.x * d.x + d.z * d.z).sqrt();
    (h * d.y + radius_top * flat).max(-h * d.y + radius_bottom * flat)
}
