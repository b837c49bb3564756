//! Overlaps of a convex shape at a pose.

use super::advance::{over_plane, overlaps};
use super::candidates::Candidate;
use super::filter::QueryFilter;
use super::probe::Probe;
use crate::error::Error;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::narrow_phase::Support;
use crate::shape::Geometry;
use crate::world::World;
use glam::{DVec3, Vec3};

/// A shape that is overlapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Overlap {
    /// Whose shape it is.
    pub body: BodyHandle,
    /// Which shape.
    pub shape: ShapeHandle,
}

/// # Queries: overlaps
impl World {
    /// All shapes that a convex one at a pose overlaps or touches, by [`ShapeHandle`]. They replace the
    /// content of `found`, which alone may grow.
    ///
    /// Planes are the half-space below; triangles of meshes and height fields are surfaces, so a shape that
    /// is on neither side of one overlaps it. For depths and directions out see [`World::cast_shape_all`]
    /// with a path of zero. [`QueryFilter::skip_inside`] has no effect. When, where and how often it may be
    /// asked: as [`World::cast_ray`].
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let mut found = Vec::new();
    /// let zone = Geometry::sphere(1.0);
    /// world.overlap(&zone, DVec3::Y * 2.0, Quat::IDENTITY, &QueryFilter::default(), &mut found)?;
    /// assert!(found.iter().any(|overlap| overlap.body == body));
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// The shape is not convex or has no size, the rotation is not a unit quaternion, a number is not finite
    /// or beyond 1e15, or the budget does not allow the tree of movable bodies (see [`World::cast_ray`]);
    /// then `found` is as it was.
    pub fn overlap(
        &self,
        shape: &Geometry,
        position: DVec3,
        rotation: glam::Quat,
        filter: &QueryFilter<'_>,
        found: &mut Vec<Overlap>,
    ) -> Result<(), Error> {
        let probe = Probe::new(shape, position, rotation.into())?;
        self.ready(filter)?;
        found.clear();
        self.overlapping(&probe, filter, |candidate| {
            let (body, shape) = self.handles(candidate.index);
            found.push(Overlap { body, shape });
            true
        })?;
        found.sort_unstable_by_key(|o| o.shape);
        Ok(())
    }

    /// Whether a convex shape at a pose overlaps or touches anything. Rules and errors are those of
    /// [`World::overlap`].
    ///
    /// # Errors
    /// As there.
    pub fn overlap_any(
        &self,
        shape: &Geometry,
        position: DVec3,
        rotation: glam::Quat,
        filter: &QueryFilter<'_>,
    ) -> Result<bool, Error> {
        let probe = Probe::new(shape, position, rotation.into())?;
        let mut any = false;
        self.overlapping(&probe, filter, |_| {
            any = true;
            false
        })?;
        Ok(any)
    }

    /// Calls `f` with each, until it returns that this was enough.
    fn overlapping<'a>(
        &'a self,
        probe: &Probe<'_>,
        filter: &QueryFilter<'_>,
        mut f: impl FnMut(&Candidate<'a>) -> bool,
    ) -> Result<(), Error> {
        self.along(probe.position, Vec3::ZERO, probe.half, filter, 1.0, |candidate, most| {
            if meets(probe, candidate) && !f(candidate) { -1.0 } else { most }
        })
    }
}

fn meets(probe: &Probe<'_>, candidate: &Candidate<'_>) -> bool {
    let (a, pose) = (&probe.support, probe.pose_of(candidate));
    let mut triangle = |_: u32, corners: [Vec3; 3]| {
        let [p, q, r] = corners.map(Vec3::as_dvec3);
        let normal = pose.rotation * (q - p).cross(r - p);
        let at = pose.rotation * p + pose.position;
        let hint = if normal.dot(at) < 0.0 { -normal } else { normal };
        overlaps(a, &Support::triangle(corners), &pose, hint)
    };
    let to_mesh = pose.rotation.transpose();
    let around = || {
        let (at, half) = (to_mesh * -pose.position, a.half_extents(to_mesh));
        // A margin for rounding.
        let half = half + 1e-6 * (at.abs() + half);
        ((at - half).as_vec3(), (at + half).as_vec3())
    };
    let geometry = &candidate.shape.geometry;
    if let Some(ground) = geometry.ground() {
        let (min, max) = around();
        return ground.any_in_box(min, max, &mut triangle);
    }
    match geometry.support() {
        Some(other) => overlaps(a, &other, &pose, pose.position),
        None => over_plane(a, &pose).0 <= 0.0,
    }
}
