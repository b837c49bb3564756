//! A convex shape against a triangle mesh or a height field.
//!
//! Triangles near the shape are gathered in eights and transformed into its frame. Tests in lanes find most
//! of them further apart than the margin. Each of the others yields a *patch*: a normal and the points nearer
//! than the margin, real and potential ones alike ([`boxes`], [`sphere`], [`capsule`], [`hull`],
//! [`cylinder`]). If the surface does not have the patch's normal there, because its edge is flat or concave,
//! the patch takes the triangle's normal or is dropped ([`patch`]). Patches with about the same normal become
//! one manifold of at most four points ([`merge`]).
//!
//! A triangle has two sides. The one with the body's centre of mass counts as outside, so that a shape that
//! is stuck halfway is pushed back to where its centre is ([`side_of`]).

pub(crate) mod boxes;
pub(crate) mod capsule;
pub(crate) mod cylinder;
pub(crate) mod hull;
pub(crate) mod merge;
pub(crate) mod nearby;
pub(crate) mod patch;
pub(crate) mod reach;
pub(crate) mod sphere;
pub(crate) mod touched;
pub(crate) mod triangle_contact;
pub(crate) mod triangles;

use super::{RawManifold, RawPoint, Relative};
use crate::lanes::{Lanes, kernel, with_best};
use crate::memory::{Allowance, Buffer, Buffers, sum_bytes};
use crate::narrow_phase::convex::clip::CLOUD;
use crate::narrow_phase::convex::gjk::distance;
use crate::narrow_phase::convex::polytope::Pose;
use crate::narrow_phase::convex::round_polytope::Core;
use crate::shape::support::Support;
use crate::shape::{Collider, Geometry, Ground};
use glam::Vec3;
use merge::{MAX_MANIFOLDS, Merge};
use nearby::{Eight, Extent, Nearby};
use patch::Patches;
use reach::{Bounds, Near, Reach, along, around, bounds, side_of};
use touched::Touched;
use triangles::Triangles;

/// Feature in a triangle's key: the deepest point of the shape, wherever it is.
const DEEPEST: u32 = 0x7f;

/// Buffers of [`collide_mesh`], kept from call to call.
#[derive(Debug, Default)]
pub(crate) struct MeshScratch {
    pub(crate) nearby: Nearby,
    patches: Patches,
    merge: Merge,
    /// Bytes that its buffers may still grow by.
    pub(crate) allowance: Allowance,
    /// How much was left out because they could not: triangles, or points of manifolds.
    pub(crate) shed: u32,
}

impl Buffers for MeshScratch {
    fn each(&mut self, f: &mut dyn FnMut(&mut dyn Buffer)) {
        self.each_ready(0, &mut |buffer, _| f(buffer));
    }
}

impl MeshScratch {
    /// The parts of the ground that the last shape, which was `a`, is within a distance of [m]; not all of
    /// them, if they are many. `path`: displacement of the shape in its own frame; only planes into which it
    /// leads by no more than `margin` are added [m].
    pub(crate) fn touched(&self, a: &Collider, within: f32, path: Vec3, margin: f32) -> Touched {
        let Patches { touches, patches, .. } = &self.patches;
        let mut touched = Touched::of(a);
        for patch in patches.iter().filter(|p| p.least <= within) {
            let touch = &touches[patch.touch as usize];
            touched.add_triangle(touch.index);
            if patch.reach.is_some() {
                touched.add_plane(touch.front, touch.front.dot(touch.corners[0]), path, margin);
            }
        }
        touched
    }

    /// A triangle that the last shape, which was `a`, pierces although no manifold says so, because the way
    /// out past its edge is shorter and leads behind a neighbour. Returns how far the shape is beyond its
    /// plane, and the normal into it.
    pub(crate) fn pierced(&self, a: &Collider) -> Option<(f32, Vec3)> {
        let (touch, apart) = self.patches.passed_over()?;
        let triangle = Support::triangle(touch.corners);
        let gap = distance(&a.geometry.support()?, &triangle, &Relative::IDENTITY, Vec3::ZERO);
        (gap.overlap || gap.distance < 0.0).then_some((-apart, -touch.front))
    }

