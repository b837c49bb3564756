//! Box against box: fifteen separating axes, then face against face or edge against edge.
//!
//! 1. The axis of greatest separation: three faces of each box, nine pairs of edges. Faces win over edges and
//!    `a` over `b` unless the other is better by a bias, so that a stack keeps its reference face.
//! 2. A face: the other box's face that looks at it is clipped to it, and four points are kept
//!    (`box_face.rs`).
//! 3. An edge: one point, where the two edges pass.
//! 4. Apart, the axis of greatest separation is a lower bound of the distance and every pair of points an
//!    upper one. Where face or edge points meet the bound, they are right. Where they don't (edge or vertex
//!    regions), the closest features include a vertex, and `box_apart.rs` finds them; a reference plane would
//!    stop a passing box there.

use super::box_apart::closest_vertex;
use super::box_face::face_points;
use super::lanes_io::{ManifoldLanes, PairLanes, pick};
use crate::config::tuning::{AXIS_BIAS, AXIS_DEPTH_BIAS, FLAT_FACE_BIAS, FLAT_FACE_COSINE};
use crate::lanes::{Lanes, Mask, Vec3, kernel};

/// Two boxes in the frame of the first.
pub(crate) struct Boxes<L> {
    /// Centre of `b`, by axes of `a` and by axes of `b`.
    pub(crate) p: [L; 3],
    pub(crate) q: [L; 3],
    /// `r[i][j]`: axis `i` of `a` dot axis `j` of `b`.
    pub(crate) r: [[L; 3]; 3],
    pub(crate) a: [L; 3],
    pub(crate) b: [L; 3],
    /// Least half extent of all six.
    pub(crate) least: L,
}

impl<L: Lanes> Boxes<L> {
    #[inline(always)]
    fn new(pair: &PairLanes<L>) -> Self {
        let m = pair.rotation.to_matrix();
        let (p, q) = (pair.position, m.mul_transposed(pair.position));
        let r = [[m.x.x, m.y.x, m.z.x], [m.x.y, m.y.y, m.z.y], [m.x.z, m.y.z, m.z.z]];
        let a = [pair.size_a[0], pair.size_a[1], pair.size_a[2]];
        let b = [pair.size_b[0], pair.size_b[1], pair.size_b[2]];
        let least = a[0].min(a[1]).min(a[2]).min(b[0]).min(b[1]).min(b[2]);
        Boxes { p: [p.x, p.y, p.z], q: [q.x, q.y, q.z], r, a, b, least }
    }

    /// A vector in the frame of `b`, in that of `a`.
    #[inline(always)]
    pub(crate) fn seen_from_a(&self, v: Vec3<L>) -> Vec3<L> {
        self.vector_of_b([v.x, v.y, v.z])
    }
    /// The inverse of [`Boxes::seen_from_a`].
    #[inline(always)]
    pub(crate) fn seen_from_b(&self, v: Vec3<L>) -> Vec3<L> {
        let [x, y, z] = &self.r;
        Vec3::new(
            x[0] * v.x + y[0] * v.y + z[0] * v.z,
            x[1] * v.x + y[1] * v.y + z[1] * v.z,
            x[2] * v.x + y[2] * v.y + z[2] * v.z,
        )
    }
    /// A vector given by the axes of `b`.
    #[inline(always)]
    pub(crate) fn vector_of_b(&self, v: [L; 3]) -> Vec3<L> {
        let row = |i: usize| self.r[i][0] * v[0] + self.r[i][1] * v[1] + self.r[i][2] * v[2];
        Vec3::new(row(0), row(1), row(2))
    }
}

