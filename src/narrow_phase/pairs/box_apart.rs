//! Boxes that are apart and meet neither face to face nor at crossing edges: the closest features then
//! include a vertex, so the sixteen distances of a vertex from a box hold the answer.

use super::box_box::Boxes;
use super::lanes_io::{ManifoldLanes, direction};
use crate::lanes::{Lanes, Vec3, kernel};

/// A vertex and the other box's nearest point to it.
#[derive(Clone, Copy)]
struct Vertex<L> {
    /// In the other box's frame.
    at: Vec3<L>,
    /// From the nearest point of the other box to the vertex.
    gap: Vec3<L>,
    key: L,
}

impl<L: Lanes> Vertex<L> {
    #[inline(always)]
    fn take(&mut self, take: L::Mask, other: Vertex<L>) {
        self.at = Vec3::select(take, other.at, self.at);
        self.gap = Vec3::select(take, other.gap, self.gap);
        self.key = L::select(take, other.key, self.key);
    }
}

/// Vertex `k` of a box with centre `centre`, half axes `axes`, against a box round the origin.
#[inline(always)]
fn vertex<L: Lanes>(k: usize, centre: Vec3<L>, axes: &[Vec3<L>; 3], half: Vec3<L>) -> Vertex<L> {
    let mut at = centre;
    for (bit, axis) in axes.iter().enumerate() {
        at = if k >> bit & 1 == 0 { at - *axis } else { at + *axis };
    }
    Vertex { at, gap: at - at.max(-half).min(half), key: L::splat(k as f32) }
}

/// The nearest vertex of eight, and its distance squared.
#[inline(always)]
fn nearest<L: Lanes>(centre: Vec3<L>, axes: &[Vec3<L>; 3], half: Vec3<L>) -> (Vertex<L>, L) {
    let mut best = vertex(0, centre, axes, half);
    let mut least = best.gap.length_squared();
    for k in 1..8 {
        let other = vertex(k, centre, axes, half);
        let squared = other.gap.length_squared();
        best.take(squared.lt(least), other);
        least = squared.min(least);
    }
    (best, least)
}

/// The vertex furthest from `from` (and further than the root of `least`) whose own way to the box is along
/// `normal`: the other end of two parallel edges, or of an edge along a face.
#[inline(always)]
fn furthest_aligned<L: Lanes>(
    centre: Vec3<L>,
    axes: &[Vec3<L>; 3],
    half: Vec3<L>,
    from: Vec3<L>,
    normal: Vec3<L>,
    distance: L,
    least: L,
) -> (Vertex<L>, L) {
    let none = Vec3::zero();
    let (mut best, mut most) = (Vertex { at: none, gap: none, key: L::zero() }, least);
    for k in 0..8 {
        let other = vertex(k, centre, axes, half);
        let along = other.gap.dot(normal);
        let aligned = along.gt(L::zero()) & (along * along).ge(other.gap.length_squared() * L::splat(0.995));
        let squared = (other.at - other.gap * L::splat(0.5) - from).length_squared();
        // Beside the first, not behind it.
        let behind = along - distance;
        let take = aligned & (behind * behind).lt(squared * L::splat(0.25)) & squared.gt(most);
        best.take(take, other);
        most = L::select(take, squared, most);
    }
    (best, most)
}

kernel! {
    /// Puts the closest features' manifold into the lanes of `lanes`: one point, or two where edges are
    /// parallel.
    pub(crate) fn closest_vertex<'a, L: Lanes>(
        x: &'a Boxes<L>,
        lanes: L::Mask,
        out: &'a mut ManifoldLanes<L>,
    ) {
        let (r, half) = (&x.r, L::splat(0.5));
        let (half_a, half_b) = (Vec3::new(x.a[0], x.a[1], x.a[2]), Vec3::new(x.b[0], x.b[1], x.b[2]));
        // b's vertices in a's frame, and a's in b's.
        let (p, q) = (Vec3::new(x.p[0], x.p[1], x.p[2]), -Vec3::new(x.q[0], x.q[1], x.q[2]));
        let axes_b: [Vec3<L>; 3] = std::array::from_fn(|j| Vec3::new(r[0][j], r[1][j], r[2][j]) * x.b[j]);
        let axes_a: [Vec3<L>; 3] = std::array::from_fn(|i| Vec3::new(r[i][0], r[i][1], r[i][2]) * x.a[i]);
        let middle = |v: &Vertex<L>| v.at - v.gap * half;
        let (of_b, b_squared) = nearest(p, &axes_b, half_a);
        let (of_a, a_squared) = nearest(q, &axes_a, half_b);
        let from_a = a_squared.lt(b_squared);
        let gap = Vec3::select(from_a, -x.seen_from_a(of_a.gap), of_b.gap);
        let (normal, distance) = direction(gap, L::zero(), out.normal);
        let position = Vec3::select(from_a, p + x.seen_from_a(middle(&of_a)), middle(&of_b));
        let key = L::select(from_a, of_a.key, of_b.key + L::splat(8.0));

        // A point nearer than this adds nothing.
        let least = x.least * L::splat(0.05);
        let least = least * least;
        let (second_b, b_squared) = furthest_aligned(p, &axes_b, half_a, position, normal, distance, least);
        let (there, back) = (x.seen_from_b(position - p), x.seen_from_b(-normal));
        let (second_a, a_squared) = furthest_aligned(q, &axes_a, half_b, there, back, distance, least);
        let from_a = a_squared.gt(b_squared);
        let second = Vec3::select(from_a, p + x.seen_from_a(middle(&second_a)), middle(&second_b));
        let second_gap = L::select(from_a, second_a.gap.length(), second_b.gap.length());
        let second_key = L::select(from_a, second_a.key, second_b.key + L::splat(8.0));
        let has_second = a_squared.max(b_squared).gt(least);

        let none = L::splat(f32::INFINITY);
        out.normal = Vec3::select(lanes, normal, out.normal);
        let points = [
            (position, distance, key),
            (second, L::select(has_second, second_gap, none), second_key),
            (second, none, second_key),
            (second, none, second_key),
        ];
        for (i, (position, separation, key)) in points.into_iter().enumerate() {
            out.position[i] = Vec3::select(lanes, position, out.position[i]);
            out.separation[i] = L::select(lanes, separation, out.separation[i]);
            out.key[i] = L::select(lanes, key, out.key[i]);
        }
    }
}
