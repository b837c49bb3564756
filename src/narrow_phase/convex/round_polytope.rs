//! A sphere or capsule against a polytope, and round shapes among themselves.
//!
//! Reference plane first: the ends of the core are projected on the best face and the core is clipped to its
//! side planes, which gives both points of a capsule that lies on it. Where that isn't nearest, the nearest
//! edge is, or one of its vertices: exactly, over all edges of faces that the core sees.

use super::clip::Spans;
use super::polytope::Polytope;
use super::sat::{in_lanes, nearest_on_segments, offer};
use crate::config::tuning::ALONG_SINE_SQUARED;
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, f32x8};
use crate::narrow_phase::contacts::manifold::RawManifold;
use crate::shape::{Collider, Geometry};
use glam::Vec3;

/// The most faces of a polytope, in words of 64.
const FACE_WORDS: usize = 8;

/// A sphere or capsule: all balls with centres from `start` to `start + along`, with radii linear in between
/// [m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Core {
    pub(crate) start: Vec3,
    /// Zero: a sphere.
    pub(crate) along: Vec3,
    pub(crate) radius: f32,
    /// Growth of the radius to the other end; less than the length.
    pub(crate) growth: f32,
}

impl Core {
    pub(crate) fn of(shape: &Collider) -> Option<Core> {
        match shape.geometry {
            Geometry::Sphere { radius } => {
                Some(Core { start: Vec3::ZERO, along: Vec3::ZERO, radius, growth: 0.0 })
            }
            Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                let growth = radius_top - radius_bottom;
                if growth.abs() >= 2.0 * half_height {
                    // One ball contains the other.
                    let (y, radius) =
                        if growth > 0.0 { (half_height, radius_top) } else { (-half_height, radius_bottom) };
                    return Some(Core { start: Vec3::Y * y, along: Vec3::ZERO, radius, growth: 0.0 });
                }
                let start = Vec3::new(0.0, -half_height, 0.0);
                let along = Vec3::new(0.0, 2.0 * half_height, 0.0);
                Some(Core { start, along, radius: radius_bottom, growth })
            }
            _ => None,
        }
    }
    pub(crate) fn at(&self, s: f32) -> Vec3 {
        self.start + self.along * s
    }
    pub(crate) fn radius_at(&self, s: f32) -> f32 {
        self.radius + self.growth * s
    }
    pub(crate) fn is_ball(&self) -> bool {
        self.along == Vec3::ZERO
    }
    pub(crate) fn moved(&self, pose: &crate::narrow_phase::convex::polytope::Pose) -> Core {
        Core { start: pose.point(self.start), along: pose.direction(self.along), ..*self }
    }

    /// Where on the core the ball is that comes nearest to a point: the foot of the perpendicular, shifted
    /// towards the thicker end by the distance that makes the surface there perpendicular to the way out.
    #[inline(always)]
    fn nearest<L: Lanes>(&self, point: LaneVec3<L>) -> L {
        let squared = self.along.length_squared();
        if squared == 0.0 {
            return L::zero();
        }
        let away = point - LaneVec3::splat(self.start);
        let along = LaneVec3::splat(self.along);
        let mut s = away.dot(along) * L::splat(1.0 / squared);
        if self.growth != 0.0 {
            let aside = (away - along * s).length();
            s += aside * L::splat(self.growth / (squared * (squared - self.growth * self.growth)).sqrt());
        }
        s.clamp(L::zero(), L::one())
    }

    /// Where the core and the segments `q + t e` come nearest.
    #[inline(always)]
    pub(crate) fn nearest_segment<L: Lanes>(&self, q: LaneVec3<L>, e: LaneVec3<L>) -> (L, L) {
        let (start, along) = (LaneVec3::<L>::splat(self.start), LaneVec3::<L>::splat(self.along));
        if self.growth == 0.0 {
            return nearest_on_segments(start, along, q, e);
        }
        // As between lines of one radius, but shifted along the core as in `nearest`: the squared distance is
        // c² + k² (s - s*)², c the distance of the lines and k the sine between them.
        let (zero, one, tiny) = (L::zero(), L::one(), L::splat(1e-30));
        let r = start - q;
        let (dd, ee) = (L::splat(self.along.length_squared()), e.dot(e).max(tiny));
        let (de, dr, er) = (along.dot(e), along.dot(r), e.dot(r));
        let det = dd * ee - de * de;
        let cross = along.cross(e);
        let sine2 = cross.length_squared() / (dd * ee);
        let growth = L::splat(self.growth / self.along.length());
        let allowance = sine2 - growth * growth;
        let crossing = allowance.gt(L::splat(1e-6)) & det.gt(dd * ee * L::splat(1e-6));
        let apart = (r.dot(cross)).abs() / cross.length().max(tiny);
        let shift = apart * growth / (sine2 * allowance * dd).max(tiny).sqrt();
        let thick = if self.growth > 0.0 { one } else { zero };
        let s = L::select(crossing, (de * er - dr * ee) / L::select(crossing, det, one) + shift, thick);
        let s = s.clamp(zero, one);
        let t = ((de * s + er) / ee).clamp(zero, one);
        let s = self.nearest(q + e * t);
        let t = ((de * s + er) / ee).clamp(zero, one);
        (s, t)
    }
}

