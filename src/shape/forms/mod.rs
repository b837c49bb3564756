//! The interface of a form to the engine, implemented in the file of the form.
//!
//! Callers write a [`Geometry`](super::Geometry); `with_form!` makes of it the value that implements the
//! trait, in the only match over all forms. It is compiled for each form, so code with a loop matches once,
//! around the loop. Hulls are in `hull/form.rs`, meshes and height fields in `ground.rs`.

mod capsule;
mod cuboid;
mod cylinder;
mod kind;
pub(crate) mod outline;
mod plane;
mod solid;
mod sphere;
pub(crate) mod support;

pub(super) use capsule::Capsule;
pub(super) use cuboid::Cuboid;
pub(crate) use cylinder::Frustum;
pub(crate) use kind::{Kind, Symmetry};
pub(super) use plane::HalfSpace;
pub(super) use solid::clip;
pub(crate) use solid::{Entry, NearPoint};
pub(super) use sphere::Ball;

use super::mass::Moments;
use super::material::Material;
use crate::error::Error;
use crate::lanes::{Lanes, Vec3 as LaneVec3};
use crate::math::Quat;
use glam::{DVec3, Vec3};
use outline::{Line, Solid, Triangle, Window};
use solid::turned_box;
use support::Support;

/// A form, in its own frame [m].
///
/// The default implementations mostly fit planes, meshes and height fields, which fill no space.
pub(super) trait Form<'a>: Copy {
    const KIND: Kind;
    /// In words, for names and messages.
    const NAME: &'static str;
    /// Its code in snapshots: never changed.
    const CODE: u32;

    /// Its numbers, which [`Collider::size`](super::Collider::size) and snapshots hold; none of shared
    /// geometry.
    fn size(self) -> [f32; 4] {
        [0.0; 4]
    }

    /// Checks every range.
    fn validate(self) -> Result<(), Error> {
        Ok(())
    }

    /// Low and high corner of the box around it; of a plane it has no end.
    fn aabb(self) -> (Vec3, Vec3);

    /// Bounds around its origin once it is turned.
    fn turned_bounds(self, rotation: Quat) -> (Vec3, Vec3) {
        turned_box(self.aabb(), rotation)
    }

    /// See [`Geometry::radius`](super::Geometry::radius).
    fn radius(self) -> f32 {
        let (min, max) = self.aabb();
        min.abs().max(max.abs()).length()
    }

    /// See [`Geometry::inner_radius`](super::Geometry::inner_radius).
    fn inner_radius(self) -> f32 {
        0.0
    }

    /// Whether a point surely lies inside; never in planes, meshes and height fields.
    fn holds(self, _point: Vec3) -> bool {
        false
    }

    /// From the middle to the end of the core of a long shape; zero for others.
    fn core_end(self) -> Vec3 {
        Vec3::ZERO
    }

    /// Mass, centre and inertia at a density of one.
    fn moments(self) -> Moments {
        Moments::ZERO
    }

    /// The core and the radius of a convex and bounded form.
    fn support(self) -> Option<Support<'a>> {
        None
    }

    /// The points that are furthest along unit directions.
    #[inline(always)]
    fn lane_support<L: Lanes>(self, d: LaneVec3<L>) -> LaneVec3<L> {
        d * L::splat(f32::MAX)
    }

    /// How far it reaches from its origin along unit directions.
    #[inline(always)]
    fn lane_reach<L: Lanes>(self, d: LaneVec3<L>) -> L {
        self.lane_support(d).dot(d)
    }

    /// Where a path enters it, if it is larger by `extra` [m] all around; not from within. Triangles are
    /// asked in another way: [`Ground`](super::Ground).
    fn enter(self, _start: DVec3, _path: DVec3, _extra: f64) -> Option<Entry> {
        None
    }

    /// Whether a point is inside, and not on the surface.
    fn contains(self, _at: DVec3) -> bool {
        false
    }

    /// The point of it that is nearest to one outside; `None` if that has to be searched.
    fn nearest(self, _at: DVec3) -> Option<NearPoint> {
        None
    }

    /// Vertices and triangles that show a convex form.
    fn solid(self) -> Solid {
        Solid::default()
    }

    /// The triangles that show it, within a window.
    fn triangles(self, _window: Window, triangle: &mut Triangle<'_>) {
        let (vertices, triangles) = self.solid();
        triangles.iter().for_each(|t| triangle(t.map(|v| vertices[v as usize])));
    }

    /// The lines that show it, within a window.
    fn lines(self, window: Window, line: &mut Line<'_>) {
        self.triangles(window, &mut |[a, b, c]| {
            line(a, b);
            line(b, c);
            line(c, a);
        });
    }

    /// The materials of its parts.
    fn materials(self) -> &'a [Material] {
        &[]
    }

    /// Where it lies, if shapes share it.
    fn address(self) -> Option<usize> {
        None
    }

    /// Its bytes, live and reserved, if shapes share it.
    fn bytes(self) -> (usize, usize) {
        (0, 0)
    }

    /// The content of shared geometry as words, for a fingerprint.
    fn words(self, _out: &mut Vec<u32>) {}

    #[inline]
    fn kind(self) -> Kind {
        Self::KIND
    }
    fn name(self) -> &'static str {
        Self::NAME
    }
    fn code(self) -> u32 {
        Self::CODE
    }
}

#[cfg(test)]
mod tests;
