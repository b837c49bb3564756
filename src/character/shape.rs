//! The capsule in the world: its casts, and which surfaces it can stand on.

use super::settings::CharacterSettings;
use crate::error::Error;
use crate::math::Quat;
use crate::query::{QueryFilter, Ray, RayHit, ShapeCast, ShapeHit};
use crate::shape::Geometry;
use crate::world::World;
use glam::{DVec3, Vec3};

/// A rotation of y to a unit vector; not glam's, which asks the platform's sine.
pub(super) fn upright(up: Vec3) -> Quat {
    let w = 1.0 + up.y;
    if w < 1e-6 {
        Quat::from_xyzw(1.0, 0.0, 0.0, 0.0)
    } else {
        Quat::from_xyzw(up.z, 0.0, -up.x, w).normalize()
    }
}

/// A character's capsule with its skin, in a world.
pub(super) struct Shape<'a> {
    pub(super) world: &'a World,
    pub(super) filter: QueryFilter<'a>,
    pub(super) capsule: Geometry,
    /// A thinner core, which touches only shapes that reach deep into the capsule.
    core: Geometry,
    pub(super) rotation: Quat,
    pub(super) up: DVec3,
    /// Radius with the skin [m].
    pub(super) radius: f64,
    half_height: f64,
    /// Gaps and overlaps that don't count [m]: more than what a cast leaves open, far less than the skin.
    pub(super) tiny: f64,
    cosine: f64,
}

impl<'a> Shape<'a> {
    pub(super) fn new(world: &'a World, settings: &CharacterSettings, filter: &QueryFilter<'a>) -> Shape<'a> {
        let up = settings.up.normalize();
        let radius = settings.radius + settings.skin;
        Shape {
            world,
            filter: QueryFilter { skip_inside: true, ..*filter },
            capsule: Geometry::capsule(settings.half_height, radius),
            core: Geometry::capsule(settings.half_height, 0.5 * radius),
            rotation: upright(up),
            up: up.as_dvec3().normalize(),
            radius: radius.into(),
            half_height: settings.half_height.into(),
            tiny: 1e-3 * f64::from(settings.skin),
            // A slope of exactly the angle counts, whatever the rounding of its normal.
            cosine: libm::cos(settings.max_slope.into()) - 2e-6,
        }
    }

    /// The same among other shapes.
    pub(super) fn among<'b>(&self, filter: &QueryFilter<'b>) -> Shape<'b>
    where
        'a: 'b,
    {
        Shape {
            world: self.world,
            filter: *filter,
            capsule: self.capsule.clone(),
            core: self.core.clone(),
            ..*self
        }
    }

    /// Splits a vector into its parts along `up` and across.
    pub(super) fn split(&self, v: DVec3) -> (f64, DVec3) {
        let rise = self.up.dot(v);
        (rise, v - self.up * rise)
    }

    /// Where a capsule at a place would touch level ground.
    pub(super) fn feet(&self, at: DVec3) -> DVec3 {
        at - self.up * (self.half_height + self.radius)
    }

    pub(super) fn is_floor(&self, normal: Vec3) -> bool {
        self.up.dot(normal.as_dvec3()) >= self.cosine
    }

    /// The first shape that stops the capsule on a path [m].
    pub(super) fn cast(&self, from: DVec3, path: DVec3) -> Result<Option<ShapeHit>, Error> {
        self.cast_as(&self.capsule, from, path)
    }

    /// The first shape that stops the capsule's core on a path [m]: for paths out of overlaps, which must not
    /// pass through anything else.
    pub(super) fn cast_core(&self, from: DVec3, path: DVec3) -> Result<Option<ShapeHit>, Error> {
        self.cast_as(&self.core, from, path)
    }

    fn cast_as(&self, shape: &Geometry, from: DVec3, path: DVec3) -> Result<Option<ShapeHit>, Error> {
        let cast = ShapeCast::new(shape, from, path.as_vec3()).rotated(self.rotation);
        self.world.cast_shape(&cast, &self.filter)
    }

    /// The ground straight below the lower ball's centre, down to `reach` below the feet [m], if one can
    /// stand on it.
    pub(super) fn floor_below(&self, at: DVec3, reach: f64) -> Result<Option<RayHit>, Error> {
        let from = at - self.up * self.half_height;
        self.floor_on_ray(from, self.radius + reach)
    }

    pub(super) fn floor_on_ray(&self, from: DVec3, length: f64) -> Result<Option<RayHit>, Error> {
        let ray = Ray::new(from, (self.up * -length).as_vec3());
        Ok(self.world.cast_ray(&ray, &self.filter)?.filter(|hit| self.is_floor(hit.normal)))
    }
}
