use super::*;
use crate::config::ContinuousMode;
use crate::lanes::Mask;
use crate::lanes::{f32x4, f32x8};
use crate::random::Random;
use glam::{DVec3, vec3};

fn mover(min: glam::Vec3, max: glam::Vec3, motion: glam::Vec3, spin: f32) -> Mover {
    Mover { collider: 0, aabb: Aabb { min, max }, motion, spin, mode: ContinuousMode::Segment }
}

/// Paths of lengths 0 to 100 m near boxes of 0 to 5 m, all about `centre`; every eighth along an axis.
fn cases(count: usize, centre: glam::Vec3) -> Vec<(Path, Aabb)> {
    let mut random = Random(11);
    (0..count)
        .map(|i| {
            let start = centre + random.cube() * 5.0;
            let half = (random.cube() * 0.5).abs();
            let mut motion = random.cube() * [0.0, 1.0, 10.0, 100.0][i % 4];
            if i % 8 == 1 {
                motion.y = 0.0;
                motion.z = 0.0;
            }
            let path = Path::new(&mover(start - half, start + half, motion, random.unit() * 0.1), 0.05);
            let middle = start + motion * random.unit() + random.cube() * 4.0;
            let half = (random.cube() * [0.0, 0.1, 5.0][i % 3]).abs();
            (path, Aabb { min: middle - half, max: middle + half })
        })
        .collect()
}

fn answers<L: Lanes>(path: &Path, boxes: &[Aabb; 8]) -> u32 {
    let lanes = path.lanes::<L>();
    (0..8).step_by(L::N).fold(0, |bits, i| {
        let (min, max) = (Vec3::from_fn(|k| boxes[i + k].min), Vec3::from_fn(|k| boxes[i + k].max));
        bits | lanes.hits(min, max).bits() << i
    })
}

#[test]
fn a_path_hits_the_same_boxes_at_any_width() {
    let cases = cases(8_000, glam::Vec3::ZERO);
    let mut hits = 0;
    for eight in cases.chunks(8) {
        let mut boxes: [Aabb; 8] = std::array::from_fn(|i| eight[i].1);
        boxes[3] = Aabb::EMPTY;
        for (path, _) in eight {
            let one = answers::<f32>(path, &boxes);
            assert_eq!(one, answers::<f32x4>(path, &boxes));
            assert_eq!(one, answers::<f32x8>(path, &boxes));
            assert_eq!(one & 8, 0, "an inert lane answers no");
            hits += one.count_ones();
        }
    }
    assert!(hits > 2_000, "{hits}");
}

/// The slab test in f64: another method than the one under test. Boxes are grown by `slack` [m].
pub(in crate::broad_phase) fn slabs(
    start: DVec3,
    motion: DVec3,
    extent: DVec3,
    min: DVec3,
    max: DVec3,
    slack: f64,
) -> bool {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for k in 0..3 {
        let (low, high) = (min[k] - extent[k] - slack, max[k] + extent[k] + slack);
        if motion[k] == 0.0 {
            if start[k] < low || start[k] > high {
                return false;
            }
            continue;
        }
        let (t0, t1) = ((low - start[k]) / motion[k], (high - start[k]) / motion[k]);
        enter = enter.max(t0.min(t1));
        leave = leave.min(t0.max(t1));
    }
    enter <= leave
}

#[test]
fn a_path_misses_nothing_that_exact_arithmetic_hits_and_hits_little_else() {
    // At 1e6 m numbers are 0.06 m apart, but the test is not about rounding of the boxes themselves.
    for centre in [glam::Vec3::ZERO, vec3(1e6, -1e6, 1e6)] {
        let (mut hits, mut misses) = (0, 0);
        for (path, target) in cases(20_000, centre) {
            let (min, max) = (target.min.as_dvec3(), target.max.as_dvec3());
            let motion = path.half.as_dvec3() * 2.0;
            let exact = |slack| slabs(path.start.as_dvec3(), motion, path.extent.as_dvec3(), min, max, slack);
            let hit = path.hits(&target);
            assert!(hit || !exact(0.0), "missed: {path:?} {target:?}");
            let slack = 2e-4 + path.segment().rounding.max_element() as f64 * 2.0;
            assert!(!hit || exact(slack), "made up: {path:?} {target:?}");
            (hits, misses) = (hits + u32::from(hit), misses + u32::from(!hit));
            // The exact test must not accept a box that a node's test rejects.
            assert!(!hit || answers::<f32>(&path, &[target; 8]) != 0);
        }
        assert!(hits > 3_000 && misses > 3_000, "{hits} {misses}");
    }
}

#[test]
fn two_paths_meet_where_exact_relative_motion_hits_the_sum_of_boxes() {
    let paths: Vec<Path> = cases(60_000, vec3(300.0, 0.0, 0.0)).into_iter().map(|c| c.0).collect();
    let mut hits = 0;
    for two in paths.chunks(2) {
        let (p, q) = (&two[0], &two[1]);
        let motion = (p.half.as_dvec3() - q.half.as_dvec3()) * 2.0;
        let extent = p.extent.as_dvec3() + q.extent.as_dvec3();
        let at = q.start.as_dvec3();
        let exact = |slack| slabs(p.start.as_dvec3(), motion, extent, at, at, slack);
        let hit = p.meets(q);
        assert_eq!(hit, q.meets(p));
        assert!(hit || !exact(0.0));
        assert!(!hit || exact(2e-4));
        hits += u32::from(hit);
    }
    assert!(hits > 100, "{hits}");
}

#[test]
fn a_path_of_length_zero_is_a_box_test_and_huge_numbers_stay_finite() {
    let still = Path::new(&mover(glam::Vec3::splat(-1.0), glam::Vec3::ONE, glam::Vec3::ZERO, 0.0), 0.0);
    assert!(still.hits(&Aabb { min: glam::Vec3::splat(0.9), max: glam::Vec3::splat(2.0) }));
    assert!(!still.hits(&Aabb { min: glam::Vec3::splat(1.1), max: glam::Vec3::splat(2.0) }));
    let motion = vec3(LARGEST, LARGEST, -LARGEST);
    let far = Path::new(&mover(glam::Vec3::splat(-1.0), glam::Vec3::ONE, motion, LARGEST), 0.1);
    assert!(far.hits(&Aabb { min: vec3(1e9, 1e9, -2e9), max: vec3(2e9, 2e9, -1e9) }));
    assert!(far.meets(&far));
}
