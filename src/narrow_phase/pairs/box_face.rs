//! A face of one box against the face of the other that looks at it.
//!
//! The other face is clipped to the side planes of the reference face, and of the up to eight corners four
//! are kept: the furthest in each of four directions, diagonal to the slope of the one face against the
//! other. A rectangle keeps its four corners, whichever way the slope goes; if it is tilted about an edge,
//! these are the two lower and the two upper ones. The deepest is kept in any case. Every corner that
//! clipping can bring is offered to every lane: twelve, most of them invalid.

use super::box_box::{Boxes, Face};
use super::lanes_io::{ManifoldLanes, pick};
use crate::config::tuning::{FLUSH_BIAS, TIE_SLOPE};
use crate::lanes::{Lanes, Vec3};

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

/// The corners that are kept.
struct Corners<L> {
    kept: [Extreme<L>; 4],
    deepest: Extreme<L>,
    /// The direction down the slope.
    down: [L; 2],
}

impl<L: Lanes> Corners<L> {
    #[inline(always)]
    fn offer(&mut self, valid: L::Mask, u: L, v: L, key: L) {
        let Corners { kept, deepest, down: [du, dv] } = self;
        let (down, aside) = (*du * u + *dv * v, *du * v - *dv * u);
        kept[0].offer(valid, down + aside, u, v, key);
        kept[1].offer(valid, down - aside, u, v, key);
        kept[2].offer(valid, -(down + aside), u, v, key);
        kept[3].offer(valid, aside - down, u, v, key);
        deepest.offer(valid, down, u, v, key);
    }
}

/// The two faces, in the frame of the reference face: axes u and v along it, n out of it.
struct Faces<L: Lanes> {
    /// Half extents of the reference box.
    half: [L; 3],
    /// Middle of the other face, over that of the reference face.
    middle: [L; 3],
    /// The edges of the other face from its middle: along u and v, and half their lengths.
    first: [L; 2],
    second: [L; 2],
    lengths: [L; 2],
    /// Slope of the other face over the reference face.
    slope: [L; 2],
    /// Whether the reference face looks along n or against it.
    up: L,
    /// Which face of the other box it is.
    other_y: L::Mask,
    other_z: L::Mask,
    out: L,
}

impl<L: Lanes> Faces<L> {
    #[inline(always)]
    fn new(x: &Boxes<L>, face: &Face<L>) -> Faces<L> {
        // To the frame of the face: rows u, v, n; the other box's centre above it.
        let of_b = face.of_b;
        let choose = |b: L, a: L| L::select(of_b, b, a);
        let m: [[L; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| choose(x.r[j][i], x.r[i][j])));
        let centre: [L; 3] = std::array::from_fn(|i| choose(-x.q[i], x.p[i]));
        let reference: [L; 3] = std::array::from_fn(|i| choose(x.b[i], x.a[i]));
        let other: [L; 3] = std::array::from_fn(|i| choose(x.a[i], x.b[i]));
        let row = |v: [L; 3]| pick(face.is_y, face.is_z, v);
        let turned = |v: [L; 3]| [row([v[1], v[2], v[0]]), row([v[2], v[0], v[1]]), row(v)];
        let half = turned(reference);
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
        // No division by zero: the axis nearest to the normal is within 55 degrees of it.
        let steep = -(L::one() / mn);
        Faces {
            half,
            middle: [cu + mu * out, cv + mv * out, cn.abs() + mn * out - half[2]],
            first: [axis(0, 1) * h1, axis(1, 1) * h1],
            second: [axis(0, 2) * h2, axis(1, 2) * h2],
            lengths: [h1, h2],
            slope: [mu * steep, mv * steep],
            up,
            other_y,
            other_z,
            out,
        }
    }

    /// Separation over the reference face. Here and below u and v count from the middle of the other face: on
    /// a wide floor, that keeps their digits.
    #[inline(always)]
    fn depth(&self, u: L, v: L) -> L {
        self.middle[2] + self.slope[0] * u + self.slope[1] * v
    }

