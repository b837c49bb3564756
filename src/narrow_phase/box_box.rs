//! Box against box: fifteen separating axes, then face against face or edge against edge.
//!
//! 1. The axis of greatest separation: three faces of each box, nine pairs of edges. Faces win over edges and
//!    `a` over `b` unless the other is better by a bias, so that a stack keeps its reference face.
//! 2. A face: the other box's face that looks at it is clipped to it, and four points are kept (`face_points`).
//! 3. An edge: one point, where the two edges pass.
//! 4. Apart, the axis of greatest separation is a lower bound of the distance and every pair of points an upper
//!    one. Where face or edge points meet the bound, they are right. Where they don't (edge or vertex regions),
//!    the closest features include a vertex, and `box_apart.rs` finds them; a reference plane would stop there
//!    what passes by.

use super::box_apart::closest_vertex;
use super::lanes_io::{ManifoldLanes, PairLanes, pick};
use crate::lanes::{Lanes, Mask, Vec3};

/// Axes prefer faces, and those of `a`, by this share of the least half extent, and of the depth.
/// Large against rounding and the tilt of a resting box, small against the slop.
const BIAS: f32 = 1e-3;
const DEPTH_BIAS: f32 = 1e-2;
/// Side planes lie this share of the least half extent further out. Boxes that are flush (walls, pyramids) then
/// keep their vertices as features, whichever way rounding pushes them.
const FLUSH: f32 = 1e-4;
/// Added slope by which equal depths are told apart: of a flat contact always the same corners come first.
const TIE: f32 = 5e-5;

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

    /// A vector given by the axes of `b`.
    #[inline(always)]
    pub(crate) fn from_b(&self, v: [L; 3]) -> Vec3<L> {
        let row = |i: usize| self.r[i][0] * v[0] + self.r[i][1] * v[1] + self.r[i][2] * v[2];
        Vec3::new(row(0), row(1), row(2))
    }
}

/// See the module.
pub(crate) fn box_box<L: Lanes>(p: &PairLanes<L>) -> ManifoldLanes<L> {
    let boxes = Boxes::new(p);
    let bias = boxes.least * L::splat(BIAS);
    let allowed = |s: L| bias + (-s).max(L::zero()) * L::splat(DEPTH_BIAS);

    let face = best_face(&boxes, allowed);
    let edge = best_edge(&boxes);
    let greatest = face.greatest.max(edge.separation);
    let apart = greatest.gt(L::zero());
    let edge_wins = edge.separation.gt(face.separation + allowed(face.separation));

    let mut out = face_points(&boxes, &face, apart, p.margin);
    let [s0, s1, s2, s3] = out.separation;
    let deepest = s0.min(s1).min(s2.min(s3));
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

/// The reference face: a box and an axis of it.
struct Face<L: Lanes> {
    separation: L,
    /// Of all six, whichever was chosen.
    greatest: L,
    of_b: L::Mask,
    is_y: L::Mask,
    is_z: L::Mask,
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
    normal: Vec3<L>,
    position: Vec3<L>,
    key: L,
    /// The closest points of the two lines lie on both edges.
    passes: L::Mask,
}

#[inline(always)]
fn best_edge<L: Lanes>(x: &Boxes<L>) -> Edge<L> {
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
            let gap = (x.p[i2] * r1 - x.p[i1] * r2).abs() - (reach_a + reach_b);
            let separation = gap / L::select(crosses, squared, L::one()).sqrt();
            let take = crosses & separation.gt(best);
            best = L::select(take, separation, best);
            edge_i = L::select(take, L::splat(i as f32), edge_i);
            edge_j = L::select(take, L::splat(j as f32), edge_j);
        }
    }

    let is = |edge: L| {
        let (one, two) = (edge.eq(L::one()), edge.eq(L::splat(2.0)));
        [!(one | two), one, two]
    };
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
    let p = Vec3::new(x.p[0], x.p[1], x.p[2]);
    let normal = cross * (over.sqrt() * cross.dot(p).sign());

    // Middles of the two edges, and which of the four parallel ones they are.
    let (n, mut key) = ([normal.x, normal.y, normal.z], edge_i * L::splat(3.0) + edge_j);
    let mut side = |away: L, is_edge: L::Mask, half: L| {
        key = key + key + L::select(is_edge | away.lt(zero), zero, L::one());
        L::select(is_edge, zero, half * away.sign())
    };
    let on_a: [L; 3] = std::array::from_fn(|k| side(n[k], is_i[k], x.a[k]));
    let middle_a = Vec3::new(on_a[0], on_a[1], on_a[2]);
    let on_b: [L; 3] = std::array::from_fn(|k| {
        let away = -(x.r[0][k] * n[0] + x.r[1][k] * n[1] + x.r[2][k] * n[2]);
        side(away, is_j[k], x.b[k])
    });
    let middle_b = p + x.from_b(on_b);

    let w = middle_b - middle_a;
    let (cosine, on_a, on_b) = (along_a.dot(along_b), w.dot(along_a), w.dot(along_b));
    let s = (on_a - cosine * on_b) * over;
    let t = cosine * s - on_b;
    let (half_a, half_b) = (pick(is_i[1], is_i[2], x.a), of_j(&x.b));
    let passes = crosses & s.abs().le(half_a) & t.abs().le(half_b);
    let (s, t) = (s.clamp(-half_a, half_a), t.clamp(-half_b, half_b));
    let position = (middle_a + along_a * s + middle_b + along_b * t) * L::splat(0.5);
    Edge { separation: best, normal, position, key: key + L::splat(1024.0), passes }
}

