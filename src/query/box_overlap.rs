//! Shapes whose boxes meet a box: no shape is looked at.

use super::filter::QueryFilter;
use super::overlap::Overlap;
use super::ray::check_start;
use crate::error::Error;
use crate::world::{Aabb, World};
use glam::Vec3;

/// # Queries: boxes
impl World {
    /// All shapes whose boxes ([`World::shape_aabb`]) meet a box along the axes of the world or touch it, by
    /// [`ShapeHandle`](crate::ShapeHandle): cheaper than [`World::overlap`], as a first selection. They
    /// replace the content of `found`, which alone may grow. A box around a turned shape is larger than the
    /// shape; that of a plane is around its half-space, everywhere if it leans. Exactly, or with a turned
    /// box, [`World::overlap`] answers. [`QueryFilter::skip_inside`] has no effect. When, where and how often
    /// it may be asked: as [`World::cast_ray`].
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let mut found = Vec::new();
    /// let area = Aabb { min: DVec3::splat(-1.0), max: DVec3::splat(3.0) };
    /// world.overlap_aabb(&area, &QueryFilter::only_dynamic(), &mut found)?;
    /// assert_eq!(found.len(), 1);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// A corner is not finite or beyond 1e15, or the low one is not below the high one, or the budget does
    /// not allow the tree of movable bodies (see [`World::cast_ray`]); then `found` is as it was.
    pub fn overlap_aabb(
        &self,
        area: &Aabb,
        filter: &QueryFilter<'_>,
        found: &mut Vec<Overlap>,
    ) -> Result<(), Error> {
        check_start("box corner", area.min)?;
        check_start("box corner", area.max)?;
        if let Some(value) = (area.max - area.min).to_array().into_iter().find(|side| *side < 0.0) {
            return Err(Error::OutOfRange { what: "box side", expected: "at least zero", value });
        }
        self.ready(filter)?;
        found.clear();
        // A margin for rounding: boxes decide below.
        let half = area.half_extents().as_vec3() * (1.0 + 4.0 * f32::EPSILON);
        self.along(area.centre(), Vec3::ZERO, half, filter, 1.0, |candidate, most| {
            if self.aabb_of_collider(candidate.index).overlaps(area) {
                let (body, shape) = self.handles(candidate.index);
                found.push(Overlap { body, shape });
            }
            most
        })?;
        found.sort_unstable_by_key(|o| o.shape);
        Ok(())
    }
}