    /// Offers the edges of the other face, clipped: side * second + t first and side * first + t second. The
    /// first family also brings the vertices, where nothing was clipped.
    #[inline(always)]
    fn offer_edges(&self, slack: L, corners: &mut Corners<L>) {
        let ([hu, hv, _], [fu, fv, _]) = (self.half, self.middle);
        let (wu, wv) = (hu + slack, hv + slack);
        let (one, minus) = (L::one(), -L::one());
        let key = |k: usize| L::splat(k as f32);
        let families = [(0, self.first, self.second), (1, self.second, self.first)];
        for (family, [tu, tv], [ou, ov]) in families {
            let tiny = L::splat(1e-12);
            let over = |t: L| one / L::select(t.abs().gt(tiny), t, tiny);
            let (over_u, over_v) = (over(tu), over(tv));
            let (half_u, half_v) = ((wu * over_u).abs(), (wv * over_v).abs());
            for (side, k) in [(minus, 0), (one, 2)] {
                let (u, v) = (ou * side, ov * side);
                let (at_u, at_v) = (-((fu + u) * over_u), -((fv + v) * over_v));
                let low = (at_u - half_u).max(at_v - half_v).max(minus);
                let high = (at_u + half_u).min(at_v + half_v).min(one);
                let valid = low.le(high);
                let (cut_low, cut_high) = (low.gt(minus), high.lt(one));
                let (low_u, low_v, high_u, high_v) =
                    (u + tu * low, v + tv * low, u + tu * high, v + tv * high);
                if family == 0 {
                    corners.offer(valid, low_u, low_v, L::select(cut_low, key(4 + k), key(k)));
                    corners.offer(valid, high_u, high_v, L::select(cut_high, key(5 + k), key(1 + k)));
                } else {
                    corners.offer(valid & cut_low, low_u, low_v, key(8 + k));
                    corners.offer(valid & cut_high, high_u, high_v, key(9 + k));
                }
            }
        }
    }

    /// Offers the corners of the reference face that lie over the other one.
    #[inline(always)]
    fn offer_corners(&self, slack: L, corners: &mut Corners<L>) {
        let ([hu, hv, _], [fu, fv, _], [h1, h2]) = (self.half, self.middle, self.lengths);
        let ([e1u, e1v], [e2u, e2v]) = (self.first, self.second);
        let (one, minus) = (L::one(), -L::one());
        let size = (e1u * e2v - e1v * e2u).abs();
        let (room_1, room_2) = (size * (h1 - slack), size * (h2 - slack));
        let (x1, y1, z1) = (hu * e2v, hv * e2u, fu * e2v - fv * e2u);
        let (x2, y2, z2) = (hu * e1v, hv * e1u, fu * e1v - fv * e1u);
        for (k, side_u, side_v) in [(12, minus, minus), (13, one, minus), (14, minus, one), (15, one, one)] {
            let s = x1 * side_u - y1 * side_v - z1;
            let t = x2 * side_u - y2 * side_v - z2;
            let within = (s.abs() * h1).le(room_1) & (t.abs() * h2).le(room_2);
            corners.offer(within, hu * side_u - fu, hv * side_v - fv, L::splat(k as f32));
        }
    }

    /// Puts the lowest vertex, pulled onto the face, in the place of the first corner.
    #[inline(always)]
    fn rescue(&self, empty: L::Mask, corner: &mut Extreme<L>) {
        let ([hu, hv, _], [fu, fv, _], [gu, gv]) = (self.half, self.middle, self.slope);
        let ([e1u, e1v], [e2u, e2v]) = (self.first, self.second);
        let (s1, s2) = (-(gu * e1u + gv * e1v).sign(), -(gu * e2u + gv * e2v).sign());
        corner.u = L::select(empty, (fu + e1u * s1 + e2u * s2).clamp(-hu, hu) - fu, corner.u);
        corner.v = L::select(empty, (fv + e1v * s1 + e2v * s2).clamp(-hv, hv) - fv, corner.v);
    }

    /// Which two faces meet: 36 pairs of faces with 16 corners each.
    #[inline(always)]
    fn key(&self, face: &Face<L>) -> L {
        let (zero, one) = (L::zero(), L::one());
        let key = |k: usize| L::splat(k as f32);
        let which = |y: L::Mask, z: L::Mask, sign: L| {
            L::select(z, key(4), L::select(y, key(2), zero)) + L::select(sign.lt(zero), one, zero)
        };
        let faces = L::select(face.of_b, key(6), zero) + which(face.is_y, face.is_z, self.up);
        (faces * key(6) + which(self.other_y, self.other_z, self.out)) * key(16) + key(4096)
    }
}

