//! Contact points of a reference face and an incident face, and of two edges.
//!
//! The points are the corners of the common area of both faces, seen along the reference normal: incident
//! vertices over the reference face, crossings of incident edges with its side planes, reference vertices
//! under the incident face. The three kinds are found eight at a time without building the polygons in
//! between (Cyrus and Beck's line clipping, 1978, instead of Sutherland and Hodgman's polygons).

use super::polytope::{Polytope, Pose};
use super::sat::{in_lanes, nearest_on_segments};
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, f32x8};
use crate::narrow_phase::contacts::manifold::RawPoint;
use glam::Vec3;

/// Most points of a contact before they are reduced.
pub(crate) const CLOUD: usize = 64;
/// Most corners of a face that are used; if it has more, evenly chosen ones.
const LOOP: usize = 24;

/// Contact points before they are reduced to four.
pub(crate) struct Cloud {
    points: [RawPoint; CLOUD],
    count: usize,
}

impl Cloud {
    pub(crate) fn new() -> Cloud {
        Cloud { points: [RawPoint::default(); CLOUD], count: 0 }
    }
    pub(crate) fn points(&self) -> &[RawPoint] {
        &self.points[..self.count]
    }
    #[inline(always)]
    pub(crate) fn push(&mut self, point: RawPoint) {
        if self.count < CLOUD {
            self.points[self.count] = point;
            self.count += 1;
        }
    }
    /// Sets bits in the keys of all points from `first` on.
    pub(crate) fn mark(&mut self, first: usize, bits: u32) {
        for point in &mut self.points[first..self.count] {
            point.key |= bits;
        }
    }
    pub(crate) fn least(&self) -> f32 {
        self.points().iter().map(|p| p.separation).fold(f32::MAX, f32::min)
    }
}

/// A key made of the kind of features that meet and their indices: 2 and 15 + 15 bits.
pub(crate) fn key(kind: u32, one: usize, other: usize) -> u32 {
    kind << 30 | (one as u32 & 0x7fff) << 15 | (other as u32 & 0x7fff)
}
const VERTEX: u32 = 0;
const CROSSING: u32 = 1;
const CORNER: u32 = 2;
pub(crate) const EDGES: u32 = 3;

/// The corners of a face and which vertices they are.
pub(crate) struct Loop {
    corners: [Vec3; LOOP],
    index: [u16; LOOP],
    count: usize,
}

impl Loop {
    pub(crate) fn new(vertices: &[Vec3], face: &[u16], pose: &Pose) -> Loop {
        let mut out = Loop { corners: [Vec3::ZERO; LOOP], index: [0; LOOP], count: face.len().min(LOOP) };
        for i in 0..out.count {
            // Up to LOOP corners this is `i`.
            let v = face[i * face.len() / out.count];
            out.corners[i] = pose.point(vertices[usize::from(v)]);
            out.index[i] = v;
        }
        out
    }
    /// The corners, and which vertices they are.
    pub(crate) fn corners(&self) -> (&[Vec3], &[u16]) {
        (&self.corners[..self.count], &self.index[..self.count])
    }
    /// Whether a point is over the face of this border, seen along the face's normal.
    pub(crate) fn is_over(&self, normal: Vec3, point: Vec3) -> bool {
        (0..self.count).all(|i| (self.at(i + 1) - self.at(i)).cross(normal).dot(point - self.at(i)) <= 0.0)
    }
    fn at(&self, i: usize) -> Vec3 {
        self.corners[if i < self.count { i } else { 0 }]
    }
    /// Eight corners from `8 k` on, past the end the first.
    fn eight(&self, k: usize) -> LaneVec3<f32x8> {
        in_lanes(|i| self.at(8 * k + i))
    }
}

/// The parts of segments, of their 0..=1, that are inside of some sides; `enter` beyond `exit` where none is
/// (Cyrus and Beck).
pub(crate) struct Spans<L> {
    pub(crate) enter: L,
    pub(crate) exit: L,
}

