//! Input of the broad phase about a collider that may move.

use super::Aabb;
use crate::config::ContinuousMode;
use glam::Vec3;

/// A collider that may move in this step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mover {
    /// Stable index of the collider.
    pub(crate) collider: u32,
    /// Bounds at the start of the step.
    pub(crate) aabb: Aabb,
    /// Predicted displacement of the shape's origin within the step [m].
    pub(crate) motion: Vec3,
    /// How far any point of the shape may get from where pure translation takes it, by rotation [m].
    pub(crate) spin: f32,
    /// How it is kept from passing through others.
    pub(crate) mode: ContinuousMode,
}
