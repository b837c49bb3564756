//! A capsule against triangles: nearest points of its core, eight triangles at a time.
//!
//! The part of the core that is over a triangle, seen along the normal, yields two points. Where another part
//! of the core is nearer, that part is nearest to an edge.

use super::patch::{Patches, Touch, Verdict};
use super::reach::Bounds;
use super::triangle_contact::{Gap, TriangleContact, key};
use super::triangles::Triangles;
use crate::config::tuning::THROUGH_SINE;
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, ones};
use crate::narrow_phase::RawPoint;
use crate::narrow_phase::convex::clip::Spans;
use crate::narrow_phase::convex::round_polytope::{Core, EdgeContact, part_inside};
use crate::shape::Ground;
use glam::Vec3;

/// Where the core is relative to one triangle.
struct Place<'a> {
    core: &'a Core,
    touch: &'a Touch,
    margin: f32,
    /// Height of the core's ends over the plane [m].
    heights: [f32; 2],
    /// The part of the core that is over the triangle; the first above the second if none is.
    over: (f32, f32),
    /// Which edge is nearest to the core, where on the core and where on the edge.
    edge: usize,
    at: (f32, f32),
}

/// The part of the core over each triangle, and the nearest edge: distance of the surface, number, where on
/// the core, where on the edge.
#[inline(always)]
fn nearest<L: Lanes>(core: &Core, triangles: &Triangles<L>) -> ((L, L), [L; 4]) {
    let zero = L::zero();
    let (start, along) = (LaneVec3::<L>::splat(core.start), LaneVec3::<L>::splat(core.along));
    let [a, b, c] = triangles.corners;
    let winding = (b - a).cross(c - b);
    let mut over = Spans::whole();
    let (mut least, mut edge) = (L::splat(f32::MAX), zero);
    let (mut on_core, mut on_edge) = (zero, zero);
    for i in 0..3 {
        let (from, to) = (triangles.corners[i], triangles.corners[(i + 1) % 3]);
        let e = to - from;
        let out = e.cross(winding);
        let d0 = out.dot(start - from);
        let d1 = d0 + out.dot(along);
        over.cut(d0, d1);

        let (s, t) = core.nearest_segment(from, e);
        let apart = (from + e * t - start - along * s).length();
        let distance = apart - L::splat(core.radius) - s * L::splat(core.growth);
        let nearer = distance.lt(least);
        least = Lanes::select(nearer, distance, least);
        edge = Lanes::select(nearer, L::splat(i as f32), edge);
        on_core = Lanes::select(nearer, s, on_core);
        on_edge = Lanes::select(nearer, t, on_edge);
    }
    ((over.enter, over.exit), [least, edge, on_core, on_edge])
}

/// Adds a patch for every triangle that is nearer than its margin.
#[inline(always)]
pub(crate) fn touch<L: Lanes>(
    core: &Core,
    half: Vec3,
    size: f32,
    triangles: &Triangles<L>,
    margins: L,
    ground: &Ground,
    patches: &mut Patches,
) {
    let (r0, r1) = (core.radius, core.radius + core.growth);
    let (_, axis, _) = triangles.separate(Vec3::ZERO, half);
    let front = triangles.front;
    // Divided component by component, which rounds least: if a triangle is much longer than the capsule, its
    // far corners magnify a tilt.
    let [a, b, c] = triangles.corners;
    let cross = (b - a).cross(c - a);
    let length = cross.length() * front.dot(cross).sign();
    let n = LaneVec3::new(cross.x / length, cross.y / length, cross.z / length);
    let offset = n.dot(a);
    let h0 = n.dot(LaneVec3::splat(core.start)) - offset;
    let h1 = n.dot(LaneVec3::splat(core.at(1.0))) - offset;
    let face = Lanes::min(h0 - L::splat(r0), h1 - L::splat(r1));
    let near = axis.le(margins) & face.le(margins);
    if near.bits() & triangles.valid == 0 {
        return;
    }
    let ((low, high), [distance, edge, on_core, on_edge]) = nearest(core, triangles);
    let near = near & (low.le(high) | distance.le(margins));
    let bits = near.bits() & triangles.valid;
    if bits == 0 {
        return;
    }
    let (low, high, h0, h1) = (low.eight(), high.eight(), h0.eight(), h1.eight());
    let (face, margins, distance) = (face.eight(), margins.eight(), distance.eight());
    let (edge, on_core, on_edge) = (edge.eight(), on_core.eight(), on_edge.eight());
    let tolerance = 1e-4 * size;
    for lane in ones(bits) {
        let touch = triangles.touch(lane, ground);
        let (face, distance) = (face[lane], distance[lane]);
        let place = Place {
            core,
            touch: &touch,
            margin: margins[lane],
            heights: [h0[lane], h1[lane]],
            over: (low[lane], high[lane]),
            edge: edge[lane] as usize,
            at: (on_core[lane], on_edge[lane]),
        };
        let first = patches.points.len();
        if place.is_over(face, tolerance) {
            place.over_face(&mut patches.points);
            patches.add(touch, -touch.front, Some(face), first);
            continue;
        }
        if distance > place.margin {
            continue;
        }
        let (c, q) = place.nearest();
        let apart = (q - c).length();
        let normal = if apart > 1e-6 * size { (q - c) / apart } else { -touch.front };
        let slope = -normal.dot(touch.front);
        // Seen through the triangle.
        let verdict = if slope < -THROUGH_SINE && distance < 0.0 {
            Verdict::Face(f32::MIN)
        } else {
            touch.judge(normal, distance, face, size)
        };
        let own = |points: &mut Vec<RawPoint>| place.at_edge(normal, apart, tolerance, points);
        let over = |points: &mut Vec<RawPoint>| {
            // The face's own normal already.
            if slope > 0.999_999 { own(points) } else { place.over_face(points) }
        };
        let (margin, apart) = (place.margin, distance);
        let found = TriangleContact { normal, apart, face, margin, verdict, gap: Gap::Round };
        found.add(&touch, Bounds { middle: Vec3::ZERO, half }, own, over, patches);
    }
}