impl<L: Lanes> Spans<L> {
    /// Whole segments, before any side has cut them.
    #[inline(always)]
    pub(crate) fn whole() -> Spans<L> {
        Spans { enter: L::zero(), exit: L::one() }
    }

    /// Cuts off the part beyond a side, given the distances of the starts and the ends. Returns where it
    /// moves `enter`, and `exit`.
    #[inline(always)]
    pub(crate) fn cut(&mut self, start: L, end: L) -> (L::Mask, L::Mask) {
        let (out0, out1) = (start.gt(L::zero()), end.gt(L::zero()));
        let both = out0 & out1;
        let crosses = (out0 | out1) & !both;
        let t = start / L::select(crosses, start - end, L::one());
        let later = crosses & out0 & t.gt(self.enter);
        self.enter = L::select(later, t, self.enter);
        let sooner = crosses & out1 & t.lt(self.exit);
        self.exit = L::select(sooner, t, self.exit);
        self.exit = L::select(both, L::splat(-1.0), self.exit);
        (later, sooner)
    }
}

/// Cuts off the part beyond a side of the polygon of the first `count` corners: a step of the clipping of
/// Sutherland and Hodgman (1974). Returns how many corners are left. `beyond`: how far a corner is.
/// `crossing`: the corner where an edge crosses the side, from its corners, the share of it up to there, and
/// whether the edge leaves: then the side itself is the next edge, else the old one goes on.
#[inline(always)]
pub(crate) fn cut_off<C: Copy + Default, const N: usize>(
    polygon: &mut [C; N],
    count: usize,
    beyond: impl Fn(&C) -> f32,
    crossing: impl Fn(&C, &C, f32, bool) -> C,
) -> usize {
    let mut cut = [C::default(); N];
    let mut kept = 0;
    let Some(mut last) = polygon[..count].last().copied() else { return 0 };
    let mut from = beyond(&last);
    for &this in &polygon[..count] {
        let to = beyond(&this);
        if (from > 0.0) != (to > 0.0) && kept < N {
            cut[kept] = crossing(&last, &this, from / (from - to), to > 0.0);
            kept += 1;
        }
        if to <= 0.0 && kept < N {
            cut[kept] = this;
            kept += 1;
        }
        (last, from) = (this, to);
    }
    *polygon = cut;
    kept
}

/// Takes the points that are nearer than the margin to the reference plane `normal`·x = `offset`.
struct Sink<'a> {
    normal: Vec3,
    offset: f32,
    margin: f32,
    cloud: &'a mut Cloud,
}

impl Sink<'_> {
    /// `at`: on the incident surface.
    #[inline(always)]
    fn add(&mut self, at: Vec3, key: u32) {
        let separation = self.normal.dot(at) - self.offset;
        if separation <= self.margin {
            let position = at - self.normal * (0.5 * separation);
            self.cloud.push(RawPoint { position, separation, key });
        }
    }
}

/// All points of the incident face (or, with two corners, edge) that are over the face `normal`·x = `offset`
/// and nearer than the margin, and those of the face under the incident one. All in one frame; the normal
/// points out of the reference shape; `incident_plane` in the same frame.
///
/// A point lies midway between the surfaces, its separation is along the normal. `tolerance` [m]: vertices
/// this far outside count as inside, so that equal boxes on top of each other meet in their vertices.
pub(crate) fn clip_face(
    reference: &Loop,
    (normal, offset): (Vec3, f32),
    incident: &Loop,
    incident_plane: (Vec3, f32),
    margin: f32,
    tolerance: f32,
    cloud: &mut Cloud,
) {
    let mut sides = [(Vec3::ZERO, 0.0f32); LOOP];
    for (i, side) in sides[..reference.count].iter_mut().enumerate() {
        let along = reference.at(i + 1) - reference.at(i);
        let out = along.cross(normal);
        let length = out.length();
        // A side without length bounds nothing.
        let out = if length > 0.0 { out / length } else { Vec3::ZERO };
        *side = (out, out.dot(reference.at(i)) + tolerance);
    }
    let mut sink = Sink { normal, offset, margin, cloud };
    clip_incident_edges(&sides[..reference.count], incident, &mut sink);
    add_reference_corners(reference, incident, incident_plane, tolerance, &mut sink);
}