/// A corner of the clipped face that lies furthest in some direction.
struct Extreme<L> {
    reach: L,
    u: L,
    v: L,
    key: L,
}

impl<L: Lanes> Extreme<L> {
    #[inline(always)]
    fn offer(&mut self, valid: L::Mask, reach: L, u: L, v: L, key: L) {
        let take = valid & reach.gt(self.reach);
        self.reach = L::select(take, reach, self.reach);
        self.u = L::select(take, u, self.u);
        self.v = L::select(take, v, self.v);
        self.key = L::select(take, key, self.key);
    }
}

/// The face of the other box that looks at the reference face, clipped to it, and of the up to eight corners
/// four: the furthest down the slope of the one face against the other (that is the deepest), up, and to both
/// sides. Of a rectangle those are its four corners, whichever way the slope goes.
#[inline(always)]
fn face_points<L: Lanes>(x: &Boxes<L>, face: &Face<L>, apart: L::Mask, margin: L) -> ManifoldLanes<L> {
    let zero = L::zero();
    // To the frame of the face: rows u, v, n; the other box's centre above it.
    let of_b = face.of_b;
    let choose = |b: L, a: L| L::select(of_b, b, a);
    let m: [[L; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| choose(x.r[j][i], x.r[i][j])));
    let centre: [L; 3] = std::array::from_fn(|i| choose(-x.q[i], x.p[i]));
    let reference: [L; 3] = std::array::from_fn(|i| choose(x.b[i], x.a[i]));
    let other: [L; 3] = std::array::from_fn(|i| choose(x.a[i], x.b[i]));
    let row = |v: [L; 3]| pick(face.is_y, face.is_z, v);
    let turned = |v: [L; 3]| [row([v[1], v[2], v[0]]), row([v[2], v[0], v[1]]), row(v)];
    let [hu, hv, hn] = turned(reference);
    let [cu, cv, cn] = turned(centre);
    let up = cn.sign();
    let columns: [[L; 3]; 3] = std::array::from_fn(|j| turned([m[0][j], m[1][j], m[2][j]]));

    // The other box's face: its axis that is nearest to the normal, and the two axes that span it.
    let lean: [L; 3] = std::array::from_fn(|j| columns[j][2].abs());
    let other_y = lean[1].gt(lean[0]);
    let other_z = lean[2].gt(lean[0].max(lean[1]));
    let column = |v: [L; 3]| pick(other_y, other_z, v);
    let axis = |k: usize, turn: usize| {
        column([columns[turn % 3][k], columns[(turn + 1) % 3][k], columns[(turn + 2) % 3][k]])
    };
    let (mu, mv, mn) = (axis(0, 0), axis(1, 0), axis(2, 0) * up);
    let (h1, h2) = (column([other[1], other[2], other[0]]), column([other[2], other[0], other[1]]));
    let out = -(mn.sign() * column(other));
    let (fu, fv, fn_) = (cu + mu * out, cv + mv * out, cn.abs() + mn * out - hn);
    let (e1u, e1v) = (axis(0, 1) * h1, axis(1, 1) * h1);
    let (e2u, e2v) = (axis(0, 2) * h2, axis(1, 2) * h2);
    // Separation over the reference face: fn + gu (u - fu) + gv (v - fv). No division by zero: the axis nearest
    // to the normal is within 55 degrees of it.
    let steep = -(L::one() / mn);
    let (gu, gv) = (mu * steep, mv * steep);
    let depth = |u: L, v: L| fn_ + gu * (u - fu) + gv * (v - fv);

    // Down the slope; level, along a direction that singles out one corner of any rectangle along the axes.
    let (du, dv) = (L::splat(0.4 * TIE) - gu, L::splat(0.9 * TIE) - gv);
    let none = || Extreme { reach: L::splat(f32::NEG_INFINITY), u: zero, v: zero, key: -L::one() };
    let mut kept = [none(), none(), none(), none()];
    let mut offer = |valid: L::Mask, u: L, v: L, key: L| {
        let (down, aside) = (du * u + dv * v, du * v - dv * u);
        kept[0].offer(valid, down, u, v, key);
        kept[1].offer(valid, aside, u, v, key);
        kept[2].offer(valid, -down, u, v, key);
        kept[3].offer(valid, -aside, u, v, key);
    };

    // Edges of the other face, clipped: f + side * e2 + t e1 and f + side * e1 + t e2. The first family also
    // brings the vertices, where nothing was clipped.
    let slack = x.least * L::splat(FLUSH);
    let (wu, wv) = (hu + slack, hv + slack);
    let (one, minus) = (L::one(), -L::one());
    let key = |k: usize| L::splat(k as f32);
    for (family, (tu, tv), (ou, ov)) in [(0, (e1u, e1v), (e2u, e2v)), (1, (e2u, e2v), (e1u, e1v))] {
        let tiny = L::splat(1e-12);
        let over = |t: L| one / L::select(t.abs().gt(tiny), t, tiny);
        let (over_u, over_v) = (over(tu), over(tv));
        let (half_u, half_v) = ((wu * over_u).abs(), (wv * over_v).abs());
        for (side, k) in [(minus, 0), (one, 2)] {
            let (u, v) = (fu + ou * side, fv + ov * side);
            let (at_u, at_v) = (-(u * over_u), -(v * over_v));
            let low = (at_u - half_u).max(at_v - half_v).max(minus);
            let high = (at_u + half_u).min(at_v + half_v).min(one);
            let valid = low.le(high);
            let (cut_low, cut_high) = (low.gt(minus), high.lt(one));
            if family == 0 {
                offer(valid, u + tu * low, v + tv * low, L::select(cut_low, key(4 + k), key(k)));
                offer(valid, u + tu * high, v + tv * high, L::select(cut_high, key(5 + k), key(1 + k)));
            } else {
                offer(valid & cut_low, u + tu * low, v + tv * low, key(8 + k));
                offer(valid & cut_high, u + tu * high, v + tv * high, key(9 + k));
            }
        }
    }
    // Corners of the reference face that lie over the other one.
    let size = (e1u * e2v - e1v * e2u).abs();
    let (room_1, room_2) = (size * (h1 - slack), size * (h2 - slack));
    let (x1, y1, z1) = (hu * e2v, hv * e2u, fu * e2v - fv * e2u);
    let (x2, y2, z2) = (hu * e1v, hv * e1u, fu * e1v - fv * e1u);
    for (k, side_u, side_v) in [(12, minus, minus), (13, one, minus), (14, minus, one), (15, one, one)] {
        let s = x1 * side_u - y1 * side_v - z1;
        let t = x2 * side_u - y2 * side_v - z2;
        let within = (s.abs() * h1).le(room_1) & (t.abs() * h2).le(room_2);
        offer(within, hu * side_u, hv * side_v, key(k));
    }

    // Deep and skew, the bias can leave nothing over the face: then its lowest vertex, pulled onto it.
    let [k0, _, _, _] = &mut kept;
    let empty = k0.key.lt(zero);
    let lowest = |e_u: L, e_v: L| -(gu * e_u + gv * e_v).sign();
    let (s1, s2) = (lowest(e1u, e1v), lowest(e2u, e2v));
    let rescued = empty & !apart;
    k0.u = L::select(empty, (fu + e1u * s1 + e2u * s2).clamp(-hu, hu), k0.u);
    k0.v = L::select(empty, (fv + e1v * s1 + e2v * s2).clamp(-hv, hv), k0.v);

    // Back to the frame of a.
    let (zero_v, unit) = (zero, one);
    let basis = |i: usize| {
        let e = |k: usize| if k == i { unit } else { zero_v };
        Vec3::new(choose(x.r[0][i], e(0)), choose(x.r[1][i], e(1)), choose(x.r[2][i], e(2)))
    };
    let (bx, by, bz) = (basis(0), basis(1), basis(2));
    let of_row = |a: Vec3<L>, b: Vec3<L>, c: Vec3<L>| {
        Vec3::new(row([a.x, b.x, c.x]), row([a.y, b.y, c.y]), row([a.z, b.z, c.z]))
    };
    let (axis_u, axis_v, axis_n) = (of_row(by, bz, bx), of_row(bz, bx, by), of_row(bx, by, bz) * up);
    let origin = Vec3::new(choose(x.p[0], zero), choose(x.p[1], zero), choose(x.p[2], zero)) + axis_n * hn;

    // Which two faces meet is part of the key: 36 pairs of faces with 16 corners each.
    let which = |y: L::Mask, z: L::Mask, sign: L| {
        L::select(z, key(4), L::select(y, key(2), zero)) + L::select(sign.lt(zero), one, zero)
    };
    let faces = choose(key(6), zero) + which(face.is_y, face.is_z, up);
    let faces = (faces * key(6) + which(other_y, other_z, out)) * key(16) + key(4096);

    let infinite = L::splat(f32::INFINITY);
    let mut out = ManifoldLanes::single(axis_n * choose(minus, one), Vec3::zero(), infinite, margin);
    for i in 0..4 {
        let c = &kept[i];
        let again = kept[..i].iter().fold(c.key.lt(zero), |again, before| again | c.key.eq(before.key));
        let separation = depth(c.u, c.v);
        out.separation[i] = L::select(again, infinite, separation);
        out.position[i] = origin + axis_u * c.u + axis_v * c.v + axis_n * (separation * L::splat(0.5));
        out.key[i] = faces + c.key;
    }
    out.separation[0] = L::select(rescued, face.separation, out.separation[0]);
    out.key[0] = L::select(rescued, faces, out.key[0]);
    out
}