fn lanes(v: Vec3) -> LaneVec3<f32> {
    LaneVec3::new(v.x, v.y, v.z)
}

/// Any unit vector that is perpendicular to both, or to the first if they are parallel.
fn perpendicular(a: Vec3, b: Vec3) -> Vec3 {
    let cross = a.cross(b);
    if cross.length_squared() > 1e-8 * a.length_squared() * b.length_squared() {
        return cross.normalize();
    }
    let a = if a.length_squared() > 0.0 { a } else { b };
    if a.length_squared() > 0.0 { a.normalize().any_orthonormal_vector() } else { Vec3::Y }
}

/// The face that a core is furthest in front of.
struct BestFace {
    face: usize,
    normal: Vec3,
    offset: f32,
    separation: f32,
    /// Which faces the core sees, a bit each.
    seen: [u64; FACE_WORDS],
}

impl BestFace {
    /// If they are further apart than the margin: by how much at least.
    #[inline(always)]
    fn of(core: &Core, p: &Polytope, margin: f32, tolerance: f32) -> Result<BestFace, f32> {
        let (start, end) = (core.start, core.start + core.along);
        let (r0, r1) = (core.radius, core.radius + core.growth);
        let mut best = (f32::MIN, 0);
        let mut seen = [0u64; FACE_WORDS];
        for (k, [nx, ny, nz, offset]) in p.normal_chunks.iter().enumerate() {
            let n = LaneVec3::new(f32x8::new(*nx), f32x8::new(*ny), f32x8::new(*nz));
            let offset = f32x8::new(*offset);
            let s0 = n.dot(LaneVec3::splat(start)) - offset;
            let s1 = n.dot(LaneVec3::splat(end)) - offset;
            let sees = s0.gt(f32x8::splat(-tolerance)) | s1.gt(f32x8::splat(-tolerance));
            seen[(k / 8).min(FACE_WORDS - 1)] |= u64::from(sees.bits()) << (8 * (k % 8));
            let separation = Lanes::min(s0 - f32x8::splat(r0), s1 - f32x8::splat(r1));
            if offer(&mut best, separation, 8 * k) && best.0 > margin {
                return Err(best.0);
            }
        }
        let (separation, face) = best;
        let (normal, offset) = p.planes[face];
        Ok(BestFace { face, normal, offset, separation, seen })
    }

    #[inline(always)]
    fn sees(&self, face: u16) -> bool {
        face as usize >= 64 * FACE_WORDS || self.seen[usize::from(face) / 64] >> (face % 64) & 1 != 0
    }

    /// Height of the core's axis over the face [m].
    #[inline(always)]
    fn height(&self, core: &Core, s: f32) -> f32 {
        self.normal.dot(core.at(s)) - self.offset
    }

    /// The points of the core at `low` and `high` over the face.
    #[inline(always)]
    fn add_points(&self, core: &Core, (low, high): (f32, f32), margin: f32, manifold: &mut RawManifold) {
        manifold.normal = -self.normal;
        for (k, s) in [low, high].into_iter().enumerate() {
            let (h, r) = (self.height(core, s), core.radius_at(s));
            if k == 0 || high - low > 1e-3 {
                let position = core.at(s) - self.normal * (0.5 * (h + r));
                manifold.add(margin, position, h - r, 2 * self.face as u32 + k as u32);
            }
        }
    }
}

/// The edge of a polytope that is nearest to a core, and where on both that is.
struct NearestEdge {
    distance: f32,
    edge: usize,
    /// On the core, 0..=1.
    s: f32,
    /// On the edge, 0..=1.
    t: f32,
}

