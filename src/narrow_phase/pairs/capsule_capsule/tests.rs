use super::*;
use crate::math::Quat;
use crate::narrow_phase::Relative;
use crate::narrow_phase::pairs::lanes_io::testing::*;
use glam::{Vec3, vec3};

fn check(found: &[crate::narrow_phase::RawManifold], pairs: &[Pair]) {
    for (m, (relative, a, b, margin)) in found.iter().zip(pairs) {
        let truth = between_capsules(relative, a, b);
        if truth < *margin as f64 - 1e-5 {
            let deepest = deepest(m) as f64;
            assert!((deepest - truth).abs() < 5e-5, "{deepest} {truth} {relative:?} {a:?} {b:?}");
        } else if truth > *margin as f64 + 1e-5 {
            assert_eq!(m.count, 0);
            assert!(m.gap() as f64 <= truth + 5e-5, "{} {truth} {relative:?}", m.gap());
        }
    }
}

#[test]
fn uniform_capsules_are_as_far_apart_as_their_segments_at_any_width() {
    let mut pairs = uniform(pairs(4, 1500, 2.0));
    pairs[0].0.position = Vec3::ZERO;
    (pairs[1].1[0], pairs[1].2[0]) = (0.0, 0.0);
    pairs[2].0 = Relative { position: vec3(0.0, 0.2, 0.0), rotation: Quat::IDENTITY };
    for (i, pair) in pairs.iter_mut().enumerate().skip(3).step_by(5) {
        // Nearly parallel, by ever less.
        pair.0.rotation = Quat::from_scaled_axis(pair.0.position * 0.5f32.powi(i as i32 % 24));
    }
    check(&same_at_any_width(&pairs, capsule_capsule, capsule_capsule, capsule_capsule), &pairs);
}

#[test]
fn tapered_capsules_are_as_far_apart_as_their_nearest_balls_at_any_width() {
    let mut pairs = pairs(5, 1500, 2.0);
    for pair in pairs.iter_mut().step_by(3) {
        (pair.1[2], pair.2[0]) = (pair.1[1], 0.2 * pair.2[0]);
    }
    let kernel = tapered_capsule_capsule::<f32>;
    let found = same_at_any_width(&pairs, kernel, tapered_capsule_capsule, tapered_capsule_capsule);
    check(&found, &pairs);
}

#[test]
fn the_tapered_kernel_agrees_with_the_uniform_one() {
    let pairs = uniform(pairs(6, 500, 2.0));
    agree(&pairs, capsule_capsule, tapered_capsule_capsule);
}

#[test]
fn capsules_side_by_side_touch_at_both_ends_of_the_overlap() {
    let size = [0.5, 0.1, 0.1, 0.0];
    for turn in [0.0, 1e-4, -1e-4, 3e-3] {
        for flip in [Quat::IDENTITY, Quat::from_xyzw(0.0, 0.0, 1.0, 0.0)] {
            let relative =
                Relative { position: vec3(0.2, 0.3, 0.0), rotation: flip * Quat::from_rotation_x(turn) };
            for m in run::<f32>(&[(relative, size, size, 0.02)], capsule_capsule) {
                assert!(m.normal.dot(Vec3::X) > 0.9999 && (2..=3).contains(&m.count));
                let ends = m.points().iter().map(|p| (p.key, p.position.y, p.separation));
                for (key, y, separation) in ends.filter(|p| p.0 < 2) {
                    assert!((y - [-0.2, 0.5][key as usize]).abs() < 2e-3, "{key} {y}");
                    assert!(separation.abs() < 1e-4);
                }
            }
        }
    }
}

#[test]
fn crossing_capsules_touch_at_one_point() {
    let size = [0.5, 0.1, 0.1, 0.0];
    let relative = Relative { position: vec3(0.2, 0.1, 0.1), rotation: Quat::from_rotation_x(0.8) };
    let m = run::<f32>(&[(relative, size, size, 1.0)], capsule_capsule)[0];
    assert_eq!((m.count, m.points[0].key), (1, 2));
    assert!(m.points[0].separation.abs() < 1e-6 && (m.points[0].position.x - 0.1).abs() < 1e-6);
    // Axes that meet: out along x or against it, by the sum of the radii.
    let relative = Relative { position: Vec3::ZERO, ..relative };
    let m = run::<f32>(&[(relative, size, size, 0.0)], capsule_capsule)[0];
    assert!((m.normal.x.abs() - 1.0).abs() < 1e-6 && (m.points[0].separation + 0.2).abs() < 1e-6);
}
