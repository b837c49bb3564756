//! Proxies: the record of a collider in the broad phase, and how far its boxes are inflated.

use super::bvh::NONE;
use super::{Aabb, LARGEST, Mover};
use crate::config::ContinuousMode;
use crate::config::tuning::{FAT_SHARE, FAT_STEPS_AHEAD, LEAST_FAT_SHARE};
use glam::{Vec3, Vec3A};

/// The role of a collider in the broad phase. The order decides which of two reports their pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(super) enum Role {
    Absent,
    /// A mover that no update has listed yet.
    New,
    /// Without bounds: static (a plane) or kinematic. Never searches: others find it.
    Endless,
    Static,
    Slow,
    /// Fast, and looks along its path.
    Fast,
    /// Fast, and looks in its swept box.
    Volume,
}

/// A collider's box; 32 bytes, half a cache line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Proxy {
    /// The box in the tree: the box of a static, the fat box of a slow mover, the swept box of a fast one.
    pub(super) bounds: Aabb,
    /// Its leaf's place in the tree, or `NONE`.
    pub(super) place: u32,
    /// Its path, while it is fast.
    pub(super) path: u32,
}

impl Proxy {
    pub(super) const NONE: Proxy = Proxy { bounds: Aabb::EMPTY, place: NONE, path: NONE };

    /// Reads boxes and sets places: a tree does both in turn, which cells allow.
    #[inline]
    pub(super) fn boxes_and_places(all: &mut [Proxy]) -> (impl Fn(u32) -> Aabb, impl FnMut(u32, u32)) {
        let cells = std::cell::Cell::from_mut(all).as_slice_of_cells();
        let place = |c: u32, place: u32| cells[c as usize].set(Proxy { place, ..cells[c as usize].get() });
        (|c: u32| cells[c as usize].get().bounds, place)
    }
}

// Rounding: of a sum.
/// Bound on the rounding error of a sum as a share of its terms: two units of 2^-24, doubled.
const ROUNDING: f32 = 4.0 / (1 << 24) as f32;
// Rounding: of a swept box.
/// The same for the lengths of a swept box: more than the widening of the test of two paths, so that the
/// search along one path surely leads to all that the test says yes to.
const ROUNDING_SWEPT: f32 = 8.0 * ROUNDING;

/// The mover's own margin [m], and whether it is fast: continuous, and outruns the margin.
#[inline]
pub(super) fn margin_of(mover: &Mover, margin: f32) -> (f32, bool) {
    let size = (mover.aabb.max - mover.aabb.min).max_element();
    let own = (size * FAT_SHARE).max(margin * LEAST_FAT_SHARE).min(margin);
    let rest = own - mover.spin;
    // Written so that a NaN, which the caller should have refused, counts as fast and is tamed there.
    let slow = rest >= 0.0 && mover.motion.length_squared() <= rest * rest;
    (own, !slow & (mover.mode != ContinuousMode::Discrete))
}

/// Whether a slow mover may keep its fat box. The check that all at rest pay in every step, so it asks the
/// cheap question first: a shape that moves less than the least of margins needn't be measured.
#[inline]
pub(super) fn rests(mover: &Mover, margin: f32, bounds: &Aabb) -> bool {
    let least = margin * LEAST_FAT_SHARE - mover.spin;
    let still = least >= 0.0 && mover.motion.length_squared() <= least * least;
    if !still && margin_of(mover, margin).1 {
        return false;
    }
    // The same as `bounds.contains(&needs(mover))`, four numbers at a time.
    let share = if mover.mode == ContinuousMode::Discrete { 0.0 } else { 1.0 };
    let (min, max) = (Vec3A::from(mover.aabb.min), Vec3A::from(mover.aabb.max));
    let (motion, zero) = (Vec3A::from(mover.motion * share), Vec3A::ZERO);
    let reach = Vec3A::splat(mover.spin * share) + min.abs().max(max.abs()) * ROUNDING;
    let low = Vec3A::from(bounds.min).cmple(min + motion.min(zero) - reach);
    let high = Vec3A::from(bounds.max).cmpge(max + motion.max(zero) + reach);
    (low & high).all()
}

/// The box that a slow mover's fat box must contain: the box at the start of the step and at its end, however
/// it turns.
#[inline]
pub(super) fn needs(mover: &Mover) -> Aabb {
    let Aabb { min, max } = mover.aabb;
    let motion = if mover.mode == ContinuousMode::Discrete { Vec3::ZERO } else { mover.motion };
    let spin = if mover.mode == ContinuousMode::Discrete { 0.0 } else { mover.spin };
    let reach = Vec3::splat(spin) + min.abs().max(max.abs()) * ROUNDING;
    Aabb { min: min + motion.min(Vec3::ZERO) - reach, max: max + motion.max(Vec3::ZERO) + reach }
}

/// A new fat box.
pub(super) fn fat_box(mover: &Mover, margin: f32) -> Aabb {
    let Aabb { min, max } = needs(mover);
    let limit = Vec3::splat(margin);
    let ahead = tamed(mover).motion * FAT_STEPS_AHEAD;
    let ahead = ahead.clamp(-limit, limit);
    let reach = limit + min.abs().max(max.abs()) * ROUNDING;
    Aabb { min: min + ahead.min(Vec3::ZERO) - reach, max: max + ahead.max(Vec3::ZERO) + reach }
}

/// Where a fast mover may get within the step. The motion must be tame.
pub(super) fn swept_box(mover: &Mover, margin: f32) -> Aabb {
    let Aabb { min, max } = needs(mover);
    let lengths = mover.motion.abs() + (max - min);
    let reach = margin + min.abs().max(max.abs()) * ROUNDING + lengths * ROUNDING_SWEPT;
    Aabb { min: min - reach, max: max + reach }
}

/// The mover with a motion and spin that can be computed with.
pub(super) fn tamed(mover: &Mover) -> Mover {
    let tame = |v: f32| if v.is_nan() { 0.0 } else { v.clamp(-LARGEST, LARGEST) };
    let Vec3 { x, y, z } = mover.motion;
    Mover { motion: Vec3::new(tame(x), tame(y), tame(z)), spin: tame(mover.spin).max(0.0), ..*mover }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_keeps_its_box_is_inside_it_and_not_fast() {
        let mut random = crate::random::Random(3);
        let mut kept = 0;
        for i in 0..20_000 {
            let mut v = |size: f32| random.cube() * size;
            let (at, half) = (v(100.0), v(1.0).abs());
            let mover = Mover {
                collider: 0,
                aabb: Aabb { min: at - half, max: at + half },
                motion: v([0.0, 0.005, 0.05, 0.5][i % 4]),
                spin: v([0.0, 0.02, 0.3][i % 3]).x.abs(),
                mode: [ContinuousMode::Segment, ContinuousMode::Discrete][i % 2],
            };
            let reach = 0.2 + v(0.2);
            let bounds = Aabb { min: mover.aabb.min - reach, max: mover.aabb.max + reach };
            let expected = !margin_of(&mover, 0.1).1 && bounds.contains(&needs(&mover));
            assert_eq!(rests(&mover, 0.1, &bounds), expected);
            kept += usize::from(expected);
        }
        assert!(kept > 2_000 && kept < 18_000, "{kept}");
    }
}
