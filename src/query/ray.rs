//! Rays: the first shape on a straight line, whether there is any, and all of them.

use super::candidates::Candidate;
use super::filter::QueryFilter;
use super::ray_shape::{Met, meet};
use crate::error::{Error, within};
use crate::handle::{BodyHandle, ShapeHandle};
use crate::world::{World, finite_position};
use glam::{DVec3, Vec3};

// Guard: keeps products of two lengths far from overflow.
/// Beyond this no coordinate and no component of a path may be [m].
const FURTHEST: f32 = 1e15;

/// A straight line from one point to another.
///
/// ```
/// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
/// let down = Ray::new(DVec3::Y * 2.0, Vec3::NEG_Y * 10.0);
/// let between = Ray::between(DVec3::ZERO, DVec3::X * 5.0);
/// assert_eq!(down.at(0.5), DVec3::NEG_Y * 3.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ray {
    /// Where it starts, in the world [m].
    pub from: DVec3,
    /// From its start to its end [m]: direction times length. It may be zero; then it meets the shapes that
    /// contain the point.
    pub path: Vec3,
}

impl Ray {
    /// A ray from a point along a path [m].
    pub fn new(from: impl Into<DVec3>, path: Vec3) -> Ray {
        Ray { from: from.into(), path }
    }
    /// A ray from one point to another [m].
    pub fn between(from: impl Into<DVec3>, to: impl Into<DVec3>) -> Ray {
        let from = from.into();
        Ray { from, path: (to.into() - from).as_vec3() }
    }
    /// The point at a fraction of the path [m].
    pub fn at(&self, fraction: f32) -> DVec3 {
        self.from + self.path.as_dvec3() * f64::from(fraction)
    }

    pub(super) fn validate(&self) -> Result<(), Error> {
        check_start("ray start", self.from)?;
        check_path("ray path", self.path)
    }
}

/// Where a query starts.
pub(super) fn check_start(what: &'static str, at: DVec3) -> Result<(), Error> {
    finite_position(at)?;
    match at.to_array().into_iter().find(|v| v.abs() > 1e15) {
        Some(value) => Err(Error::OutOfRange { what, expected: "within 1e15", value }),
        None => Ok(()),
    }
}

pub(super) fn check_path(what: &'static str, path: Vec3) -> Result<(), Error> {
    for value in path.to_array() {
        within(what, value, -FURTHEST, FURTHEST, "within 1e15")?;
    }
    Ok(())
}

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RayHit {
    /// Whose shape it is.
    pub body: BodyHandle,
    /// Which shape.
    pub shape: ShapeHandle,
    /// Fraction of the path, 0..=1; zero if the ray starts inside.
    pub fraction: f32,
    /// Where it is met, in the world [m]; more exact than by the fraction.
    pub point: DVec3,
    /// Unit vector out of the shape; for a triangle, against the ray. Zero if the ray starts inside.
    pub normal: Vec3,
    /// Index of the triangle, for a triangle mesh or a height field.
    pub triangle: Option<u32>,
    /// Whether the ray starts inside a solid shape.
    pub inside: bool,
}

/// # Queries: rays
impl World {
    /// The first shape that a ray meets.
    ///
    /// Convex shapes and planes (the half-space below) are solid: a ray that starts inside one meets it at
    /// the fraction 0, with [`RayHit::inside`], unless [`QueryFilter::skip_inside`] says otherwise; it never
    /// meets a solid shape from within. Triangles of meshes and height fields are met from both sides. Among
    /// shapes at the same fraction the one with the lower [`ShapeHandle`] is reported, among a mesh's
    /// triangles the one with the lower index.
    ///
    /// Sees the world as it is now, including additions, motions and removals since the last step. The same
    /// bits after any history of the world, on every build. Allocates nothing except, in the first query
    /// after a change, memory for the tree of movable shapes to grow ([`World::memory`]). Any number of
    /// threads may ask at the same time.
    ///
    /// ```
    /// use backstop::glam::{DVec3, Vec3};
    /// use backstop::{BodyDesc, Geometry, QueryFilter, Ray, Settings, ShapeDesc, World};
    ///
    /// # fn main() -> Result<(), backstop::Error> {
    /// let mut world = World::new(Settings::default())?;
    /// let floor = ShapeDesc::new(Geometry::cuboid(10.0, 0.5, 10.0));
    /// let floor = world.add_body(&BodyDesc::fixed().with_shape(floor))?;
    /// let down = Ray::new(DVec3::Y * 5.0, Vec3::Y * -100.0);
    /// let hit = world.cast_ray(&down, &QueryFilter::new())?.expect("there is a floor");
    /// assert_eq!((hit.body, hit.point.y, hit.normal), (floor, 0.5, Vec3::Y));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// A number is not finite or beyond 1e15, or the budget does not allow the tree of movable bodies
    /// ([`Error::Budget`]): asked by the first query of a world, and by one that meets static bodies that no
    /// step has met.
    pub fn cast_ray(&self, ray: &Ray, filter: &QueryFilter<'_>) -> Result<Option<RayHit>, Error> {
        ray.validate()?;
        self.first_on_ray(ray, filter)
    }

