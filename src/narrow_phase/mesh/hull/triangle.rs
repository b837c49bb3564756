//! A hull and a triangle: separating axes and nearest edges, eight faces or edges of the hull at a time.
//!
//! The same method as for any two polytopes ([`convex`](crate::narrow_phase::convex)), but a triangle has
//! three edges and one face, which makes the choice among features simpler.

use crate::config::tuning::{FACE_PREFERENCE, THROUGH_SINE};
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, kernel};
use crate::narrow_phase::RawPoint;
use crate::narrow_phase::convex::clip::{Cloud, Loop, Segment, clip_edges, clip_face, key};
use crate::narrow_phase::convex::polytope::{Polytope, Pose};
use crate::narrow_phase::convex::sat::{PARALLEL, nearest_on_segments};
use crate::narrow_phase::mesh::patch::Touch;
use crate::narrow_phase::mesh::triangle_contact::{named, outline};
use crate::shape::{ConvexHull, HullEdge};
use glam::Vec3;

/// How a hull and a triangle are nearest or overlap least.
pub(crate) struct ContactAxis {
    /// Unit, from the hull to the triangle.
    pub(crate) normal: Vec3,
    /// Separation along it [m].
    pub(crate) apart: f32,
    feature: Feature,
}

enum Feature {
    /// A face of the hull.
    Hull(usize),
    /// The triangle's.
    Triangle,
    /// An edge of each.
    Edges([usize; 2]),
    /// The nearest points of an edge of each, no nearer than a face.
    Level([usize; 2], [Vec3; 2]),
}

/// The vertex of a hull that is furthest below a triangle's plane.
pub(crate) struct Deepest {
    pub(crate) at: Vec3,
    /// Its height over the plane [m].
    pub(crate) separation: f32,
}

impl ContactAxis {
    /// `None` if they are further apart than the margin.
    ///
    /// `by_hull`: result of [`face_axis`]. `face`: separation along the triangle's normal; the hull's deepest
    /// vertex is over the triangle only if they overlap.
    pub(crate) fn between<L: Lanes>(
        hull: &ConvexHull,
        touch: &Touch,
        by_hull: (f32, usize),
        face: f32,
        margin: f32,
        size: f32,
    ) -> Option<ContactAxis> {
        let tolerance = FACE_PREFERENCE.1 * size;
        let clearly = |s: f32| if s < 0.0 { FACE_PREFERENCE.0 * s + tolerance } else { s + tolerance };
        let by_face = if face > clearly(by_hull.0) {
            ContactAxis { normal: -touch.front, apart: face, feature: Feature::Triangle }
        } else {
            let normal = hull.planes[by_hull.1].0;
            if by_hull.0 > 0.0 && is_corner_over(hull, by_hull.1, touch) {
                return Some(ContactAxis { normal, apart: by_hull.0, feature: Feature::Hull(by_hull.1) });
            }
            ContactAxis { normal, apart: by_hull.0, feature: Feature::Hull(by_hull.1) }
        };
        let mut touching = None;
        if by_face.apart <= 0.0 {
            let (apart, edges) = edge_axis::<L>(hull, touch);
            if apart > margin {
                return None;
            }
            if apart <= clearly(by_face.apart) {
                return Some(by_face);
            }
            let normal = edge_normal(hull, touch, edges);
            let by_edges = ContactAxis { normal, apart, feature: Feature::Edges(edges) };
            if apart <= 0.0 {
                return Some(by_edges);
            }
            touching = Some(by_edges);
        }
        // Apart, and no part of one is over the face of the other.
        let (edges, [p, q]) = nearest_edges::<L>(hull, touch);
        let distance = (q - p).length();
        if distance > margin {
            return None;
        }
        if distance <= by_face.apart + tolerance {
            return Some(ContactAxis { feature: Feature::Level(edges, [p, q]), ..by_face });
        }
        // If two edges just touch, only their cross product has a direction.
        if distance < 1e-5 * size {
            return touching.or(Some(by_face));
        }
        Some(ContactAxis { normal: (q - p) / distance, apart: distance, feature: Feature::Edges(edges) })
    }

