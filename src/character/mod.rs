//! A convex shape that walks: collide and slide, steps, slopes, moving ground.
//!
//! A character is not a body. It queries a world (`src/query/`) and moves its own position, so that any
//! number of them may walk at the same time through `&World`. All casts use its shape enlarged by its skin;
//! rounding and moving bodies cause overlap of the skin, which is resolved at the start of the next walk.
//!
//! One walk: the ground carries it ([`carry`]), overlapping bodies push it out ([`overlap`]), it slides along
//! obstacles ([`slide`]) and over steps ([`step`]), and settles on the ground ([`ground`]).

mod carry;
mod ground;
mod overlap;
mod planes;
mod report;
mod resident;
mod settings;
mod shape;
mod slide;
mod step;

pub use report::{CharacterHit, CharacterReport, Ground};
pub(crate) use resident::checked_character;
pub use settings::CharacterSettings;

use crate::body::BodyKind;
use crate::error::Error;
use crate::math::Quat;
use crate::query::{QueryFilter, ShapeHit};
use crate::shape::Geometry;
use crate::world::World;
use carry::{Carrier, carry};
use glam::{DVec3, Vec3};
use ground::{settle, velocity_at};
use overlap::push_out;
use shape::{Form, Own, Shape, upright};
use slide::Slide;

/// A capsule, or another convex shape, that walks through a world: a character.
///
/// ```
/// use backstop::glam::{DVec3, Vec3};
/// use backstop::{BodyDesc, Geometry, Character, CharacterSettings, QueryFilter, Settings, ShapeDesc, World};
///
/// # fn main() -> Result<(), backstop::Error> {
/// let mut world = World::new(Settings::default())?;
/// world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane)))?;
/// let mut character = Character::new(CharacterSettings::default(), DVec3::Y)?;
/// let (mut velocity, dt) = (Vec3::ZERO, 1.0 / 60.0);
/// for _ in 0..120 {
///     world.step(dt)?;
///     // What the player wants, and gravity; to jump is a velocity upwards.
///     velocity = Vec3::new(3.0, velocity.y - 9.81 * dt, 0.0);
///     let report = character.walk(&world, &QueryFilter::new(), velocity, dt)?;
///     velocity = report.velocity;
///     report.push(&mut world)?;
/// }
/// assert!(character.ground().is_some() && (character.position().x - 6.0).abs() < 1e-4);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Character {
    settings: CharacterSettings,
    /// Its shape, if that is not the capsule of the settings, and its rotation from upright.
    own: Option<Own>,
    turned: Quat,
    position: DVec3,
    ground: Option<Ground>,
    carrier: Option<Carrier>,
}

impl Character {
    /// A character whose capsule has its middle at a point [m]. It stands on nothing until it walks.
    ///
    /// # Errors
    /// If a setting is out of range, or the point is not finite.
    pub fn new(settings: CharacterSettings, position: DVec3) -> Result<Character, Error> {
        settings.validate()?;
        crate::limits::position(position)?;
        Ok(Character { settings, own: None, turned: Quat::IDENTITY, position, ground: None, carrier: None })
    }

    /// With a shape of its own instead of a capsule, as [`Character::set_shape`].
    ///
    /// # Errors
    /// As there.
    pub fn with_shape(mut self, shape: Geometry) -> Result<Character, Error> {
        self.set_shape(Some(shape))?;
        Ok(self)
    }

    /// Where the middle of the capsule, or the origin of its own shape, is [m].
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Where the ground is under a character that stands on level ground [m]: a skin below its shape, under
    /// the middle of it.
    pub fn feet(&self) -> DVec3 {
        if let Ok(form) = Form::new(&self.settings, self.own(), self.turned)
            && self.own.is_some()
        {
            return form.feet(self.position);
        }
        let s = &self.settings;
        self.position - s.up.as_dvec3() * f64::from(s.half_height + s.radius + s.skin)
    }

    /// The ground under it after the last walk.
    pub fn ground(&self) -> Option<&Ground> {
        self.ground.as_ref()
    }

