use super::*;
use crate::math::Quat;
use crate::narrow_phase::pairs::lanes_io::testing::*;
use crate::narrow_phase::{RawManifold, Relative};
use glam::{DQuat, DVec3, Vec3, vec3};

/// In the box's frame: the balls at the capsule's ends, and the box's half extents.
struct Slow {
    ends: [(DVec3, f64); 2],
    half: DVec3,
    into: DQuat,
}

impl Slow {
    fn new((relative, a, b, _): &Pair) -> Slow {
        let into = relative.rotation.as_dquat().inverse();
        let end = |y: f32, r: f32| (into * (DVec3::Y * y as f64 - relative.position.as_dvec3()), r as f64);
        let half = DVec3::new(b[0] as f64, b[1] as f64, b[2] as f64);
        Slow { ends: [end(-a[0], a[1]), end(a[0], a[2])], half, into }
    }

    /// Least of (distance from the box, the same less the radius) along the axis: both are convex.
    fn nearest(&self) -> (f64, f64) {
        let at = |s: f64| {
            let [(p, r), (q, o)] = self.ends;
            let (x, r) = (p.lerp(q, s), r + (o - r) * s);
            let core = (x.abs() - self.half).max(DVec3::ZERO).length();
            (core, core - r)
        };
        let least = |f: &dyn Fn(f64) -> f64| {
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..100 {
                let third = (high - low) / 3.0;
                if f(low + third) <= f(high - third) { high -= third } else { low += third }
            }
            f(low).min(f(high))
        };
        (least(&|s| at(s).0), least(&|s| at(s).1))
    }

    /// Separation along a unit direction out of the box.
    fn along(&self, n: DVec3) -> f64 {
        self.ends.iter().map(|(c, r)| n.dot(*c) - r).fold(f64::INFINITY, f64::min) - n.abs().dot(self.half)
    }

    /// Greatest separation over all directions, by sampling and refining: the depth, negative.
    fn depth(&self, random: &mut Random) -> f64 {
        let mut best = (f64::NEG_INFINITY, DVec3::X);
        let attempt = |n: DVec3, best: &mut (f64, DVec3)| {
            let n = n.normalize_or(DVec3::X);
            if self.along(n) > best.0 {
                *best = (self.along(n), n);
            }
        };
        for axis in DVec3::AXES {
            attempt(axis, &mut best);
            attempt(-axis, &mut best);
        }
        // Several starts, for the overlap has several local answers.
        let mut all = best;
        for _ in 0..12 {
            let mut best = (f64::NEG_INFINITY, DVec3::X);
            for _ in 0..100 {
                attempt(random.cube().as_dvec3(), &mut best);
            }
            for i in 0..500 {
                let step = 0.3 * 0.985f64.powi(i);
                attempt(best.1 + random.cube().as_dvec3() * step, &mut best);
            }
            all = if best.0 > all.0 { best } else { all };
        }
        all.0
    }
}

fn check(found: &[RawManifold], pairs: &[Pair]) {
    let mut random = Random(99);
    let (mut deep, mut two) = (0, 0);
    for (m, pair) in found.iter().zip(pairs) {
        let slow = Slow::new(pair);
        let (core, mut truth) = slow.nearest();
        let mut tolerance = 5e-5;
        let n = -(slow.into * m.normal.as_dvec3());
        if core < 1e-5 {
            deep += 1;
            truth = slow.depth(&mut random);
            // The bias that keeps faces.
            tolerance = 4e-3;
        }
        assert!((slow.along(n) - truth).abs() < tolerance, "{} {truth} {core} {pair:?}", slow.along(n));
        if truth < pair.3 as f64 - tolerance {
            let found = deepest(m) as f64;
            assert!((found - truth).abs() < tolerance, "{found} {truth} {core} {pair:?}");
            two += (m.count == 2) as u32;
        } else if truth > pair.3 as f64 + tolerance {
            assert_eq!(m.count, 0);
            assert!(m.gap() as f64 <= truth + 5e-5, "{} {truth} {pair:?}", m.gap());
        }
    }
    assert!(deep > 50 && two > 100, "{deep} {two}");
}

