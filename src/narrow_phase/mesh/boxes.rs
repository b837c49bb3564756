//! A box against triangles: separating axes eight triangles at a time, then clipping of those that touch.
//!
//! In the box's frame a face of it is a rectangle along two axes, and the triangle, projected on it along the
//! normal of contact, is clipped by four comparisons.

use super::patch::{Patches, Touch, Verdict};
use super::reach::Bounds;
use super::triangle_contact::{Gap, TriangleContact, key};
use super::triangles::{Furthest, Triangles};
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, ones};
use crate::narrow_phase::RawPoint;
use crate::narrow_phase::convex::clip::cut_off;
use crate::narrow_phase::convex::sat::nearest_on_segments;
use crate::shape::Ground;
use glam::Vec3;

/// Adds a patch for every triangle that is nearer than its margin.
#[inline(always)]
pub(crate) fn touch<L: Lanes>(
    half: Vec3,
    triangles: &Triangles<L>,
    limit: L,
    ground: &Ground,
    patches: &mut Patches,
) {
    let size = half.length();
    let (face, axis, name) = triangles.separate(Vec3::ZERO, half);
    let near = face.le(limit) & axis.le(limit);
    if near.bits() & triangles.valid == 0 {
        return;
    }
    let (edges, edge_name) = edge_axes(half, triangles);
    let bits = (near & edges.le(limit)).bits() & triangles.valid;
    let (face, axis, name) = (face.eight(), axis.eight(), name.eight());
    let (edges, edge_name) = (edges.eight(), edge_name.eight());
    for lane in ones(bits) {
        let (touch, margin) = (triangles.touch(lane, ground), limit.lane(lane));
        // Faces are preferred, as long as that costs little: their points last.
        let clearly = |apart: f32| if apart < 0.0 { 0.95 * apart } else { apart } + 5e-4 * size;
        let (face, axis, edge) = (face[lane], axis[lane], edges[lane]);
        let by_edge = edge > clearly(face.max(axis));
        let (normal, apart) = if by_edge {
            (edge_normal(&touch, edge_name[lane] as usize), edge)
        } else if axis > clearly(face) {
            let name = name[lane] as usize;
            (Vec3::AXES[name % 3] * if name < 3 { 1.0 } else { -1.0 }, axis)
        } else {
            (-touch.front, face)
        };
        let verdict = if normal == -touch.front {
            Verdict::Face(f32::MIN)
        } else {
            touch.judge(normal, apart, face, size)
        };
        let own = |points: &mut Vec<RawPoint>| {
            if by_edge {
                points.extend(edge_point(half, &touch, edge_name[lane] as usize, normal, margin));
            } else {
                clip(half, &touch, normal, margin, points);
            }
        };
        let over = |points: &mut Vec<RawPoint>| clip(half, &touch, -touch.front, margin, points);
        let found = TriangleContact { normal, apart, face, margin, verdict, gap: Gap::None };
        found.add(&touch, Bounds { middle: Vec3::ZERO, half }, own, over, patches);
    }
}

/// The cross product of a box axis and a vector.
#[inline(always)]
fn cross_axis<L: Lanes>(axis: usize, v: LaneVec3<L>) -> LaneVec3<L> {
    match axis {
        0 => LaneVec3::new(L::zero(), -v.z, v.y),
        1 => LaneVec3::new(v.z, L::zero(), -v.x),
        _ => LaneVec3::new(-v.y, v.x, L::zero()),
    }
}

/// The cross product of an edge of the box and one of the triangle on which they are furthest apart: by how
/// much, and 3 · box axis + triangle edge, plus 9 if the normal is the negative of the product.
#[inline(always)]
fn edge_axes<L: Lanes>(half: Vec3, triangles: &Triangles<L>) -> (L, L) {
    let mut best = Furthest::none();
    let half = LaneVec3::<L>::splat(half);
    for e in 0..3 {
        let c = &triangles.corners;
        let (from, to, third) = (c[e], c[(e + 1) % 3], c[(e + 2) % 3]);
        let along = to - from;
        let squared = along.length_squared();
        for axis in 0..3 {
            let cross = cross_axis(axis, along);
            let length = cross.length_squared();
            // Along each other, within a degree: the faces' axes do.
            let valid = length.gt(squared * L::splat(3e-4));
            let scale = L::one() / Lanes::select(valid, length, L::one()).sqrt();
            let (one, other) = (cross.dot(from) * scale, cross.dot(third) * scale);
            let reach = cross.abs().dot(half) * scale;
            let through = cross.dot(triangles.front) * scale;
            let never = L::splat(f32::MIN);
            let above = Lanes::select(valid, Lanes::min(one, other) - reach, never);
            let below = Lanes::select(valid, -Lanes::max(one, other) - reach, never);
            best.offer(3 * axis + e, above, through);
            best.offer(3 * axis + e + 9, below, -through);
        }
    }
    (best.apart, best.name)
}

fn edge_normal(touch: &Touch, name: usize) -> Vec3 {
    let e = name % 3;
    let along = touch.corners[(e + 1) % 3] - touch.corners[e];
    let cross = cross_axis(name % 9 / 3, LaneVec3::<f32>::splat(along)).lane(0);
    cross / if name < 9 { cross.length() } else { -cross.length() }
}

