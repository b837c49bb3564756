//! Messages with entities, platforms, sleep and hooks.

use crate::common::*;
use backstop_bevy::backstop::{ContactHook, ContactHooks, Settings, glam};
use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_time::{Fixed, Time};
use bevy_transform::components::Transform;
use std::time::Duration;

/// A ball of 0.5 m that falls by 3 m onto a floor that reports. Expected: one hit, and the first begin, of
/// these two entities, at the speed of the fall, sqrt(2 g h) = 7.67 m/s; an end for each begin but the last,
/// and for that when the ball is despawned.
#[test]
fn contacts_name_entities() {
    let mut app = app();
    let ground = floor(&mut app);
    app.world_mut().entity_mut(ground).insert(ContactMessages);
    let body = ball(&mut app, 3.5);
    log::<ContactBegan>(&mut app);
    log::<ContactHit>(&mut app);
    log::<ContactEnded>(&mut app);
    run(&mut app, 120);
    let began = logged::<ContactBegan>(&app);
    let contact = began[0].0;
    assert_eq!((contact.bodies, contact.shapes), ([ground, body], [ground, body]));
    assert!(contact.point.y.abs() < 0.2 && contact.normal.y > 0.99, "{contact:?}");
    let hits = logged::<ContactHit>(&app);
    assert_eq!(hits.len(), 1);
    assert_eq!(hits[0].0, contact);
    assert!((contact.approach_speed - (2.0_f32 * 9.81 * 3.0).sqrt()).abs() < 0.2, "{contact:?}");
    let ends = began.len() - 1;
    assert_eq!(logged::<ContactEnded>(&app).len(), ends);
    app.world_mut().despawn(body);
    run(&mut app, 2);
    let ended = ContactEnded { shapes: [ground, body], bodies: [ground, body] };
    assert_eq!(logged::<ContactEnded>(&app)[ends..], [ended]);
}

/// A ball that flies at 500 m/s through a sensor of 10 cm, on a child of a body. Expected: it enters and
/// leaves within one step, and both messages name the sensor's own entity, the ball's shape and its body.
#[test]
fn sensors_name_entities() {
    let mut app = app();
    log::<SensorEntered>(&mut app);
    log::<SensorLeft>(&mut app);
    let gate = app.world_mut().spawn((RigidBody::Static, Transform::from_xyz(20.0, 0.0, 0.0))).id();
    let sensor = app.world_mut().spawn((Shape::cuboid(0.05, 2.0, 2.0), Sensor, ChildOf(gate))).id();
    let flying = Velocity::linear(Vec3::new(500.0, 0.0, 0.0));
    let body = app.world_mut().spawn((RigidBody::Dynamic, flying)).id();
    let shape = app.world_mut().spawn((Shape::sphere(0.1), ChildOf(body))).id();
    run(&mut app, 10);
    let entered = logged::<SensorEntered>(&app);
    assert_eq!(entered.len(), 1);
    assert_eq!((entered[0].0.sensor, entered[0].0.visitor, entered[0].0.body), (sensor, shape, body));
    let left = logged::<SensorLeft>(&app);
    assert_eq!((left.len(), left[0].0.sensor, left[0].0.visitor), (1, sensor, shape));
    assert!(get::<PhysicsPose>(&app, body).position.x > 60.0, "nothing stopped it");
}

/// A gate that hangs in the air, and one with its lower half in static ground. Expected: only a gate that
/// also senses what is static enters it, once, and leaves when it is asked no more.
#[test]
fn sensors_of_what_is_static_are_asked_for() {
    let mut app = app();
    log::<SensorEntered>(&mut app);
    log::<SensorLeft>(&mut app);
    let slab = (RigidBody::Static, Shape::cuboid(5.0, 0.5, 5.0));
    let ground = app.world_mut().spawn((slab, Transform::from_xyz(0.0, -0.5, 0.0))).id();
    let gate = (RigidBody::Static, Shape::cuboid(0.5, 0.5, 0.5), Sensor);
    app.world_mut().spawn(gate.clone());
    let asked = app.world_mut().spawn((gate.clone(), SensesStatic)).id();
    app.world_mut().spawn((gate, SensesStatic, Transform::from_xyz(0.0, 5.0, 0.0)));
    run(&mut app, 5);
    let entered = logged::<SensorEntered>(&app);
    assert_eq!(entered.len(), 1);
    assert_eq!((entered[0].0.sensor, entered[0].0.visitor), (asked, ground));
    assert!(logged::<SensorLeft>(&app).is_empty());
    app.world_mut().entity_mut(asked).remove::<SensesStatic>();
    run(&mut app, 2);
    assert_eq!(logged::<SensorLeft>(&app).len(), 1);
}

