//! A capsule against triangles: nearest points of its core, eight triangles at a time.
//!
//! The part of the core that is over a triangle, seen along the normal, yields two points. Where another part
//! of the core is nearer, that part is nearest to an edge.

use super::boxes::key;
use super::patch::{Patches, Touch, Verdict};
use super::reach::Bounds;
use super::triangle_contact::TriangleContact;
use super::triangles::Triangles;
use crate::config::tuning::{ALONG_SINE_SQUARED, THROUGH_SINE};
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3};
use crate::narrow_phase::RawPoint;
use crate::narrow_phase::convex::clip::Spans;
use crate::narrow_phase::convex::round_polytope::{Core, part_inside};
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
    let mut bits = near.bits() & triangles.valid;
    if bits == 0 {
        return;
    }
    let (low, high, h0, h1) = (low.eight(), high.eight(), h0.eight(), h1.eight());
    let (face, margins, distance) = (face.eight(), margins.eight(), distance.eight());
    let (edge, on_core, on_edge) = (edge.eight(), on_core.eight(), on_edge.eight());
    let tolerance = 1e-4 * size;
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize % 8;
        bits &= bits - 1;
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
        let found =
            TriangleContact { normal, apart: distance, face, margin: place.margin, verdict, round: true };
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
        let Place { core, touch, .. } = *self;
        let (v, e) = self.edge();
        let first = points.len();
        let mut add = |s: f32, height: f32, name: u32| {
            let (c, r) = (core.at(s), core.radius_at(s));
            if height - r <= self.margin {
                let position = c + normal * (0.5 * (height + r));
                let key = key(touch.index, 0x80 | (self.edge as u32) << 2 | name);
                points.push(RawPoint { position, separation: height - r, key });
            }
        };
        let (dd, ee, de) = (core.along.length_squared(), e.length_squared(), core.along.dot(e));
        let s = self.at.0;
        let nearest = apart - core.radius_at(s);
        if dd > 0.0 && ee > 0.0 && dd * ee - de * de < ALONG_SINE_SQUARED * dd * ee {
            let (t0, t1) = (core.along.dot(v - core.start) / dd, core.along.dot(v + e - core.start) / dd);
            let (low, high) = (t0.min(t1).max(0.0), t0.max(t1).min(1.0));
            if high - low > 1e-3 {
                let mut least = f32::MAX;
                for (k, s) in [low, high].into_iter().enumerate() {
                    let c = core.at(s);
                    // Straight ahead, along the normal.
                    let ahead = c + normal * apart;
                    let q = v + e * (e.dot(ahead - v) / ee).clamp(0.0, 1.0);
                    let height = normal.dot(q - c);
                    least = least.min(height - core.radius_at(s));
                    add(s, height, k as u32);
                }
                if least <= nearest + tolerance {
                    return;
                }
            }
        }
        add(s, apart, 3);
        // Over the edge of a face it nearly lies on: the other end over the face steadies it.
        let slope = -normal.dot(touch.front);
        if slope > 0.99 && !core.is_ball() && points.len() == first + 1 {
            let other = |s: f32| self.height(s) / slope;
            let (low, high) = self.shadow(normal, slope);
            let end = if (low - s).abs() > (high - s).abs() { low } else { high };
            if low <= high && (end - s).abs() > 0.05 {
                let (height, r) = (other(end), core.radius_at(end));
                if height - r <= self.margin {
                    let position = core.at(end) + normal * (0.5 * (height + r));
                    let key = key(touch.index, 0x80 | (self.edge as u32) << 2 | 2);
                    points.push(RawPoint { position, separation: height - r, key });
                }
            }
        }
    }

    /// The part of the core that is over the triangle as seen along a normal.
    fn shadow(&self, normal: Vec3, slope: f32) -> (f32, f32) {
        let at = |s: f32| self.core.at(s) + normal * (self.height(s) / slope);
        let (start, end) = (at(0.0), at(1.0));
        part_inside((0..3).map(|i| {
            let (out, from) = (self.touch.outward(i), self.touch.corners[i]);
            (out.dot(start - from), out.dot(end - from))
        }))
    }
}
