use super::*;
use crate::math::Quat;
use crate::narrow_phase::pairs::lanes_io::testing::*;
use crate::narrow_phase::{RawManifold, Relative};
use glam::{DVec3, Vec3, vec3};

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
        let reach = |k: usize| (0..3).map(|i| self.axes[k][i].dot(n).abs() * self.half[k][i]).sum::<f64>();
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

    /// The distance of boxes that are apart: every vertex against the other box, every edge against every
    /// edge.
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
            true => (greatest, AXIS_BIAS as f64 * slow.least - AXIS_DEPTH_BIAS as f64 * greatest + 1e-5),
            false => (slow.distance(), 3.0 * AXIS_BIAS as f64 * slow.least + 1e-5),
        };
        seen[(truth > 0.0) as usize + (truth > 0.0 && m.count <= 2) as usize] += 1;
        let along = slow.along(m.normal.as_dvec3());
        // A nearly flat face may stand for the edges in it.
        let by_face = m.points().iter().all(|p| p.key >= 4096);
        if by_face && truth < 0.0 {
            // The part of the other box that reaches below the face beside it is no overlap: moved out along
            // the normal by the depth, the boxes are apart, but for its angle to the edges' axis.
            assert!(along < truth + tolerance, "normal: {along} {truth} {pair:?}");
            let mut out = *pair;
            out.0.position -= m.normal * truth as f32;
            let left = Slow::new(&out).greatest();
            let lean = (1.0 - FLAT_FACE_COSINE as f64) * -truth;
            assert!(left > -(tolerance + lean), "not the way out: {left} {truth} {pair:?}");
        } else {
            let lean = if by_face { FLAT_FACE_BIAS as f64 * slow.least } else { 0.0 };
            assert!((along - truth).abs() < tolerance + lean, "normal: {along} {truth} {pair:?}");
        }
        if truth > pair.3 as f64 + tolerance {
            assert_eq!(m.count, 0);
            assert!(m.gap() as f64 <= truth + 1e-5, "{} {truth} {pair:?}", m.gap());
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
                let tilt = random.cube() * noise;
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
        let (tilt, x) = (random.cube() * 2e-5, 1.0 + random.range(-2e-5, 2e-5));
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
        let rotation = Quat::from_scaled_axis(random.cube() * 1e-5) * Quat::from_rotation_y(yaw);
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
        let rotation = Quat::from_scaled_axis(random.cube() * 1e-5)
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
        let (tilt, x) = (random.cube() * 5e-3, random.range(-1.5, 1.5));
        let m = stacked(Vec3::ONE, Vec3::ONE, x, random.range(-0.005, 0.005), random.range(-1.0, 1.0), tilt);
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
