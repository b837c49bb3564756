//! The path of a fast body against inflated boxes.
//!
//! The mover shrinks to the centre of its box, and whatever it may meet grows by its half extents (the Minkowski sum
//! of two boxes is a box): "does the moving box touch the box" becomes "does the segment touch the grown box".
//! Everything is measured from the middle of the path, so that rounding is relative to the lengths at hand and not
//! to the distance from the world's origin.

use super::{Aabb, LARGEST, Mover};
use crate::lanes::{Lanes, Vec3};

/// Which of `L::N` boxes a straight path touches; lane `i` answers for box `i`.
///
/// `half`: half vector of the path [m]. `offset`: from the middle of the path to the middle of the box [m].
/// `extent`: half extents of the box, already inflated by the mover's and by the margin [m]. An inert lane has a NaN
/// offset or an extent of -inf and answers no. No division: a path of length zero is a point test. Separating axes,
/// three box normals and three cross products: Ericson, *Real-Time Collision Detection* (2005), 5.3.3.
#[inline(always)]
pub(super) fn path_hits_boxes<L: Lanes>(half: Vec3<L>, offset: Vec3<L>, extent: Vec3<L>) -> L::Mask {
    let d = half.abs();
    let m = offset.abs();
    let c = offset.cross(half).abs(); // c.x: the axis x × half, and so on
    m.x.le(extent.x + d.x)
        & m.y.le(extent.y + d.y)
        & m.z.le(extent.z + d.z)
        & c.x.le(extent.y * d.z + extent.z * d.y)
        & c.y.le(extent.x * d.z + extent.z * d.x)
        & c.z.le(extent.x * d.y + extent.y * d.x)
}

/// What a test is widened by, as a share of the lengths in it: eight roundings. Where a path touches a box, no length
/// in the test exceeds extent + half path, and each is off by a few units of 2^-24 of that.
const ROUNDING: f32 = 8.0 / (1 << 24) as f32;
/// The same for boxes of inner nodes: wide enough that rounding never hides a box that would answer yes by itself.
const ROUNDING_INNER: f32 = 4.0 * ROUNDING;

/// A path longer than this many of its boxes is looked along; of a shorter one the box around it is searched, which costs
/// a third, and finds few that the path misses (scene `bullets`: from 8 on no difference).
const LONG: f32 = 8.0;

/// The segment that a fast mover moves along within the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path {
    pub(super) collider: u32,
    /// Middle of its box at the start of the step [m].
    start: glam::Vec3,
    /// Half of its motion [m].
    half: glam::Vec3,
    /// Half extents of its box, with spin and margin [m].
    extent: glam::Vec3,
    spin: f32,
    margin: f32,
}

/// A path for a look-up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    middle: glam::Vec3,
    /// Half of its length and direction [m].
    half: glam::Vec3,
    /// Half extents of the box that moves [m].
    extent: glam::Vec3,
    /// What rounding may have moved `middle` by [m].
    rounding: glam::Vec3,
}

impl Path {
    /// The mover's box must be bounded (see [`LARGEST`]).
    pub(crate) fn new(mover: &Mover, margin: f32) -> Path {
        let Aabb { min, max } = mover.aabb;
        let start = min * 0.5 + max * 0.5;
        let reach = glam::Vec3::splat(mover.spin + margin);
        Path {
            collider: mover.collider,
            start,
            half: mover.motion * 0.5,
            extent: (max - start).max(start - min) + reach,
            spin: mover.spin,
            margin,
        }
    }

    /// Its length and direction [m].
    pub(super) fn motion(&self) -> glam::Vec3 {
        self.half * 2.0
    }

    /// Whether the box around all of it holds much more than the path itself.
    pub(super) fn is_long(&self) -> bool {
        self.half.abs().cmpgt(self.extent * LONG).any()
    }

    /// Of a step that is over: only whose it was matters.
    pub(super) fn past(collider: u32) -> Path {
        let zero = glam::Vec3::ZERO;
        Path { collider, start: zero, half: zero, extent: zero, spin: 0.0, margin: 0.0 }
    }

    /// Whether the path touches a box that doesn't move (or holds all of its own motion within the step).
    #[inline]
    pub(super) fn hits(&self, target: &Aabb) -> bool {
        let lanes = PathLanes::<f32>::of(&self.segment(), ROUNDING);
        lanes.hits(Vec3::splat(target.min), Vec3::splat(target.max))
    }

    /// Whether two fast movers may meet: the path of one relative to the other, against the sum of their boxes.
    pub(super) fn meets(&self, other: &Path) -> bool {
        let half = self.half - other.half;
        let offset = (other.start - self.start) - half;
        let slack = (self.half.abs() + other.half.abs()) * (2.0 * ROUNDING);
        let extent = (self.extent + other.extent) * (1.0 + ROUNDING) + slack;
        path_hits_boxes::<f32>(Vec3::splat(half), Vec3::splat(offset), Vec3::splat(extent))
    }

    /// Whether the motion of one relative to the other outruns the smaller margin.
    pub(super) fn outruns(&self, other: &Path) -> bool {
        let rest = self.margin.min(other.margin) - self.spin - other.spin;
        rest < 0.0 || (self.half - other.half).length_squared() * 4.0 > rest * rest
    }

    /// For the boxes of a tree's nodes.
    #[inline]
    pub(crate) fn lanes<L: Lanes>(&self) -> PathLanes<L> {
        self.segment().lanes()
    }

