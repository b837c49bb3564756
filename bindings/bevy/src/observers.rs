//! What the last step did as events of the entities that it happened to, for observers; the messages with the
//! same content are in messages.rs.

use crate::messages::{Contact, ContactEnded, Crossing};
use bevy_ecs::prelude::*;

/// A shape with [`ContactMessages`](crate::ContactMessages) began to touch another: triggered on its entity,
/// and then on those above it, so that an observer of the body hears of all its shapes. If both shapes ask
/// for messages it is triggered on each of them. [`ContactBegan`](crate::ContactBegan) is the message.
///
/// ```
/// use backstop_bevy::prelude::*;
/// use bevy_ecs::prelude::*;
///
/// fn spawn(mut commands: Commands) {
///     commands
///         .spawn((RigidBody::Dynamic, Shape::sphere(0.5), ContactMessages))
///         .observe(|collision: On<CollisionStart>, mut commands: Commands| {
///             commands.entity(collision.other_body).despawn();
///         });
/// }
/// ```
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
#[entity_event(propagate, auto_propagate)]
pub struct CollisionStart {
    /// The entity that it is triggered on: first that of the shape.
    pub entity: Entity,
    /// Entity of the shape.
    pub shape: Entity,
    /// Entity of its body.
    pub body: Entity,
    /// Entity of the other shape.
    pub other: Entity,
    /// Entity of the other body.
    pub other_body: Entity,
    /// Point, normal, speed and impulse, as in the message.
    pub contact: Contact,
}

/// A shape with [`ContactMessages`](crate::ContactMessages) no longer touches another, or that is gone:
/// triggered as [`CollisionStart`] is, but on no shape that is gone itself. [`ContactEnded`] is the message.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq, Eq)]
#[entity_event(propagate, auto_propagate)]
pub struct CollisionEnd {
    /// The entity that it is triggered on: first that of the shape.
    pub entity: Entity,
    /// Entity of the shape.
    pub shape: Entity,
    /// Entity of its body.
    pub body: Entity,
    /// Entity of the other shape.
    pub other: Entity,
    /// Entity of the other body.
    pub other_body: Entity,
}

/// A shape entered a [`Sensor`](crate::Sensor): triggered on the entity of the sensor's shape, and then on
/// those above it. [`SensorEntered`](crate::SensorEntered) is the message.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
#[entity_event(propagate, auto_propagate)]
pub struct SensorStart {
    /// The entity that it is triggered on: first that of the sensor's shape.
    pub entity: Entity,
    /// What entered which sensor.
    pub crossing: Crossing,
}

/// A shape left a [`Sensor`](crate::Sensor), or is gone: triggered as [`SensorStart`] is.
/// [`SensorLeft`](crate::SensorLeft) is the message.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
#[entity_event(propagate, auto_propagate)]
pub struct SensorEnd {
    /// The entity that it is triggered on: first that of the sensor's shape.
    pub entity: Entity,
    /// What left which sensor.
    pub crossing: Crossing,
}

/// The two shapes in turn, those that ask for messages: shape, body, other shape and other body.
fn asking(shapes: [Entity; 2], bodies: [Entity; 2], asks: [bool; 2]) -> impl Iterator<Item = [Entity; 4]> {
    let turns = [[0, 1], [1, 0]].into_iter().filter(move |[own, _]| asks[*own]);
    turns.map(move |[own, other]| [shapes[own], bodies[own], shapes[other], bodies[other]])
}

/// Triggers the begin of a contact on the shapes that ask for messages.
pub(crate) fn start(commands: &mut Commands, contact: Contact, asks: [bool; 2]) {
    for [shape, body, other, other_body] in asking(contact.shapes, contact.bodies, asks) {
        commands.trigger(CollisionStart { entity: shape, shape, body, other, other_body, contact });
    }
}

/// Triggers the end of a contact on the shapes that ask for messages.
pub(crate) fn end(commands: &mut Commands, ended: ContactEnded, asks: [bool; 2]) {
    for [shape, body, other, other_body] in asking(ended.shapes, ended.bodies, asks) {
        commands.trigger(CollisionEnd { entity: shape, shape, body, other, other_body });
    }
}