kernel! {
    /// See the module.
    pub(crate) fn box_box<'a, L: Lanes>(p: &'a PairLanes<L>) -> ManifoldLanes<L> {
        let boxes = Boxes::new(p);
        let bias = boxes.least * L::splat(AXIS_BIAS);
        let allowed = |s: L| bias + (-s).max(L::zero()) * L::splat(AXIS_DEPTH_BIAS);

        let face = best_face(&boxes, allowed);
        let edge = best_edge(&boxes);
        let greatest = face.greatest.max(edge.bound);
        let apart = greatest.gt(L::zero());
        let mut out = face_points(&boxes, &face, apart, p.margin);
        out.gap = greatest;
        let [s0, s1, s2, s3] = out.separation;
        let deepest = s0.min(s1).min(s2.min(s3));
        // The clipped face of nearly flat boxes has the edges' depth already, and four points to rest on.
        // Thin boxes that lie across each other would otherwise go from the one to the other and back for
        // ever.
        let flat = out.normal.dot(edge.normal).gt(L::splat(FLAT_FACE_COSINE))
            & (deepest - edge.separation).abs().le(allowed(edge.separation))
            & ((edge.separation - face.separation).lt(boxes.least * L::splat(FLAT_FACE_BIAS)) | !apart);
        let edge_wins = edge.bound.gt(face.separation + allowed(face.separation)) & !flat;
        let short = apart & deepest.gt(greatest + bias + bias);
        let by_edge =
            (edge_wins & (edge.passes | !apart)) | (short & edge.passes & edge.separation.gt(L::zero()));
        let none = L::splat(f32::INFINITY);
        out.normal = Vec3::select(by_edge, edge.normal, out.normal);
        out.position[0] = Vec3::select(by_edge, edge.position, out.position[0]);
        out.separation[0] = L::select(by_edge, edge.separation, out.separation[0]);
        out.key[0] = L::select(by_edge, edge.key, out.key[0]);
        for separation in &mut out.separation[1..] {
            *separation = L::select(by_edge, none, *separation);
        }

        let by_vertex = short & !by_edge;
        if by_vertex.any() {
            closest_vertex(&boxes, by_vertex, &mut out);
        }
        out
    }
}

/// The reference face: a box and an axis of it.
pub(crate) struct Face<L: Lanes> {
    pub(crate) separation: L,
    /// Largest of all six, whichever axis was chosen.
    pub(crate) greatest: L,
    pub(crate) of_b: L::Mask,
    pub(crate) is_y: L::Mask,
    pub(crate) is_z: L::Mask,
}

#[inline(always)]
fn best_face<L: Lanes>(x: &Boxes<L>, allowed: impl Fn(L) -> L) -> Face<L> {
    let r = |i: usize, j: usize| x.r[i][j].abs();
    let of_a: [L; 3] = std::array::from_fn(|i| {
        x.p[i].abs() - (x.a[i] + (r(i, 0) * x.b[0] + r(i, 1) * x.b[1] + r(i, 2) * x.b[2]))
    });
    let of_b: [L; 3] = std::array::from_fn(|j| {
        x.q[j].abs() - (x.b[j] + (r(0, j) * x.a[0] + r(1, j) * x.a[1] + r(2, j) * x.a[2]))
    });
    let best = |s: [L; 3]| {
        let is_y = s[1].gt(s[0]);
        let first = s[1].max(s[0]);
        let is_z = s[2].gt(first);
        (s[2].max(first), is_y & !is_z, is_z)
    };
    let ((a, a_y, a_z), (b, b_y, b_z)) = (best(of_a), best(of_b));
    let take_b = b.gt(a + allowed(a));
    let choose = |yes: L::Mask, no: L::Mask| (take_b & yes) | (!take_b & no);
    Face {
        separation: L::select(take_b, b, a),
        greatest: a.max(b),
        of_b: take_b,
        is_y: choose(b_y, a_y),
        is_z: choose(b_z, a_z),
    }
}

/// The best pair of edges as a contact.
struct Edge<L: Lanes> {
    separation: L,
    /// The separation less the largest error by rounding.
    bound: L,
    normal: Vec3<L>,
    position: Vec3<L>,
    key: L,
    /// The closest points of the two lines lie on both edges.
    passes: L::Mask,
}

/// Whether an edge is the first, the second or the third.
#[inline(always)]
fn is<L: Lanes>(edge: L) -> [L::Mask; 3] {
    let (one, two) = (edge.eq(L::one()), edge.eq(L::splat(2.0)));
    [!(one | two), one, two]
}

/// The middle of an edge along an axis, on the side that is away; notes the side in the key.
#[inline(always)]
fn side<L: Lanes>(key: &mut L, away: L, is_edge: L::Mask, half: L) -> L {
    let zero = L::zero();
    *key = *key + *key + L::select(is_edge | away.lt(zero), zero, L::one());
    L::select(is_edge, zero, half * away.sign())
}