/// Incident edges within the side planes: an edge's first vertex or where it enters, and where it leaves.
#[inline(always)]
fn clip_incident_edges(sides: &[(Vec3, f32)], incident: &Loop, sink: &mut Sink<'_>) {
    let edges = if incident.count == 2 { 1 } else { incident.count };
    let zero = f32x8::zero();
    for k in 0..edges.div_ceil(8) {
        let from = incident.eight(k);
        let to = in_lanes(|i| incident.at(8 * k + i + 1));
        let mut span = Spans::whole();
        let (mut enter_side, mut exit_side) = (zero, zero);
        for (j, (out, bound)) in sides.iter().enumerate() {
            let (out, bound) = (LaneVec3::splat(*out), f32x8::splat(*bound));
            let (d0, d1) = (out.dot(from) - bound, out.dot(to) - bound);
            if !(d0.gt(zero) | d1.gt(zero)).any() {
                continue;
            }
            let side = f32x8::splat(j as f32);
            let (later, sooner) = span.cut(d0, d1);
            enter_side = Lanes::select(later, side, enter_side);
            exit_side = Lanes::select(sooner, side, exit_side);
        }
        let Spans { enter, exit } = span;
        let inside = enter.le(exit).bits();
        if inside == 0 {
            continue;
        }
        let (enter, exit) = (enter.to_array(), exit.to_array());
        let (enter_side, exit_side) = (enter_side.to_array(), exit_side.to_array());
        for i in 0..(edges - 8 * k).min(8) {
            if inside >> i & 1 == 0 {
                continue;
            }
            let (p, q) = (incident.at(8 * k + i), incident.at(8 * k + i + 1));
            let vertex = usize::from(incident.index[8 * k + i]);
            let crossing = |side: f32| key(CROSSING, vertex, side as usize);
            if enter[i] > 0.0 {
                sink.add(p + (q - p) * enter[i], crossing(enter_side[i]));
            } else {
                sink.add(p, key(VERTEX, vertex, 0));
            }
            // Where the edge ends inside, the next one begins.
            if exit[i] < 1.0 {
                sink.add(p + (q - p) * exit[i], crossing(exit_side[i]) | 0x2000);
            } else if incident.count == 2 {
                sink.add(q, key(VERTEX, usize::from(incident.index[1]), 0));
            }
        }
    }
}

/// Corners of the reference face under the incident face, clearly inside it: on its border they are
/// crossings.
#[inline(always)]
fn add_reference_corners(
    reference: &Loop,
    incident: &Loop,
    (incident_normal, incident_offset): (Vec3, f32),
    tolerance: f32,
    sink: &mut Sink<'_>,
) {
    let normal = sink.normal;
    let slope = normal.dot(incident_normal);
    if incident.count < 3 || slope > -1e-3 {
        return;
    }
    let zero = f32x8::zero();
    for k in 0..reference.count.div_ceil(8) {
        let corners = reference.eight(k);
        let mut inside = f32x8::zero().le(zero);
        for j in 0..incident.count {
            let out = (incident.at(j + 1) - incident.at(j)).cross(normal);
            // Counter-clockwise seen along its own normal is clockwise seen along the reference normal.
            let out = -out;
            let bound = out.dot(incident.at(j)) - tolerance * out.length();
            let within = LaneVec3::splat(out).dot(corners).lt(f32x8::splat(bound));
            // A side without length bounds nothing.
            inside = inside & (within | f32x8::splat(out.length_squared()).le(zero));
        }
        let bits = inside.bits();
        for i in 0..(reference.count - 8 * k).min(8) {
            if bits >> i & 1 != 0 {
                let corner = reference.at(8 * k + i);
                let along = (incident_offset - incident_normal.dot(corner)) / slope;
                sink.add(corner + normal * along, key(CORNER, usize::from(reference.index[8 * k + i]), 0));
            }
        }
    }
}

