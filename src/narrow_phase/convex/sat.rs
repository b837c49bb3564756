//! Separating axes of two polytopes, eight features at a time.
//!
//! The axes are the normals of both and the cross products of two edges whose arcs on the Gauss map meet,
//! which is where the Minkowski difference has a face (Gregorius, *The Separating Axis Test between Convex
//! Polyhedra*, GDC 2013). Only edges near the contact are tried: where the least overlap is between two
//! edges, their points of contact are no further apart than that overlap, hence than the overlap along the
//! best face normal.

use super::polytope::{Polytope, Pose};
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, kernel, with_best};
use glam::Vec3;

// Rounding: of a cross product.
/// Squared sine under which two edges count as parallel: their cross product is all rounding.
pub(crate) const PARALLEL: f32 = 1e-7;

/// The most vertices and edges of a polytope: 256, and 3 V - 6 edges.
const MAX_VERTICES: usize = 256;
const EDGE_WORDS: usize = 12;

/// A face as an axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceAxis {
    pub(crate) separation: f32,
    pub(crate) face: usize,
}

/// Takes eight more values, from index `first` on, into account for the largest and its index, the first of
/// equals; says whether one is larger.
#[inline(always)]
pub(crate) fn offer<L: Lanes>(best: &mut (f32, usize), values: L, first: usize) -> bool {
    let any = values.gt(L::splat(best.0)).any();
    if any {
        for (i, &value) in values.eight().iter().enumerate() {
            if value > best.0 {
                *best = (value, first + i);
            }
        }
    }
    any
}

#[inline(always)]
fn load<L: Lanes>(rows: &[f32; 8]) -> L {
    L::load(rows)
}

kernel! {
    /// See [`face_axis`].
    fn face_axis_in<'a, L: Lanes>(
        p: &'a Polytope<'a>,
        q: &'a Polytope<'a>,
        q_in_p: &'a Pose,
        margin: f32,
    ) -> FaceAxis {
        let mut best = (f32::MIN, 0);
        let axes = &q_in_p.axes;
        let (rx, ry, rz) =
            (LaneVec3::<L>::splat(axes.x_axis), LaneVec3::splat(axes.y_axis), LaneVec3::splat(axes.z_axis));
        let position = LaneVec3::splat(q_in_p.position);
        for (k, [nx, ny, nz, offset]) in p.normal_chunks.iter().enumerate() {
            let n = LaneVec3::new(load(nx), load(ny), load(nz));
            let (x, y, z) = (rx.dot(n), ry.dot(n), rz.dot(n));
            let mut low = L::splat(f32::MAX);
            for v in q.vertices {
                low = Lanes::min(x * L::splat(v.x) + y * L::splat(v.y) + z * L::splat(v.z), low);
            }
            let separation = low + n.dot(position) - load(offset);
            if offer(&mut best, separation, 8 * k) && best.0 > margin {
                break;
            }
        }
        // The filling repeats the first face; it never beats it, so the index is of a real one.
        FaceAxis { separation: best.0, face: best.1 }
    }
}

/// A set of edges, by index.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EdgeSet([u64; EDGE_WORDS]);

impl EdgeSet {
    pub(crate) fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.0.iter().enumerate().flat_map(|(k, &word)| {
            let mut rest = word;
            std::iter::from_fn(move || {
                let bit = rest.trailing_zeros() as usize;
                rest &= rest.wrapping_sub(1);
                (bit < 64).then_some(64 * k + bit)
            })
        })
    }
}

/// A value where a mask holds, else zero.
#[inline(always)]
fn bit<L: Lanes>(mask: L::Mask, value: f32) -> L {
    Lanes::select(mask, L::splat(value), L::zero())
}

