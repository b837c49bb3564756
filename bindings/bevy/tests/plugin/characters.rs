//! Characters walk as they do in the engine alone, and are shown where they are.

use crate::common::*;
use backstop_bevy::backstop::{
    self, BodyDesc, CharacterHandle, CharacterReport, CharacterSettings, Error, Geometry, QueryFilter,
    Settings, ShapeDesc, World, glam,
};
use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use std::time::Duration;

const DT: f32 = 1.0 / 60.0;

/// Half extents and places of boxes: a floor, five stairs of 0.2 m, a deck with a wall at its end.
fn boxes() -> Vec<(Vec3, Vec3)> {
    let mut all = vec![(Vec3::new(30.0, 0.5, 30.0), Vec3::new(0.0, -0.5, 0.0))];
    for i in 1..=5_u8 {
        let top = 0.2 * f32::from(i);
        let x = 2.0 + 0.4 * f32::from(i);
        all.push((Vec3::new(0.2, 0.5 * top, 1.0), Vec3::new(x, 0.5 * top, 0.0)));
    }
    all.push((Vec3::new(2.0, 0.5, 1.0), Vec3::new(6.2, 0.5, 0.0)));
    all.push((Vec3::new(0.1, 1.0, 1.0), Vec3::new(8.3, 2.0, 0.0)));
    all
}

/// A crate of 25 kg on the deck, and a lift beside it that moves off by 0.5 m/s along x.
const CRATE: (Vec3, Vec3, f32) = (Vec3::splat(0.25), Vec3::new(6.5, 1.25, 0.0), 200.0);
const LIFT: (Vec3, Vec3) = (Vec3::new(3.0, 0.1, 1.0), Vec3::new(7.0, 0.85, 2.1));
const LIFT_SPEED: Vec3 = Vec3::new(0.25, 0.05, 0.0);

/// What the game wants in a step: up the stairs and against the crate, which goes to the wall, off sideways
/// to the lift, there a jump, and a rest.
fn wish(step: u32) -> CharacterInput {
    let velocity = match step {
        0..240 => Vec3::new(3.0, 0.0, 0.0),
        240..300 => Vec3::new(0.0, 0.0, 2.0),
        _ => Vec3::ZERO,
    };
    CharacterInput { velocity, jump: if step == 400 { 3.0 } else { 0.0 } }
}

/// The engine alone: what docs/characters.md says, in the order of the plugin.
struct Alone {
    world: World,
    walker: CharacterHandle,
    report: CharacterReport,
}

impl Alone {
    fn new() -> Alone {
        let mut world = World::new(Settings::default()).unwrap();
        let cuboid = |half: Vec3| ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z));
        let at = |desc: BodyDesc, place: Vec3| desc.with_position(place.to_engine().as_dvec3());
        for (half, place) in boxes() {
            world.add_body(&at(BodyDesc::fixed(), place).with_shape(cuboid(half))).unwrap();
        }
        let (half, place, density) = CRATE;
        let shape = cuboid(half).with_density(density);
        world.add_body(&at(BodyDesc::dynamic(), place).with_shape(shape)).unwrap();
        let lift = at(BodyDesc::kinematic(), LIFT.1).with_shape(cuboid(LIFT.0));
        world.add_body(&lift.with_velocity(LIFT_SPEED.to_engine(), glam::Vec3::ZERO)).unwrap();
        let made = backstop::Character::new(CharacterSettings::default(), glam::DVec3::Y).unwrap();
        let walker = world.add_character(&made).unwrap();
        Alone { world, walker, report: CharacterReport::default() }
    }

    fn step(&mut self, input: &CharacterInput) {
        self.world.step(DT).unwrap();
        let (last, wish) = (self.report.velocity, input.velocity.to_engine());
        let fall = last.y - 9.81 * DT;
        let velocity = match self.report.ground {
            Some(_) if input.jump > 0.0 => wish.with_y(input.jump),
            Some(_) => wish.with_y(fall),
            None => {
                let across = last.with_y(0.0);
                let missing = wish - across;
                (across + missing.clamp_length_max(10.0 * DT)).with_y(fall)
            }
        };
        self.report = self.world.walk_character(self.walker, &QueryFilter::new(), velocity, DT).unwrap();
        self.report.push(&mut self.world).unwrap();
    }
}

