//! A cylinder against triangles: its deepest point over each, eight triangles at a time. The exact distance
//! is computed only where that does not decide.
//!
//! Over a triangle the argument for hulls holds ([`hull`](super::hull)): no way out is shorter than along the
//! triangle's normal.

use super::hull::inside;
use super::patch::{Patches, Verdict};
use super::reach::Bounds;
use super::sphere::nearest;
use super::triangle_contact::{Gap, TriangleContact, named, outline};
use super::triangles::{Triangles, nearest_corner};
use crate::config::tuning::{FACE_PREFERENCE, THROUGH_SINE};
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, ones};
use crate::narrow_phase::RawPoint;
use crate::narrow_phase::convex::clip::Cloud;
use crate::narrow_phase::convex::cylinder::{cylinder_triangle, over_triangle};
use crate::shape::Collider;
use crate::shape::Ground;

/// Adds a patch for every triangle that is nearer than its margin.
#[inline(always)]
pub(crate) fn touch<L: Lanes>(
    a: &Collider,
    bounds: Bounds,
    triangles: &Triangles<L>,
    margins: L,
    ground: &Ground,
    patches: &mut Patches,
) {
    let (_, axis, _) = triangles.separate(bounds.middle, bounds.half);
    let near = axis.le(margins);
    if near.bits() & triangles.valid == 0 {
        return;
    }
    let rims = rims(a, -triangles.front);
    // The deepest point of the whole shape below the face.
    let face = triangles.height - Lanes::max(rims[0].1, rims[1].1);
    let near = near & face.le(margins);
    if near.bits() & triangles.valid == 0 {
        return;
    }
    let near = near & !beside(a, triangles, margins);
    let slight = L::splat(FACE_PREFERENCE.1 * a.radius);
    let needed = Lanes::max(face * L::splat(-FACE_PREFERENCE.0) - slight, L::zero());
    let mut over_it = 0;
    for (point, reach) in rims {
        let deepest = (triangles.height - reach).le(face + slight);
        over_it |= (deepest & inside(triangles, point).ge(needed)).bits();
    }
    let (face, margins) = (face.eight(), margins.eight());
    for lane in ones(near.bits() & triangles.valid) {
        let (front, face, margin) = (triangles.front.lane(lane), face[lane], margins[lane]);
        let touch = triangles.touch(lane, ground);
        let over = |points: &mut Vec<RawPoint>| {
            let mut cloud = Cloud::new();
            over_triangle(a, &outline(&touch), front, margin, &mut cloud);
            points.extend(named(&touch, cloud.points()));
        };
        if over_it >> lane & 1 != 0 {
            let first = patches.points.len();
            over(&mut patches.points);
            if patches.points.len() > first {
                patches.add(touch, -front, Some(face), first);
                continue;
            }
        }
        let manifold = cylinder_triangle(a, touch.corners, margin);
        if manifold.count == 0 {
            continue;
        }
        let apart = manifold.least();
        // A direction through the triangle is no way out.
        let verdict = if manifold.normal.dot(front) > THROUGH_SINE && apart < 0.0 {
            Verdict::Face(f32::MIN)
        } else {
            touch.judge(manifold.normal, apart, face, a.radius)
        };
        let found =
            TriangleContact { normal: manifold.normal, apart, face, margin, verdict, gap: Gap::Round };
        let own = |points: &mut Vec<RawPoint>| points.extend(named(&touch, manifold.points()));
        found.add(&touch, bounds, own, over, patches);
    }
}

/// The point of either rim that is furthest along eight unit directions, and how far [m].
#[inline(always)]
fn rims<L: Lanes>(a: &Collider, d: LaneVec3<L>) -> [(LaneVec3<L>, L); 2] {
    let [half_height, bottom, top, _] = a.size;
    let across = (d.x * d.x + d.z * d.z).sqrt();
    let scale = L::one() / Lanes::select(across.gt(L::zero()), across, L::one());
    let (x, z) = (d.x * scale, d.z * scale);
    let mut rims = [(LaneVec3::zero(), L::zero()); 2];
    for (rim, (y, radius)) in rims.iter_mut().zip([(-half_height, bottom), (half_height, top)]) {
        let (y, radius) = (L::splat(y), L::splat(radius));
        *rim = (LaneVec3::new(x * radius, y, z * radius), y * d.y + radius * across);
    }
    rims
}

/// Which triangles are further away than their margins, along the directions from the shape's origin to their
/// nearest points.
#[inline(always)]
fn beside<L: Lanes>(a: &Collider, triangles: &Triangles<L>, margins: L) -> L::Mask {
    let (point, _) = nearest(triangles, LaneVec3::zero());
    let length = point.length();
    let some = length.gt(L::splat(f32::MIN_POSITIVE));
    let u = point * (L::one() / Lanes::select(some, length, L::one()));
    let (_, far) = nearest_corner(triangles, u);
    some & (far - a.geometry.lane_reach(u)).gt(margins)
}