kernel! {
    /// Edges of `p` that are not wholly outside the box `min`..`max` on one side, nor below `low` along
    /// `normal`. All in the frame of `p`.
    fn edges_near_in<'a, L: Lanes>(
        p: &'a Polytope<'a>,
        min: Vec3,
        max: Vec3,
        normal: Vec3,
        low: f32,
    ) -> EdgeSet {
        let mut codes = [0u8; MAX_VERTICES];
        let (min, max) = (LaneVec3::<L>::splat(min), LaneVec3::<L>::splat(max));
        let (normal, low) = (LaneVec3::splat(normal), L::splat(low));
        for ([x, y, z], codes) in p.vertex_chunks.iter().zip(codes.chunks_exact_mut(8)) {
            let v = LaneVec3::<L>::new(load(x), load(y), load(z));
            let code = bit::<L>(v.x.lt(min.x), 1.0)
                + bit::<L>(v.x.gt(max.x), 2.0)
                + bit::<L>(v.y.lt(min.y), 4.0)
                + bit::<L>(v.y.gt(max.y), 8.0)
                + bit::<L>(v.z.lt(min.z), 16.0)
                + bit::<L>(v.z.gt(max.z), 32.0)
                + bit::<L>(normal.dot(v).lt(low), 64.0);
            for (to, from) in codes.iter_mut().zip(code.eight()) {
                *to = from as u8;
            }
        }
        let mut set = EdgeSet::default();
        for (word, edges) in set.0.iter_mut().zip(p.edges.chunks(64)) {
            for (i, edge) in edges.iter().enumerate() {
                let a = codes[usize::from(edge.vertices[0]) % MAX_VERTICES];
                let b = codes[usize::from(edge.vertices[1]) % MAX_VERTICES];
                *word |= u64::from(a & b == 0) << i;
            }
        }
        set
    }
}

/// Along `normal` (from a to b, in a's frame) all of `a` is below `high` and all of `b` above `low`.
pub(crate) struct Slab {
    pub(crate) normal: Vec3,
    pub(crate) high: f32,
    pub(crate) low: f32,
}

/// Edges of both that can be nearer to the other than `reach`.
pub(crate) fn edges_in_reach(
    a: &Polytope,
    b: &Polytope,
    b_in_a: &Pose,
    a_in_b: &Pose,
    reach: f32,
    &Slab { normal, high, low }: &Slab,
) -> (EdgeSet, EdgeSet) {
    let around = |p: &Polytope, pose: &Pose| {
        let (centre, half) = ((p.min + p.max) * 0.5, (p.max - p.min) * 0.5);
        let m = &pose.axes;
        let half = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z + reach;
        (pose.point(centre) - half, pose.point(centre) + half)
    };
    let (min, max) = around(b, b_in_a);
    let near_a = edges_near(a, min, max, normal, low - reach);
    let (min, max) = around(a, a_in_b);
    let down = -b_in_a.back(normal);
    let near_b = edges_near(b, min, max, down, normal.dot(b_in_a.position) - high - reach);
    (near_a, near_b)
}

/// Two edges as an axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeAxis {
    /// Unit, from `a` to `b`, in a's frame.
    pub(crate) normal: Vec3,
    pub(crate) separation: f32,
    pub(crate) edges: [usize; 2],
}

/// Eight edges of `b` in a's frame: start, direction, and the normals of the two faces.
struct EdgeLanes<L> {
    index: [usize; 8],
    start: LaneVec3<L>,
    along: LaneVec3<L>,
}

impl<L: Lanes> EdgeLanes<L> {
    #[inline(always)]
    fn gather(b: &Polytope, pose: &Pose, index: [usize; 8]) -> Self {
        let start = in_lanes(|i| b.vertices[usize::from(b.edges[index[i]].vertices[0])]);
        let end = in_lanes(|i| b.vertices[usize::from(b.edges[index[i]].vertices[1])]);
        EdgeLanes {
            index,
            start: turn(pose, start) + LaneVec3::splat(pose.position),
            along: turn(pose, end - start),
        }
    }
    #[inline(always)]
    fn normals(&self, b: &Polytope, pose: &Pose, k: usize) -> LaneVec3<L> {
        turn(pose, in_lanes(|i| b.planes[usize::from(b.edges[self.index[i]].faces[k])].0))
    }
}