/// Stairs, a crate that is pushed, a wall, a lift and a jump. Expected: the bits of the engine alone in each
/// of ten seconds' steps, and what the state says of it: stairs of a metre, the crate's entity, the lift's.
#[test]
fn a_character_walks_as_in_the_engine_alone() {
    let mut app = app();
    let cuboid = |half: Vec3| Shape::cuboid(half.x, half.y, half.z);
    for (half, place) in boxes() {
        app.world_mut().spawn((RigidBody::Static, cuboid(half), Transform::from_translation(place)));
    }
    let place = Transform::from_translation(CRATE.1);
    let shape = (cuboid(CRATE.0), Density(CRATE.2));
    let crate_ = app.world_mut().spawn((RigidBody::Dynamic, shape, place)).id();
    let place = Transform::from_translation(LIFT.1);
    let moves = Velocity::linear(LIFT_SPEED);
    let lift = app.world_mut().spawn((RigidBody::Kinematic, cuboid(LIFT.0), moves, place)).id();
    let start = Transform::from_xyz(0.0, 1.0, 0.0);
    let walker = app.world_mut().spawn((Character::default(), start)).id();

    let mut alone = Alone::new();
    let (mut climbed, mut pushed, mut lifted, mut flew) = (0.0, 0.0, Vec3::ZERO, 0);
    for step in 0..600 {
        app.world_mut().entity_mut(walker).insert(wish(step));
        app.update();
        alone.step(&wish(step));
        assert_eq!(physics(&app).state_hash(), alone.world.state_hash(), "step {step}");
        let state = get::<CharacterState>(&app, walker);
        assert_eq!(state.velocity, alone.report.velocity.to_bevy(), "step {step}");
        climbed += state.stepped;
        let hit = state.touched.iter().filter(|touch| touch.body == Some(crate_));
        pushed += hit.map(|touch| touch.impulse.length()).sum::<f32>();
        if state.ground.is_some_and(|ground| ground.body == Some(lift)) {
            lifted += state.carried;
        }
        flew += u32::from(step > 300 && !state.grounded());
    }
    let pose = get::<PhysicsPose>(&app, walker).position;
    assert_eq!(pose, alone.world.character(alone.walker).unwrap().position().to_bevy());
    assert!((0.5..1.01).contains(&climbed), "{climbed} m by steps");
    assert!(pushed > 10.0, "{pushed} N s");
    assert!(lifted.x > 0.9 && lifted.y > 0.15, "{lifted}");
    // 3 m/s up and down again at 9.81 m/s²: 0.61 s, less what the lift rose meanwhile.
    assert!((33..38).contains(&flew), "{flew} steps in the air");
    let crate_x = get::<PhysicsPose>(&app, crate_).position.x;
    assert!((crate_x - (8.2 - 0.25)).abs() < 0.05, "it lies at the wall: {crate_x}");
    assert!(get::<CharacterInput>(&app, walker).jump == 0.0);
}

/// On a platform that moves by 2 m/s, drawn at 144 frames a second. Expected: it is drawn in the same place
/// on it in every frame, since it walks after the step; the game turns it in every frame, and that stays.
#[test]
fn a_platform_carries_it_without_lag() {
    let mut app = app();
    let moves = Velocity::linear(Vec3::new(2.0, 0.5, 0.0));
    let platform = app.world_mut().spawn((RigidBody::Kinematic, Shape::cuboid(2.0, 0.1, 2.0), moves)).id();
    let start = Transform::from_xyz(0.5, 1.0, 0.0);
    let walker = app.world_mut().spawn((Character::default(), start)).id();
    app.add_systems(Update, |mut all: Query<&mut Transform, With<Character>>| {
        all.iter_mut().for_each(|mut transform| transform.rotate_y(0.01));
    });
    run(&mut app, 10);
    let between = |app: &App| {
        let at = |entity| get::<Transform>(app, entity).translation;
        at(walker) - at(platform)
    };
    let start = between(&app);
    each_frame(&mut app, Duration::from_secs_f64(1.0 / 144.0));
    let mut last = get::<Transform>(&app, walker);
    for frame in 0..432 {
        app.update();
        assert!((between(&app) - start).length() < 1e-4, "frame {frame}: {}", between(&app) - start);
        let now = get::<Transform>(&app, walker);
        if frame > 3 {
            let moved = now.translation.x - last.translation.x;
            assert!((moved - 2.0 / 144.0).abs() < 1e-4, "frame {frame}: {moved} m");
        }
        last = now;
    }
    let turned = Quat::from_rotation_y(4.42);
    assert!((last.rotation * turned.inverse()).w.abs() > 1.0 - 1e-4, "in 442 frames: {}", last.rotation);
    let ground = get::<CharacterState>(&app, walker).ground.expect("it stands on the platform");
    assert_eq!((ground.body, ground.shape), (Some(platform), Some(platform)));
    assert!((ground.velocity - Vec3::new(2.0, 0.5, 0.0)).length() < 1e-5 && ground.normal == Vec3::Y);
}