    /// The buffer for triangles, if there is memory.
    pub(crate) fn nearby(&mut self) -> Option<&mut Nearby> {
        self.nearby.has_place(&mut self.allowance).then_some(&mut self.nearby)
    }

    /// Calls `f` with each buffer and the capacity that it needs if it may not grow: for the triangles that
    /// are gathered, and for the contacts of so many triangles.
    pub(crate) fn each_ready(&mut self, triangles: usize, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        // There must be capacity for all that the next eight triangles may yield; most yield four points.
        let points = 4 * triangles + 8 * CLOUD;
        f(self.nearby.buffer(), crate::narrow_phase::mesh::nearby::CHUNK);
        f(&mut self.patches.touches, triangles);
        f(&mut self.patches.patches, triangles);
        f(&mut self.patches.points, points);
        f(&mut self.merge.points, points);
        f(&mut self.merge.place, triangles);
    }

    /// Bytes of the triangles that are gathered for a pair.
    pub(crate) fn least(&mut self) -> usize {
        self.nearby.buffer().missing(crate::narrow_phase::mesh::nearby::CHUNK)
    }

    /// Bytes live and reserved.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        sum_bytes([self.nearby.bytes(), self.patches.bytes(), self.merge.bytes()])
    }
}

/// Finds all points of a convex shape and a mesh or height field that are nearer than the margin. Adds them
/// to `out` as up to [`MAX_MANIFOLDS`] manifolds in the shape's frame, the deepest first. Returns whether any
/// triangle was near enough to be examined.
pub(crate) fn collide_mesh(
    a: &Collider,
    b: &Collider,
    rel: &Relative,
    reach: Reach,
    scratch: &mut MeshScratch,
    out: &mut Vec<RawManifold>,
) -> bool {
    let Some(ground) = b.geometry.ground() else { return false };
    let Some(shape) = Shape::of(a, Pose::new(rel.position, rel.rotation)) else { return false };
    let MeshScratch { nearby, patches, merge, allowance, shed } = scratch;
    if !nearby.has_place(allowance) {
        *shed += 1;
        return false;
    }
    patches.clear();
    let each = points_each(a);
    let Reach { margin, within, path } = reach;
    let mut near = Near::default();
    let mut extent = along(&shape.pose, shape.extent(margin), path);
    if within < margin {
        let close = shape.extent(within.max(0.0));
        nearby.gather(&ground, close, &mut |found| {
            for (eight, lanes) in found.each() {
                with_best!(Wide => find_near::<Wide>(&mut near, &shape, eight, lanes, within));
            }
        });
        if near.count == 0 {
            return false;
        }
        extent = near.extent(&shape.pose, close, margin).unwrap_or(extent);
    }
    nearby.gather(&ground, extent, &mut |found| {
        for (eight, lanes) in found.each() {
            // There must be capacity for all that these triangles may yield: the functions below don't check
            // it.
            if !allowance.is_endless() && !patches.has_place(8, each, allowance) {
                *shed += 1;
                return;
            }
            with_best!(Wide => touch_eight::<Wide>(&near, &shape, eight, lanes, reach, &ground, patches));
        }
    });
    shape.finish(patches);
    if !allowance.is_endless() {
        let place = out.len() + MAX_MANIFOLDS;
        if !merge.has_place(patches, allowance) || allowance.fit(out, place) < place {
            *shed += 1;
            return true;
        }
    }
    merge.manifolds(patches, &ground, &shape.pose, a.radius, out);
    true
}

kernel! {
    /// Adds those of eight triangles that are within a distance [m].
    fn find_near<'a, L: Lanes>(
        near: &'a mut Near,
        shape: &'a Shape<'a>,
        eight: &'a Eight,
        lanes: u32,
        within: f32,
    ) {
        near.add(&shape.triangles::<L>(eight, lanes), shape.collider, shape.bounds, within);
    }
}