    /// Its settings.
    pub fn settings(&self) -> &CharacterSettings {
        &self.settings
    }

    /// Replaces the settings: to crouch, to grow. Its middle stays where it is; whether there is room for it
    /// `overlap_any` tells, with [`Character::shape`].
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn set_settings(&mut self, settings: CharacterSettings) -> Result<(), Error> {
        settings.validate()?;
        self.settings = settings;
        Ok(())
    }

    /// Gives it a shape of its own, any convex geometry, or with none the capsule of its settings again. Its
    /// y axis is along [`CharacterSettings::up`]; its origin is at the character's position, which
    /// stays. The radius and half height of the settings then mean nothing. Whether there is room for it
    /// `overlap_any` tells.
    ///
    /// # Errors
    /// If the shape is not convex or has no size.
    pub fn set_shape(&mut self, shape: Option<Geometry>) -> Result<(), Error> {
        Form::new(&self.settings, shape.as_ref(), self.turned)?;
        self.own = shape.map(Own);
        Ok(())
    }

    /// Its shape without the skin, and how that is turned in the world: for queries, or for a kinematic body
    /// that others collide with.
    pub fn shape(&self) -> (Geometry, glam::Quat) {
        let (capsule, straight) = self.capsule();
        match &self.own {
            None => (capsule, straight),
            Some(Own(own)) => (own.clone(), (Quat::from(straight) * self.turned).normalize().into()),
        }
    }

    /// Turns its own shape from upright at once, by a unit quaternion in axes whose y is
    /// [`CharacterSettings::up`]; a capsule is not turned. Shapes that it overlaps then push it out in the
    /// next walk. To turn with moving ground, add [`CharacterReport::turned`] about y.
    ///
    /// # Errors
    /// If it is not a unit quaternion.
    pub fn set_rotation(&mut self, rotation: impl Into<glam::Quat>) -> Result<(), Error> {
        let rotation: glam::Quat = rotation.into();
        self.turned = crate::limits::unit_quat("character rotation", rotation)?;
        Ok(())
    }

    /// The rotation of its own shape from upright.
    pub fn rotation(&self) -> glam::Quat {
        self.turned.into()
    }

    /// Puts it somewhere else at once [m], on nothing.
    ///
    /// # Errors
    /// If the point is not finite.
    pub fn set_position(&mut self, position: DVec3) -> Result<(), Error> {
        crate::limits::position(position)?;
        (self.position, self.ground, self.carrier) = (position, None, None);
        Ok(())
    }

    /// The capsule of its settings without the skin, and how that is turned: [`Character::shape`] of a
    /// character without a shape of its own.
    pub fn capsule(&self) -> (Geometry, glam::Quat) {
        let capsule = Geometry::capsule(self.settings.half_height, self.settings.radius);
        (capsule, upright(self.settings.up.normalize()).into())
    }

