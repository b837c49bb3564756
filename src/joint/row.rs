//! Parts of joints for the solver: locks, which are solved as blocks, and rows of one direction.

use super::motion::{Axes, Axis, Motion, Spring};
use glam::Vec3;
use std::f32::consts::TAU;

/// End of a list of joints.
pub(crate) const NONE: u32 = u32::MAX;

/// Kind of lock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LockKind {
    /// Points together.
    Point,
    /// The second body's point on a line of the first.
    Line(Axis),
    /// All rotation.
    Weld,
    /// An axis.
    Hinge(Axis),
}

/// A limit without width: rows without bounds, solved as a block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lock {
    pub(crate) joint: u32,
    pub(crate) kind: LockKind,
    /// It stands for locks of single axes.
    pub(super) merged: bool,
    /// Impulse of the last substep, in world axes [N s] or [N m s].
    pub(crate) impulse: Vec3,
    /// How much of it does not yield.
    pub(crate) lasting_impulse: f32,
    /// How much of it was there in the last step too.
    pub(crate) steady: f32,
    /// By how much the velocities of its tree are those of before [s]; below zero if it was in none yet.
    pub(crate) lag: f32,
}

/// Kind of row of one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum RowKind {
    /// Rigid.
    Limit {
        min: f32,
        max: f32,
    },
    /// Beyond its range a spring.
    Yielding {
        min: f32,
        max: f32,
        spring: Spring,
    },
    Motor {
        position: f32,
        velocity: f32,
        spring: Spring,
        max_force: f32,
    },
}

/// A limit with a width, or a motor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) joint: u32,
    pub(crate) motion: Motion,
    pub(crate) axes: Axes,
    pub(crate) kind: RowKind,
    /// The other locks of the joint, which reduce the mobility of the row.
    pub(crate) beside: [Option<LockKind>; 2],
    /// At the lower and the upper end, of the last substep [N s] or [N m s]; a motor's is the first.
    pub(crate) impulse: [f32; 2],
    /// The part of a lock's that does not yield.
    pub(crate) lasting_impulse: f32,
    /// Of a limit of a hinge, the angle after the last step with its whole turns [rad]; infinite before the
    /// first step, and of all other rows.
    pub(crate) turned: f32,
}

impl Row {
    /// Whether it knows in which turn its angle is: about the axis of a hinge, but not on a ball, whose twist
    /// jumps where it is bent by half a turn.
    pub(crate) fn counts_turns(&self) -> bool {
        let hinge = matches!(self.beside[1], Some(LockKind::Hinge(axis)) if self.axes == Axes::One(axis));
        hinge && self.motion == Motion::Angular && !matches!(self.kind, RowKind::Motor { .. })
    }

    /// An angle with its whole turns: those nearest to the angle after the last step. At first, of a hinge's
    /// limit the fewest with which it is in range, else those nearest to the middle of its range or its
    /// target.
    pub(crate) fn with_turns(&self, angle: f32) -> f32 {
        if self.turned.is_finite() {
            return nearest_turn(angle, self.turned);
        }
        let (RowKind::Limit { min, max } | RowKind::Yielding { min, max, .. }) = self.kind else {
            let [target, _] = self.kind.ends();
            return nearest_turn(angle, target);
        };
        let turns = |way: f32| (way / TAU).ceil().max(0.0);
        let within = angle + TAU * (turns(min - angle) - turns(angle - max));
        let fits = self.counts_turns() && min <= within && within <= max;
        if fits { within } else { nearest_turn(angle, 0.5 * (min + max)) }
    }
}

/// An angle with the whole turns that bring it nearest to another [rad].
fn nearest_turn(angle: f32, to: f32) -> f32 {
    if to.is_finite() { angle - TAU * ((angle - to) / TAU).round() } else { angle }
}
