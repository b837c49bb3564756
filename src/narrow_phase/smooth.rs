//! Cylinders, frusta and cones against any polytope, and against capsules.
//!
//! A prism with an edge in the direction of contact *is* the cylinder there. So the separating-axis test runs on a
//! prism; its axis is turned into the exact one of the round surface, each candidate judged by the exact extents of
//! both shapes (any direction is a lower bound of the distance, so a better one is never wrong); then the prisms are
//! spun to it and the contact is read off their caps, edges and rims.

#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "a NaN must go the way of a zero")]

use super::Relative;
use super::clip::{Cloud, Segment, clip_edges};
use super::convex::{face_contact, manifold_of};
use super::gjk::distance;
use super::manifold::{RawManifold, RawPoint};
use super::polytope::{Polytope, Pose, SIDES, Solid, Triangle};
use super::round_polytope::Core;
use super::sat::{FaceAxis, edge_axis, edges_in_reach, face_axis, nearest_edges};
use super::support::Support;
use crate::shape::{Collider, Geometry};
use glam::{Quat, Vec2, Vec3};

/// Half height, radius at the bottom, radius at the top [m].
#[derive(Clone, Copy, Debug)]
struct Frustum {
    half_height: f32,
    bottom: f32,
    top: f32,
}

impl Frustum {
    fn of(shape: &Collider) -> Option<Frustum> {
        match shape.geometry {
            Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                Some(Frustum { half_height, bottom: radius_bottom, top: radius_top })
            }
            _ => None,
        }
    }
    fn extent(&self, d: Vec3) -> f32 {
        let flat = (d.x * d.x + d.z * d.z).sqrt();
        let rise = self.half_height * d.y;
        (flat * self.bottom - rise).max(flat * self.top + rise)
    }
    /// Unit vector from the axis towards a point or along a direction; x if that is on the axis.
    fn outward(p: Vec3) -> Vec3 {
        let flat = (p.x * p.x + p.z * p.z).sqrt();
        if flat > 0.0 && flat < f32::MAX { Vec3::new(p.x / flat, 0.0, p.z / flat) } else { Vec3::X }
    }
    /// Outward normal of the side where a point is.
    fn side_normal(&self, p: Vec3) -> Vec3 {
        let u = Frustum::outward(p);
        (u * (2.0 * self.half_height) + Vec3::Y * (self.bottom - self.top)).normalize()
    }
    /// The direction of the side's straight line towards `n`, or of the rim there.
    fn line(&self, n: Vec3, rim: bool) -> Vec3 {
        let u = Frustum::outward(n);
        if rim {
            Vec3::new(-u.z, 0.0, u.x)
        } else {
            u * (self.top - self.bottom) + Vec3::Y * (2.0 * self.half_height)
        }
    }
}

/// What a cylinder meets.
pub(super) enum Other<'a> {
    Shape(&'a Collider),
    Triangle(&'a Triangle),
}

impl<'a> Other<'a> {
    fn solid(&self, direction: Vec3) -> Option<Solid<'a>> {
        match self {
            Other::Shape(shape) => Solid::of(shape, direction),
            Other::Triangle(triangle) => Some(Solid::Triangle((*triangle).clone())),
        }
    }
    fn frustum(&self) -> Option<Frustum> {
        match self {
            Other::Shape(shape) => Frustum::of(shape),
            Other::Triangle(_) => None,
        }
    }
}

/// What of one shape is in contact: decides which curve its part of the axis comes from.
#[derive(Clone, Copy, Debug)]
enum Part {
    /// A straight edge, in a's frame.
    Edge(Vec3),
    /// A vertex, in a's frame.
    Vertex(Vec3),
    Side,
    Rim,
}

/// Two solids with what is needed to judge a direction exactly.
struct Both<'a> {
    pose: &'a Pose,
    round: [Option<Frustum>; 2],
    flat: [Polytope<'a>; 2],
}

