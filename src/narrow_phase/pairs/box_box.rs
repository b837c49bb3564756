//! Box against box: fifteen separating axes, then face against face or edge against edge.
//!
//! 1. The axis of greatest separation: three faces of each box, nine pairs of edges. Faces win over edges and
//!    `a` over `b` unless the other is better by a bias, so that a stack keeps its reference face.
//! 2. A face: the other box's face that looks at it is clipped to it, and four points are kept (`box_face.rs`).
//! 3. An edge: one point, where the two edges pass.
//! 4. Apart, the axis of greatest separation is a lower bound of the distance and every pair of points an upper
//!    one. Where face or edge points meet the bound, they are right. Where they don't (edge or vertex regions),
//!    the closest features include a vertex, and `box_apart.rs` finds them; a reference plane would stop there
//!    what passes by.

use super::box_apart::closest_vertex;
use super::box_face::face_points;
use super::lanes_io::{ManifoldLanes, PairLanes, pick};
use crate::lanes::{Lanes, Mask, Vec3};

/// Axes prefer faces, and those of `a`, by this share of the least half extent, and of the depth.
/// Large against rounding and the tilt of a resting box, small against the slop.
const BIAS: f32 = 1e-3;
const DEPTH_BIAS: f32 = 1e-2;
/// Cosine of the angle (3.6 degrees) up to which faces that give the same depth are better than edges.
const FLAT: f32 = 0.998;
/// And how much further the face's lowest vertex may reach, beyond the edge where clipping drops it, as a share
/// of the least half extent.
const FLAT_BIAS: f32 = 5e-2;

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
    pub(crate) fn vector_of_b(&self, v: [L; 3]) -> Vec3<L> {
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
    let greatest = face.greatest.max(edge.bound);
    let apart = greatest.gt(L::zero());
    let mut out = face_points(&boxes, &face, apart, p.margin);
    let [s0, s1, s2, s3] = out.separation;
    let deepest = s0.min(s1).min(s2.min(s3));
    // Of nearly flat boxes the clipped face has the edges' depth already, and four points to rest on.
    let flat = out.normal.dot(edge.normal).gt(L::splat(FLAT))
        & (deepest - edge.separation).abs().le(allowed(edge.separation))
        & (edge.separation - face.separation).lt(boxes.least * L::splat(FLAT_BIAS));
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

/// The reference face: a box and an axis of it.
pub(crate) struct Face<L: Lanes> {
    pub(crate) separation: L,
    /// Of all six, whichever was chosen.
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
    /// The separation less what rounding may have added.
    bound: L,
    normal: Vec3<L>,
    position: Vec3<L>,
    key: L,
    /// The closest points of the two lines lie on both edges.
    passes: L::Mask,
}

#[inline(always)]
fn best_edge<L: Lanes>(x: &Boxes<L>) -> Edge<L> {
    // Rounding of a gap before it is divided by the sine: on a wide floor, edges that are almost parallel could
    // otherwise claim a millimetre that is not there.
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
mod tests {
    use super::*;
    use crate::narrow_phase::pairs::lanes_io::testing::*;
    use crate::narrow_phase::{RawManifold, Relative};
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

        fn outside(&self, k: usize, x: DVec3) -> DVec3 {
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
                    least = least.min(self.outside(1 - k, self.vertex(k, i)).length());
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
            // A nearly flat face may stand for the edges in it.
            let by_face = m.points().iter().all(|p| p.key >= 4096);
            let lean = if by_face { FLAT_BIAS as f64 * slow.least } else { 0.0 };
            assert!((along - truth).abs() < tolerance + lean, "normal: {along} {truth} {pair:?}");
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
                    let off = slow.outside(k, x).length();
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

    #[test]
    fn the_answer_scales_with_the_scene() {
        let pairs = pairs(17, 1000, 1.5);
        let at = |scale: f32| {
            let mut scaled = pairs.clone();
            for (relative, a, b, margin) in &mut scaled {
                relative.position *= scale;
                (*a, *b, *margin) = (a.map(|h| h * scale), b.map(|h| h * scale), *margin * scale);
            }
            run::<f32>(&scaled, box_box)
        };
        // Powers of two, so that rounding is the same: 1 mm and 1 km.
        let (one, small, big) = (at(1.0), at(1.0 / 1024.0), at(1024.0));
        for ((one, small), big) in one.iter().zip(&small).zip(&big) {
            assert_eq!((one.normal, one.count), (small.normal, small.count));
            assert_eq!((one.normal, one.count), (big.normal, big.count));
            for i in 0..one.count as usize {
                let (one, small, big) = (one.points[i], small.points[i], big.points[i]);
                assert_eq!((one.key, one.separation), (small.key, small.separation * 1024.0));
                assert_eq!((one.key, one.separation * 1024.0), (big.key, big.separation));
            }
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
        for turn in [0.1, 0.5, std::f32::consts::FRAC_PI_4, 1.2, 3.0] {
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
    fn a_small_box_anywhere_on_a_wide_floor_rests_on_four_points() {
        let mut random = Random(18);
        let (floor, small) = (vec3(50.0, 0.5, 50.0), Vec3::splat(0.05));
        for i in 0..2000 {
            let yaw = random.range(-1.0, 1.0) * 0.5f32.powi(i % 20);
            let rotation = Quat::from_scaled_axis(random.vector(1e-5)) * Quat::from_rotation_y(yaw);
            let position = vec3(random.range(-45.0, 45.0), 0.55, random.range(-45.0, 45.0));
            let m = one(Relative { position, rotation }, floor, small, 0.01);
            assert!(m.count == 4 && m.points().iter().all(|p| p.separation.abs() < 1e-5), "{yaw} {m:?}");
            let back = rotation.conjugate();
            let m = one(Relative { position: back * -position, rotation: back }, small, floor, 0.01);
            // The floor's distance is now measured along a tilted axis, from afar.
            assert!(m.count == 4 && m.points().iter().all(|p| p.separation.abs() < 1e-3), "{yaw} {m:?}");
        }
    }

    #[test]
    fn a_small_box_on_its_edge_on_a_wide_floor_rests_on_two_points() {
        let mut random = Random(19);
        // Also with other axes of the box along the floor's, which cost the matrix digits.
        let quarter = std::f32::consts::FRAC_PI_2;
        let lying = [Quat::IDENTITY, Quat::from_rotation_x(quarter), Quat::from_rotation_y(quarter)];
        let (floor, small) = (vec3(50.0, 0.5, 50.0), Vec3::splat(0.05));
        for i in 0..2000 {
            let tilt = Quat::from_rotation_z(random.range(0.4, 1.1));
            let yaw = random.range(-1.0, 1.0) * 0.5f32.powi(i % 20);
            let rotation = Quat::from_scaled_axis(random.vector(1e-5))
                * Quat::from_rotation_y(yaw)
                * tilt
                * lying[i as usize % 3];
            let down = (rotation.conjugate() * Vec3::Y).abs().dot(small);
            let position = vec3(random.range(-45.0, 45.0), 0.5 + down, random.range(-45.0, 45.0));
            let back = rotation.conjugate();
            let (over, under) = (
                one(Relative { position, rotation }, floor, small, 0.01),
                one(Relative { position: back * -position, rotation: back }, small, floor, 0.01),
            );
            for m in [over, under] {
                assert!(m.count == 2 && deepest(&m).abs() < 1e-4, "{i} {yaw} {m:?}");
            }
        }
    }

    #[test]
    fn a_nearly_flat_box_over_an_edge_keeps_its_four_points() {
        let mut random = Random(16);
        for _ in 0..500 {
            let (tilt, x) = (random.vector(5e-3), random.range(-1.5, 1.5));
            let m =
                stacked(Vec3::ONE, Vec3::ONE, x, random.range(-0.005, 0.005), random.range(-1.0, 1.0), tilt);
            assert!(m.count >= 3, "{tilt} {x} {m:?}");
        }
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
}
