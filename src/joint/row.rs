//! What joints are made of for the solver: locks, which are solved as blocks, and rows of one direction.

use super::desc::{Axes, Axis, Motion, Spring};
use glam::Vec3;

/// End of a list of joints.
pub(crate) const NONE: u32 = u32::MAX;

/// What a lock keeps.
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

/// What a row of one direction does.
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
    Drive {
        position: f32,
        velocity: f32,
        spring: Spring,
        max_force: f32,
    },
}

/// A limit with a width, or a drive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) joint: u32,
    pub(crate) motion: Motion,
    pub(crate) axes: Axes,
    pub(crate) kind: RowKind,
    /// What else the joint locks, which leaves the row less to move.
    pub(crate) beside: [Option<LockKind>; 2],
    /// At the lower and the upper end, of the last substep [N s] or [N m s]; a drive's is the first.
    pub(crate) impulse: [f32; 2],
    /// The part of a lock's that does not yield.
    pub(crate) lasting_impulse: f32,
}