/// Origin and axes u, v, n of a reference face in the frame of box a.
#[inline(always)]
fn frame_in_a<L: Lanes>(x: &Boxes<L>, face: &Face<L>, up: L) -> (Vec3<L>, [Vec3<L>; 3]) {
    let (zero, one) = (L::zero(), L::one());
    let choose = |b: L, a: L| L::select(face.of_b, b, a);
    let row = |v: [L; 3]| pick(face.is_y, face.is_z, v);
    let basis = |i: usize| {
        let e = |k: usize| if k == i { one } else { zero };
        Vec3::new(choose(x.r[0][i], e(0)), choose(x.r[1][i], e(1)), choose(x.r[2][i], e(2)))
    };
    let (bx, by, bz) = (basis(0), basis(1), basis(2));
    let of_row = |a: Vec3<L>, b: Vec3<L>, c: Vec3<L>| {
        Vec3::new(row([a.x, b.x, c.x]), row([a.y, b.y, c.y]), row([a.z, b.z, c.z]))
    };
    let axes = [of_row(by, bz, bx), of_row(bz, bx, by), of_row(bx, by, bz) * up];
    (Vec3::new(choose(x.p[0], zero), choose(x.p[1], zero), choose(x.p[2], zero)), axes)
}

/// Points of the contact at `face`, of which those that coincide or don't exist are infinitely far; in
/// overlap at least one remains.
#[inline(always)]
pub(crate) fn face_points<L: Lanes>(
    x: &Boxes<L>,
    face: &Face<L>,
    apart: L::Mask,
    margin: L,
) -> ManifoldLanes<L> {
    let (zero, one) = (L::zero(), L::one());
    let faces = Faces::new(x, face);
    // Down the slope; level, along a direction that singles out one corner of any rectangle along the axes.
    let [gu, gv] = faces.slope;
    let down = [L::splat(0.4 * TIE_SLOPE) - gu, L::splat(0.9 * TIE_SLOPE) - gv];
    let none = || Extreme { reach: L::splat(f32::NEG_INFINITY), u: zero, v: zero, key: -one };
    let mut corners = Corners { kept: [none(), none(), none(), none()], deepest: none(), down };
    let slack = x.least * L::splat(FLUSH_BIAS);
    faces.offer_edges(slack, &mut corners);
    faces.offer_corners(slack, &mut corners);

    // Deep and skew, the bias can leave nothing over the face.
    let Corners { mut kept, deepest, .. } = corners;
    let empty = kept[0].key.lt(zero);
    let rescued = empty & !apart;
    faces.rescue(empty, &mut kept[0]);

    let infinite = L::splat(f32::INFINITY);
    let mut separation: [L; 4] = std::array::from_fn(|i| {
        let c = &kept[i];
        let again = kept[..i].iter().fold(c.key.lt(zero), |again, before| again | c.key.eq(before.key));
        L::select(again, infinite, faces.depth(c.u, c.v))
    });
    // The deepest takes the place of a double, or else of the highest.
    let [s0, s1, s2, s3] = separation;
    let highest = s0.max(s1).max(s2.max(s3));
    let lowest = faces.depth(deepest.u, deepest.v);
    let mut missing = !empty & lowest.lt(s0.min(s1).min(s2.min(s3)) - slack);
    for (c, s) in kept.iter_mut().zip(&mut separation) {
        let here = missing & s.eq(highest);
        missing = missing & !here;
        c.u = L::select(here, deepest.u, c.u);
        c.v = L::select(here, deepest.v, c.v);
        c.key = L::select(here, deepest.key, c.key);
        *s = L::select(here, lowest, *s);
    }
    separation[0] = L::select(rescued, face.separation, separation[0]);

    let (origin, [axis_u, axis_v, axis_n]) = frame_in_a(x, face, faces.up);
    let ([_, _, hn], [fu, fv, _]) = (faces.half, faces.middle);
    let (flip, key) = (L::select(face.of_b, -one, one), faces.key(face));
    let mut out = ManifoldLanes::single(axis_n * flip, Vec3::zero(), infinite, margin);
    for (i, (c, s)) in kept.iter().zip(separation).enumerate() {
        out.separation[i] = s;
        // A point that does not exist still gets a finite place.
        let middle = hn + L::select(s.lt(infinite), s, zero) * L::splat(0.5);
        out.position[i] = origin + axis_u * (fu + c.u) + axis_v * (fv + c.v) + axis_n * middle;
        out.key[i] = key + c.key.max(zero);
    }
    out
}