/// A vertex or an edge in contact, with the vertices' indices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    pub(crate) ends: [Vec3; 2],
    pub(crate) index: [usize; 2],
}

impl Segment {
    pub(crate) fn of_edge(p: &Polytope, edge: usize, pose: &Pose) -> Segment {
        let index = p.edges[edge].vertices.map(usize::from);
        Segment { ends: index.map(|i| pose.point(p.vertices[i])), index }
    }

    /// The vertex of `p` furthest along `direction` and, of those less than `tolerance` short of it, the one
    /// furthest from it. Direction in the frame of `p`.
    pub(crate) fn support(p: &Polytope, direction: Vec3, tolerance: f32, pose: &Pose) -> Segment {
        let (first, most) = p.support(direction);
        let (mut second, mut furthest) = (first, 0.0);
        for (i, v) in p.vertices.iter().enumerate() {
            let away = (*v - p.vertices[first]).length_squared();
            if v.dot(direction) >= most - tolerance && away > furthest {
                (second, furthest) = (i, away);
            }
        }
        // In the order of indices: rounding that decides which one is further along must not change the keys.
        let index = [first.min(second), first.max(second)];
        Segment { ends: index.map(|i| pose.point(p.vertices[i])), index }
    }

    /// A key that does not depend on the direction.
    fn name(&self) -> usize {
        self.index[0].min(self.index[1]) * 181 + self.index[0].max(self.index[1])
    }
}

/// Points of two edges, of `a` and of `b` in one frame: one where they cross, two where they run along each
/// other.
pub(crate) fn clip_edges(a: &Segment, b: &Segment, normal: Vec3, margin: f32, cloud: &mut Cloud) {
    let (p, d) = (a.ends[0], a.ends[1] - a.ends[0]);
    let (q, e) = (b.ends[0], b.ends[1] - b.ends[0]);
    let (dd, ee, de) = (d.dot(d), e.dot(e), d.dot(e));
    let mut emit = |on_a: Vec3, on_b: Vec3, key: u32| {
        let separation = normal.dot(on_b - on_a);
        if separation <= margin {
            cloud.push(RawPoint { position: (on_a + on_b) * 0.5, separation, key });
        }
    };
    // Along each other: within 6 degrees.
    if dd > 0.0 && ee > 0.0 && dd * ee - de * de < 0.01 * dd * ee {
        let (t0, t1) = (d.dot(q - p) / dd, d.dot(q + e - p) / dd);
        let (low, high) = (t0.min(t1).max(0.0), t0.max(t1).min(1.0));
        // Keys say which end of a or b it is.
        if high - low > 1e-3 {
            for (t, end) in [(low, low > 0.0), (high, high < 1.0)] {
                let on_a = p + d * t;
                let on_b = q + e * (e.dot(on_a - q) / ee).clamp(0.0, 1.0);
                let nearer = usize::from((on_b - q).length_squared() * 4.0 > ee);
                let name = if end { 2 + nearer } else { usize::from(t > 0.5) };
                emit(on_a, on_b, key(EDGES, a.name(), b.name() * 4 + name));
            }
            return;
        }
    }
    let lanes = |v: Vec3| LaneVec3::new(v.x, v.y, v.z);
    let (s, t) = nearest_on_segments(lanes(p), lanes(d), lanes(q), lanes(e));
    emit(p + d * s, q + e * t, key(EDGES, a.name(), b.name() * 4 + 1));
}