/// Lane `i` from `f(i)`, called once for all three coordinates.
#[inline(always)]
pub(crate) fn in_lanes<L: Lanes>(f: impl Fn(usize) -> Vec3) -> LaneVec3<L> {
    let [mut x, mut y, mut z] = [[0.0f32; 8]; 3];
    for (i, ((x, y), z)) in x.iter_mut().zip(&mut y).zip(&mut z).enumerate() {
        [*x, *y, *z] = f(i).to_array();
    }
    LaneVec3::new(L::load(&x), L::load(&y), L::load(&z))
}

#[inline(always)]
fn turn<L: Lanes>(pose: &Pose, v: LaneVec3<L>) -> LaneVec3<L> {
    let m = &pose.axes;
    LaneVec3::splat(m.x_axis) * v.x + LaneVec3::splat(m.y_axis) * v.y + LaneVec3::splat(m.z_axis) * v.z
}

/// The next eight of a set; the last is repeated where fewer are left.
#[inline(always)]
fn eight(edges: &mut impl Iterator<Item = usize>) -> Option<[usize; 8]> {
    let mut index = [edges.next()?; 8];
    for i in 1..8 {
        index[i] = edges.next().unwrap_or(index[i - 1]);
    }
    Some(index)
}

kernel! {
    /// See [`edge_axis`].
    fn edge_axis_in<'a, L: Lanes>(
        a: &'a Polytope<'a>,
        b: &'a Polytope<'a>,
        pose: &'a Pose,
        near: &'a (EdgeSet, EdgeSet),
    ) -> Option<EdgeAxis> {
        let (near_a, near_b) = near;
        let mut best: Option<EdgeAxis> = None;
        let mut most = f32::MIN;
        let mut of_b = near_b.iter();
        while let Some(index) = eight(&mut of_b) {
            let lanes = EdgeLanes::<L>::gather(b, pose, index);
            let (c0, c1) = (lanes.normals(b, pose, 0), lanes.normals(b, pose, 1));
            let length_b = lanes.along.length_squared();
            for ia in near_a.iter() {
                let edge = &a.edges[ia];
                let [v0, v1] = edge.vertices.map(|v| a.vertices[usize::from(v)]);
                let [a0, a1] = edge.faces.map(|f| a.planes[usize::from(f)].0);
                let along = LaneVec3::<L>::splat(v1 - v0);
                // The arcs from a0 to a1 and from -c0 to -c1 cross. An edge runs along the cross product of
                // its two normals, so that four dot products tell.
                let (c0a, c1a) = (c0.dot(along), c1.dot(along));
                let a0b = LaneVec3::splat(a0).dot(lanes.along);
                let a1b = LaneVec3::splat(a1).dot(lanes.along);
                let zero = L::zero();
                let meets = (c0a * c1a).lt(zero) & (a0b * a1b).lt(zero) & (c0a * a1b).lt(zero);
                if !meets.any() {
                    continue;
                }
                let cross = along.cross(lanes.along);
                let squared = cross.length_squared();
                let valid = meets & squared.gt(length_b * L::splat(PARALLEL * (v1 - v0).length_squared()));
                let outward = cross.dot(LaneVec3::splat(a0 + a1));
                let scale = outward.sign() / squared.sqrt();
                let normal = cross * scale;
                let separation = normal.dot(lanes.start - LaneVec3::splat(v0));
                let better = valid & separation.gt(L::splat(most));
                let bits = better.bits();
                if bits == 0 {
                    continue;
                }
                for (i, &s) in separation.eight().iter().enumerate() {
                    if bits >> i & 1 != 0 && s > most {
                        most = s;
                        let edges = [ia, index[i]];
                        best = Some(EdgeAxis { normal: normal.lane(i), separation: s, edges });
                    }
                }
            }
        }
        best
    }
}

/// The nearest points of two edges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// On `a` and on `b`, in a's frame.
    pub(crate) points: [Vec3; 2],
    pub(crate) distance: f32,
    pub(crate) edges: [usize; 2],
}