impl NearestEdge {
    /// Something is nearest that a face sees which the core sees: if the way out of an edge or vertex is a
    /// sum of normals with positive weights, one of them points towards the core.
    #[inline(always)]
    fn of(core: &Core, p: &Polytope, best: &BestFace) -> NearestEdge {
        let sees = |f: u16| best.sees(f);
        let mut wanted = p.edges.iter().enumerate().filter(|(_, e)| sees(e.faces[0]) || sees(e.faces[1]));
        let mut nearest = NearestEdge { distance: f32::MAX, edge: 0, s: 0.0, t: 0.0 };
        while let Some((first, _)) = wanted.next() {
            let mut index = [first; 8];
            for i in 1..8 {
                index[i] = wanted.next().map_or(index[i - 1], |(e, _)| e);
            }
            let end =
                |k: usize| in_lanes::<f32x8>(|i| p.vertices[usize::from(p.edges[index[i]].vertices[k])]);
            let q = end(0);
            let e = end(1) - q;
            let (s, t) = core.nearest_segment(q, e);
            let apart = (q + e * t - LaneVec3::splat(core.start) - LaneVec3::splat(core.along) * s).length();
            let distance = apart - f32x8::splat(core.radius) - s * f32x8::splat(core.growth);
            if distance.lt(f32x8::splat(nearest.distance)).any() {
                for (i, &d) in distance.to_array().iter().enumerate() {
                    if d < nearest.distance {
                        nearest = NearestEdge { distance: d, edge: index[i], s: s.lane(i), t: t.lane(i) };
                    }
                }
            }
        }
        nearest
    }
}

/// A core and a polytope in the frame of the polytope; the normal points from the core to the polytope.
///
/// `size` is a length of the smaller one [m]; tolerances are a ten-thousandth of it.
pub(crate) fn round_polytope(core: &Core, p: &Polytope, margin: f32, size: f32) -> RawManifold {
    let mut manifold = RawManifold::default();
    let (start, end) = (core.start, core.start + core.along);
    let (r0, r1) = (core.radius, core.radius + core.growth);
    let tolerance = 1e-4 * size;
    let best = match BestFace::of(core, p, margin, tolerance) {
        Ok(best) => best,
        Err(gap) => return RawManifold::apart(gap),
    };
    let height = |s: f32| best.height(core, s);

    let (low, high) = over_face(p, best.face, start, end);
    let over = low <= high;
    let whole = (low, if core.is_ball() { low } else { high });
    let nearest_face = (height(low) - core.radius_at(low)).min(height(high) - core.radius_at(high));
    if over && nearest_face <= best.separation + tolerance {
        best.add_points(core, whole, margin, &mut manifold);
        return manifold;
    }

    // A plane that the whole core is in front of proves that it doesn't.
    if best.separation <= -r0.min(r1) && pierces(core, p) {
        if over {
            best.add_points(core, whole, margin, &mut manifold);
        } else {
            let deeper = if height(0.0) - r0 <= height(1.0) - r1 { 0.0 } else { 1.0 };
            best.add_points(core, (deeper, deeper), margin, &mut manifold);
        }
        return manifold;
    }

    let nearest = NearestEdge::of(core, p, &best);
    if nearest.distance <= margin {
        add_edge_points(core, p, &best, &nearest, margin, size, &mut manifold);
    } else {
        // Unless there was no edge to look at.
        return RawManifold::apart(if nearest.distance < f32::MAX { nearest.distance } else { 0.0 });
    }
    manifold
}

/// The points of a core and the edge of a polytope that is nearest to it.
#[inline(always)]
fn add_edge_points(
    core: &Core,
    p: &Polytope,
    best: &BestFace,
    nearest: &NearestEdge,
    margin: f32,
    size: f32,
    manifold: &mut RawManifold,
) {
    let &NearestEdge { edge, s, t, .. } = nearest;
    let [start, end] = p.edges[edge].vertices.map(|v| p.vertices[usize::from(v)]);
    let along = end - start;
    let (c, q) = (core.at(s), start + along * t);
    let apart = (q - c).length();
    let normal = if apart > 1e-6 * size { (q - c) / apart } else { -best.normal };
    manifold.normal = normal;
    let name = (edge as u32 | 0x8000) << 2;
    let (front, tolerance) = (best.normal, 1e-4 * size);
    EdgeContact { core, s, start, end, along, normal, apart, tolerance, front, counts: margin }.add_points(
        |s| best.height(core, s),
        |from, to| over_face(p, best.face, from, to),
        |position, separation, k| {
            manifold.add(margin, position, separation, name + k);
            separation <= margin
        },
    );
}