impl Both<'_> {
    fn extent(&self, k: usize, d: Vec3) -> f32 {
        self.round[k].map_or_else(|| self.flat[k].support(d).1, |f| f.extent(d))
    }
    /// Distance of the two along `n` (unit, a's frame).
    fn separation(&self, n: Vec3) -> f32 {
        n.dot(self.pose.position) - self.extent(1, self.pose.back(-n)) - self.extent(0, n)
    }
    /// The direction of a part of shape `k` where it faces along `n`, in a's frame.
    fn line(&self, k: usize, part: Part, n: Vec3) -> Option<Vec3> {
        let rim = matches!(part, Part::Rim);
        match (part, self.round[k]) {
            (Part::Edge(e), _) => Some(e),
            (Part::Side | Part::Rim, Some(f)) if k == 0 => Some(f.line(n, rim)),
            (Part::Side | Part::Rim, Some(f)) => Some(self.pose.direction(f.line(self.pose.back(-n), rim))),
            _ => None,
        }
    }
    /// The exact axis near `n` of two parts.
    fn refine(&self, parts: [Part; 2], n: Vec3) -> Vec3 {
        let n = self.refine_parts(parts, n);
        let tapers = |f: &Option<Frustum>| f.is_some_and(|f| f.top != f.bottom);
        let both_round = self.round.iter().all(Option::is_some);
        if both_round || self.round.iter().any(tapers) { self.climb(n) } else { n }
    }
    /// Uphill in steps that halve: for two round shapes or one that tapers, whose parts shift with the axis and whose extents are cheap.
    fn climb(&self, n: Vec3) -> Vec3 {
        let mut best = (n, self.separation(n));
        let mut step = 0.1;
        while step > 5e-4 {
            let n = best.0;
            let (u, v) = n.any_orthonormal_pair();
            for aside in [u, v, u + v, u - v] {
                for next in [(n + aside * step).normalize(), (n - aside * step).normalize()] {
                    let separation = self.separation(next);
                    if separation > best.1 {
                        best = (next, separation);
                    }
                }
            }
            if best.0 == n {
                step *= 0.5;
            }
        }
        best.0
    }
    fn refine_parts(&self, parts: [Part; 2], n: Vec3) -> Vec3 {
        if parts.iter().any(|part| matches!(part, Part::Rim)) {
            return self.refine_rim(parts, n);
        }
        let mut best = (n, self.separation(n));
        let mut now = n;
        for _ in 0..4 {
            let next = match [0, 1].map(|k| self.line(k, parts[k], now)) {
                [Some(d), Some(e)]
                    if d.cross(e).length_squared() > 1e-4 * d.length_squared() * e.length_squared() =>
                {
                    d.cross(e)
                }
                _ => match self.sideways(parts, now) {
                    Some(radial) => radial,
                    None => break,
                },
            };
            let length = next.length();
            if !(length > 0.0) {
                break;
            }
            now = if next.dot(n) < 0.0 { -next / length } else { next / length };
            let separation = self.separation(now);
            if separation > best.1 {
                best = (now, separation);
            }
        }
        best.0
    }
    /// The exact axis near `n` where a rim meets a line: the line and a tangent of the rim make an axis, and the tangent
    /// is searched for by golden sections. Of two rims one after the other.
    fn refine_rim(&self, parts: [Part; 2], mut n: Vec3) -> Vec3 {
        let both = parts.iter().all(|part| matches!(part, Part::Rim));
        for k in if both { &[0usize, 1, 0][..] } else { &[0, 1] } {
            let (k, other) = (*k, 1 - *k);
            if !matches!(parts[k], Part::Rim) {
                continue;
            }
            let (Some(t), Some(line)) = (self.line(k, Part::Rim, n), self.line(other, parts[other], n))
            else {
                continue;
            };
            let up = if k == 0 { Vec3::Y } else { self.pose.axes.y_axis };
            let aside = up.cross(t);
            let axis = |x: f32| {
                let cross = (t + aside * x).cross(line);
                let length = cross.length();
                let axis = if length > 0.0 { cross / length } else { n };
                if axis.dot(n) < 0.0 { -axis } else { axis }
            };
            // Half the angle between two edges of the prism, and some more.
            let ratio = 0.618_034;
            let (mut low, mut high) = (-0.35f32, 0.35f32);
            let point = |low: f32, high: f32| high - ratio * (high - low);
            let (mut one, mut two) = (point(low, high), point(high, low));
            let (mut at_one, mut at_two) = (self.separation(axis(one)), self.separation(axis(two)));
            for _ in 0..14 {
                if at_one > at_two {
                    (high, two, at_two) = (two, one, at_one);
                    one = point(low, high);
                    at_one = self.separation(axis(one));
                } else {
                    (low, one, at_one) = (one, two, at_two);
                    two = point(high, low);
                    at_two = self.separation(axis(two));
                }
            }
            let found = axis(0.5 * (low + high));
            if self.separation(found) > self.separation(n) {
                n = found;
            }
        }
        n
    }
    /// The normal of a round side towards what it meets: a vertex, an edge along it, another round shape's axis or rim.
    fn sideways(&self, parts: [Part; 2], n: Vec3) -> Option<Vec3> {
        if let (Part::Side, Some(f)) = (parts[0], self.round[0]) {
            let at = match parts[1] {
                Part::Vertex(v) => v,
                Part::Side => self.pose.position,
                _ => self.pose.point(self.flat[1].vertices[self.flat[1].support(self.pose.back(-n)).0]),
            };
            return Some(f.side_normal(at));
        }
        if let (Part::Side, Some(f)) = (parts[1], self.round[1]) {
            let at = match parts[0] {
                Part::Vertex(v) => v,
                _ => self.flat[0].vertices[self.flat[0].support(n).0],
            };
            let local = self.pose.back(at - self.pose.position);
            return Some(-self.pose.direction(f.side_normal(local)));
        }
        None
    }
}