/// Expected: a translation that is written puts it there at once, with its body, and it is not drawn on the
/// way; nothing between is hit.
#[test]
fn a_translation_that_is_written_teleports() {
    let mut app = app();
    floor(&mut app);
    log::<ContactBegan>(&mut app);
    let wall = (RigidBody::Static, Shape::cuboid(0.1, 2.0, 5.0), ContactMessages);
    app.world_mut().spawn((wall, Transform::from_xyz(5.0, 2.0, 0.0)));
    let parts = (Character::default(), RigidBody::Kinematic, Shape::capsule(0.6, 0.3));
    let walker = app.world_mut().spawn((parts, Transform::from_xyz(0.0, 1.0, 0.0))).id();
    run(&mut app, 30);
    assert!(get::<CharacterState>(&app, walker).grounded());
    app.world_mut().get_mut::<Transform>(walker).unwrap().translation = Vec3::new(10.0, 3.0, 0.0);
    app.update();
    let drawn = get::<Transform>(&app, walker).translation;
    assert!(drawn.x == 10.0 && drawn.y <= 3.0 && drawn.y > 2.99, "{drawn}");
    assert!(!get::<CharacterState>(&app, walker).grounded());
    let body = physics(&app).body(walker).unwrap();
    assert_eq!(physics(&app).position(body).unwrap(), glam::DVec3::new(10.0, 3.0, 0.0));
    run(&mut app, 60);
    assert!((get::<PhysicsPose>(&app, walker).position.y - 0.92).abs() < 1e-3, "it has landed");
    assert_eq!(physics(&app).position(body).unwrap().x, 10.0);
    assert_eq!(logged::<ContactBegan>(&app), []);
}

/// A character with a body. Expected: a sensor hears its entity once when it walks in and once when it
/// leaves; the body is where it is, a step later; and it does not stand in its own way.
#[test]
fn its_body_is_seen() {
    let mut app = app();
    floor(&mut app);
    log::<SensorEntered>(&mut app);
    log::<SensorLeft>(&mut app);
    let gate = (RigidBody::Static, Shape::cuboid(0.2, 2.0, 2.0), Sensor);
    app.world_mut().spawn((gate, Transform::from_xyz(3.0, 2.0, 0.0)));
    let parts = (Character::default(), RigidBody::Kinematic, Shape::capsule(0.6, 0.3));
    let walks = CharacterInput::walk(Vec3::new(1.5, 0.0, 0.0));
    let walker = app.world_mut().spawn((parts, walks, Transform::from_xyz(0.0, 0.92, 0.0))).id();
    run(&mut app, 240);
    let entered: Vec<Entity> = logged::<SensorEntered>(&app).iter().map(|message| message.0.body).collect();
    assert_eq!(entered, [walker]);
    assert_eq!(logged::<SensorLeft>(&app).len(), 1);
    let pose = get::<PhysicsPose>(&app, walker).position;
    // In the first step it knows of no ground yet, and comes up to speed by 10 m/s².
    let late = (1.5 - 10.0 / 60.0) / 60.0;
    assert!((pose.x - (6.0 - late)).abs() < 1e-4, "{pose}");
    let body = physics(&app).body(walker).unwrap();
    let behind = pose.x - physics(&app).position(body).unwrap().x;
    assert!((behind - 1.5 / 60.0).abs() < 1e-5, "{behind}");
}