/// A core and the edge of a face that is nearest to it.
pub(crate) struct EdgeContact<'a> {
    pub(crate) core: &'a Core,
    /// Where on the core that is, 0..=1.
    pub(crate) s: f32,
    /// Ends and direction of the edge.
    pub(crate) start: Vec3,
    pub(crate) end: Vec3,
    pub(crate) along: Vec3,
    /// Unit, from the core to the edge.
    pub(crate) normal: Vec3,
    /// Distance of the nearest points of core and edge [m].
    pub(crate) apart: f32,
    /// Points that are further away by less are as near [m].
    pub(crate) tolerance: f32,
    /// Outward normal of the face.
    pub(crate) front: Vec3,
    /// How near the ends of a shared stretch have to be to stand for the nearest point [m].
    pub(crate) counts: f32,
}

impl EdgeContact<'_> {
    /// Adds both ends of the common part if the two lie along each other, else the nearest point and, where
    /// the core nearly lies on the face, one that steadies it.
    ///
    /// `height`: of a place on the core's axis over the face [m]. `over`: the part of a segment that is over
    /// the face. `add`: takes position, separation and a number below four, and says whether it added that.
    #[inline(always)]
    pub(crate) fn add_points(
        &self,
        height: impl Fn(f32) -> f32,
        over: impl Fn(Vec3, Vec3) -> (f32, f32),
        mut add: impl FnMut(Vec3, f32, u32) -> bool,
    ) {
        let &EdgeContact { core, s, start, end, along, normal, apart, .. } = self;
        let (mut least, mut count) = (f32::MAX, 0);
        let mut put = |s: f32, height: f32, name: u32| {
            let (c, r) = (core.at(s), core.radius_at(s));
            count += u32::from(add(c + normal * (0.5 * (height + r)), height - r, name));
            count
        };
        let (dd, ee, de) = (core.along.length_squared(), along.length_squared(), core.along.dot(along));
        if dd > 0.0 && ee > 0.0 && dd * ee - de * de < ALONG_SINE_SQUARED * dd * ee {
            let (t0, t1) = (core.along.dot(start - core.start) / dd, core.along.dot(end - core.start) / dd);
            let (low, high) = (t0.min(t1).max(0.0), t0.max(t1).min(1.0));
            if high - low > 1e-3 {
                for (k, s) in [low, high].into_iter().enumerate() {
                    let c = core.at(s);
                    // Straight ahead, along the normal.
                    let ahead = c + normal * apart;
                    let q = start + along * (along.dot(ahead - start) / ee).clamp(0.0, 1.0);
                    let height = normal.dot(q - c);
                    let separation = height - core.radius_at(s);
                    least = if separation <= self.counts { least.min(separation) } else { least };
                    put(s, height, k as u32);
                }
            }
        }
        if least <= apart - core.radius_at(s) + self.tolerance {
            return;
        }
        let alone = put(s, apart, 3) == 1;
        // Over the edge of a face it nearly lies on: the other end over the face steadies it.
        let slope = -normal.dot(self.front);
        if alone && slope > 0.99 && !core.is_ball() {
            let shadow = |s: f32| core.at(s) + normal * (height(s) / slope);
            let (low, high) = over(shadow(0.0), shadow(1.0));
            let other = if (low - s).abs() > (high - s).abs() { low } else { high };
            if low <= high && (other - s).abs() > 0.05 {
                put(other, height(other) / slope, 2);
            }
        }
    }
}

/// The part of a segment that is over a face, in the segment's 0..=1; the first above the second if none is.
fn over_face(p: &Polytope, face: usize, start: Vec3, end: Vec3) -> (f32, f32) {
    let (normal, _) = p.planes[face];
    let corners = p.face(face);
    let corner = |i: usize| p.vertices[usize::from(corners[if i < corners.len() { i } else { 0 }])];
    part_inside((0..corners.len()).map(|i| {
        let out = (corner(i + 1) - corner(i)).cross(normal);
        (out.dot(start - corner(i)), out.dot(end - corner(i)))
    }))
}