/// A platform that goes 2 m/s along x by its transform, and a box on it with friction 1. Expected: after the
/// start the box goes as fast and stays where it is on the platform; and the platform is where its transform
/// was set, to the bit, and stops when nobody moves it.
#[test]
fn a_platform_carries() {
    let mut app = app();
    let slab = (RigidBody::Kinematic, Shape::cuboid(3.0, 0.5, 3.0), ShapeMaterial::friction(1.0));
    let platform = app.world_mut().spawn((slab, Transform::from_xyz(0.0, -0.5, 0.0), Platform)).id();
    let cargo = (RigidBody::Dynamic, Shape::cuboid(0.5, 0.5, 0.5), ShapeMaterial::friction(1.0));
    let cargo = app.world_mut().spawn((cargo, Transform::from_xyz(0.0, 0.5, 0.0))).id();
    run(&mut app, 30);
    app.add_systems(
        FixedUpdate,
        |mut platforms: Query<&mut Transform, With<Platform>>, time: Res<Time<Fixed>>| {
            for mut transform in &mut platforms {
                transform.translation.x += 2.0 * time.delta_secs();
            }
        },
    );
    each_frame(&mut app, Duration::from_secs_f64(1.0 / 144.0));
    run(&mut app, 144);
    let between =
        |app: &App| get::<PhysicsPose>(app, cargo).position.x - get::<PhysicsPose>(app, platform).position.x;
    let before = between(&app);
    assert!((get::<Velocity>(&app, cargo).linear.x - 2.0).abs() < 0.01);
    assert!((get::<Velocity>(&app, platform).linear.x - 2.0).abs() < 1e-3);
    run(&mut app, 144);
    assert!((between(&app) - before).abs() < 0.01, "it slid from {before} to {}", between(&app));
    assert!((get::<PhysicsPose>(&app, platform).position.x - 4.0).abs() < 0.05);

    app.world_mut().entity_mut(platform).remove::<Platform>();
    run(&mut app, 144);
    let rests = get::<PhysicsPose>(&app, platform);
    assert_eq!(get::<Velocity>(&app, platform), Velocity::default());
    assert_eq!(get::<Transform>(&app, platform).translation, rests.position.as_vec3());
    run(&mut app, 144);
    assert_eq!(get::<PhysicsPose>(&app, platform), rests);
    let elsewhere = bevy_math::DVec3::new(50.0, 3.0, 0.0);
    app.world_mut().resource_mut::<PhysicsWorld>().teleport(platform, elsewhere, rests.rotation).unwrap();
    run(&mut app, 3);
    assert_eq!(get::<PhysicsPose>(&app, platform).position, elsewhere);
    assert_eq!(get::<Transform>(&app, platform).translation, elsewhere.as_vec3());
    assert_eq!(get::<Velocity>(&app, platform), Velocity::default(), "put there, not moved");
}

#[derive(Component)]
struct Platform;

/// A kinematic body with a velocity and no changes of its transform. Expected: it goes on with it.
#[test]
fn a_kinematic_body_goes_with_its_velocity() {
    let mut app = app();
    let body = (RigidBody::Kinematic, Shape::sphere(0.5), Velocity::linear(Vec3::new(0.0, 3.0, 0.0)));
    let body = app.world_mut().spawn(body).id();
    run(&mut app, 60);
    assert!((get::<PhysicsPose>(&app, body).position.y - 3.0).abs() < 1e-4);
}

/// A ball that hangs below another, static one, by a joint that bears half of its weight. Expected: the joint
/// breaks, once; one that bears twice the weight and reports more than half of it does so in each step.
#[test]
fn joints_break_and_strain() {
    let mut app = app();
    log::<JointBroke>(&mut app);
    log::<JointStrained>(&mut app);
    let mut hang = |x: f32, change: &dyn Fn(Joint) -> Joint| {
        let at = |y: f32| Transform::from_xyz(x, y, 0.0);
        let hook = app.world_mut().spawn((RigidBody::Static, at(10.0))).id();
        let load = app.world_mut().spawn((RigidBody::Dynamic, Shape::sphere(0.1), at(9.0))).id();
        let joint = Joint::ball([hook, load]).at(Vec3::new(x, 10.0, 0.0));
        app.world_mut().spawn(change(joint)).id()
    };
    let weight = 1000.0 * 4.0 / 3.0 * std::f32::consts::PI * 0.001 * 9.81;
    let weak = hang(0.0, &|joint| joint.with_break_force(0.5 * weight, f32::INFINITY));
    let strong = hang(5.0, &|joint| joint.with_thresholds(0.5 * weight, f32::INFINITY));
    run(&mut app, 60);
    assert_eq!(logged::<JointBroke>(&app), [JointBroke { joint: weak }]);
    assert_eq!((physics(&app).joint(weak), physics(&app).joint_count()), (None, 1));
    let strained = logged::<JointStrained>(&app);
    assert!(strained.len() >= 55 && strained.iter().all(|message| message.joint == strong));
    assert!((strained[50].force.length() / weight - 1.0).abs() < 0.02, "{:?}", strained[50]);
}