/// A cylinder or a polytope and another shape of which at least one is a cylinder; see `collide_convex`.
pub(super) fn cylinder(a: &Collider, b: &Other, pose: &Pose, margin: f32) -> RawManifold {
    let found = by_axes(a, b, pose, margin);
    if found.count != 1 || found.points[0].separation >= 0.0 {
        return found;
    }
    // One vertex, maybe beside the face: the axes tried are those of what is near, and no face sees that the two are
    // apart by edges that are not.
    let other = match b {
        Other::Shape(b) => Support::of(b),
        Other::Triangle(t) => Some(Support::triangle(t.corners())),
    };
    let (Some(own), Some(other)) = (Support::of(a), other) else { return found };
    let at = Relative { position: pose.position, rotation: Quat::from_mat3(&pose.axes) };
    let nearest = distance(&own, &other, &at, found.normal);
    if nearest.overlap || nearest.distance <= 0.0 {
        return found;
    }
    let mut apart = RawManifold { normal: nearest.normal, ..found };
    apart.count = u32::from(nearest.distance <= margin);
    apart.points[0].position = (nearest.point_a + nearest.point_b) * 0.5;
    apart.points[0].separation = nearest.distance;
    apart
}

fn by_axes(a: &Collider, b: &Other, pose: &Pose, margin: f32) -> RawManifold {
    let none = RawManifold::default();
    let back = pose.inverse();
    let (size, against) = match b {
        Other::Shape(b) => (a.radius.min(b.radius), Vec3::ZERO),
        Other::Triangle(t) => (a.radius, t.normal()),
    };
    let tolerance = 5e-4 * size;
    let round = [Frustum::of(a), b.frustum()];
    // A prism is inside of its cylinder by at most this much.
    let slack = 0.02 * round.iter().flatten().map(|f| f.bottom.max(f.top)).sum::<f32>();

    let (Some(of_a), Some(of_b)) = (Solid::of(a, pose.position), b.solid(back.position)) else { return none };
    let (p, q) = (of_a.view(), of_b.view());
    let Some(axis) = best_axis(&p, &q, (pose, &back), margin + slack, slack + tolerance, against) else {
        return none;
    };
    let both = Both { pose, round, flat: [p, q] };
    let mut n = axis.normal;
    if let Some(parts) = axis.parts {
        let refined = both.refine(parts, n);
        n = if refined.dot(against) > 1e-3 { n } else { refined };
    }
    let separation = both.separation(n);
    if separation > margin {
        return none;
    }

    let (Some(of_a), Some(of_b)) = (Solid::of(a, n), b.solid(pose.back(-n))) else { return none };
    let (p, q) = (of_a.view(), of_b.view());
    let mut cloud = Cloud::new();
    // Nearly along a flat face is along it, if that costs nothing.
    let planar = planar(&p, &q, pose, n).map(|(on_b, face)| {
        let n = if on_b { -pose.direction(q.planes[face].0) } else { p.planes[face].0 };
        (on_b, FaceAxis { separation: both.separation(n), face })
    });
    if let Some((on_b, face)) = planar.filter(|(_, face)| face.separation >= separation - tolerance) {
        let normal = face_contact(&p, &q, pose, (face, on_b), margin, tolerance, &mut cloud);
        if face.separation <= 0.0 || cloud.least() <= face.separation + tolerance {
            return manifold_of(&cloud, normal);
        }
    } else if separation <= 0.0 {
        return along(a, b, &both, n, margin, size);
    }
    match apart(a, b, (&both, &back), n, margin, slack) {
        Some(n) => along(a, b, &both, n, margin, size),
        None => none,
    }
}