#[cfg(test)]
mod tests {
    use super::super::lanes_io::testing::*;
    use super::super::{RawManifold, Relative};
    use super::*;
    use crate::lanes::f32x8;
    use glam::{DVec3, Quat, Vec3, vec3};

    /// The pair in f64: centre and axes of each box in the frame of `a`.
    struct Slow {
        centre: [DVec3; 2],
        axes: [[DVec3; 3]; 2],
        half: [DVec3; 2],
        least: f64,
    }

    impl Slow {
        fn new((relative, a, b, _): &Pair) -> Slow {
            let half = [a, b].map(|h| DVec3::new(h[0] as f64, h[1] as f64, h[2] as f64));
            let turn = relative.rotation.as_dquat().normalize();
            Slow {
                centre: [DVec3::ZERO, relative.position.as_dvec3()],
                axes: [DVec3::AXES, DVec3::AXES.map(|axis| turn * axis)],
                half,
                least: half[0].min_element().min(half[1].min_element()),
            }
        }

        fn along(&self, n: DVec3) -> f64 {
            let reach =
                |k: usize| (0..3).map(|i| self.axes[k][i].dot(n).abs() * self.half[k][i]).sum::<f64>();
            (self.centre[1] - self.centre[0]).dot(n) - reach(0) - reach(1)
        }

