//! Components of bodies.

use crate::world::PhysicsWorld;
use backstop::{BodyKind, ContinuousMode, MassProperties, RowGroup};
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;
use bevy_math::{DVec3, Quat, Vec3};
#[cfg(feature = "reflect")]
use bevy_reflect::std_traits::ReflectDefault;
use bevy_transform::components::Transform;

/// A rigid body of the world. Its shapes are the [`Shape`](crate::Shape)s on its entity and on the entities
/// below it. Removing the component, or the entity, removes the body with its joints.
///
/// A dynamic body needs mass: a shape with density, or [`Mass`]. Without it the entity waits, and
/// [`PhysicsError`](crate::PhysicsError) says so once.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
#[require(Transform, PhysicsPose, Velocity, Sleeping)]
#[component(on_remove = body_removed)]
#[component(summary_tick)]
pub enum RigidBody {
    /// Nothing moves it but a change of its `Transform`, at once.
    Static,
    /// Moves to its `Transform` within a step, and pushes what is in the way and carries what stands on it;
    /// or moves with its [`Velocity`], if that is set instead.
    Kinematic,
    /// Forces and contacts move it. A change of its `Transform` puts it there at once.
    #[default]
    Dynamic,
}

impl From<RigidBody> for BodyKind {
    fn from(body: RigidBody) -> BodyKind {
        match body {
            RigidBody::Static => BodyKind::Static,
            RigidBody::Kinematic => BodyKind::Kinematic,
            RigidBody::Dynamic => BodyKind::Dynamic,
        }
    }
}

/// Where a body is after the last step, in `f64`: what the engine has, while its `Transform` may be between
/// the last two steps. Written by the plugin; a change of it has no effect.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
pub struct PhysicsPose {
    /// Its origin in the world [m].
    pub position: DVec3,
    /// How its axes are turned.
    pub rotation: Quat,
}

impl Default for PhysicsPose {
    fn default() -> Self {
        PhysicsPose { position: DVec3::ZERO, rotation: Quat::IDENTITY }
    }
}

/// Velocity of a body. Written after each step; a change of it sets the body's velocity before the next.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
pub struct Velocity {
    /// That of its centre of mass [m/s].
    pub linear: Vec3,
    /// About the world's axes [rad/s].
    pub angular: Vec3,
}

impl Velocity {
    /// Moves so, and does not turn [m/s].
    pub fn linear(linear: Vec3) -> Self {
        Velocity { linear, angular: Vec3::ZERO }
    }
    /// Turns so, about the world's axes [rad/s].
    pub fn angular(angular: Vec3) -> Self {
        Velocity { linear: Vec3::ZERO, angular }
    }
}

/// Whether a body is asleep. Written after each step; setting it puts the body's island to sleep or wakes it.
/// No body falls asleep unless [`Settings::sleeping`](backstop::Settings::sleeping) says so.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
#[component(summary_tick)]
pub struct Sleeping(pub bool);

/// Mass, centre of mass and inertia of a body, instead of those of its shapes.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::TypePath, serde::Serialize, serde::Deserialize))]
#[component(on_remove = trait_removed)]
pub struct Mass(pub MassProperties);

/// Factor on gravity; 1 without this.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone))]
#[component(on_remove = trait_removed)]
pub struct GravityScale(pub f32);

/// Rates at which a body loses its velocity [1/s]; zero without this.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone))]
#[component(on_remove = trait_removed)]
pub struct Damping {
    /// That of the linear velocity.
    pub linear: f32,
    /// That of the angular velocity.
    pub angular: f32,
}

/// Greatest speeds of a dynamic body after a step, whatever drives it; none without this.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
#[component(on_remove = trait_removed)]
pub struct MaxSpeeds {
    /// Of its centre of mass [m/s].
    pub linear: Option<f32>,
    /// [rad/s]
    pub angular: Option<f32>,
}

/// World axes along which a body can't move, and about which it can't turn.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone))]
#[component(on_remove = trait_removed)]
pub struct LockedAxes {
    /// x, y and z.
    pub translation: [bool; 3],
    /// x, y and z.
    pub rotation: [bool; 3],
}

/// How a body is kept from passing through others; [`ContinuousMode::Segment`] without this.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::TypePath, serde::Serialize, serde::Deserialize))]
#[component(on_remove = trait_removed)]
pub struct Continuous(pub ContinuousMode);

/// The group after which the rows of a body are solved:
/// [`BodyDesc::solved_after`](backstop::BodyDesc::solved_after).
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::TypePath, serde::Serialize, serde::Deserialize))]
#[component(on_remove = trait_removed)]
pub struct SolvedAfter(pub RowGroup);

/// A body that never falls asleep.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
#[component(on_remove = trait_removed)]
pub struct NeverSleeps;

/// A body that takes no part in the world, and keeps its place there.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
#[component(on_remove = trait_removed)]
pub struct BodyDisabled;

impl LockedAxes {
    /// It can move, and can't turn.
    pub const ROTATION: LockedAxes = LockedAxes { translation: [false; 3], rotation: [true; 3] };
}

/// A force and a torque that act on a dynamic body in every step, and keep it awake.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
pub struct ConstantForce {
    /// At the centre of mass [N].
    pub force: Vec3,
    /// About it, in world axes [N m].
    pub torque: Vec3,
}

/// A body or a character whose `Transform` is that of the last step, and not between the last two.
#[derive(Component, Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
pub struct NoInterpolation;

/// A body or a character whose `Transform` is ahead of the last step, where its velocity leads in the time
/// since, and not between the last two steps. It is drawn without the delay of a step, and goes back when
/// something stops it: [`BackstopPlugin::with_extrapolation`](crate::BackstopPlugin::with_extrapolation) for
/// all.
#[derive(Component, Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
pub struct Extrapolation;

fn body_removed(mut world: DeferredWorld, context: HookContext) {
    if let Some(mut physics) = world.get_resource_mut::<PhysicsWorld>() {
        physics.remove_body_of(context.entity);
    }
}

fn trait_removed(mut world: DeferredWorld, context: HookContext) {
    if let Some(mut physics) = world.get_resource_mut::<PhysicsWorld>() {
        physics.changed_bodies.push(context.entity);
    }
}