/// Apart, and nearest at an edge, a rim or a round side of both. Spun towards the nearest points, looked at again;
/// of what is found the direction along which they are furthest apart, since no direction shows more than the
/// distance.
fn apart(
    a: &Collider,
    b: &Other,
    (both, back): (&Both, &Pose),
    first: Vec3,
    margin: f32,
    slack: f32,
) -> Option<Vec3> {
    let pose = both.pose;
    let mut best = (first, both.separation(first));
    let (mut spin_a, mut spin_b) = (first, pose.back(-first));
    for _ in 0..3 {
        let (of_a, of_b) = (Solid::of(a, spin_a)?, b.solid(spin_b)?);
        let (p, q) = (of_a.view(), of_b.view());
        let n = best.0;
        let high = p.support(n).1;
        let low = n.dot(pose.position) - q.support(pose.back(-n)).1;
        let near = edges_in_reach(&p, &q, pose, back, margin + slack, n, (high, low));
        let Some(nearest) = nearest_edges(&p, &q, pose, &near) else { break };
        let [on_a, on_b] = nearest.points;
        if !(nearest.distance > 0.0) {
            break;
        }
        let n = (on_b - on_a) / nearest.distance;
        let parts = [part(&p, nearest.edges[0], &Pose::IDENTITY), part(&q, nearest.edges[1], pose)];
        for n in [n, both.refine(parts, n)] {
            let separation = both.separation(n);
            if separation > best.1 {
                best = (n, separation);
            }
        }
        // The point of a rim or side that is nearest to a vertex is on the way from the axis to it.
        (spin_a, spin_b) = (on_b, pose.back(on_a - pose.position));
    }
    let n = both.climb(best.0);
    (both.separation(n) <= margin).then_some(n)
}

/// The kind of an edge.
fn part(p: &Polytope, edge: usize, pose: &Pose) -> Part {
    match p.sides {
        0 => {
            let [v, w] = p.edges[edge].vertices.map(|v| p.vertices[usize::from(v)]);
            Part::Edge(pose.direction(w - v))
        }
        _ if edge < SIDES => Part::Side,
        _ => Part::Rim,
    }
}

/// The contact where two shapes face each other along `n`, with prisms spun to it.
fn along(a: &Collider, b: &Other, both: &Both, n: Vec3, margin: f32, size: f32) -> RawManifold {
    let pose = both.pose;
    let (Some(of_a), Some(of_b)) = (Solid::of(a, n), b.solid(pose.back(-n))) else {
        return RawManifold::default();
    };
    let separation = both.separation(n);
    let mut cloud = Cloud::new();
    let one = Segment::support(&of_a.view(), n, 0.01 * size, &Pose::IDENTITY);
    let other = Segment::support(&of_b.view(), pose.back(-n), 0.01 * size, pose);
    clip_edges(&one, &other, n, margin, &mut cloud);
    let mut manifold = manifold_of(&cloud, n);
    if manifold.count == 1 {
        manifold.points[0].separation = separation;
    }
    manifold
}

/// The best axis of two prisms or polytopes.
struct Axis {
    normal: Vec3,
    /// The parts in contact, unless a flat face is the axis.
    parts: Option<[Part; 2]>,
}

