//! A character that other bodies see: a character of the world, and a kinematic body within it.

use crate::Controls;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Character, CharacterHandle, CharacterReport, CharacterSettings, Error, Filter,
    Geometry, QueryFilter, ShapeDesc, World,
};

/// By how much the body is thinner than the character [m].
const THINNER: f32 = 0.01;

/// The category of their bodies: the mask of a body that they shall not stop leaves it out.
pub const WALKER: u64 = 2;

/// The handles of a character and of its body. The velocity of the body is that of the character, so that all
/// of its state is in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walker {
    /// In the world, so that snapshots have it.
    pub character: CharacterHandle,
    /// Other bodies, and other characters, run into it.
    pub body: BodyHandle,
}

impl Walker {
    /// A character of the default size with its feet at a point [m].
    ///
    /// # Errors
    ///
    /// Those of [`World::add_body`] and [`World::add_character`].
    pub fn add_to(world: &mut World, feet: impl Into<DVec3>) -> Result<Walker, Error> {
        let settings = CharacterSettings::default();
        let half = settings.half_height + settings.radius + settings.skin;
        let middle = feet.into() + DVec3::Y * f64::from(half);
        let character = world.add_character(&Character::new(settings, middle)?)?;
        let thinner = Geometry::capsule(settings.half_height, settings.radius - THINNER);
        let shape = ShapeDesc::new(thinner).with_filter(Filter::default().with_category(WALKER));
        let body = world.add_body(&BodyDesc::kinematic().with_position(middle).with_shape(shape))?;
        Ok(Walker { character, body })
    }

    /// Walks before a step of `dt` [s], pushes the bodies in its way, and has its own body follow. `wish`: a
    /// velocity
    /// over the ground, where y is the speed of a jump [m/s]. In the air it falls with the velocity that it
    /// has.
    ///
    /// # Errors
    ///
    /// Those of [`World::walk_character`].
    pub fn walk(&self, world: &mut World, wish: Vec3, dt: f32) -> Result<CharacterReport, Error> {
        let on_ground = world.character(self.character)?.ground().is_some();
        let falling = world.linear_velocity(self.body)? + world.settings().gravity * dt;
        let velocity = if on_ground { wish } else { falling };
        let filter = QueryFilter::new().excluding(self.body);
        let report = world.walk_character(self.character, &filter, velocity, dt)?;
        report.push(world)?;
        let at = self.position(world)?;
        world.move_kinematic_and_stop(self.body, at, Quat::IDENTITY, dt)?;
        Ok(report)
    }

    /// Makes its cylinder lower or higher on the feet that it stands on: half the height [m].
    ///
    /// # Errors
    ///
    /// Those of [`Character::set_settings`] and [`World::set_geometry`].
    pub fn set_half_height(&self, world: &mut World, half_height: f32) -> Result<(), Error> {
        let mut character = world.character(self.character)?;
        let settings = *character.settings();
        if half_height == settings.half_height {
            return Ok(());
        }
        character.set_settings(CharacterSettings { half_height, ..settings })?;
        let up = DVec3::Y * f64::from(half_height - settings.half_height);
        character.set_position(character.position() + up)?;
        world.set_character(self.character, &character)?;
        let thinner = Geometry::capsule(half_height, settings.radius - THINNER);
        let shape = world.shapes(self.body)?.next();
        shape.map_or(Ok(()), |shape| world.set_geometry(shape, thinner))
    }

    /// Where its middle is [m].
    ///
    /// # Errors
    ///
    /// If it was removed.
    pub fn position(&self, world: &World) -> Result<DVec3, Error> {
        Ok(world.character(self.character)?.position())
    }

    /// Where its feet are [m].
    ///
    /// # Errors
    ///
    /// If it was removed.
    pub fn feet(&self, world: &World) -> Result<DVec3, Error> {
        Ok(world.character(self.character)?.feet())
    }
}

/// Speed of characters that the keys move, and of their jumps [m/s].
pub const RUN: f32 = 3.0;
/// See [`RUN`].
pub const JUMP: f32 = 4.5;

/// The velocity that the keys ask for, with the speed of a jump: forwards is -z and right +x. Without keys
/// `alone` [m/s].
pub fn wish(controls: &Controls, alone: Vec3) -> Vec3 {
    let across = Vec3::new(controls.right, 0.0, -controls.forward).clamp_length_max(1.0) * RUN;
    let jump = Vec3::Y * if controls.jump { JUMP } else { 0.0 };
    jump + if across == Vec3::ZERO { alone } else { across }
}

/// Has all of some characters walk alike: see [`Walker::walk`].
///
/// # Errors
///
/// As there.
pub fn walk_all(walkers: &[Walker], world: &mut World, wish: Vec3, dt: f32) -> Result<(), Error> {
    walkers.iter().try_for_each(|walker| walker.walk(world, wish, dt).map(drop))
}