#[inline(always)]
fn best_edge<L: Lanes>(x: &Boxes<L>) -> Edge<L> {
    // Rounding of a gap before it is divided by the sine: on a wide floor, edges that are almost parallel
    // could otherwise claim a millimetre that is not there.
    let p = Vec3::new(x.p[0], x.p[1], x.p[2]);
    let scale =
        p.abs().dot(Vec3::splat(glam::Vec3::ONE)) + x.a[0] + x.a[1] + x.a[2] + x.b[0] + x.b[1] + x.b[2];
    let rounding = scale * L::splat(4e-7);

    let mut best = L::splat(f32::NEG_INFINITY);
    let (mut edge_i, mut edge_j) = (L::zero(), L::zero());
    for i in 0..3 {
        let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
        for j in 0..3 {
            let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
            let (r1, r2) = (x.r[i1][j], x.r[i2][j]);
            let squared = r1 * r1 + r2 * r2;
            // Within a milliradian of parallel, faces say the same.
            let crosses = squared.gt(L::splat(1e-6));
            let reach_a = x.a[i1] * r2.abs() + x.a[i2] * r1.abs();
            let reach_b = x.b[j1] * x.r[i][j2].abs() + x.b[j2] * x.r[i][j1].abs();
            let gap = (x.p[i2] * r1 - x.p[i1] * r2).abs() - (reach_a + reach_b + rounding);
            let separation = gap / L::select(crosses, squared, L::one()).sqrt();
            let take = crosses & separation.gt(best);
            best = L::select(take, separation, best);
            edge_i = L::select(take, L::splat(i as f32), edge_i);
            edge_j = L::select(take, L::splat(j as f32), edge_j);
        }
    }

    let (is_i, is_j) = (is(edge_i), is(edge_j));
    let zero = L::zero();
    let unit = |k: usize| L::select(is_i[k], L::one(), zero);
    let along_a = Vec3::new(unit(0), unit(1), unit(2));
    let of_j = |row: &[L; 3]| pick(is_j[1], is_j[2], *row);
    let along_b = Vec3::new(of_j(&x.r[0]), of_j(&x.r[1]), of_j(&x.r[2]));
    let cross = along_a.cross(along_b);
    let squared = cross.length_squared();
    let crosses = squared.gt(L::splat(1e-7));
    let over = L::one() / L::select(crosses, squared, L::one());
    let normal = cross * (over.sqrt() * cross.dot(p).sign());

    // Middles of the two edges, and which of the four parallel ones they are.
    let (n, mut key) = ([normal.x, normal.y, normal.z], edge_i * L::splat(3.0) + edge_j);
    let (mut on_a, mut on_b) = ([zero; 3], [zero; 3]);
    for k in 0..3 {
        on_a[k] = side(&mut key, n[k], is_i[k], x.a[k]);
    }
    let middle_a = Vec3::new(on_a[0], on_a[1], on_a[2]);
    for k in 0..3 {
        let away = -(x.r[0][k] * n[0] + x.r[1][k] * n[1] + x.r[2][k] * n[2]);
        on_b[k] = side(&mut key, away, is_j[k], x.b[k]);
    }
    let middle_b = p + x.vector_of_b(on_b);

    let w = middle_b - middle_a;
    let (cosine, on_a, on_b) = (along_a.dot(along_b), w.dot(along_a), w.dot(along_b));
    let s = (on_a - cosine * on_b) * over;
    let t = cosine * s - on_b;
    let (half_a, half_b) = (pick(is_i[1], is_i[2], x.a), of_j(&x.b));
    let passes = crosses & s.abs().le(half_a) & t.abs().le(half_b);
    let (s, t) = (s.clamp(-half_a, half_a), t.clamp(-half_b, half_b));
    let position = (middle_a + along_a * s + middle_b + along_b * t) * L::splat(0.5);
    let separation = w.dot(normal);
    Edge { separation, bound: best, normal, position, key: key + L::splat(1024.0), passes }
}

#[cfg(test)]
mod tests;
