//! A hull against triangles: its deepest vertex over each, eight triangles at a time. All else is computed
//! only where that does not decide.
//!
//! Where the deepest vertex is over a triangle, and further from its border than below its plane, no way out
//! is shorter than along the triangle's normal: along a direction that leans by θ it is at least d cos θ + r
//! sin θ, with the depth d and the distance r from the border, which is least at one of its ends. No other
//! axis has to be tried.

mod face;
mod triangle;

use super::patch::{Patches, Touch};
use super::reach::Bounds;
use super::triangle_contact::{Gap, TriangleContact, named};
use super::triangles::Triangles;
use crate::config::tuning::FACE_PREFERENCE;
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, ones};
use crate::narrow_phase::RawPoint;
use crate::narrow_phase::convex::clip::key;
use crate::narrow_phase::convex::polytope::{Polytope, Solid};
use crate::narrow_phase::convex::sat::in_lanes;
use crate::shape::ConvexHull;
use crate::shape::Ground;
use face::over_face;
use triangle::{ContactAxis, Deepest, face_axis};

/// The vertex of a hull that is furthest along each of eight directions, and how far [m].
#[inline(always)]
fn furthest<L: Lanes>(p: &Polytope, d: LaneVec3<L>) -> (L, L) {
    let (mut most, mut vertex) = (L::splat(f32::MIN), L::zero());
    for (i, v) in p.vertices.iter().enumerate() {
        let along = LaneVec3::<L>::splat(*v).dot(d);
        let further = along.gt(most);
        most = Lanes::max(along, most);
        vertex = Lanes::select(further, L::splat(i as f32), vertex);
    }
    (vertex, most)
}

/// How far inside each triangle a point is, seen along the triangle's normal; negative outside [m].
#[inline(always)]
pub(crate) fn inside<L: Lanes>(triangles: &Triangles<L>, at: LaneVec3<L>) -> L {
    let [a, b, c] = triangles.corners;
    let winding = (b - a).cross(c - b);
    let (one, two, three) = (side(at, winding, a, b), side(at, winding, b, c), side(at, winding, c, a));
    Lanes::min(Lanes::min(one, two), three)
}

/// How far inside a side of a triangle a point is.
#[inline(always)]
fn side<L: Lanes>(at: LaneVec3<L>, winding: LaneVec3<L>, from: LaneVec3<L>, to: LaneVec3<L>) -> L {
    let out = (to - from).cross(winding);
    out.dot(from - at) / out.length()
}

/// Adds a patch for every triangle that is nearer than its margin.
#[inline(always)]
pub(crate) fn touch<L: Lanes>(
    hull: &ConvexHull,
    size: f32,
    bounds: Bounds,
    triangles: &Triangles<L>,
    margins: L,
    ground: &Ground,
    patches: &mut Patches,
) {
    let solid = Solid::Hull(hull);
    let p = &solid.view();
    let (_, axis, _) = triangles.separate(bounds.middle, bounds.half);
    let front = triangles.front;
    let box_face = triangles.height + LaneVec3::splat(bounds.middle).dot(front)
        - front.abs().dot(LaneVec3::splat(bounds.half));
    let near = axis.le(margins) & box_face.le(margins);
    if near.bits() & triangles.valid == 0 {
        return;
    }
    let (vertex, reach) = furthest(p, -front);
    let face = triangles.height - reach;
    let bits = (near & face.le(margins)).bits() & triangles.valid;
    if bits == 0 {
        return;
    }
    let vertex = vertex.eight();
    let deepest = in_lanes::<L>(|i| p.vertices[vertex[i] as usize]);
    let inside = inside(triangles, deepest);
    let needed = face * L::splat(-FACE_PREFERENCE.0) - L::splat(FACE_PREFERENCE.1 * size);
    let clear = inside.ge(Lanes::max(needed, L::zero())).bits();
    let (face, margins, inside) = (face.eight(), margins.eight(), inside.eight());
    for lane in ones(bits) {
        let touch = triangles.touch(lane, ground);
        let (face, margin) = (face[lane], margins[lane]);
        let deepest = Deepest { at: p.vertices[vertex[lane] as usize], separation: face };
        let first = patches.points.len();
        let over = |points: &mut Vec<RawPoint>| {
            let first = points.len();
            over_face(p, &touch, margin, size, points);
            if inside[lane] >= 0.0 {
                add_deepest(&deepest, &touch, size, first, points);
            }
        };
        if clear >> lane & 1 != 0 {
            over(&mut patches.points);
            patches.add(touch, -touch.front, Some(face), first);
            continue;
        }
        let by_hull = face_axis::<L>(hull, &touch);
        if by_hull.0 > margin {
            continue;
        }
        let Some(contact) = ContactAxis::between::<L>(hull, &touch, by_hull, face, margin, size) else {
            continue;
        };
        let verdict = touch.judge(contact.normal, contact.apart, face, size);
        let own = |points: &mut Vec<RawPoint>| {
            contact.points(p, &touch, &deepest, margin, size, points);
        };
        let ContactAxis { normal, apart, .. } = contact;
        let found = TriangleContact { normal, apart, face, margin, verdict, gap: Gap::Flat };
        found.add(&touch, bounds, own, over, patches);
    }
}

/// Adds the deepest vertex if it is none of a face's points from `first` on: it need not be a corner of the
/// face that is most level.
fn add_deepest(deepest: &Deepest, touch: &Touch, size: f32, first: usize, points: &mut Vec<RawPoint>) {
    let Deepest { at, separation } = *deepest;
    if points[first..].iter().all(|p| p.separation > separation + FACE_PREFERENCE.1 * size) {
        let position = at - touch.front * (0.5 * separation);
        points.extend(named(touch, &[RawPoint { position, separation, key: key(0, 0x7fff, 1) }]));
    }
}
