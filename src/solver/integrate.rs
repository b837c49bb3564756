//! Velocities and displacements of all movable bodies over a substep.

use crate::config::Settings;
use crate::config::tuning::{FOLLOWED_TURN, SWIFT_DISTANCE};
use crate::constraint::JointStage;
use crate::constraint::contact::row::Motion;
use crate::lanes::{Lanes, Mask, Record, f32x8, is_within};
use crate::limits::MAX_LEFT_SPEED;
use crate::threads::{Workers, per_block};
use std::sync::atomic::{AtomicBool, Ordering};

/// Bodies in a block of work.
const BLOCK: usize = per_block(256, 1);

/// Bits of the lanes of a record that hold the linear part, and those of both parts.
const LINEAR: u32 = 0b0000_0111;
const BOTH: u32 = 0b0111_0111;

/// Velocities above which a body moves or turns further in a substep than the rows of joints account for.
#[derive(Clone, Copy)]
pub(super) struct FastLimit(f32x8);

impl FastLimit {
    pub(super) fn new(settings: &Settings, joints: &[JointStage], h: f32) -> FastLimit {
        let slides = joints.iter().any(|stage| stage.kind.slides());
        let way = if slides { SWIFT_DISTANCE * settings.length_unit } else { f32::INFINITY };
        let turn = if joints.is_empty() { f32::INFINITY } else { FOLLOWED_TURN };
        FastLimit(f32x8::new([way, way, way, way, turn, turn, turn, turn]) * f32x8::splat(1.0 / h))
    }

    #[inline(always)]
    pub(super) fn is_exceeded_by(&self, velocity: &Record) -> bool {
        lanes(*velocity).abs().lt(self.0).bits() & BOTH != BOTH
    }
}

/// How the impulses before a substep are applied again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WarmStart {
    /// By a pass over the rows: they may be those of another step.
    ByRows,
    /// By one addition per body: rows keep their directions within a step, so they would repeat the change of
    /// velocity of the substep before. Joint rows rotate with their bodies and re-apply their warm start
    /// themselves; trees that conserve energy need none.
    ByDifference,
}

/// Integrates the movable bodies over a substep, on several threads.
pub(super) struct Integrator<'a> {
    pub(super) workers: &'a Workers<'a>,
    pub(super) motion: &'a Motion<'a, 'a>,
    /// Numbers of movable bodies, and of dynamic ones, which come first.
    pub(super) movers: usize,
    pub(super) dynamic: usize,
    /// Substep [s].
    pub(super) h: f32,
    pub(super) fast: FastLimit,
}

impl Integrator<'_> {
    /// Whether a body turns that can't be pushed; the bodies that it carries have to turn along.
    pub(super) fn ground_turns(&self) -> bool {
        // SAFETY: between stages this thread is alone.
        let turns = |i| unsafe { self.motion.velocity.read(i) }.angular != glam::Vec3::ZERO;
        (self.dynamic..self.movers).any(turns)
    }

    /// Adds gravity, forces and the warm start to velocities. Returns whether a body was fast before.
    #[inline(always)]
    pub(super) fn velocities(&self, warm_start: WarmStart, acceleration: &[Record]) -> bool {
        let (motion, fast, dynamic, h) = (self.motion, self.fast, self.dynamic, self.h);
        let any_fast = AtomicBool::new(false);
        self.each_body(|i| {
            // SAFETY: each body is in one block.
            let (v, b) = unsafe { (motion.velocity.get(i), motion.base.get(i)) };
            let now = lanes(*v);
            if fast.is_exceeded_by(v) {
                any_fast.store(true, Ordering::Relaxed);
            }
            let warm = match warm_start {
                WarmStart::ByRows => f32x8::ZERO,
                WarmStart::ByDifference => {
                    self.mark_touched(i, v, b);
                    now - lanes(*b)
                }
            };
            let pull = acceleration.get(i).map_or(f32x8::ZERO, |&pull| lanes(pull) * f32x8::splat(h));
            let free = now + pull;
            (*b, *v) = (record(free), record(if i < dynamic { free + warm } else { free }));
        });
        any_fast.into_inner()
    }

    /// Marks bodies that rows changed after they had moved, when velocities were relaxed: `finish` would
    /// otherwise treat them as free and turn them as at the start of the step.
    pub(super) fn mark_relaxed(&self) {
        let motion = self.motion;
        self.each_body(|i| {
            // SAFETY: each body is in one block.
            let (v, b) = unsafe { (motion.velocity.get(i), motion.base.get(i)) };
            self.mark_touched(i, v, b);
        });
    }

    /// Marks a body whose velocity rows changed.
    #[inline(always)]
    fn mark_touched(&self, i: usize, now: &Record, before: &Record) {
        if lanes(*now).eq(lanes(*before)).bits() & BOTH != BOTH {
            // SAFETY: each body is in one block.
            unsafe { self.motion.delta.get(i) }.set_touched();
        }
    }

    /// Whether any body is fast.
    #[inline(always)]
    pub(super) fn any_fast(&self) -> bool {
        let (velocity, fast) = (self.motion.velocity, self.fast);
        let any_fast = AtomicBool::new(false);
        self.each_body(|i| {
            // SAFETY: each body is in one block.
            if fast.is_exceeded_by(unsafe { velocity.get(i) }) {
                any_fast.store(true, Ordering::Relaxed);
            }
        });
        any_fast.into_inner()
    }

    /// Moves bodies on by a substep. Returns whether all velocities are in range.
    #[inline(always)]
    pub(super) fn displacements(&self, acceleration: &[Record]) -> bool {
        let (motion, dynamic, h) = (self.motion, self.dynamic, self.h);
        let out_of_range = AtomicBool::new(false);
        self.each_body(|i| {
            // SAFETY: each body is in one block.
            let (v, d, b) = unsafe { (motion.velocity.get(i), motion.delta.get(i), motion.base.get(i)) };
            let (now, before) = (lanes(*v), lanes(*b));
            if !is_within(now, MAX_LEFT_SPEED) {
                out_of_range.store(true, Ordering::Relaxed);
            }
            let same = now.eq(before).bits();
            let mut moved = now * f32x8::splat(h);
            if i < dynamic
                && same & LINEAR == LINEAR
                && let Some(&fall) = acceleration.get(i)
            {
                // Nothing touched the body: its path is the parabola, not the chord of semi-implicit Euler.
                moved -= lanes(Record { angular: glam::Vec3::ZERO, ..fall }) * f32x8::splat(0.5 * h * h);
            }
            // A mark tells `finish` that the body was not free in the whole step. It is set along with the
            // rest, in one wide store: a partial write would stall the next load of the record.
            // So does a torque: a free turn is made of the angular velocity at the start of the step.
            let twisted = acceleration.get(i).is_some_and(|pull| pull.angular != glam::Vec3::ZERO);
            *d = record((lanes(*d) + moved) | Record::touched_lanes(same & BOTH != BOTH || twisted));
        });
        !out_of_range.into_inner()
    }

    #[inline(always)]
    fn each_body(&self, work: impl Fn(usize) + Sync) {
        let movers = self.movers;
        self.workers.run(movers.div_ceil(BLOCK), &|block| {
            (block * BLOCK..((block + 1) * BLOCK).min(movers)).for_each(&work);
        });
    }
}

#[inline(always)]
fn lanes(record: Record) -> f32x8 {
    bytemuck::must_cast(record)
}

#[inline(always)]
fn record(lanes: f32x8) -> Record {
    bytemuck::must_cast(lanes)
}
