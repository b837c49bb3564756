//! A character's shape in the world: its casts, and which surfaces it can stand on.

use super::settings::CharacterSettings;
use crate::error::Error;
use crate::math::Quat;
use crate::query::{Probe, QueryFilter, Ray, RayHit, ShapeHit};
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

/// A shape that a character has instead of a capsule. Two are equal if their geometry is.
#[derive(Clone, Debug)]
pub(super) struct Own(pub(super) Geometry);

impl PartialEq for Own {
    fn eq(&self, other: &Own) -> bool {
        match (&self.0, &other.0) {
            (Geometry::Hull(one), Geometry::Hull(other)) => one.vertices() == other.vertices(),
            (one, other) => one.kind_name() == other.kind_name() && one.size() == other.size(),
        }
    }
}

/// A character's form: its shape for casts, and the place of its feet.
#[derive(Clone)]
pub(super) struct Form {
    /// The shape for casts, with `skin` around it: a capsule with the skin in its radius, or the caller's
    /// shape.
    geometry: Geometry,
    skin: f32,
    /// A core without skin, which touches only shapes that reach deep into the character.
    core: Geometry,
    rotation: Quat,
    pub(super) up: DVec3,
    /// The least half extent with the skin [m]; a capsule's radius.
    pub(super) radius: f64,
    /// From its position to its feet: below its middle, where it would touch level ground [m].
    foot: DVec3,
    /// From its position to where a look for ground starts [m], and how high that is over the feet.
    low: DVec3,
    drop: f64,
}

impl Form {
    /// The capsule of the settings.
    fn capsule(settings: &CharacterSettings) -> Form {
        let up = settings.up.normalize();
        let thick = settings.radius + settings.skin;
        let (axis, radius) = (up.as_dvec3().normalize(), f64::from(thick));
        let half_height = f64::from(settings.half_height);
        Form {
            geometry: Geometry::capsule(settings.half_height, thick),
            skin: 0.0,
            core: Geometry::capsule(settings.half_height, 0.5 * thick),
            rotation: upright(up),
            up: axis,
            radius,
            foot: -(axis * (half_height + radius)),
            low: -(axis * half_height),
            drop: radius,
        }
    }

    /// A shape of the caller, turned from upright.
    fn shaped(settings: &CharacterSettings, geometry: &Geometry, turned: Quat) -> Result<Form, Error> {
        let up = settings.up.normalize();
        let rotation = (upright(up) * turned).normalize();
        let axis = up.as_dvec3().normalize();
        let probe = Probe::new(geometry, DVec3::ZERO, rotation)?.with_skin(settings.skin);
        // Half the extent along an axis, and its middle.
        let along = |d: DVec3| {
            let (ahead, behind) = (probe.reach(d), probe.reach(-d));
            (0.5 * (ahead + behind), 0.5 * (ahead - behind))
        };
        let (u, v) = axis.any_orthonormal_pair();
        let [(tall, middle), (wide, at_u), (deep, at_v)] = [along(axis), along(u), along(v)];
        let low = u * at_u + v * at_v + axis * middle;
        Ok(Form {
            geometry: geometry.clone(),
            skin: settings.skin,
            core: geometry.clone(),
            rotation,
            up: axis,
            radius: tall.min(wide).min(deep),
            foot: low - axis * tall,
            low,
            drop: tall,
        })
    }

    /// That of a character with these settings; `own`: its shape if that is no capsule.
    pub(super) fn new(
        settings: &CharacterSettings,
        own: Option<&Geometry>,
        turned: Quat,
    ) -> Result<Form, Error> {
        own.map_or_else(|| Ok(Form::capsule(settings)), |shape| Form::shaped(settings, shape, turned))
    }

    /// Where it would touch level ground.
    pub(super) fn feet(&self, at: DVec3) -> DVec3 {
        at + self.foot
    }
}

/// A character's form in a world.
pub(super) struct Shape<'a> {
    pub(super) world: &'a World,
    pub(super) filter: QueryFilter<'a>,
    pub(super) form: Form,
    pub(super) up: DVec3,
    /// See [`Form`] [m].
    pub(super) radius: f64,
    /// Gaps and overlaps that don't count [m]: more than the gap that a cast leaves, far less than the skin.
    pub(super) tiny: f64,
    cosine: f64,
}

impl<'a> Shape<'a> {
    pub(super) fn new(
        world: &'a World,
        settings: &CharacterSettings,
        form: Form,
        filter: &QueryFilter<'a>,
    ) -> Shape<'a> {
        Shape {
            world,
            filter: QueryFilter { skip_inside: true, ..*filter },
            up: form.up,
            radius: form.radius,
            form,
            tiny: 1e-3 * f64::from(settings.skin),
            // A slope of exactly the angle counts, for any rounding of its normal.
            cosine: libm::cos(settings.max_slope.into()) - 2e-6,
        }
    }

    /// The same among other shapes.
    pub(super) fn among<'b>(&self, filter: &QueryFilter<'b>) -> Shape<'b>
    where
        'a: 'b,
    {
        Shape { world: self.world, filter: *filter, form: self.form.clone(), ..*self }
    }

    /// Splits a vector into its parts along `up` and across.
    pub(super) fn split(&self, v: DVec3) -> (f64, DVec3) {
        let rise = self.up.dot(v);
        (rise, v - self.up * rise)
    }

    /// Where it would touch level ground, from a place.
    pub(super) fn feet(&self, at: DVec3) -> DVec3 {
        self.form.feet(at)
    }

    /// The shape with its skin at a place.
    pub(super) fn probe(&self, at: DVec3) -> Result<Probe<'_>, Error> {
        let form = &self.form;
        Ok(Probe::new(&form.geometry, at, form.rotation)?.with_skin(form.skin))
    }

    pub(super) fn is_floor(&self, normal: Vec3) -> bool {
        self.up.dot(normal.as_dvec3()) >= self.cosine
    }

    /// The first shape that stops the character on a path [m].
    pub(super) fn cast(&self, from: DVec3, path: DVec3) -> Result<Option<ShapeHit>, Error> {
        self.world.cast_probe(&self.probe(from)?, path.as_vec3(), &self.filter)
    }

    /// The first shape that stops the character's core on a path [m]: for paths out of overlaps, which must
    /// not pass through anything else.
    pub(super) fn cast_core(&self, from: DVec3, path: DVec3) -> Result<Option<ShapeHit>, Error> {
        let core = Probe::new(&self.form.core, from, self.form.rotation)?;
        self.world.cast_probe(&core, path.as_vec3(), &self.filter)
    }

    /// The ground straight below the character's middle, a capsule's lower ball's, down to `reach` below the
    /// feet [m], if one can stand on it.
    pub(super) fn floor_below(&self, at: DVec3, reach: f64) -> Result<Option<RayHit>, Error> {
        self.floor_on_ray(at + self.form.low, self.form.drop + reach)
    }

    pub(super) fn floor_on_ray(&self, from: DVec3, length: f64) -> Result<Option<RayHit>, Error> {
        let ray = Ray::new(from, (self.up * -length).as_vec3());
        Ok(self.world.cast_ray(&ray, &self.filter)?.filter(|hit| self.is_floor(hit.normal)))
    }
}
