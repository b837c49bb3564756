//! What the last step did, with entities. All are Bevy messages; a reader gets each once, in a fixed schedule
//! or in any other.

use backstop::Error;
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_math::Vec3;

/// Two shapes began to touch, of which one has [`ContactMessages`](crate::ContactMessages).
#[derive(Message, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Message))]
pub struct ContactBegan(pub Contact);

/// Two shapes hit each other at [`Settings::hit_speed`](backstop::Settings::hit_speed) or faster. One of them
/// has [`ContactMessages`](crate::ContactMessages).
#[derive(Message, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Message))]
pub struct ContactHit(pub Contact);

/// A contact that began or was an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect))]
pub struct Contact {
    /// Entities of the shapes.
    pub shapes: [Entity; 2],
    /// Entities of their bodies.
    pub bodies: [Entity; 2],
    /// Midway between the surfaces, where transforms are [m].
    pub point: Vec3,
    /// Unit, from the first shape to the second.
    pub normal: Vec3,
    /// Approach speed there before anything was solved [m/s]; negative if they separate.
    pub approach_speed: f32,
    /// Normal impulse of the whole step [N s].
    pub impulse: f32,
}

/// Two shapes no longer touch, or one of them is gone.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Message))]
pub struct ContactEnded {
    /// Entities of the shapes.
    pub shapes: [Entity; 2],
    /// Entities of their bodies.
    pub bodies: [Entity; 2],
}

/// A shape entered a [`Sensor`](crate::Sensor).
#[derive(Message, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Message))]
pub struct SensorEntered(pub Crossing);

/// A shape left a [`Sensor`](crate::Sensor), or is gone.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Message))]
pub struct SensorLeft(pub Crossing);

/// A shape that crossed the surface of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect))]
pub struct Crossing {
    /// Entity of the sensor's shape.
    pub sensor: Entity,
    /// Entity of the shape that crossed its surface.
    pub visitor: Entity,
    /// Entity of that shape's body.
    pub body: Entity,
    /// Time, as a fraction of the step.
    pub fraction: f32,
}

/// A joint broke.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Message))]
pub struct JointBroke {
    /// Its entity.
    pub joint: Entity,
}

/// A coupling broke.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Message))]
pub struct CouplingBroke {
    /// Its entity.
    pub coupling: Entity,
}

/// The load of a joint was above its thresholds in the last step.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Message))]
pub struct JointStrained {
    /// Its entity.
    pub joint: Entity,
    /// Its force on the second body, in world axes [N].
    pub force: Vec3,
    /// Its torque on the second body about the joint [N m].
    pub torque: Vec3,
}

/// A body woke.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Message))]
pub struct BodyWoke {
    /// Its entity.
    pub body: Entity,
}

/// A body fell asleep.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Message))]
pub struct BodyFellAsleep {
    /// Its entity.
    pub body: Entity,
}

/// Something that was asked for is refused. The world is as it was; what can't be made waits until its
/// components allow it, and is reported once. It is also logged.
#[derive(Message, Clone, Debug, PartialEq)]
pub struct PhysicsError {
    /// Whose component is not allowed; none if the step was refused.
    pub entity: Option<Entity>,
    /// Why.
    pub problem: Problem,
}

/// Why something is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// By the engine.
    #[error(transparent)]
    Engine(#[from] Error),
    /// A shape with no body on its entity or above it.
    #[error("there is no RigidBody on the entity of the shape or above it")]
    NoBodyAbove,
    /// A joint of an entity that is no body.
    #[error("the joint is of {0}, which is no body of the world")]
    NoBody(Entity),
    /// A coupling of an entity that is no joint.
    #[error("the coupling is of {0}, which is no joint of the world")]
    NoJoint(Entity),
    /// A character whose body is static or dynamic.
    #[error("the body of a character has to be kinematic")]
    NotKinematic,
    /// A mesh of which a `ShapeConstructor` can't make its shape.
    #[error("no shape can be made of the mesh: {0}")]
    Mesh(&'static str),
    /// A scale that the form of a shape can't have.
    #[error("a {shape} can't have the scale {scale}")]
    Scale {
        /// The kind of shape.
        shape: &'static str,
        /// By which it would be scaled.
        scale: Vec3,
    },
}

/// Writes all messages of a step.
#[derive(SystemParam)]
pub(crate) struct Writers<'w> {
    pub(crate) began: MessageWriter<'w, ContactBegan>,
    pub(crate) ended: MessageWriter<'w, ContactEnded>,
    pub(crate) hits: MessageWriter<'w, ContactHit>,
    pub(crate) entered: MessageWriter<'w, SensorEntered>,
    pub(crate) left: MessageWriter<'w, SensorLeft>,
    pub(crate) broke: MessageWriter<'w, JointBroke>,
    pub(crate) decoupled: MessageWriter<'w, CouplingBroke>,
    pub(crate) strained: MessageWriter<'w, JointStrained>,
    pub(crate) woke: MessageWriter<'w, BodyWoke>,
    pub(crate) slept: MessageWriter<'w, BodyFellAsleep>,
    pub(crate) errors: MessageWriter<'w, PhysicsError>,
}