/// Expected: what can't be is refused with the engine's error, once; it walks as soon as it can; and it
/// leaves the world with its component or its entity.
#[test]
fn characters_come_and_go_with_their_component() {
    let mut app = app();
    floor(&mut app);
    log::<PhysicsError>(&mut app);
    let fat = CharacterSettings { radius: -1.0, ..CharacterSettings::default() };
    let start = Transform::from_xyz(0.0, 1.0, 0.0);
    let a = app.world_mut().spawn((Character::new(fat), start)).id();
    let flat = Character::default().with_shape(Shape::plane());
    let b = app.world_mut().spawn((flat, start)).id();
    let heavy = (Character::default(), RigidBody::Dynamic, Shape::sphere(0.3));
    let c = app.world_mut().spawn((heavy, Transform::from_xyz(5.0, 1.0, 0.0))).id();
    run(&mut app, 10);
    let errors = logged::<PhysicsError>(&app);
    let of = |entity: Entity| -> Vec<&Problem> {
        errors.iter().filter(|error| error.entity == Some(entity)).map(|error| &error.problem).collect()
    };
    assert!(matches!(of(a)[..], [Problem::Engine(Error::OutOfRange { what: "character radius", .. })]));
    assert_eq!(of(b).len(), 1, "a plane is not convex: {errors:?}");
    assert_eq!(of(c), [&Problem::NotKinematic]);
    assert_eq!(physics(&app).characters().count(), 1);

    app.world_mut().entity_mut(a).insert(Character::default());
    app.world_mut().entity_mut(b).despawn();
    app.world_mut().entity_mut(c).insert(RigidBody::Kinematic);
    app.world_mut().entity_mut(a).insert(CharacterInput::walk(Vec3::new(f32::NAN, 0.0, 0.0)));
    run(&mut app, 10);
    assert_eq!(logged::<PhysicsError>(&app).len(), errors.len() + 1, "a velocity that is none, once");
    app.world_mut().entity_mut(a).insert(CharacterInput::walk(Vec3::Z));
    run(&mut app, 60);
    assert!((get::<PhysicsPose>(&app, a).position.z - 1.0).abs() < 0.2);
    let handle = physics(&app).character_of(a).unwrap();
    assert_eq!(physics(&app).entity_of_character(handle), Some(a));
    let crouched = CharacterSettings { half_height: 0.2, ..CharacterSettings::default() };
    app.world_mut().entity_mut(a).insert(Character::new(crouched));
    run(&mut app, 60);
    assert_eq!(physics(&app).character_of(a), Some(handle), "it is the same character");
    assert!((get::<PhysicsPose>(&app, a).position.y - 0.52).abs() < 1e-3);

    app.world_mut().entity_mut(a).remove::<Character>();
    assert_eq!(physics(&app).characters().count(), 1);
    app.world_mut().despawn(c);
    assert_eq!((physics(&app).characters().count(), physics(&app).body_count()), (0, 1));
    run(&mut app, 5);
}

/// A box that is 2 m long and turned along its way. Expected: it fits between walls 1 m apart, as wide as it
/// is across; turned across by the game it is squeezed. After a snapshot, with its state put back, it walks
/// the same bits again, and is turned as it was.
#[test]
fn a_box_walks_turned_and_is_restored() {
    let mut app = app();
    floor(&mut app);
    for z in [-0.6, 0.6] {
        let wall = (RigidBody::Static, Shape::cuboid(3.0, 1.0, 0.1));
        app.world_mut().spawn((wall, Transform::from_xyz(4.0, 1.0, z)));
    }
    let long = Character::default().with_shape(Shape::cuboid(0.3, 0.5, 1.0));
    let walks = CharacterInput::walk(Vec3::new(2.0, 0.0, 0.0));
    let along = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let start = Transform::from_xyz(-1.0, 0.52, 0.0).with_rotation(along);
    let walker = app.world_mut().spawn((long, walks, start)).id();
    run(&mut app, 60);
    let mut saved = backstop::Snapshot::new();
    physics(&app).snapshot(&mut saved);
    let state = get::<CharacterState>(&app, walker);
    run(&mut app, 120);
    let (hash, pose) = (physics(&app).state_hash(), get::<PhysicsPose>(&app, walker));
    let late = (2.0 - 10.0 / 60.0) / 60.0;
    assert!((pose.position.x - (5.0 - late)).abs() < 1e-4, "{pose:?}");
    app.world_mut().get_mut::<Transform>(walker).unwrap().rotation = Quat::IDENTITY;
    run(&mut app, 1);
    let overlap = get::<CharacterState>(&app, walker).overlap;
    assert!((overlap - 0.5).abs() < 0.03, "half a metre of it is in each wall: {overlap}");

    app.world_mut().resource_mut::<PhysicsWorld>().restore(&saved).unwrap();
    app.world_mut().entity_mut(walker).insert(state);
    run(&mut app, 1);
    assert!(get::<Transform>(&app, walker).rotation.angle_between(along) < 1e-3);
    run(&mut app, 119);
    let again = get::<PhysicsPose>(&app, walker).position;
    assert_eq!((physics(&app).state_hash(), again), (hash, pose.position));
}