/// Expected: a box at rest falls asleep, which its component and one message say; setting the component
/// wakes it, which another says; a force moves it.
#[test]
fn bodies_fall_asleep_and_wake() {
    let mut app = app_with(BackstopPlugin::new(Settings::default().with_sleeping(true)).unwrap());
    floor(&mut app);
    let at = Transform::from_xyz(0.0, 0.5, 0.0);
    let body = app.world_mut().spawn((RigidBody::Dynamic, Shape::cuboid(0.5, 0.5, 0.5), at)).id();
    log::<BodyFellAsleep>(&mut app);
    log::<BodyWoke>(&mut app);
    run(&mut app, 120);
    assert_eq!(logged::<BodyFellAsleep>(&app), [BodyFellAsleep { body }]);
    assert!(get::<Sleeping>(&app, body).0 && logged::<BodyWoke>(&app).is_empty());
    app.world_mut().entity_mut(body).insert(Sleeping(false));
    run(&mut app, 2);
    assert_eq!(logged::<BodyWoke>(&app), [BodyWoke { body }]);
    assert!(!get::<Sleeping>(&app, body).0);
    run(&mut app, 120);
    assert!(get::<Sleeping>(&app, body).0, "asleep again");
    let force = ConstantForce { force: Vec3::new(0.0, 30_000.0, 0.0), torque: Vec3::ZERO };
    app.world_mut().entity_mut(body).insert(force);
    run(&mut app, 60);
    // 1000 kg, so 30 m/s² less gravity.
    assert!((get::<Velocity>(&app, body).linear.y - (30.0 - 9.81)).abs() < 0.5);
    app.world_mut().entity_mut(body).insert(Sleeping(true));
    run(&mut app, 2);
    assert_eq!(logged::<BodyFellAsleep>(&app).len(), 2);
}

struct Nothing;

impl ContactHooks for Nothing {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        let known = contact.user_data().map(|bits| Entity::try_from_bits(bits).is_some());
        if known == [true, true] {
            contact.veto();
        }
    }
}

/// Expected: hooks that veto let a ball fall through a floor.
#[test]
fn hooks_see_contacts() {
    let mut app = app();
    floor(&mut app);
    app.insert_resource(PhysicsHooks(Box::new(Nothing)));
    let body = ball(&mut app, 2.0);
    app.world_mut().entity_mut(body).insert(ContactHooked);
    run(&mut app, 120);
    assert!(get::<PhysicsPose>(&app, body).position.y < -5.0);
}

/// Expected: a world in a schedule of the game's own takes steps of its own length there, and no others.
#[test]
fn a_schedule_of_the_game_runs_the_world() {
    let plugin = BackstopPlugin::default().in_schedule(Update).with_step(0.01).without_interpolation();
    let mut app = app_with(plugin);
    app.world_mut()
        .resource_mut::<PhysicsWorld>()
        .set_settings(Settings::default().with_gravity(glam::Vec3::ZERO))
        .unwrap();
    let body = ball(&mut app, 0.0);
    app.world_mut().entity_mut(body).insert(Velocity::linear(Vec3::X));
    each_frame(&mut app, Duration::from_millis(3));
    run(&mut app, 100);
    assert!((get::<Transform>(&app, body).translation.x - 1.0).abs() < 1e-4);
}

/// A platform that moves by its transform and becomes dynamic. Expected: it flies on at its speed, and a
/// joint that broke holds again in a world that was restored.
#[test]
fn what_was_is_not_held_against_it() {
    let mut app = app();
    let body = (RigidBody::Kinematic, Shape::sphere(0.5), Platform, GravityScale(0.0));
    let body = app.world_mut().spawn(body).id();
    app.add_systems(FixedUpdate, |mut platforms: Query<&mut Transform, With<Platform>>| {
        for mut transform in &mut platforms {
            transform.translation.x += 0.1;
        }
    });
    run(&mut app, 10);
    app.world_mut().entity_mut(body).remove::<Platform>().insert(RigidBody::Dynamic);
    run(&mut app, 10);
    assert!((get::<Velocity>(&app, body).linear.x - 6.0).abs() < 1e-3);

    let hook = app.world_mut().spawn((RigidBody::Static, Transform::from_xyz(0.0, 10.0, 0.0))).id();
    let load = ball(&mut app, 9.0);
    let joint = Joint::ball([hook, load]).at(Vec3::new(0.0, 10.0, 0.0)).with_break_force(1e6, f32::INFINITY);
    let joint = app.world_mut().spawn(joint).id();
    run(&mut app, 10);
    let mut saved = backstop_bevy::backstop::Snapshot::new();
    physics(&app).snapshot(&mut saved);
    let held = physics(&app).joint(joint);
    let weak = held.expect("it holds");
    app.world_mut().resource_mut::<PhysicsWorld>().set_joint_break_force(weak, 1.0, 1.0).unwrap();
    run(&mut app, 30);
    assert_eq!(physics(&app).joint(joint), None);
    app.world_mut().resource_mut::<PhysicsWorld>().restore(&saved).unwrap();
    assert_eq!(physics(&app).joint(joint), held);
    run(&mut app, 60);
    assert!((get::<PhysicsPose>(&app, load).position.y - 9.0).abs() < 0.01);
}