kernel! {
    /// See [`nearest_edges`].
    fn nearest_edges_in<'a, L: Lanes>(
        a: &'a Polytope<'a>,
        b: &'a Polytope<'a>,
        pose: &'a Pose,
        near: &'a (EdgeSet, EdgeSet),
    ) -> Option<Nearest> {
        let (near_a, near_b) = near;
        let mut best: Option<Nearest> = None;
        let mut least = f32::MAX;
        let mut of_b = near_b.iter();
        while let Some(index) = eight(&mut of_b) {
            let lanes = EdgeLanes::<L>::gather(b, pose, index);
            for ia in near_a.iter() {
                let [v0, v1] = a.edges[ia].vertices.map(|v| a.vertices[usize::from(v)]);
                let (start, along) = (LaneVec3::<L>::splat(v0), LaneVec3::splat(v1 - v0));
                let (s, t) = nearest_on_segments(start, along, lanes.start, lanes.along);
                let (p, q) = (start + along * s, lanes.start + lanes.along * t);
                let squared = (q - p).length_squared();
                let bits = squared.lt(L::splat(least)).bits();
                if bits == 0 {
                    continue;
                }
                for (i, &d) in squared.eight().iter().enumerate() {
                    if bits >> i & 1 != 0 && d < least {
                        least = d;
                        best = Some(Nearest {
                            points: [p.lane(i), q.lane(i)],
                            distance: d.sqrt(),
                            edges: [ia, index[i]],
                        });
                    }
                }
            }
        }
        best
    }
}

/// The face normal of `p` along which `q` is furthest out. Ends at the first that separates by more than the
/// margin.
pub(crate) fn face_axis(p: &Polytope, q: &Polytope, q_in_p: &Pose, margin: f32) -> FaceAxis {
    with_best!(Wide => face_axis_in::<Wide>(p, q, q_in_p, margin))
}

fn edges_near(p: &Polytope, min: Vec3, max: Vec3, normal: Vec3, low: f32) -> EdgeSet {
    with_best!(Wide => edges_near_in::<Wide>(p, min, max, normal, low))
}

/// The pair of edges along whose common normal the two are furthest apart.
pub(crate) fn edge_axis(
    a: &Polytope,
    b: &Polytope,
    pose: &Pose,
    near: &(EdgeSet, EdgeSet),
) -> Option<EdgeAxis> {
    with_best!(Wide => edge_axis_in::<Wide>(a, b, pose, near))
}

/// The nearest points of all edges in reach. If the polytopes are apart, these are their nearest points,
/// unless one lies inside a face.
pub(crate) fn nearest_edges(
    a: &Polytope,
    b: &Polytope,
    pose: &Pose,
    near: &(EdgeSet, EdgeSet),
) -> Option<Nearest> {
    with_best!(Wide => nearest_edges_in::<Wide>(a, b, pose, near))
}

/// Where the segments `p + s d` and `q + t e` are nearest: s and t in 0..=1.
///
/// The nearest points of the two lines, then each clamped and projected on the other in turn: exact, since
/// the distance is convex (Ericson, *Real-Time Collision Detection*, 5.1.9). Parallel segments: anywhere that
/// is nearest.
#[inline(always)]
pub(crate) fn nearest_on_segments<L: Lanes>(
    p: LaneVec3<L>,
    d: LaneVec3<L>,
    q: LaneVec3<L>,
    e: LaneVec3<L>,
) -> (L, L) {
    let (zero, one, tiny) = (L::zero(), L::one(), L::splat(1e-30));
    let r = p - q;
    let dd = d.dot(d).max(tiny);
    let ee = e.dot(e).max(tiny);
    let (de, dr, er) = (d.dot(e), d.dot(r), e.dot(r));
    let det = dd * ee - de * de;
    let flat = det.le(dd * ee * L::splat(1e-6));
    let s = L::select(flat, zero, (de * er - dr * ee) / L::select(flat, one, det)).clamp(zero, one);
    let t = ((de * s + er) / ee).clamp(zero, one);
    let s = ((de * t - dr) / dd).clamp(zero, one);
    let t = ((de * s + er) / ee).clamp(zero, one);
    (s, t)
}