/// The part of a segment, of its 0..=1, that is inside of all sides, given how far its ends are beyond each;
/// the first above the second if none is.
pub(crate) fn part_inside(beyond: impl Iterator<Item = (f32, f32)>) -> (f32, f32) {
    let mut span = Spans::<f32>::whole();
    for (start, end) in beyond {
        span.cut(start, end);
    }
    (span.enter, span.exit)
}

/// Whether the core itself, without its radius, meets the polytope.
fn pierces(core: &Core, p: &Polytope) -> bool {
    let mut span = Spans::<f32x8>::whole();
    for [nx, ny, nz, offset] in p.normal_chunks {
        let n = LaneVec3::new(f32x8::new(*nx), f32x8::new(*ny), f32x8::new(*nz));
        let d0 = n.dot(LaneVec3::splat(core.start)) - f32x8::new(*offset);
        let d1 = d0 + n.dot(LaneVec3::splat(core.along));
        span.cut(d0, d1);
    }
    let enter = span.enter.to_array().into_iter().fold(0.0, f32::max);
    enter <= span.exit.to_array().into_iter().fold(1.0, f32::min)
}

/// Two spheres or capsules in one frame.
pub(crate) fn round_round(a: &Core, b: &Core, margin: f32) -> RawManifold {
    let mut manifold = RawManifold::default();
    let gap = |s: f32| {
        let t = b.nearest(lanes(a.at(s)));
        (b.at(t) - a.at(s)).length() - a.radius_at(s) - b.radius_at(t)
    };
    let (mut s, _) = nearest_on_segments(lanes(a.start), lanes(a.along), lanes(b.start), lanes(b.along));
    if (a.growth != 0.0 || b.growth != 0.0) && !a.is_ball() {
        if b.is_ball() {
            s = a.nearest(lanes(b.start));
        } else {
            // Convex in s, and no closed form if both are tapered: golden sections, each 0.618 of the one
            // before.
            let ratio = 0.618_034;
            let (mut low, mut high) = (0.0f32, 1.0f32);
            for _ in 0..32 {
                let (one, two) = (high - ratio * (high - low), low + ratio * (high - low));
                if gap(one) < gap(two) {
                    high = two;
                } else {
                    low = one;
                }
            }
            s = 0.5 * (low + high);
            for end in [0.0, 1.0] {
                s = if gap(end) <= gap(s) { end } else { s };
            }
        }
    }
    let t = b.nearest(lanes(a.at(s)));
    let (p, q) = (a.at(s), b.at(t));
    let apart = (q - p).length();
    if apart - a.radius_at(s) - b.radius_at(t) > margin {
        return manifold;
    }
    let n =
        if apart > 1e-6 * (a.radius + b.radius) { (q - p) / apart } else { perpendicular(a.along, b.along) };
    manifold.normal = n;
    let mut emit = |s: f32, t: f32, key: u32| {
        let (p, q) = (a.at(s), b.at(t));
        let (h, ra, rb) = (n.dot(q - p), a.radius_at(s), b.radius_at(t));
        manifold.add(margin, (p + q + n * (ra - rb)) * 0.5, h - ra - rb, key);
    };
    let (aa, bb, ab) = (a.along.length_squared(), b.along.length_squared(), a.along.dot(b.along));
    if aa > 0.0 && bb > 0.0 && aa * bb - ab * ab < ALONG_SINE_SQUARED * aa * bb {
        let (t0, t1) = (a.along.dot(b.start - a.start) / aa, a.along.dot(b.at(1.0) - a.start) / aa);
        let (low, high) = (t0.min(t1).max(0.0), t0.max(t1).min(1.0));
        // Side by side, and not overlapping so deep that the way out is along them.
        if high - low > 1e-3 && n.dot(a.along).abs() < 0.5 * aa.sqrt() {
            for (s, key) in [(low, 0), (high, 1)] {
                // Straight ahead, along the normal.
                emit(s, (b.along.dot(a.at(s) + n * apart - b.start) / bb).clamp(0.0, 1.0), key);
            }
        }
    }
    // Tapered ones can be nearest in between.
    emit(s, t, 2);
    let count = manifold.count as usize;
    if count > 1 {
        let between = manifold.points[count - 1].separation;
        manifold.count -= 1;
        if manifold.least() > between + 1e-4 * (a.radius + b.radius) {
            manifold.count += 1;
        }
    }
    manifold
}
