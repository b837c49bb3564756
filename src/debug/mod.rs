//! Debug drawing of a world: shapes, boxes, contacts, joints, and the colours of the solver.
//!
//! A game implements [`DebugDraw`] over its own renderer and calls [`World::draw`](crate::World::draw)
//! between steps, when it wants to see something. Everything is read from data that a step leaves behind
//! anyway: a world that is never drawn pays nothing, and drawing changes nothing.
//!
//! ```
//! use backstop::debug::{DebugDraw, DrawOptions, Ink};
//! use backstop::glam::{DVec3, Vec3};
//! # use backstop::{Settings, World};
//!
//! /// Lines for the graphics card, relative to the camera.
//! struct Lines {
//!     camera: DVec3,
//!     vertices: Vec<(Vec3, [f32; 3])>,
//! }
//!
//! impl DebugDraw for Lines {
//!     fn line(&mut self, from: DVec3, to: DVec3, ink: Ink) {
//!         for end in [from, to] {
//!             self.vertices.push(((end - self.camera).as_vec3(), ink.colour.to_array()));
//!         }
//!     }
//! }
//!
//! # let world = World::new(Settings::default()).unwrap();
//! let mut lines = Lines { camera: DVec3::ZERO, vertices: Vec::new() };
//! world.draw(&DrawOptions::default(), &mut lines);
//! ```
//!
//! Positions are those of the world, in `f64`. Far from the origin `f32` has no millimetres left, so take the
//! camera's position off first and convert then, as above; the difference is exact enough wherever the camera
//! is.

mod bounds;
mod contacts;
mod draw;
mod joints;
mod options;
mod shapes;
pub(crate) mod solver;
#[cfg(test)]
mod test_scenes;
#[cfg(test)]
mod tests;

pub use options::{Colour, DrawOptions, Palette, Region};
pub use shapes::{DrawnShape, convex, triangles, wireframe};

use glam::DVec3;

/// The interface to a game's renderer. Each method does nothing unless it is implemented; shapes that are not
/// drawn as a whole come as lines.
pub trait DebugDraw {
    /// A shape, for renderers that have meshes of their own. By default its wireframe, line by line.
    fn shape(&mut self, shape: &DrawnShape<'_>) {
        shape.wireframe(&mut |from, to| self.line(from, to, shape.ink));
    }

    /// A line between two points of the world [m].
    fn line(&mut self, from: DVec3, to: DVec3, ink: Ink) {
        let _ = (from, to, ink);
    }

    /// A point of the world [m]; how large is the renderer's choice.
    fn point(&mut self, at: DVec3, ink: Ink) {
        let _ = (at, ink);
    }
}

/// The drawn elements and their colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ink {
    /// For renderers that draw some things differently, points of contact on top of shapes for example.
    pub element: Element,
    /// From the [`Palette`].
    pub colour: Colour,
}

/// The kind of a drawn element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Element {
    /// A shape on a body.
    Shape,
    /// The box around a shape.
    Aabb,
    /// The box that the broad phase keeps of it.
    FatAabb,
    /// The path that a swept body would have taken in the last step.
    Motion,
    /// A point of contact that touched when the last step began.
    RealPoint,
    /// One that was apart then.
    PotentialPoint,
    /// A potential one that pushed although the shapes are apart after the step; see
    /// [`DrawOptions::contacts`].
    GhostPoint,
    /// From one surface to the other at a point of contact.
    Gap,
    /// Normal at a point of contact, from the first shape to the second.
    Normal,
    /// Impulse at a point of contact.
    Impulse,
    /// An axis of a joint's frame.
    JointFrame,
    /// The range of a joint's limit.
    JointLimit,
    /// From one frame of a joint to the other.
    JointGap,
    /// The motions of a coupling: a rope from frame to frame, or a line from one joint to the other.
    Coupling,
    /// A body's centre of mass.
    CentreOfMass,
    /// One of its principal axes of inertia.
    PrincipalAxis,
    /// A contact, in the solver's colour.
    SolverColour,
}