/// The flat face that faces along `n`, and whether it is b's.
fn planar(p: &Polytope, q: &Polytope, pose: &Pose, n: Vec3) -> Option<(bool, usize)> {
    let flat = |p: &Polytope, d: Vec3| {
        let face = p.face_towards(d);
        (face >= p.sides && p.planes[face].0.dot(d) > 0.999).then_some(face)
    };
    let of_q = || flat(q, pose.back(-n)).map(|face| (true, face));
    flat(p, n).map(|face| (false, face)).or_else(of_q)
}

/// Face and edge axes; `None` if one separates by more than the margin. Flat faces are preferred by the tolerance.
fn best_axis(
    p: &Polytope,
    q: &Polytope,
    (pose, back): (&Pose, &Pose),
    margin: f32,
    tolerance: f32,
    against: Vec3,
) -> Option<Axis> {
    let face_p = face_axis(p, q, pose, margin, against);
    let face_q = face_axis(q, p, back, margin, Vec3::ZERO);
    if face_p.separation > margin || face_q.separation > margin {
        return None;
    }
    let on_q = face_q.separation > face_p.separation;
    let face = if on_q { face_q } else { face_p };
    let (normal, high, low) = if on_q {
        let n = -pose.direction(q.planes[face.face].0);
        let low = n.dot(pose.position) - q.planes[face.face].1;
        (n, low - face.separation, low)
    } else {
        let (n, offset) = p.planes[face.face];
        (n, offset, offset + face.separation)
    };
    let near = edges_in_reach(p, q, pose, back, margin.max(-face.separation), normal, (high, low));
    let edges = edge_axis(p, q, pose, &near, against);
    if let Some(e) = edges.filter(|e| e.separation > face.separation) {
        if e.separation > margin {
            return None;
        }
        // A rim's chord beats the cap it belongs to by rounding and by the prism's error; it isn't better then.
        if e.separation > face.separation + tolerance.min(0.05 * e.separation.abs()) {
            let parts = [part(p, e.edges[0], &Pose::IDENTITY), part(q, e.edges[1], pose)];
            return Some(Axis { normal: e.normal, parts: Some(parts) });
        }
    }
    let (own, other) = if on_q { (q, p) } else { (p, q) };
    if face.face >= own.sides {
        return Some(Axis { normal, parts: None });
    }
    // A side of the prism: what of the other it meets.
    let d = if on_q { normal } else { pose.back(-normal) };
    let met = if other.sides > 0 {
        if other.face_towards(d) < other.sides { Part::Side } else { Part::Rim }
    } else {
        let v = other.vertices[other.support(d).0];
        Part::Vertex(if on_q { v } else { pose.point(v) })
    };
    Some(Axis { normal, parts: Some(if on_q { [met, Part::Side] } else { [Part::Side, met] }) })
}

/// A sphere or capsule and a cylinder, in the frame of the cylinder; the normal points to the cylinder.
///
/// The signed distance of a point from the frustum is exact and, like that of any convex set, convex: so is what the
/// balls of a capsule are away, and golden sections find the nearest. Lying along a side or on a cap gives two points.
pub(super) fn round_cylinder(core: &Core, shape: &Collider, margin: f32) -> RawManifold {
    let mut manifold = RawManifold::default();
    let Some(frustum) = Frustum::of(shape) else { return manifold };
    let gap = |s: f32| frustum.distance(core.at(s)).0 - core.radius_at(s);
    let mut s = 0.0;
    if !core.is_ball() {
        let ratio = 0.618_034;
        let (mut low, mut high) = (0.0f32, 1.0f32);
        let point = |low: f32, high: f32| high - ratio * (high - low);
        let (mut one, mut two) = (point(low, high), point(high, low));
        let (mut at_one, mut at_two) = (gap(one), gap(two));
        for _ in 0..22 {
            if at_one < at_two {
                (high, two, at_two) = (two, one, at_one);
                one = point(low, high);
                at_one = gap(one);
            } else {
                (low, one, at_one) = (one, two, at_two);
                two = point(high, low);
                at_two = gap(two);
            }
        }
        s = 0.5 * (low + high);
        for end in [0.0, 1.0] {
            s = if gap(end) <= gap(s) { end } else { s };
        }
    }
    let (distance, out) = frustum.distance(core.at(s));
    let nearest = distance - core.radius_at(s);
    if nearest > margin {
        return manifold;
    }
    let n = -out;
    manifold.normal = n;
    let mut add = |s: f32, distance: f32, key: u32| {
        let (separation, count) = (distance - core.radius_at(s), manifold.count as usize);
        if separation <= margin {
            let position = core.at(s) + n * (0.5 * (distance + core.radius_at(s)));
            manifold.points[count] = RawPoint { position, separation, key };
            manifold.count += 1;
        }
        separation
    };
    let mut least = f32::MAX;
    if let Some((low, high, height)) = frustum.shared(core, s, out) {
        for (s, key) in [(low, 0), (high, 1)] {
            least = least.min(add(s, height(s), key));
        }
    }
    if least > nearest + 1e-4 * shape.radius {
        add(s, distance, 2);
    }
    manifold
}