        /// Separation along the best of the fifteen axes.
        fn greatest(&self) -> f64 {
            let mut best = f64::NEG_INFINITY;
            let mut attempt = |n: DVec3| {
                if n.length() > 1e-6 {
                    best = best.max(self.along(n.normalize())).max(self.along(-n.normalize()));
                }
            };
            for i in 0..3 {
                attempt(self.axes[0][i]);
                attempt(self.axes[1][i]);
                for j in 0..3 {
                    attempt(self.axes[0][i].cross(self.axes[1][j]));
                }
            }
            best
        }

        fn from_box(&self, k: usize, x: DVec3) -> DVec3 {
            let local = DVec3::from_array(self.axes[k].map(|axis| axis.dot(x - self.centre[k])));
            local - local.clamp(-self.half[k], self.half[k])
        }

        fn vertex(&self, k: usize, i: usize) -> DVec3 {
            let side = |bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            (0..3).fold(self.centre[k], |x, bit| x + self.axes[k][bit] * self.half[k][bit] * side(bit))
        }

        /// Of boxes that are apart: every vertex against the other box, every edge against every edge.
        fn distance(&self) -> f64 {
            let mut least = f64::INFINITY;
            for k in 0..2 {
                for i in 0..8 {
                    least = least.min(self.from_box(1 - k, self.vertex(k, i)).length());
                }
            }
            let edges = |k: usize| {
                (0..3)
                    .flat_map(move |bit| {
                        (0..8).filter(move |i| i >> bit & 1 == 0).map(move |i| (i, i | 1 << bit))
                    })
                    .map(move |(i, j)| (self.vertex(k, i), self.vertex(k, j)))
            };
            for (a, b) in edges(0) {
                for (c, d) in edges(1) {
                    let (u, v, w) = (b - a, d - c, a - c);
                    let det = u.dot(u) * v.dot(v) - u.dot(v).powi(2);
                    if det > 1e-12 {
                        let s = (u.dot(v) * v.dot(w) - v.dot(v) * u.dot(w)) / det;
                        let t = (u.dot(u) * v.dot(w) - u.dot(v) * u.dot(w)) / det;
                        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
                            least = least.min((w + u * s - v * t).length());
                        }
                    }
                }
            }
            least
        }
    }

    /// How many of the manifolds are (overlapping, apart by faces, apart by one or two features).
    fn check(found: &[RawManifold], pairs: &[Pair]) -> [u32; 3] {
        let mut seen = [0; 3];
        for (m, pair) in found.iter().zip(pairs) {
            let slow = Slow::new(pair);
            let greatest = slow.greatest();
            let (truth, tolerance) = match greatest < 0.0 {
                true => (greatest, BIAS as f64 * slow.least - DEPTH_BIAS as f64 * greatest + 1e-5),
                false => (slow.distance(), 3.0 * BIAS as f64 * slow.least + 1e-5),
            };
            seen[(truth > 0.0) as usize + (truth > 0.0 && m.count <= 2) as usize] += 1;
            let along = slow.along(m.normal.as_dvec3());
            assert!((along - truth).abs() < tolerance, "normal: {along} {truth} {pair:?}");
            if truth > pair.3 as f64 + tolerance {
                assert_eq!(m.count, 0);
            }
            if truth < pair.3 as f64 - tolerance {
                let deepest = deepest(m) as f64;
                assert!((deepest - truth).abs() < tolerance, "{deepest} {truth} {pair:?} {m:?}");
            }
            for point in m.points() {
                let (x, separation) = (point.position.as_dvec3(), point.separation as f64);
                for k in 0..2 {
                    let off = slow.from_box(k, x).length();
                    assert!(off < 0.5 * separation.abs() + 2.0 * tolerance, "{k} {off} {point:?} {pair:?}");
                }
            }
        }
        seen
    }

    #[test]
    fn random_boxes_keep_their_least_overlap_or_true_distance_at_any_width() {
        for (seed, reach) in [(10, 1.0), (11, 2.0)] {
            let mut pairs = pairs(seed, 3000, reach);
            pairs[0].0.position = Vec3::ZERO;
            pairs[1].0 = Relative { position: Vec3::ZERO, rotation: Quat::IDENTITY };
            for (i, pair) in pairs.iter_mut().enumerate().skip(2).step_by(7) {
                // Nearly parallel, by ever less.
                pair.0.rotation = Quat::from_scaled_axis(pair.0.position * 0.5f32.powi(i as i32 % 24));
            }
            for pair in pairs.iter_mut().step_by(5) {
                pair.2 = pair.1; // equal boxes
            }
            for pair in pairs.iter_mut().skip(1).step_by(5) {
                pair.1[1] *= 0.05; // plates
            }
            let seen = check(&same_at_any_width(&pairs, box_box, box_box, box_box), &pairs);
            assert!(seen.iter().all(|n| *n > 100), "{seen:?}");
        }
    }

    fn one(relative: Relative, a: Vec3, b: Vec3, margin: f32) -> RawManifold {
        let size = |h: Vec3| [h.x, h.y, h.z, 0.0];
        run::<f32>(&[(relative, size(a), size(b), margin)], box_box)[0]
    }

    /// Box `b` over box `a`, moved sideways by `x`, turned about y by `turn`, and tilted.
    fn stacked(a: Vec3, b: Vec3, x: f32, lift: f32, turn: f32, tilt: Vec3) -> RawManifold {
        let rotation = Quat::from_scaled_axis(tilt) * Quat::from_rotation_y(turn);
        one(Relative { position: vec3(x, a.y + b.y + lift, 0.0), rotation }, a, b, 0.05)
    }

    fn sorted(m: &RawManifold) -> Vec<[f32; 2]> {
        let mut all: Vec<_> = m.points().iter().map(|p| [p.position.x, p.position.z]).collect();
        all.sort_by(|a, b| a[0].round().total_cmp(&b[0].round()).then(a[1].total_cmp(&b[1])));
        all
    }

    #[test]
    fn a_resting_box_has_four_equal_points_at_the_corners_of_the_overlap() {
        let (big, small, tall) = (vec3(3.0, 1.0, 3.0), vec3(1.0, 1.0, 1.0), vec3(1.0, 4.0, 1.0));
        // Sizes, shift, and the overlap's bounds in x; in z it is the smaller box.
        let cases = [
            (small, small, 0.0, [-1.0, 1.0]),
            (big, small, 0.5, [-0.5, 1.5]),
            (small, big, 0.0, [-1.0, 1.0]),
            (small, tall, 1.0, [0.0, 1.0]),
            (small, small, 1.5, [0.5, 1.0]),
            (small, big, -3.5, [-1.0, -0.5]),
        ];
        let mut random = Random(12);
        for (a, b, x, [low, high]) in cases {
            for lift in [-0.01, 0.0, 0.01] {
                for noise in [0.0, 1e-7, 1e-5, 1e-4] {
                    let tilt = random.vector(noise);
                    let m = stacked(a, b, x, lift, 0.0, tilt);
                    assert_eq!(m.count, 4, "{a} {b} {x} {lift} {noise}");
                    assert!((m.normal - Vec3::Y).length() < 2e-4);
                    let mut corners = [[low, -1.0], [low, 1.0], [high, -1.0], [high, 1.0]].to_vec();
                    for p in m.points() {
                        assert!((p.separation - lift).abs() < 1e-6 + 4.0 * noise);
                        assert!((p.position.y - (a.y + 0.5 * lift)).abs() < 1e-6 + 4.0 * noise);
                        let slack = 1e-3 + 4.0 * noise;
                        corners.retain(|c| {
                            (c[0] - p.position.x).abs() > slack || (c[1] - p.position.z).abs() > slack
                        });
                    }
                    assert!(corners.is_empty(), "{a} {b} {x}: no point at {corners:?}, {m:?}");
                }
            }
        }
    }

    #[test]
    fn a_box_turned_about_y_rests_on_its_four_corners() {
        for turn in [0.1, 0.5, 0.785_398_2, 1.2, 3.0] {
            let m = stacked(vec3(3.0, 1.0, 3.0), Vec3::ONE, 0.5, 0.0, turn, Vec3::ZERO);
            assert_eq!(m.count, 4);
            for p in m.points() {
                let from = Quat::from_rotation_y(-turn) * (p.position - vec3(0.5, 1.0, 0.0));
                assert!((from.abs() - vec3(1.0, 0.0, 1.0)).length() < 1e-5 && p.separation.abs() < 1e-6);
            }
            // The overlap of equal squares has eight corners; four spread ones remain.
            let m = stacked(Vec3::ONE, Vec3::ONE, 0.0, 0.0, turn, Vec3::ZERO);
            assert_eq!(m.count, 4);
            let mean: Vec3 = m.points().iter().map(|p| p.position * 0.25).sum();
            assert!((mean - Vec3::Y).length() < 0.05);
            assert!(m.points().iter().all(|p| (p.position - Vec3::Y).length() > 0.99));
        }
    }

    #[test]
    fn keys_stay_while_a_stack_jitters() {
        let mut random = Random(13);
        let first = stacked(Vec3::ONE, Vec3::ONE, 1.0, -1e-3, 0.0, Vec3::ZERO);
        let keys = |m: &RawManifold| {
            let mut keys: Vec<_> = m.points().iter().map(|p| p.key).collect();
            keys.sort();
            keys
        };
        for _ in 0..500 {
            let (tilt, x) = (random.vector(2e-5), 1.0 + random.range(-2e-5, 2e-5));
            let m = stacked(Vec3::ONE, Vec3::ONE, x, random.range(-2e-3, 1e-4), tilt.y, tilt);
            assert_eq!(keys(&m), keys(&first), "{tilt}");
        }
        let distinct: std::collections::BTreeSet<_> = keys(&first).into_iter().collect();
        assert_eq!(distinct.len(), 4);
    }

    #[test]
    fn a_tilted_box_keeps_its_lowest_edge_and_the_other_corners() {
        for axis in [Vec3::X, Vec3::Z, -Vec3::Z, vec3(0.6, 0.0, 0.8)] {
            let tilt = axis * 0.02;
            let m = stacked(vec3(3.0, 1.0, 3.0), Vec3::ONE, 0.3, 0.0, 0.0, tilt);
            assert_eq!(m.count, 4);
            let lowest = Slow::new(&(
                Relative { position: vec3(0.3, 2.0, 0.0), rotation: Quat::from_scaled_axis(tilt) },
                [3.0, 1.0, 3.0, 0.0],
                [1.0; 4],
                0.0,
            ))
            .greatest();
            assert!((deepest(&m) as f64 - lowest).abs() < 1e-5);
        }
    }

    #[test]
    fn boxes_that_pass_diagonally_see_the_way_between_corners() {
        // Corner to corner, 0.3 m apart along each axis: no plane of a face is near.
        let relative = Relative { position: Vec3::splat(2.3), rotation: Quat::IDENTITY };
        let m = one(relative, Vec3::ONE, Vec3::ONE, 1.0);
        assert_eq!(m.count, 1);
        assert!((m.normal - Vec3::ONE.normalize()).length() < 1e-5);
        assert!((m.points[0].separation - 0.3 * 3f32.sqrt()).abs() < 1e-5);
        // Edge along edge: two points, at the ends of their overlap.
        let relative = Relative { position: vec3(2.3, 2.3, 0.5), rotation: Quat::IDENTITY };
        let m = one(relative, Vec3::ONE, Vec3::ONE, 1.0);
        assert_eq!(m.count, 2);
        let mut z = [m.points[0].position.z, m.points[1].position.z];
        z.sort_by(f32::total_cmp);
        assert!((z[0] + 0.5).abs() < 1e-5 && (z[1] - 1.0).abs() < 1e-5, "{z:?}");
    }

    #[test]
    #[ignore = "a measurement: cargo test --release speed_of_a_box_pair -- --ignored --nocapture"]
    fn speed_of_a_box_pair() {
        let mut random = Random(14);
        let resting = |random: &mut Random| -> Pair {
            let position = vec3(random.range(-1.0, 1.0), 1.0, random.range(-0.5, 0.5));
            let rotation = Quat::from_scaled_axis(random.vector(1e-3));
            (Relative { position, rotation }, [0.5; 4], [0.5; 4], 0.02)
        };
        let stack: Vec<_> = (0..4096).map(|_| resting(&mut random)).collect();
        for (name, pairs) in [("stack", stack), ("random", pairs(15, 4096, 1.5))] {
            let lanes: Vec<_> =
                (0..pairs.len() / 8).map(|k| PairLanes::<f32x8>::from_fn(|i| pairs[8 * k + i])).collect();
            let mut out = vec![RawManifold::default(); pairs.len()];
            let (mut kernel, mut whole) = (f64::INFINITY, f64::INFINITY);
            for _ in 0..50 {
                let start = std::time::Instant::now();
                for p in &lanes {
                    std::hint::black_box(box_box(p));
                }
                kernel = kernel.min(start.elapsed().as_nanos() as f64);
                let start = std::time::Instant::now();
                for (p, out) in lanes.iter().zip(out.chunks_mut(8)) {
                    let m = box_box(p);
                    for (i, out) in out.iter_mut().enumerate() {
                        *out = m.lane(i);
                    }
                }
                std::hint::black_box(&mut out);
                whole = whole.min(start.elapsed().as_nanos() as f64);
            }
            let n = pairs.len() as f64;
            println!("{name}: {:.1} ns a pair, {:.1} with its manifold", kernel / n, whole / n);
        }
    }
}
