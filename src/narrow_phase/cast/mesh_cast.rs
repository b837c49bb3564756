//! Parameters of a cast against a mesh or a height field.

use crate::narrow_phase::mesh::touched::Touched;

/// Parameters of a cast against triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshCast {
    /// How early a touch may be reported [m].
    pub(crate) tolerance: f32,
    /// Triangles nearer than this at the start are left to the kernel there, which the caller runs with at
    /// least that margin [m]. So a triangle is skipped if the shape is that close to it at the start, or if
    /// the shape is that close to the triangle's *plane* and stays so: the floor ahead of a sliding box is
    /// the floor that it is on, and its inner edges stop nothing, but a wall does. Two slops and twice the
    /// displacement by gravity in a step are enough.
    pub(crate) resting: f32,
    /// Give up if a triangle may be nearer than this at the start [m]; negative: never.
    pub(crate) alone: f32,
    /// Any touch will do, not only the first.
    pub(crate) any: bool,
    /// Triangles and planes known to be nearer than `resting` at the start.
    pub(crate) known: Touched,
    /// Steps up to this height in front of a known plane are ignored [m].
    pub(crate) lip: f32,
}

impl MeshCast {
    /// For the first touch, wherever the shape begins.
    pub(crate) fn first(tolerance: f32, resting: f32) -> MeshCast {
        MeshCast { tolerance, resting, alone: -1.0, any: false, known: Touched::default(), lip: 0.0 }
    }
}