impl Frustum {
    /// Signed distance of a point and the way out: in the half plane of the axis and the point a frustum is three
    /// segments.
    fn distance(&self, p: Vec3) -> (f32, Vec3) {
        let u = Frustum::outward(p);
        let c = Vec2::new((p.x * p.x + p.z * p.z).sqrt(), p.y);
        let corners = [
            Vec2::new(0.0, -self.half_height),
            Vec2::new(self.bottom, -self.half_height),
            Vec2::new(self.top, self.half_height),
            Vec2::new(0.0, self.half_height),
        ];
        let (mut inside, mut out) = ((f32::MIN, Vec2::Y), (f32::MAX, Vec2::Y));
        for i in 0..3 {
            let (p, along) = (corners[i], corners[i + 1] - corners[i]);
            let squared = along.length_squared();
            if !(squared > 0.0) {
                continue;
            }
            let normal = Vec2::new(along.y, -along.x) / squared.sqrt();
            let height = normal.dot(c - p);
            if height > inside.0 {
                inside = (height, normal);
            }
            let t = (along.dot(c - p) / squared).clamp(0.0, 1.0);
            let away = c - (p + along * t);
            if away.length_squared() < out.0 {
                out = (away.length_squared(), away);
            }
        }
        let length = out.0.sqrt();
        let (distance, n) =
            if inside.0 > 0.0 && length > 0.0 { (length, out.1 / length) } else { (inside.0, inside.1) };
        (distance, u * n.x + Vec3::Y * n.y)
    }

    /// The part of a core that lies along the side or on a cap, if it does at the ball `s` with the way out `out`;
    /// and the height of its balls' centres there, along `out`.
    fn shared(&self, core: &Core, s: f32, out: Vec3) -> Option<(f32, f32, impl Fn(f32) -> f32 + use<>)> {
        let (p, d) = (core.start, core.along);
        let length = d.length();
        // The line along which the balls touch: a tapered core lies on it with its axis raised.
        let touch = d - out * core.growth;
        if !(length > 0.0) || out.dot(touch).abs() > 0.1 * length {
            return None;
        }
        let (low, high, origin) = if out.y.abs() > 0.999 {
            // Over the cap: a disc.
            let (y, r) =
                if out.y > 0.0 { (self.half_height, self.top) } else { (-self.half_height, self.bottom) };
            let (a, b) = (d.x * d.x + d.z * d.z, p.x * d.x + p.z * d.z);
            let root = b * b - a * (p.x * p.x + p.z * p.z - r * r);
            if !(root > 0.0 && a > 0.0) {
                return None;
            }
            ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a, Vec3::Y * y)
        } else {
            let u = Frustum::outward(core.at(s));
            let line = self.line(u, false);
            if touch.cross(line).length_squared() > 0.01 * length * length * line.length_squared() {
                return None;
            }
            let bottom = u * self.bottom - Vec3::Y * self.half_height;
            let ends = [bottom, bottom + line].map(|q| d.dot(q - p) / (length * length));
            (ends[0].min(ends[1]), ends[0].max(ends[1]), bottom)
        };
        let (low, high) = (low.max(0.0), high.min(1.0));
        let (at_start, rise) = (out.dot(p - origin), out.dot(d));
        (high - low > 1e-3).then_some((low, high, move |s: f32| at_start + rise * s))
    }
}
