//! The path of a fast body against inflated boxes.
//!
//! The mover shrinks to the centre of its box, and any box that it may meet grows by its half extents (the
//! Minkowski sum of two boxes is a box): "does the moving box touch the box" becomes "does the segment touch
//! the grown box". Everything is measured from the middle of the path, so that rounding is relative to the
//! lengths at hand and not to the distance from the world's origin.

use super::{Aabb, LARGEST, Mover};
use crate::config::tuning::LONG_PATH;
use crate::lanes::{Lanes, Vec3};
use crate::shape::path_hits_boxes;

// Rounding: of the lengths in a test.
/// Share of the lengths in a test by which it is widened: eight roundings. Where a path touches a box, no
/// length in the test exceeds extent + half path, and each is off by a few units of 2^-24 of that.
const ROUNDING: f32 = 8.0 / (1 << 24) as f32;
// Rounding: of inner nodes.
/// The same for boxes of inner nodes: wide enough that rounding never hides a box that would answer yes by
/// itself.
const ROUNDING_INNER: f32 = 4.0 * ROUNDING;

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
    /// Bound on the rounding error of `middle` [m].
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
        self.half.abs().cmpgt(self.extent * LONG_PATH).any()
    }

    /// A path of a step that is over: only its collider matters.
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

    /// Whether two fast movers may meet: the path of one relative to the other, against the sum of their
    /// boxes.
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

    /// A path for a look-up: from one point to another with half extents around it [m]. The ends may have
    /// been rounded from `f64`: that displacement is covered.
    pub(super) fn between(from: glam::Vec3, to: glam::Vec3, extent: glam::Vec3) -> Segment {
        let limit = glam::Vec3::splat(LARGEST);
        let (from, to) = (from.clamp(-limit, limit), to.clamp(-limit, limit));
        let half = (to - from) * 0.5;
        let middle = from + half;
        Segment {
            half,
            middle,
            extent,
            // Rounding of the motion and of its half at the far end, and of both ends.
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
    /// Amount by which boxes are inflated: half extents, spin, margin, rounding [m].
    grow: Vec3<L>,
    /// Half, and a little more for rounding.
    reserve_total: L,
}

impl<L: Lanes> PathLanes<L> {
    #[inline(always)]
    fn of(path: &Segment, rounding: f32) -> Self {
        let grow = path.extent * (1.0 + rounding) + path.rounding + path.half.abs() * (2.0 * rounding);
        PathLanes {
            middle: Vec3::splat(path.middle),
            half: Vec3::splat(path.half),
            grow: Vec3::splat(grow),
            reserve_total: L::splat(0.5 + 0.5 * rounding),
        }
    }

    /// Which boxes the path touches. An inert box has min = inf, max = -inf.
    #[inline(always)]
    pub(crate) fn hits(&self, min: Vec3<L>, max: Vec3<L>) -> L::Mask {
        // The corners first, relative to the path: far from the origin their middle would lose precision.
        let (low, high) = (min - self.middle, max - self.middle);
        let offset = (low + high) * L::splat(0.5);
        let extent = (high - low) * self.reserve_total + self.grow;
        path_hits_boxes(self.half, offset, extent)
    }
}

#[cfg(test)]
pub(super) mod tests;
