//! The points of shapes that are nearest to a point.

use super::candidates::Candidate;
use super::closest_shape::{Nearest, nearest};
use super::filter::QueryFilter;
use super::ray::check_start;
use crate::error::{Error, within};
use crate::handle::{BodyHandle, ShapeHandle};
use crate::world::World;
use glam::{DVec3, Vec3};

/// The point of a shape that is nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ClosestPoint {
    /// Whose shape it is.
    pub body: BodyHandle,
    /// Which shape.
    pub shape: ShapeHandle,
    /// The nearest point, in the world [m]; inside a solid shape the query point itself.
    pub point: DVec3,
    /// How far it is away [m]; zero inside.
    pub distance: f32,
    /// Unit vector from the nearest point towards the query point; on a surface, out of it. Zero inside.
    pub normal: Vec3,
    /// Index of the triangle, for a triangle mesh or a height field.
    pub triangle: Option<u32>,
    /// Whether the point is inside a solid shape.
    pub inside: bool,
}

/// # Queries: nearest points
impl World {
    /// The shape that is nearest to a point [m], within a distance [m].
    ///
    /// Convex shapes and planes (the half-space below) are solid: a point inside one is at the distance 0
    /// from it, with [`ClosestPoint::inside`]. Triangles of meshes and height fields are surfaces. Among
    /// shapes at the same distance the one with the lower [`ShapeHandle`] is reported, among a mesh's
    /// triangles the one with the lower index. [`QueryFilter::skip_inside`] has no effect. When, where and
    /// how often it may be asked: as [`World::cast_ray`].
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let near = world.closest_point(DVec3::Y * 4.0, 5.0, &QueryFilter::default())?.expect("the cube");
    /// assert!((near.distance - 1.5).abs() < 1e-5);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// A coordinate is not finite or beyond 1e15, the distance is not a number in 0..=1e15, or the budget
    /// does not allow the tree of movable bodies (see [`World::cast_ray`]).
    pub fn closest_point(
        &self,
        point: DVec3,
        distance: f32,
        filter: &QueryFilter<'_>,
    ) -> Result<Option<ClosestPoint>, Error> {
        check(point, distance)?;
        let mut first: Option<(f32, u32, Candidate<'_>, Nearest)> = None;
        self.near(point, distance, filter, |candidate, found| {
            let key = (found.distance as f32, candidate.index);
            if first.as_ref().is_none_or(|f| key < (f.0, f.1)) {
                first = Some((key.0, key.1, Candidate { ..*candidate }, *found));
            }
            first.as_ref().map_or(distance, |f| f.0)
        })?;
        Ok(first.map(|(_, _, candidate, found)| self.closest(&candidate, &found)))
    }

    /// Whether any shape is within a distance [m] of a point [m]; inside counts. Rules and errors are those
    /// of [`World::closest_point`].
    ///
    /// # Errors
    /// As there.
    pub fn closest_point_any(
        &self,
        point: DVec3,
        distance: f32,
        filter: &QueryFilter<'_>,
    ) -> Result<bool, Error> {
        check(point, distance)?;
        let mut any = false;
        self.near(point, distance, filter, |_, _| {
            any = true;
            -1.0
        })?;
        Ok(any)
    }

    /// The nearest point of every shape within a distance [m], by distance and then by [`ShapeHandle`]. They
    /// replace the content of `found`, which alone may grow. Rules and errors are those of
    /// [`World::closest_point`].
    ///
    /// # Errors
    /// As there; then `found` is as it was.
    pub fn closest_point_all(
        &self,
        point: DVec3,
        distance: f32,
        filter: &QueryFilter<'_>,
        found: &mut Vec<ClosestPoint>,
    ) -> Result<(), Error> {
        check(point, distance)?;
        self.ready(filter)?;
        found.clear();
        self.near(point, distance, filter, |candidate, nearest| {
            found.push(self.closest(candidate, nearest));
            distance
        })?;
        found.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.shape.cmp(&b.shape)));
        Ok(())
    }

    /// Calls `f` with the nearest points of shapes that are within the distance that `f` last returned; below
    /// zero ends it.
    fn near<'a>(
        &'a self,
        point: DVec3,
        distance: f32,
        filter: &QueryFilter<'_>,
        mut f: impl FnMut(&Candidate<'a>, &Nearest) -> f32,
    ) -> Result<(), Error> {
        // A little more than the square, which is rounded.
        let squared = |d: f32| if d < 0.0 { -1.0 } else { d * d * (1.0 + 1e-6) + f32::MIN_POSITIVE };
        let mut most = distance;
        self.around(point, filter, squared(distance), |candidate, limit| {
            // Halfway to the next number: distances that round to the limit are within.
            let reach = f64::from(most) * (1.0 + 1e-7);
            match nearest(candidate.shape, candidate.local(point), reach) {
                Some(found) if found.distance as f32 <= most => {
                    most = f(candidate, &found);
                    squared(most)
                }
                _ => limit,
            }
        })
    }

    fn closest(&self, candidate: &Candidate<'_>, found: &Nearest) -> ClosestPoint {
        let (body, shape) = self.handles(candidate.index);
        ClosestPoint {
            body,
            shape,
            point: candidate.global(found.point),
            distance: found.distance as f32,
            normal: candidate.global_normal(found.normal),
            triangle: found.triangle,
            inside: found.inside,
        }
    }
}

fn check(point: DVec3, distance: f32) -> Result<(), Error> {
    check_start("point", point)?;
    within("distance", distance, 0.0, 1e15, "in 0..=1e15").map(drop)
}