    /// Adds the points that are nearer than the margin along the normal.
    pub(crate) fn points(
        &self,
        p: &Polytope,
        touch: &Touch,
        deepest: &Deepest,
        margin: f32,
        size: f32,
        points: &mut Vec<RawPoint>,
    ) {
        let mut cloud = Cloud::new();
        let n = self.normal;
        match self.feature {
            Feature::Hull(face) => {
                let reference = Loop::new(p.vertices, p.face(face), &Pose::IDENTITY);
                let plane = (touch.front, touch.front.dot(touch.corners[0]));
                let tolerance = FACE_PREFERENCE.1 * size;
                let outline = outline(touch);
                clip_face(&reference, p.planes[face], &outline, plane, margin, tolerance, &mut cloud);
                if cloud.least() > self.apart + tolerance {
                    let (index, at) = nearest_corner(n, touch);
                    let position = at - n * (0.5 * self.apart);
                    cloud.push(RawPoint { position, separation: self.apart, key: key(0, index, 1) });
                }
            }
            Feature::Triangle => {
                let Deepest { at, separation } = *deepest;
                let position = at - touch.front * (0.5 * separation);
                cloud.push(RawPoint { position, separation, key: key(0, 0x7fff, 1) });
            }
            Feature::Level([one, two], [p, q]) => {
                let separation = n.dot(q - p);
                cloud.push(RawPoint { position: (p + q) * 0.5, separation, key: key(3, one, two) });
            }
            Feature::Edges([one, two]) => {
                let on_hull = Segment::of_edge(p, one, &Pose::IDENTITY);
                let next = (two + 1) % 3;
                let on_triangle =
                    Segment { ends: [touch.corners[two], touch.corners[next]], index: [two, next] };
                clip_edges(&on_hull, &on_triangle, n, margin, &mut cloud);
            }
        }
        points.extend(named(touch, cloud.points()));
    }
}

/// The largest of eight values and its index, lane `i` of chunk `chunk`; the first lane of equals.
#[inline(always)]
fn most<L: Lanes>(values: L, chunk: L) -> (f32, usize) {
    let (mut most, mut place) = (f32::MIN, 0);
    for (i, (&value, &chunk)) in values.eight().iter().zip(&chunk.eight()).enumerate() {
        if value > most {
            (most, place) = (value, 8 * chunk as usize + i);
        }
    }
    (most, place)
}

kernel! {
    /// The face of a hull along whose normal a triangle is furthest out, and its separation [m].
    pub(crate) fn face_axis<'a, L: Lanes>(hull: &'a ConvexHull, touch: &'a Touch) -> (f32, usize) {
        let [a, b, c] = touch.corners;
        let (a, b, c) = (LaneVec3::<L>::splat(a), LaneVec3::splat(b), LaneVec3::splat(c));
        let front = LaneVec3::<L>::splat(touch.front);
        let (mut best, mut chunk) = (L::splat(f32::MIN), L::zero());
        for (k, [nx, ny, nz, offset]) in hull.normal_chunks.iter().enumerate() {
            let n = LaneVec3::new(L::load(nx), L::load(ny), L::load(nz));
            let low = Lanes::min(Lanes::min(n.dot(a), n.dot(b)), n.dot(c)) - L::load(offset);
            // The hull must not leave through the back.
            let wrong = n.dot(front).gt(L::splat(THROUGH_SINE)) & low.lt(L::zero());
            let better = low.gt(best) & !wrong;
            best = Lanes::select(better, low, best);
            chunk = Lanes::select(better, L::splat(k as f32), chunk);
        }
        let (separation, place) = most(best, chunk);
        // Padding repeats the first plane.
        (separation, if place < hull.planes.len() { place } else { 0 })
    }
}

/// The corner of a triangle that is nearest along a normal.
fn nearest_corner(n: Vec3, touch: &Touch) -> (usize, Vec3) {
    let along = touch.corners.map(|c| n.dot(c));
    let nearest = (1..3).fold(0, |best, i| if along[i] < along[best] { i } else { best });
    (nearest, touch.corners[nearest])
}

