//! A body that stands where a character is, for others to see.

use crate::body::BodyDesc;
use crate::character::Character;
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::shape::{Geometry, ShapeDesc};
use crate::world::World;

/// A kinematic body with the shape of a character, which follows it.
///
/// A character asks the world and is not in it: nothing collides with it. With this body balls bounce off
/// it, rays and other characters hit it, and it pushes what it walks into. Its own walks must not see it:
/// exclude [`CharacterBody::body`] in their filter.
///
/// ```
/// use backstop::glam::{DVec3, Vec3};
/// use backstop::{Character, CharacterBody, CharacterSettings, QueryFilter, Settings, World};
///
/// # fn main() -> Result<(), backstop::Error> {
/// let mut world = World::new(Settings::default())?;
/// let mut hero = Character::new(CharacterSettings::default(), DVec3::ZERO)?;
/// let body = CharacterBody::new(&mut world, &hero)?;
/// let (dt, own) = (1.0 / 60.0, QueryFilter::new().excluding(body.body()));
/// for _ in 0..60 {
///     hero.walk(&world, &own, Vec3::X * 2.0, dt)?;
///     body.follow(&mut world, &hero, dt)?;
///     world.step(dt)?;
/// }
/// assert!((world.position(body.body())?.x - 2.0).abs() < 1e-3);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CharacterBody {
    body: BodyHandle,
}

impl CharacterBody {
    /// Adds a body with the shape of a character, where that is now. A description of the shape of one's
    /// own, with a filter or events, goes to [`CharacterBody::with_shape`].
    ///
    /// # Errors
    /// If the budget does not allow it.
    pub fn new(world: &mut World, character: &Character) -> Result<CharacterBody, Error> {
        CharacterBody::with_shape(world, character, &ShapeDesc::new(character.shape().0))
    }

    /// The same with a shape of the caller's: another filter, a material, or a form that is not that of the
    /// character, in the same axes.
    ///
    /// # Errors
    /// If the shape is not one, or the budget does not allow it.
    pub fn with_shape(
        world: &mut World,
        character: &Character,
        shape: &ShapeDesc,
    ) -> Result<CharacterBody, Error> {
        let (_, rotation) = character.shape();
        let desc = BodyDesc::kinematic().with_position(character.position()).with_rotation(rotation);
        Ok(CharacterBody { body: world.add_body(&desc.with_shape(shape.clone()))? })
    }

    /// Takes the body along to where the character is, within the next step, of `dt` [s]: call it after each
    /// walk. It then has the velocity of that way, with which it pushes, and stands still after the step.
    ///
    /// # Errors
    /// If the body was removed, `dt` is not the length of a step, or the way is too far for one: put the body
    /// of a character that was placed elsewhere there by [`World::set_pose`].
    pub fn follow(&self, world: &mut World, character: &Character, dt: f32) -> Result<(), Error> {
        let (_, rotation) = character.shape();
        world.move_kinematic_and_stop(self.body, character.position(), rotation, dt)
    }

    /// Gives the body the form that the character has now: it crouched or grew. Bodies of a shape of the
    /// caller's with another form get that of the character.
    ///
    /// # Errors
    /// If the body was removed, or the budget does not allow it.
    pub fn reshape(&self, world: &mut World, character: &Character) -> Result<(), Error> {
        let shapes: Vec<_> = world.shapes(self.body)?.collect();
        let geometry: Geometry = character.shape().0;
        shapes.into_iter().try_for_each(|shape| world.set_geometry(shape, geometry.clone()))
    }

    /// The body: for the filter of the character's own walks, and to tell who was hit.
    pub fn body(&self) -> BodyHandle {
        self.body
    }

    /// Removes the body.
    ///
    /// # Errors
    /// If it was removed already.
    pub fn remove(self, world: &mut World) -> Result<(), Error> {
        world.remove_body(self.body)
    }
}
