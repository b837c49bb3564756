//! Predicted motion in, pairs out.

mod bvh;
mod pairs;
mod segment;

use crate::config::Continuous;
use glam::Vec3;

/// An axis-aligned box in world coordinates, rounded outwards [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Aabb {
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

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
    pub(crate) mode: Continuous,
}

/// Two colliders that may touch in this step; `a` has the lower kind, then the lower index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pair {
    pub(crate) a: u32,
    pub(crate) b: u32,
    /// The narrow phase's own: where it keeps the pair's contact. `u32::MAX`: none.
    pub(crate) contact: u32,
    /// Set while the relative motion of this step outruns the margin: the narrow phase casts.
    pub(crate) fast: bool,
}