    /// Moves with a velocity [m/s] for `dt` [s], as far as obstacles allow.
    ///
    /// On ground the velocity is relative to it; in the air it is that in the world. On ground the downward
    /// part has no effect, slopes do not change the horizontal motion, and any upward velocity leaves the
    /// ground and keeps the ground's velocity. Gravity is the caller's: add it to the velocity in every call,
    /// and hand [`CharacterReport::velocity`] back in.
    ///
    /// It sees the shapes that the filter selects: exclude a body of its own. [`QueryFilter::skip_inside`]
    /// has no effect. It is a shape cast, so it passes through nothing at any speed. Bodies that moved into
    /// it since the last walk push it out first, by the shortest way. Allocates nothing (except as a first
    /// query does), and the same world gives the same bits.
    ///
    /// # Errors
    /// A number is not finite or beyond 1e15, or `dt` is not above zero; then the character is as it was.
    pub fn walk(
        &mut self,
        world: &World,
        filter: &QueryFilter<'_>,
        velocity: Vec3,
        dt: f32,
    ) -> Result<CharacterReport, Error> {
        crate::limits::speed("velocity", velocity)?;
        let time = f64::from(crate::limits::step(dt)?);
        let settings = self.settings;
        let form = Form::new(&settings, self.own(), self.turned)?;
        let shape = Shape::new(world, &settings, form, filter);
        let mut report = CharacterReport::default();

        let (carried, turned) = carry(&shape, self.carrier, self.position, settings.iterations)?;
        let (start, overlap) = push_out(&shape, carried)?;

        // Removed ground has no velocity.
        let old_ground = self.ground.filter(|ground| world.contains(ground.body));
        let below = old_ground.map_or(Ok(Vec3::ZERO), |g| velocity_at(world, g.body, g.point))?;
        let (rise, across) = shape.split(velocity.as_dvec3());
        let walks = self.ground.filter(|_| rise <= 0.0);
        // A walking character was carried by the ground already; a jumping one keeps the ground's velocity.
        let own = if walks.is_some() { across } else { velocity.as_dvec3() + below.as_dvec3() };
        let (rise, across) = shape.split(own);
        let mut slide = Slide::new(start, across * time, rise * time);
        if let Some(ground) = walks {
            slide = slide.on(ground.normal.as_dvec3(), ground.point);
        }
        let in_world = if walks.is_some() { own.as_vec3() + below } else { own.as_vec3() };
        let mut heard = |hit: &ShapeHit| report.hit(self.meet(world, hit, in_world, dt));
        let step = settings.step_height.into();
        slide.run(&shape, settings.iterations, step, &mut heard)?;

        let mut at = slide.at;
        let landed = walks.is_none() && slide.walks;
        let ground = match rise {
            _ if walks.is_some() => settle(&shape, &mut at, (settings.snap + settings.skin).into(), step)?,
            rise if rise <= 0.0 || landed => settle(&shape, &mut at, settings.skin.into(), step)?,
            _ => None,
        };
        let left = slide.clip(&shape, own, shape.up.dot(slide.at - start) / time);
        let left = match (&ground, walks) {
            // It landed: from now on the velocity is one over the ground.
            (Some(ground), None) => shape.split(left - ground.velocity.as_dvec3()).1,
            (Some(_), Some(_)) => shape.split(left).1,
            // It walked off an edge, or flies on.
            (None, Some(_)) => left + below.as_dvec3(),
            (None, None) => left,
        };
        let carrier = ground.map(|ground| Carrier::new(world, ground.body)).transpose()?;
        crate::limits::position(at)?;

        report.moved = (at - self.position).as_vec3();
        report.carried = (carried - self.position).as_vec3();
        report.turned = turned as f32;
        report.pushed_out = (start - carried).as_vec3();
        report.stepped = slide.stepped as f32;
        report.velocity = left.as_vec3();
        report.overlap = (overlap as f32 - settings.skin).max(0.0);
        report.ground = ground;
        report.weight = world.settings().gravity * (settings.mass * dt);
        (self.position, self.ground, self.carrier) = (at, ground, carrier);
        Ok(report)
    }

    fn own(&self) -> Option<&Geometry> {
        self.own.as_ref().map(|own| &own.0)
    }

    /// An obstacle that was run into with a velocity.
    fn meet(&self, world: &World, hit: &ShapeHit, velocity: Vec3, dt: f32) -> CharacterHit {
        let &ShapeHit { body, shape, point, normal, .. } = hit;
        let mut impulse = Vec3::ZERO;
        if world.kind(body) == Ok(BodyKind::Dynamic)
            && let (Ok(mass), Ok(theirs)) = (world.mass(body), velocity_at(world, body, point))
        {
            // As in an impact of two free bodies, within the character's strength.
            let closing = -normal.dot(velocity - theirs);
            let both = self.settings.mass * mass / (self.settings.mass + mass);
            impulse = -normal * (closing.max(0.0) * both).min(self.settings.strength * dt);
        }
        CharacterHit { body, shape, point, normal, impulse }
    }
}