    #[inline]
    fn segment(&self) -> Segment {
        let Path { start, half, extent, .. } = *self;
        let middle = start + half;
        Segment { middle, half, extent, rounding: (middle - start - half).abs() }
    }

    /// A path for a look-up: from one point to another with half extents around it [m]. The ends may have been
    /// rounded from `f64`: what that moved them by is covered.
    pub(super) fn between(from: glam::Vec3, to: glam::Vec3, extent: glam::Vec3) -> Segment {
        let limit = glam::Vec3::splat(LARGEST);
        let (from, to) = (from.clamp(-limit, limit), to.clamp(-limit, limit));
        let half = (to - from) * 0.5;
        let middle = from + half;
        Segment {
            half,
            middle,
            extent,
            // Of the motion and its half, at the far end; and of both ends.
            rounding: (middle - from - half).abs()
                + (middle + half - to).abs()
                + from.abs().max(to.abs()) * ROUNDING * 0.25,
        }
    }
}

impl Segment {
    /// For the boxes of a tree's nodes.
    #[inline]
    pub(super) fn lanes<L: Lanes>(&self) -> PathLanes<L> {
        PathLanes::of(self, ROUNDING_INNER)
    }
}

/// A path in all lanes, ready for boxes by their corners.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathLanes<L> {
    middle: Vec3<L>,
    half: Vec3<L>,
    /// What a box grows by: half extents, spin, margin, rounding [m].
    grow: Vec3<L>,
    /// Half, and a little more for rounding.
    widen: L,
}

impl<L: Lanes> PathLanes<L> {
    #[inline(always)]
    fn of(path: &Segment, rounding: f32) -> Self {
        let grow = path.extent * (1.0 + rounding) + path.rounding + path.half.abs() * (2.0 * rounding);
        PathLanes {
            middle: Vec3::splat(path.middle),
            half: Vec3::splat(path.half),
            grow: Vec3::splat(grow),
            widen: L::splat(0.5 + 0.5 * rounding),
        }
    }

    /// Which boxes the path touches. An inert box has min = inf, max = -inf.
    #[inline(always)]
    pub(crate) fn hits(&self, min: Vec3<L>, max: Vec3<L>) -> L::Mask {
        // The corners first, relative to the path: far from the origin their middle would lose what matters.
        let (low, high) = (min - self.middle, max - self.middle);
        let offset = (low + high) * L::splat(0.5);
        let extent = (high - low) * self.widen + self.grow;
        path_hits_boxes(self.half, offset, extent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Continuous;
    use crate::lanes::Mask;
    use crate::lanes::{f32x4, f32x8};
    use glam::{DVec3, vec3};

    fn random(seed: &mut u64) -> f32 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 40) as f32 / (1u64 << 24) as f32
    }

    fn vector(seed: &mut u64, size: f32) -> glam::Vec3 {
        let mut r = || (random(seed) * 2.0 - 1.0) * size;
        vec3(r(), r(), r())
    }

    fn mover(min: glam::Vec3, max: glam::Vec3, motion: glam::Vec3, spin: f32) -> Mover {
        Mover { collider: 0, aabb: Aabb { min, max }, motion, spin, mode: Continuous::Segment }
    }

    /// Paths of lengths 0 to 100 m near boxes of 0 to 5 m, all about `centre`; every eighth along an axis.
    fn cases(count: usize, centre: glam::Vec3) -> Vec<(Path, Aabb)> {
        let mut seed = 11;
        (0..count)
            .map(|i| {
                let start = centre + vector(&mut seed, 5.0);
                let half = vector(&mut seed, 0.5).abs();
                let mut motion = vector(&mut seed, [0.0, 1.0, 10.0, 100.0][i % 4]);
                if i % 8 == 1 {
                    motion.y = 0.0;
                    motion.z = 0.0;
                }
                let path =
                    Path::new(&mover(start - half, start + half, motion, random(&mut seed) * 0.1), 0.05);
                let middle = start + motion * random(&mut seed) + vector(&mut seed, 4.0);
                let half = vector(&mut seed, [0.0, 0.1, 5.0][i % 3]).abs();
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
    fn slabs(start: DVec3, motion: DVec3, extent: DVec3, min: DVec3, max: DVec3, slack: f64) -> bool {
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
        // At 1e6 m numbers are 0.06 m apart, but rounding of the boxes themselves is not what is tested.
        for centre in [glam::Vec3::ZERO, vec3(1e6, -1e6, 1e6)] {
            let (mut hits, mut misses) = (0, 0);
            for (path, target) in cases(20_000, centre) {
                let (min, max) = (target.min.as_dvec3(), target.max.as_dvec3());
                let motion = path.half.as_dvec3() * 2.0;
                let exact =
                    |slack| slabs(path.start.as_dvec3(), motion, path.extent.as_dvec3(), min, max, slack);
                let hit = path.hits(&target);
                assert!(hit || !exact(0.0), "missed: {path:?} {target:?}");
                let slack = 2e-4 + path.segment().rounding.max_element() as f64 * 2.0;
                assert!(!hit || exact(slack), "made up: {path:?} {target:?}");
                (hits, misses) = (hits + u32::from(hit), misses + u32::from(!hit));
                // What a node's test says no to, the exact one must not say yes to.
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
}