#[test]
fn uniform_capsules_keep_their_true_distance_or_least_overlap_at_any_width() {
    let mut pairs = uniform(pairs(7, 2000, 1.8));
    pairs[0].0.position = Vec3::ZERO;
    pairs[1].0 = Relative { position: Vec3::ZERO, rotation: Quat::IDENTITY };
    pairs[2].1[0] = 0.0;
    check(&same_at_any_width(&pairs, capsule_box, capsule_box, capsule_box), &pairs);
}

#[test]
fn tapered_capsules_keep_their_true_distance_or_least_overlap_at_any_width() {
    let pairs = pairs(8, 2000, 1.8);
    let kernel = tapered_capsule_box::<f32>;
    check(&same_at_any_width(&pairs, kernel, tapered_capsule_box, tapered_capsule_box), &pairs);
}

#[test]
fn the_tapered_kernel_agrees_with_the_uniform_one() {
    agree(&uniform(pairs(9, 1000, 1.8)), capsule_box, tapered_capsule_box);
}

/// A capsule of half height 0.5 and radius 0.1 that lies along z at `lift` over a box, turned by `tilt`
/// about x; in a's frame the box lies towards -x.
fn lying(half: Vec3, lift: f32, tilt: f32) -> RawManifold {
    let lie = Quat::from_rotation_arc(Vec3::Y, Vec3::Z);
    let turn = Quat::from_rotation_x(tilt) * lie;
    let centre = vec3(0.0, half.y + 0.1 + lift, 0.0);
    let relative = Relative { position: turn.conjugate() * -centre, rotation: turn.conjugate() };
    let size = [half.x, half.y, half.z, 0.0];
    run::<f32>(&[(relative, [0.5, 0.1, 0.1, 0.0], size, 0.05)], capsule_box)[0]
}

#[test]
fn a_capsule_that_lies_on_a_face_has_a_point_under_each_end() {
    // On a wide box, on one that is shorter than the capsule, and on a beam no wider than 2 cm.
    let boxes = [(vec3(2.0, 1.0, 2.0), 0.5), (vec3(2.0, 1.0, 0.3), 0.3), (vec3(0.01, 0.4, 3.0), 0.5)];
    for (half, reach) in boxes {
        for lift in [-0.01, 0.0, 0.01, -0.15] {
            for tilt in [0.0, 1e-6, -1e-4, 1e-3] {
                let m = lying(half, lift, tilt);
                if lift == -0.15 && half.x < 0.1 {
                    continue; // out of a thin beam the way is sideways
                }
                assert_eq!(m.count, 2, "{half} {lift} {tilt} {m:?}");
                for p in m.points() {
                    let y = [-reach, reach][p.key as usize];
                    assert!((p.position.y - y).abs() < 2e-3, "{half} {lift} {tilt} {m:?}");
                    assert!((p.separation - lift).abs() < 1e-3);
                }
            }
        }
    }
}

#[test]
fn a_capsule_along_an_edge_has_two_points_and_across_it_one() {
    let lie = Quat::from_rotation_arc(Vec3::Y, Vec3::Z);
    let at = |turn: Quat| {
        // The centre 0.1 m off the edge at x = y = 1, diagonally.
        let off = 0.1 * std::f32::consts::FRAC_1_SQRT_2;
        let centre = vec3(1.0 + off, 1.0 + off, 0.0);
        let relative = Relative { position: turn.conjugate() * -centre, rotation: turn.conjugate() };
        run::<f32>(&[(relative, [0.5, 0.1, 0.1, 0.0], [1.0, 1.0, 4.0, 0.0], 0.05)], capsule_box)[0]
    };
    let m = at(lie);
    assert_eq!(m.count, 2);
    assert!(m.points().iter().all(|p| p.separation.abs() < 1e-6 && (p.position.y.abs() - 0.5).abs() < 1e-5));
    let across = Quat::from_rotation_z(std::f32::consts::FRAC_PI_4) * lie;
    let across = Quat::from_axis_angle(vec3(1.0, 1.0, 0.0).normalize(), 1.2) * across;
    let m = at(across);
    assert_eq!(m.count, 1);
    assert!(m.points[0].separation.abs() < 1e-6);
}