/// Whether the corner of a triangle that is nearest to the plane of a hull's face is over that face.
fn is_corner_over(hull: &ConvexHull, face: usize, touch: &Touch) -> bool {
    let n = hull.planes[face].0;
    let (_, corner) = nearest_corner(n, touch);
    let around =
        &hull.face_vertices[usize::from(hull.face_start[face])..usize::from(hull.face_start[face + 1])];
    let mut from = hull.vertices[usize::from(around[around.len() - 1])];
    around.iter().all(|&v| {
        let to = hull.vertices[usize::from(v)];
        let beyond = (to - from).cross(n).dot(corner - from);
        from = to;
        beyond <= 0.0
    })
}

/// A property of each of eight edges; if there are fewer, the first is repeated. Stored with every hull it
/// would take 48 bytes an edge, more than the rest of the hull.
#[inline(always)]
fn of_edges<L: Lanes>(edges: &[HullEdge], what: impl Fn(&HullEdge) -> Vec3) -> LaneVec3<L> {
    let mut rows = what(&edges[0]).to_array().map(|x| [x; 8]);
    for (lane, edge) in edges.iter().enumerate().take(8).skip(1) {
        let at = what(edge);
        (rows[0][lane], rows[1][lane], rows[2][lane]) = (at.x, at.y, at.z);
    }
    LaneVec3::new(L::load(&rows[0]), L::load(&rows[1]), L::load(&rows[2]))
}

/// Start and direction of eight edges.
#[inline(always)]
fn lines<L: Lanes>(hull: &ConvexHull, edges: &[HullEdge]) -> (LaneVec3<L>, LaneVec3<L>) {
    let start = of_edges(edges, |e| hull.vertices[usize::from(e.vertices[0])]);
    let end = of_edges(edges, |e| hull.vertices[usize::from(e.vertices[1])]);
    (start, end - start)
}

kernel! {
    /// The axis, among those across an edge of each whose faces meet on it, along which the two are furthest
    /// apart [m], and the edges. `f32::MIN` if there is none.
    fn edge_axis<'a, L: Lanes>(hull: &'a ConvexHull, touch: &'a Touch) -> (f32, [usize; 2]) {
        let zero = L::zero();
        let front = LaneVec3::<L>::splat(touch.front);
        let turned = if touch.behind { -1.0 } else { 1.0 };
        let (mut best, mut name) = (L::splat(f32::MIN), zero);
        for (k, edges) in hull.edges.chunks(8).enumerate() {
            let (start, along) = lines(hull, edges);
            let one = of_edges(edges, |e| hull.planes[usize::from(e.faces[0])].0);
            let other = of_edges(edges, |e| hull.planes[usize::from(e.faces[1])].0);
            // The arc of the triangle's edge goes from its front to its back.
            let rises = front.dot(along);
            let squared = along.length_squared();
            for e in 0..3 {
                let from = touch.corners[e];
                let side = (touch.corners[(e + 1) % 3] - from) * turned;
                let lanes = LaneVec3::<L>::splat(side);
                let (a, b) = (one.dot(lanes), other.dot(lanes));
                let meets = (a * b).lt(zero) & (rises * b).lt(zero);
                if meets.bits() == 0 {
                    continue;
                }
                let cross = along.cross(lanes);
                let length = cross.length_squared();
                let meets = meets & length.gt(squared * L::splat(PARALLEL * side.length_squared()));
                let normal = cross * (cross.dot(one + other).sign() / length.sqrt());
                let apart = normal.dot(LaneVec3::splat(from) - start);
                let wrong = normal.dot(front).gt(L::splat(THROUGH_SINE)) & apart.lt(zero);
                let better = meets & !wrong & apart.gt(best);
                best = Lanes::select(better, apart, best);
                name = Lanes::select(better, L::splat((3 * k + e) as f32), name);
            }
        }
        let (apart, place) = most(best, name);
        (apart, edges_at(place))
    }
}

/// The edges of lane `i` of pair `3 chunk + edge of the triangle`.
fn edges_at(place: usize) -> [usize; 2] {
    let (pair, lane) = (place / 8, place % 8);
    [8 * (pair / 3) + lane, pair % 3]
}