/// Where an edge of the box and one of the triangle are nearest.
fn edge_point(half: Vec3, touch: &Touch, name: usize, normal: Vec3, margin: f32) -> Option<RawPoint> {
    let (axis, e) = (name % 9 / 3, name % 3);
    let mut start = half * normal.signum();
    start[axis] = -half[axis];
    let along = Vec3::AXES[axis] * (2.0 * half[axis]);
    let (from, to) = (touch.corners[e], touch.corners[(e + 1) % 3]);
    let lanes = LaneVec3::<f32>::splat;
    let (s, t) = nearest_on_segments(lanes(start), lanes(along), lanes(from), lanes(to - from));
    let (p, q) = (start + along * s, from + (to - from) * t);
    let separation = normal.dot(q - p);
    // Beside each other: the edges of another triangle are nearer.
    let beside = (q - p - normal * separation).length_squared()
        > 1e-3 * half.length_squared() + separation * separation;
    let corner = (0..3).filter(|&k| k != axis).fold(0, |bits, k| bits << 1 | u32::from(normal[k] > 0.0));
    let key = key(touch.index, 0x80 | (axis as u32) << 4 | (e as u32) << 2 | corner);
    (separation <= margin && !beside).then_some(RawPoint { position: (p + q) * 0.5, separation, key })
}

/// A corner of the polygon: two coordinates on the box's face, separation, which edge starts here, which
/// feature it is.
#[derive(Clone, Copy, Default)]
struct Corner {
    x: [f32; 2],
    apart: f32,
    edge: u32,
    feature: u32,
}

/// Adds the corners of the common area of the triangle and the box's face towards `normal`, seen along the
/// normal, that are nearer than the margin.
///
/// Not by `convex::clip::clip_face`: three corners against a rectangle along the axes are four comparisons of
/// coordinates, where that works out planes, and it walks eight edges at a time. And keys name corners of the
/// box whichever triangle they are over, so that `merge` finds the same corner over two triangles.
fn clip(half: Vec3, touch: &Touch, normal: Vec3, margin: f32, points: &mut Vec<RawPoint>) {
    let w = normal.abs().max_position();
    let (u, v) = ((w + 1) % 3, (w + 2) % 3);
    let sign = if normal[w] < 0.0 { -1.0 } else { 1.0 };
    let slope = 1.0 / normal[w];
    let level = sign * half[w];

    let mut one = [Corner::default(); 8];
    let mut least = f32::MAX;
    for (i, p) in touch.corners.iter().enumerate() {
        let apart = (p[w] - level) * slope;
        least = least.min(apart);
        let x = [p[u] - normal[u] * apart, p[v] - normal[v] * apart];
        one[i] = Corner { x, apart, edge: i as u32, feature: i as u32 };
    }
    if least > margin {
        return;
    }
    let count = clip_to_rectangle(&mut one, [half[u], half[v]]);
    for c in one[..count].iter().filter(|c| c.apart <= margin) {
        let mut position = Vec3::ZERO;
        (position[u], position[v], position[w]) = (c.x[0], c.x[1], level);
        position += normal * (0.5 * c.apart);
        let is_corner = c.feature >= 8 + 8 * 4;
        let key = if is_corner {
            [u, v]
                .iter()
                .zip(c.x)
                .fold(u32::from(sign > 0.0) << w, |bits, (k, x)| bits | u32::from(x > 0.0) << k)
        } else {
            key(touch.index, c.feature)
        };
        points.push(RawPoint { position, separation: c.apart, key });
    }
}

/// Clips the triangle of the first three corners to |x| <= `bounds`. How many corners are left.
#[inline(always)]
fn clip_to_rectangle(corners: &mut [Corner; 8], bounds: [f32; 2]) -> usize {
    let mut count = 3;
    // Sides with all corners beyond end it; only those with some beyond cut.
    let beyond = |c: &Corner| {
        let over = [c.x[0] > bounds[0], -c.x[0] > bounds[0], c.x[1] > bounds[1], -c.x[1] > bounds[1]];
        (0..4).fold(0u32, |bits, side| bits | u32::from(over[side]) << side)
    };
    let codes = [beyond(&corners[0]), beyond(&corners[1]), beyond(&corners[2])];
    if codes[0] & codes[1] & codes[2] != 0 {
        return 0;
    }
    for side in ones(codes[0] | codes[1] | codes[2]) {
        let (k, s) = (side / 2, if side % 2 == 0 { 1.0 } else { -1.0 });
        let crossing = |last: &Corner, this: &Corner, t: f32, leaves: bool| {
            let mut x = [last.x[0] + (this.x[0] - last.x[0]) * t, last.x[1] + (this.x[1] - last.x[1]) * t];
            x[k] = s * bounds[k];
            Corner {
                x,
                apart: last.apart + (this.apart - last.apart) * t,
                edge: if leaves { 4 + side as u32 } else { last.edge },
                feature: 8 + 8 * last.edge + side as u32,
            }
        };
        count = cut_off(corners, count, |c| s * c.x[k] - bounds[k], crossing);
    }
    count
}