    /// Whether a ray meets anything at all: less work than [`World::cast_ray`], whose rules it follows.
    ///
    /// # Errors
    /// As there.
    pub fn cast_ray_any(&self, ray: &Ray, filter: &QueryFilter<'_>) -> Result<bool, Error> {
        ray.validate()?;
        let mut any = false;
        self.on_ray(ray, filter, true, |_, _, _| {
            any = true;
            -1.0
        })?;
        Ok(any)
    }

    /// All shapes that a ray meets, each where it is met first, by fraction and then by [`ShapeHandle`]. They
    /// replace the content of `hits`, which alone may grow. The rules are those of [`World::cast_ray`].
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let mut hits = Vec::new();
    /// let ray = Ray::new(DVec3::Y * 5.0, Vec3::NEG_Y * 10.0);
    /// world.cast_ray_all(&ray, &QueryFilter::default(), &mut hits)?;
    /// assert_eq!(hits.iter().map(|hit| hit.body).collect::<Vec<_>>(), [body, ground]);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// As there; then `hits` is as it was.
    pub fn cast_ray_all(
        &self,
        ray: &Ray,
        filter: &QueryFilter<'_>,
        hits: &mut Vec<RayHit>,
    ) -> Result<(), Error> {
        ray.validate()?;
        self.ready(filter)?;
        hits.clear();
        self.on_ray(ray, filter, false, |candidate, met, most| {
            hits.push(self.ray_hit(ray, candidate, met));
            most
        })?;
        hits.sort_unstable_by(|a, b| a.fraction.total_cmp(&b.fraction).then(a.shape.cmp(&b.shape)));
        Ok(())
    }

    pub(super) fn first_on_ray(&self, ray: &Ray, filter: &QueryFilter<'_>) -> Result<Option<RayHit>, Error> {
        let mut first: Option<(Candidate<'_>, Met)> = None;
        self.on_ray(ray, filter, false, |candidate, met, _| {
            let (fraction, index) = (met.fraction, candidate.index);
            if first.as_ref().is_none_or(|(c, m)| (fraction, index) < (m.fraction, c.index)) {
                first = Some((Candidate { ..*candidate }, *met));
            }
            first.as_ref().map_or(fraction, |(_, m)| m.fraction)
        })?;
        Ok(first.map(|(candidate, met)| self.ray_hit(ray, &candidate, &met)))
    }

    /// Calls `f` with all that a ray meets before the fraction that `f` last returned.
    #[inline(always)]
    fn on_ray<'a>(
        &'a self,
        ray: &Ray,
        filter: &QueryFilter<'_>,
        any: bool,
        mut f: impl FnMut(&Candidate<'a>, &Met, f32) -> f32,
    ) -> Result<(), Error> {
        self.along(ray.from, ray.path, Vec3::ZERO, filter, 1.0, |candidate, most| {
            match meet(candidate, ray, most, any) {
                Some(met) if met.fraction <= most && !(met.inside && filter.skip_inside) => {
                    f(candidate, &met, most)
                }
                _ => most,
            }
        })
    }

    pub(super) fn ray_hit(&self, ray: &Ray, candidate: &Candidate<'_>, met: &Met) -> RayHit {
        let (body, shape) = self.handles(candidate.index);
        RayHit {
            body,
            shape,
            fraction: met.fraction,
            point: ray.from + ray.path.as_dvec3() * met.exact,
            normal: candidate.global_normal(met.normal),
            triangle: met.triangle,
            inside: met.inside,
        }
    }
}