/// Start and direction of an edge of a hull.
fn edge(hull: &ConvexHull, edge: usize) -> (Vec3, Vec3) {
    let [v, w] = hull.edges[edge].vertices.map(|v| hull.vertices[usize::from(v)]);
    (v, w - v)
}

/// The unit normal across two edges, out of the hull.
fn edge_normal(hull: &ConvexHull, touch: &Touch, [one, two]: [usize; 2]) -> Vec3 {
    let side = touch.corners[(two + 1) % 3] - touch.corners[two];
    let cross = edge(hull, one).1.cross(side);
    let [a, b] = hull.edges[one].faces.map(|f| hull.planes[usize::from(f)].0);
    cross / if cross.dot(a + b) < 0.0 { -cross.length() } else { cross.length() }
}

/// Whether some of a hull is beyond an edge of a triangle, seen along the triangle's normal.
#[inline(always)]
fn is_beyond<L: Lanes>(hull: &ConvexHull, touch: &Touch, edge: usize) -> bool {
    let out = touch.outward(edge);
    let offset = L::splat(out.dot(touch.corners[edge]));
    let out = LaneVec3::<L>::splat(out);
    for [x, y, z] in &hull.vertex_chunks {
        if out.dot(LaneVec3::new(L::load(x), L::load(y), L::load(z))).gt(offset).any() {
            return true;
        }
    }
    false
}

kernel! {
    /// The edges that are nearest to each other, and where. If a hull and a triangle are apart, these are the
    /// nearest points of all, unless one is over a face.
    fn nearest_edges<'a, L: Lanes>(hull: &'a ConvexHull, touch: &'a Touch) -> ([usize; 2], [Vec3; 2]) {
        // An edge beyond which no part of the hull lies has no nearest point, or shares it with another edge.
        let beyond = [0, 1, 2].map(|e| is_beyond::<L>(hull, touch, e));
        let none = beyond == [false; 3];
        let (zero, one, tiny) = (L::zero(), L::one(), 1e-30);
        let (mut best, mut name) = (L::splat(f32::MAX), zero);
        for (k, edges) in hull.edges.chunks(8).enumerate() {
            let (start, along) = lines(hull, edges);
            let dd = Lanes::max(along.length_squared(), L::splat(tiny));
            let by_dd = one / dd;
            for e in (0..3).filter(|&e| beyond[e] || none) {
                // As in `nearest_on_segments`; the results of one side save three of four divisions.
                let from = touch.corners[e];
                let side = touch.corners[(e + 1) % 3] - from;
                let ee = side.length_squared().max(tiny);
                let (ee, by_ee) = (L::splat(ee), L::splat(1.0 / ee));
                let (from, side) = (LaneVec3::<L>::splat(from), LaneVec3::<L>::splat(side));
                let r = start - from;
                let (de, dr, er) = (along.dot(side), along.dot(r), side.dot(r));
                let det = dd * ee - de * de;
                let flat = det.le(dd * ee * L::splat(1e-6));
                let s = (de * er - dr * ee) / Lanes::select(flat, one, det);
                let s = Lanes::select(flat, zero, s).clamp(zero, one);
                let t = ((de * s + er) * by_ee).clamp(zero, one);
                let s = ((de * t - dr) * by_dd).clamp(zero, one);
                let t = ((de * s + er) * by_ee).clamp(zero, one);
                let squared = (r + along * s - side * t).length_squared();
                let nearer = squared.lt(best);
                best = Lanes::select(nearer, squared, best);
                name = Lanes::select(nearer, L::splat((3 * k + e) as f32), name);
            }
        }
        let (_, place) = most(-best, name);
        let edges = edges_at(place);
        let (start, along) = edge(hull, edges[0]);
        let (from, to) = (touch.corners[edges[1]], touch.corners[(edges[1] + 1) % 3]);
        let lanes = LaneVec3::<f32>::splat;
        let (s, t) = nearest_on_segments(lanes(start), lanes(along), lanes(from), lanes(to - from));
        (edges, [start + along * s, from + (to - from) * t])
    }
}
