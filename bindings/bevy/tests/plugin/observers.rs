//! Events that are triggered on entities.

use crate::common::*;
use backstop_bevy::prelude::*;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;

/// What observers heard: what it was, where, and the other one.
#[derive(Resource, Default)]
struct Heard(Vec<(&'static str, Entity, Entity)>);

/// A ball with a shape on a child that asks for messages falls onto a floor that does not, and is then moved
/// away. Expected: observers of the ball's body and of its shape each hear of the floor, once; those of the
/// floor hear nothing; a global observer hears what both hear.
#[test]
fn collisions_are_triggered_on_entities() {
    let mut app = app();
    app.init_resource::<Heard>();
    let ground = floor(&mut app);
    let body = app.world_mut().spawn((RigidBody::Dynamic, Transform::from_xyz(0.0, 0.6, 0.0))).id();
    let shape = app.world_mut().spawn((Shape::sphere(0.5), ContactMessages, ChildOf(body))).id();
    for entity in [ground, body, shape] {
        app.world_mut().entity_mut(entity).observe(|on: On<CollisionStart>, mut heard: ResMut<Heard>| {
            heard.0.push(("start", on.entity, on.other));
        });
        app.world_mut().entity_mut(entity).observe(|on: On<CollisionEnd>, mut heard: ResMut<Heard>| {
            heard.0.push(("end", on.entity, on.other));
        });
    }
    app.world_mut().add_observer(|on: On<CollisionStart>, mut heard: ResMut<Heard>| {
        assert!(on.contact.bodies.contains(&on.body) && on.contact.point.y.abs() < 0.2);
        heard.0.push(("somewhere", on.shape, on.other_body));
    });
    run(&mut app, 60);
    let mut heard = std::mem::take(&mut app.world_mut().resource_mut::<Heard>().0);
    heard.retain(|(what, ..)| *what != "somewhere");
    assert_eq!(heard, [("start", shape, ground), ("start", body, ground)]);
    app.world_mut().get_mut::<Transform>(body).unwrap().translation.y = 50.0;
    run(&mut app, 2);
    assert_eq!(app.world().resource::<Heard>().0, [("end", shape, ground), ("end", body, ground)]);
}

/// A ball that falls through a sensor, and one that is despawned in it. Expected: the sensor hears of each
/// entering and leaving once; an observer may despawn what it hears of.
#[test]
fn sensors_are_triggered() {
    let mut app = app();
    app.init_resource::<Heard>();
    let gate = (RigidBody::Static, Shape::cuboid(1.0, 0.5, 1.0), Sensor, Transform::from_xyz(0.0, 2.0, 0.0));
    let gate = app.world_mut().spawn(gate).id();
    app.world_mut().entity_mut(gate).observe(|on: On<SensorStart>, mut heard: ResMut<Heard>| {
        heard.0.push(("in", on.entity, on.crossing.body));
    });
    app.world_mut().entity_mut(gate).observe(|on: On<SensorEnd>, mut heard: ResMut<Heard>| {
        heard.0.push(("out", on.entity, on.crossing.body));
    });
    let first = ball(&mut app, 4.0);
    run(&mut app, 120);
    assert_eq!(
        std::mem::take(&mut app.world_mut().resource_mut::<Heard>().0),
        [("in", gate, first), ("out", gate, first)]
    );

    let eats = |on: On<SensorStart>, mut commands: Commands| commands.entity(on.crossing.body).despawn();
    app.world_mut().entity_mut(gate).observe(eats);
    let second = ball(&mut app, 3.2);
    app.world_mut().entity_mut(second).insert(Velocity::linear(-Vec3::Y));
    run(&mut app, 30);
    assert!(app.world().get_entity(second).is_err(), "it is eaten");
    assert_eq!(app.world().resource::<Heard>().0, [("in", gate, second), ("out", gate, second)]);
}