kernel! {
    /// Adds a patch for each of eight triangles that is nearer than its margin.
    fn touch_eight<'a, L: Lanes>(
        near: &'a Near,
        shape: &'a Shape<'a>,
        eight: &'a Eight,
        lanes: u32,
        reach: Reach,
        ground: &'a Ground<'a>,
        patches: &'a mut Patches,
    ) {
        let triangles = shape.triangles::<L>(eight, lanes);
        shape.touch(&triangles, near.margins(&triangles, reach), ground, patches);
    }
}

/// A convex shape, prepared for tests against triangles.
struct Shape<'a> {
    collider: &'a Collider,
    bounds: Bounds,
    /// The point that tells on which side of a triangle the shape belongs.
    side: Vec3,
    core: Option<Core>,
    /// Pose of the mesh in the shape's frame.
    pose: Pose,
}

impl<'a> Shape<'a> {
    #[inline(always)]
    fn of(collider: &'a Collider, pose: Pose) -> Option<Shape<'a>> {
        let bounds = bounds(collider)?;
        Some(Shape { collider, bounds, side: side_of(collider), core: Core::of(collider), pose })
    }

    /// The box, in the mesh's frame, around all points nearer to the shape than a margin.
    #[inline(always)]
    fn extent(&self, margin: f32) -> Extent {
        around(&self.pose, self.bounds.grown(margin))
    }

    #[inline(always)]
    fn triangles<L: Lanes>(&self, eight: &Eight, lanes: u32) -> Triangles<L> {
        Triangles::new(eight, lanes, &self.pose, self.side)
    }

    /// Adds a patch for every triangle that is nearer than its margin.
    #[inline(always)]
    fn touch<L: Lanes>(&self, triangles: &Triangles<L>, margins: L, ground: &Ground, patches: &mut Patches) {
        let a = self.collider;
        match (&a.geometry, &self.core) {
            (Geometry::Sphere { radius }, _) => sphere::touch(*radius, triangles, margins, ground, patches),
            (Geometry::Box { half_extents }, _) => {
                boxes::touch(*half_extents, triangles, margins, ground, patches);
            }
            (Geometry::Hull(hull), _) => {
                hull::touch(hull, a.radius, self.bounds, triangles, margins, ground, patches);
            }
            (_, Some(core)) => {
                capsule::touch(core, self.bounds.half, a.radius, triangles, margins, ground, patches)
            }
            _ => cylinder::touch(a, self.bounds, triangles, margins, ground, patches),
        }
    }

    /// Completes the patches, and drops those that the surface does not have.
    #[inline(always)]
    fn finish(&self, patches: &mut Patches) {
        let a = self.collider;
        if let Geometry::Sphere { radius } = a.geometry {
            sphere::finish(radius, patches);
        }
        if let (Some(touch), Some(shape)) = (patches.spare(), a.geometry.support()) {
            let front = touch.front.as_dvec3();
            let deepest = (shape.support(-front) - front * shape.radius).as_vec3();
            let separation = touch.front.dot(deepest - touch.corners[0]);
            let position = deepest - touch.front * (0.5 * separation);
            patches.points.push(RawPoint {
                position,
                separation,
                key: triangle_contact::key(touch.index, DEEPEST),
            });
            patches.add(touch, -touch.front, Some(separation), patches.points.len() - 1);
        }
        patches.drop_backs(self.side);
        patches.drop_hidden(a.radius);
    }
}

/// The most points that a triangle yields.
fn points_each(a: &Collider) -> usize {
    match a.geometry {
        Geometry::Sphere { .. } => 1,
        Geometry::Capsule { .. } => 4,
        Geometry::Box { .. } => 8,
        _ => CLOUD,
    }
}

#[cfg(test)]
mod tests;
