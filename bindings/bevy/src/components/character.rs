//! Components of characters.

use crate::world::PhysicsWorld;
use crate::{PhysicsPose, Shape};
use backstop::{CharacterSettings, Geometry};
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;
use bevy_math::Vec3;
#[cfg(feature = "reflect")]
use bevy_reflect::std_traits::ReflectDefault;
use bevy_transform::components::Transform;

/// A character of the world: a capsule, or another convex shape, that walks as [`CharacterInput`] says,
/// climbs steps, is carried by what it stands on and pushes bodies. [`CharacterState`] says what came of it.
/// It is no body. Removing the component, or the entity, removes it.
///
/// It walks after each step, when bodies are where they will be shown, and its translation is interpolated as
/// those of bodies are. A translation that somebody else writes puts it there at once. Its rotation is the
/// game's, and turns the shape if it has one of its own; its scale means nothing.
///
/// With [`RigidBody::Kinematic`](crate::RigidBody) and shapes beside it or below, it has a body, which
/// follows it within the next step: for sensors, queries and other bodies. It does not see that body itself.
/// A [`ShapeFilter`](crate::ShapeFilter) on the entity says what it collides with, and a
/// [`GravityScale`](crate::GravityScale) how it falls.
#[derive(Component, Clone, Debug)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::TypePath, serde::Serialize, serde::Deserialize))]
#[require(Transform, PhysicsPose, CharacterInput, CharacterState)]
#[component(on_remove = character_removed)]
pub struct Character {
    /// Size, skin, slopes, steps, mass and strength.
    pub settings: CharacterSettings,
    /// A convex shape instead of the capsule of the settings.
    pub shape: Option<Geometry>,
    /// How fast the velocity across comes near the one that is wished for in the air [m/s²], at least zero.
    /// Default 10. On ground it is there at once.
    pub air_acceleration: f32,
}

impl Default for Character {
    fn default() -> Self {
        Character::new(CharacterSettings::default())
    }
}

impl Character {
    /// A character with settings.
    pub fn new(settings: CharacterSettings) -> Self {
        Character { settings, shape: None, air_acceleration: 10.0 }
    }
    /// With a convex shape instead of the capsule of the settings.
    #[must_use]
    pub fn with_shape(mut self, shape: impl Into<Shape>) -> Self {
        self.shape = Some(shape.into().0);
        self
    }
    /// With another acceleration in the air [m/s²]; infinity for full control.
    #[must_use]
    pub fn with_air_acceleration(mut self, acceleration: f32) -> Self {
        self.air_acceleration = acceleration;
        self
    }
}

/// What a [`Character`] is to do. Written by the game whenever it likes; it counts until it is changed.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
pub struct CharacterInput {
    /// Velocity that is wished for [m/s]: relative to the ground, in the air relative to the world. What of
    /// it is along `up` counts only with a [`GravityScale`](crate::GravityScale) of zero: then the character
    /// flies or swims, and has this velocity at once.
    pub velocity: Vec3,
    /// Speed at which it jumps off the ground in the next step, if it stands on any [m/s]. Zero again after
    /// each step.
    pub jump: f32,
}

impl CharacterInput {
    /// Walks so, and does not jump [m/s].
    pub fn walk(velocity: Vec3) -> Self {
        CharacterInput { velocity, jump: 0.0 }
    }
}

/// How a [`Character`] fared in the last step. Written by the plugin; only a change of `velocity` has an
/// effect.
#[derive(Component, Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
pub struct CharacterState {
    /// Velocity after obstacles [m/s]: relative to the ground if there is some, else in the world. What is
    /// added to it counts in the next step: upwards always, across in the air.
    pub velocity: Vec3,
    /// What it stands on; none in the air, and on surfaces that are too steep.
    pub ground: Option<CharacterGround>,
    /// What it ran into, in order, up to eight.
    pub touched: Vec<CharacterTouch>,
    /// The whole displacement [m].
    pub moved: Vec3,
    /// The part of it by moving ground [m].
    pub carried: Vec3,
    /// By how much the ground turned about `up` meanwhile [rad], to turn the character or its view.
    pub turned: f32,
    /// The part of it out of bodies that had moved into the character [m].
    pub pushed_out: Vec3,
    /// How far steps were climbed [m].
    pub stepped: f32,
    /// Remaining overlap of its shape [m]; above zero only if it is squeezed.
    pub overlap: f32,
}

impl CharacterState {
    /// Whether it stands on something.
    pub fn grounded(&self) -> bool {
        self.ground.is_some()
    }
}

/// What a [`Character`] stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect))]
pub struct CharacterGround {
    /// Entity of the body; none if it is not of the plugin.
    pub body: Option<Entity>,
    /// Entity of its shape.
    pub shape: Option<Entity>,
    /// Where transforms are [m].
    pub point: Vec3,
    /// Unit, out of the ground.
    pub normal: Vec3,
    /// How fast the ground moves there [m/s].
    pub velocity: Vec3,
}

/// What a [`Character`] ran into.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect))]
pub struct CharacterTouch {
    /// Entity of the body; none if it is not of the plugin.
    pub body: Option<Entity>,
    /// Entity of its shape.
    pub shape: Option<Entity>,
    /// Where transforms are [m].
    pub point: Vec3,
    /// Unit, towards the character.
    pub normal: Vec3,
    /// Impulse on a dynamic body, zero for others [N s].
    pub impulse: Vec3,
}

fn character_removed(mut world: DeferredWorld, context: HookContext) {
    if let Some(mut physics) = world.get_resource_mut::<PhysicsWorld>() {
        physics.remove_character_of(context.entity);
    }
}