impl Place<'_> {
    fn height(&self, s: f32) -> f32 {
        let [start, end] = self.heights;
        if s == 1.0 { end } else { start + (end - start) * s }
    }

    /// Whether the part over the triangle is the nearest, or goes through the triangle. `face`: separation of
    /// the whole capsule from the plane [m].
    fn is_over(&self, face: f32, tolerance: f32) -> bool {
        let (low, high) = self.over;
        let core = self.core;
        if low > high {
            return false;
        }
        let (one, other) = (self.height(low), self.height(high));
        let nearest = (one - core.radius_at(low)).min(other - core.radius_at(high));
        nearest <= face + tolerance || (one < 0.0) != (other < 0.0)
    }

    /// The two ends of the part over the triangle.
    fn over_face(&self, points: &mut Vec<RawPoint>) {
        let (low, high) = self.over;
        if low > high {
            return;
        }
        let ends = if self.core.is_ball() || high - low < 1e-3 { 1 } else { 2 };
        for (k, s) in [low, high].into_iter().enumerate().take(ends) {
            let radius = self.core.radius_at(s);
            let height = self.height(s);
            let separation = height - radius;
            if separation <= self.margin {
                let position = self.core.at(s) - self.touch.front * (0.5 * (height + radius));
                let key = key(self.touch.index, 0x40 + k as u32);
                points.push(RawPoint { position, separation, key });
            }
        }
    }

    /// The nearest edge: start and direction.
    fn edge(&self) -> (Vec3, Vec3) {
        let (from, to) = (self.touch.corners[self.edge % 3], self.touch.corners[(self.edge + 1) % 3]);
        (from, to - from)
    }

    /// The nearest points of the core and the edge.
    fn nearest(&self) -> (Vec3, Vec3) {
        let (from, along) = self.edge();
        (self.core.at(self.at.0), from + along * self.at.1)
    }

    /// One point at the edge, or two where the capsule lies along it or nearly on the face. `apart`: distance
    /// of the nearest points of core and edge [m].
    fn at_edge(&self, normal: Vec3, apart: f32, tolerance: f32, points: &mut Vec<RawPoint>) {
        let Place { core, touch, margin, .. } = *self;
        let (start, along) = self.edge();
        let (s, front, end) = (self.at.0, touch.front, start + along);
        let edge =
            EdgeContact { core, s, start, end, along, normal, apart, tolerance, front, counts: f32::MAX };
        let over = |from: Vec3, to: Vec3| {
            part_inside((0..3).map(|i| {
                let (out, corner) = (touch.outward(i), touch.corners[i]);
                (out.dot(from - corner), out.dot(to - corner))
            }))
        };
        edge.add_points(
            |s| self.height(s),
            over,
            |position, separation, name| {
                if separation <= margin {
                    let key = key(touch.index, 0x80 | (self.edge as u32) << 2 | name);
                    points.push(RawPoint { position, separation, key });
                }
                separation <= margin
            },
        );
    }
}
