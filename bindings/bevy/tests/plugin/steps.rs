//! A step in Bevy is a step of the engine, and what is drawn lies between two of them.

use crate::common::*;
use backstop_bevy::backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World, glam};
use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_time::{Fixed, Time};
use bevy_transform::components::{GlobalTransform, Transform};
use std::time::Duration;

/// A box that falls askew onto a floor and comes to rest there within three seconds. Expected: the bits of
/// the same calls to the engine.
#[test]
fn a_falling_box_has_the_bits_of_the_engine() {
    let mut app = app();
    floor(&mut app);
    let tilt = Quat::from_xyzw(0.1, 0.2, 0.3, 0.927_361_85);
    let body =
        (RigidBody::Dynamic, Shape::cuboid(0.3, 0.5, 0.2), Velocity::angular(Vec3::new(1.0, 2.0, 0.5)));
    let body = app.world_mut().spawn((body, Transform::from_xyz(0.0, 3.0, 0.0).with_rotation(tilt))).id();

    let mut world = World::new(Settings::default()).unwrap();
    let ground = ShapeDesc::new(Geometry::cuboid(20.0, 0.5, 20.0));
    world
        .add_body(&BodyDesc::fixed().with_position(glam::DVec3::new(0.0, -0.5, 0.0)).with_shape(ground))
        .unwrap();
    let same = BodyDesc::dynamic()
        .with_position(glam::DVec3::new(0.0, 3.0, 0.0))
        .with_rotation(tilt.to_engine())
        .with_velocity(glam::Vec3::ZERO, glam::Vec3::new(1.0, 2.0, 0.5))
        .with_shape(ShapeDesc::new(Geometry::cuboid(0.3, 0.5, 0.2)));
    let same = world.add_body(&same).unwrap();
    let dt = app.world().resource::<Time<Fixed>>().timestep().as_secs_f32();
    for step in 0..180 {
        app.update();
        world.step(dt).unwrap();
        assert_eq!(physics(&app).state_hash(), world.state_hash(), "step {step}");
        let pose = get::<PhysicsPose>(&app, body);
        assert_eq!(pose.position, world.position(same).unwrap().to_bevy());
        assert_eq!(pose.rotation, world.rotation(same).unwrap().to_bevy());
    }
    let rest = get::<Velocity>(&app, body);
    assert!(rest.linear.length() < 0.01 && rest.angular.length() < 0.01, "it lies on the floor: {rest:?}");
}

/// Expected: the same of two runs of one app, whatever the length of frames, at the same number of steps.
#[test]
fn frames_of_any_length_give_the_same_bits() {
    let run = |frame: Duration, frames: usize| {
        let mut app = app();
        floor(&mut app);
        for i in 0..5 {
            ball(&mut app, 2.0 + 1.1 * i as f32);
        }
        each_frame(&mut app, frame);
        let mut steps = Vec::new();
        app.insert_resource(Hashes(Vec::new()));
        app.add_systems(FixedLast, |physics: Res<PhysicsWorld>, mut all: ResMut<Hashes>| {
            all.0.push(physics.state_hash())
        });
        for _ in 0..frames {
            app.update();
        }
        steps.append(&mut app.world_mut().resource_mut::<Hashes>().0);
        steps.truncate(110);
        assert_eq!(steps.len(), 110);
        steps
    };
    let even = run(Duration::from_nanos(16_666_667), 120);
    assert_eq!(even, run(Duration::from_nanos(16_666_667), 120));
    assert_eq!(even, run(Duration::from_secs_f64(1.0 / 144.0), 288));
    assert_eq!(even, run(Duration::from_secs_f64(1.0 / 30.0), 60));
}

#[derive(Resource)]
struct Hashes(Vec<u64>);

/// A ball that moves at 6 m/s without gravity, drawn at 144 and 30 frames a second. Expected: it is drawn
/// where it was one step ago (6 m/s times the time of the frame less a step), so between the poses of the
/// last two steps, and moves by the same in each frame.
#[test]
fn drawn_poses_lie_between_steps() {
    for hz in [144.0, 30.0] {
        let mut app =
            app_with(BackstopPlugin::new(Settings::default().with_gravity(glam::Vec3::ZERO)).unwrap());
        let body = ball(&mut app, 0.0);
        app.world_mut().entity_mut(body).insert(Velocity::linear(Vec3::new(6.0, 0.0, 0.0)));
        let (frame, step) = (Duration::from_secs_f64(1.0 / hz), Duration::from_nanos(16_666_667));
        each_frame(&mut app, frame);
        for n in 1..=200_u32 {
            app.update();
            let drawn = get::<Transform>(&app, body).translation.x;
            let last = get::<PhysicsPose>(&app, body).position.x as f32;
            let time = (frame * n).saturating_sub(step).as_secs_f32();
            let expected = if frame * n < step { 0.0 } else { 6.0 * time };
            assert!((drawn - expected).abs() < 2e-4, "{hz} Hz, frame {n}: {drawn} and not {expected}");
            assert!(drawn <= last && drawn >= last - 0.1 - 1e-5, "{drawn} beside {last}");
            assert_eq!(
                get::<GlobalTransform>(&app, body).translation().x,
                drawn,
                "it is passed on to what is drawn"
            );
        }
    }
}

/// Expected: what is drawn is not read back, so that it is as if it were not there, to the bit; and while
/// steps run transforms are those of the last step.
#[test]
fn interpolation_changes_nothing() {
    let run = |plugin: BackstopPlugin| {
        let mut app = app_with(plugin);
        floor(&mut app);
        let body = ball(&mut app, 4.0);
        app.add_systems(
            FixedUpdate,
            |bodies: Query<(Entity, &Transform, &PhysicsPose)>, world: Res<PhysicsWorld>| {
                for (_, transform, pose) in bodies.iter().filter(|(body, ..)| world.body(*body).is_some()) {
                    assert_eq!(transform.translation, pose.position.as_vec3());
                }
            },
        );
        each_frame(&mut app, Duration::from_secs_f64(1.0 / 144.0));
        run(&mut app, 500);
        (physics(&app).state_hash(), get::<PhysicsPose>(&app, body))
    };
    assert_eq!(run(BackstopPlugin::default()), run(BackstopPlugin::default().without_interpolation()));
}

/// Expected: it is there at once, and keeps its velocity and what of its pose was not set.
#[test]
fn a_transform_that_is_set_teleports() {
    let mut app = app();
    let body = ball(&mut app, 100.0);
    app.world_mut().entity_mut(body).insert(Velocity::angular(Vec3::Y));
    run(&mut app, 30);
    let (before, turn) = (get::<Velocity>(&app, body), get::<PhysicsPose>(&app, body).rotation);
    app.world_mut().get_mut::<Transform>(body).unwrap().translation = Vec3::new(50.0, 20.0, 0.0);
    app.update();
    let pose = get::<PhysicsPose>(&app, body);
    let fallen = 9.81 / 60.0 / 60.0;
    assert_eq!(pose.position.x, 50.0);
    assert!((f64::from(before.linear.y) / 60.0 - (pose.position.y - 20.0)).abs() < 1.5 * fallen);
    assert!((turn.angle_between(pose.rotation) - 1.0 / 60.0).abs() < 1e-3, "its turn goes on");
    let drawn = get::<Transform>(&app, body).translation;
    assert!(drawn.x == 50.0 && drawn.y <= 20.0, "not drawn on the way there: {drawn}");
}

/// A body below an entity that is turned by a quarter about y, scaled by 2 and at x = 10. Expected: its place
/// in the world is that of its global transform, it falls along the world's y, and a parent that moves does
/// not carry it.
#[test]
fn parents_are_taken_off() {
    let mut app = app();
    let turned = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let above = Transform::from_xyz(10.0, 0.0, 0.0).with_rotation(turned).with_scale(Vec3::splat(2.0));
    let parent = app.world_mut().spawn(above).id();
    let parts = (RigidBody::Dynamic, Shape::sphere(0.5), Transform::from_xyz(0.0, 5.0, 1.0), ChildOf(parent));
    let body = app.world_mut().spawn(parts).id();
    run(&mut app, 60);
    let pose = get::<PhysicsPose>(&app, body).position;
    assert!((pose.x - 12.0).abs() < 1e-5 && pose.z.abs() < 1e-5, "local z is the world's x: {pose}");
    let fall = 0.5 * 9.81;
    assert!((pose.y - (10.0 - fall)).abs() < 0.1, "{pose}");
    let mass = physics(&app).mass(physics(&app).body(body).unwrap()).unwrap();
    assert!((mass - 1000.0 * 4.0 / 3.0 * std::f32::consts::PI).abs() < 1.0, "its radius is 1: {mass}");

    app.world_mut().get_mut::<Transform>(parent).unwrap().translation.x = -30.0;
    run(&mut app, 1);
    let global = get::<GlobalTransform>(&app, body).translation();
    assert!((global.x - 12.0).abs() < 1e-4, "{global}");
    assert!((get::<PhysicsPose>(&app, body).position.x - 12.0).abs() < 1e-5);
}

/// Far from the origin, with the world's origin there too. Expected: transforms are relative to it, as exact
/// as near zero, and follow when it moves.
#[test]
fn transforms_follow_the_origin() {
    let mut app = app();
    let far = glam::DVec3::new(1e8, 0.0, 0.0);
    app.world_mut().resource_mut::<PhysicsWorld>().set_origin(far).unwrap();
    let body = ball(&mut app, 10.0);
    run(&mut app, 10);
    assert_eq!(get::<PhysicsPose>(&app, body).position.x, 1e8);
    assert_eq!(get::<Transform>(&app, body).translation.x, 0.0);
    let next = far + glam::DVec3::new(0.25, 0.0, 0.0);
    app.world_mut().resource_mut::<PhysicsWorld>().set_origin(next).unwrap();
    run(&mut app, 2);
    assert_eq!(get::<PhysicsPose>(&app, body).position.x, 1e8);
    assert_eq!(get::<Transform>(&app, body).translation.x, -0.25);
}

/// Expected: the run after a snapshot gives the same bits again, and transforms are those of the snapshot.
#[test]
fn a_restored_world_is_shown() {
    let mut app = app();
    floor(&mut app);
    let body = ball(&mut app, 4.0);
    run(&mut app, 20);
    let mut saved = backstop_bevy::backstop::Snapshot::new();
    physics(&app).snapshot(&mut saved);
    run(&mut app, 60);
    let (hash, pose) = (physics(&app).state_hash(), get::<PhysicsPose>(&app, body));
    app.world_mut().resource_mut::<PhysicsWorld>().restore(&saved).unwrap();
    run(&mut app, 1);
    assert!(get::<Transform>(&app, body).translation.y > 3.0);
    run(&mut app, 59);
    assert_eq!((physics(&app).state_hash(), get::<PhysicsPose>(&app, body)), (hash, pose));
}

/// A box that flies and turns without gravity, its centre of mass beside its origin, drawn at 144 frames a
/// second with extrapolation. Expected: it is drawn ahead of the last step by velocity times the time since,
/// so where it is at the time of the frame, and turned by its angular velocity times that time; its centre of
/// mass on a straight line.
#[test]
fn extrapolation_is_ahead_by_the_velocity() {
    let settings = Settings::default().with_gravity(glam::Vec3::ZERO);
    for by_component in [false, true] {
        let plugin = BackstopPlugin::new(settings.clone()).unwrap();
        let mut app = app_with(if by_component { plugin } else { plugin.with_extrapolation() });
        let body = ball(&mut app, 0.0);
        let motion = Velocity { linear: Vec3::new(6.0, 0.0, 0.0), angular: Vec3::new(0.0, 2.0, 0.0) };
        app.world_mut().entity_mut(body).insert((motion, ShapeOffset::at(Vec3::X)));
        if by_component {
            app.world_mut().entity_mut(body).insert(Extrapolation);
        }
        let frame = Duration::from_secs_f64(1.0 / 144.0);
        each_frame(&mut app, frame);
        run(&mut app, 3);
        for n in 4..=200_u32 {
            app.update();
            let (drawn, time) = (get::<Transform>(&app, body), (frame * n).as_secs_f32());
            let angle = Quat::from_rotation_y(2.0 * time).angle_between(drawn.rotation);
            assert!(angle < 2e-3, "frame {n}: {angle} rad away");
            let centre = drawn.translation + drawn.rotation * Vec3::X;
            let expected = Vec3::new(1.0 + 6.0 * time, 0.0, 0.0);
            assert!((centre - expected).length() < 3e-3, "frame {n}: {centre} and not {expected}");
            let last = get::<PhysicsPose>(&app, body).position.as_vec3();
            assert!(app.world().resource::<Time<Fixed>>().overstep_fraction() < 1.0);
            assert!((drawn.translation - last).length() <= (6.0 + 2.0) / 60.0 + 1e-4);
        }
    }
}

/// Bodies of which most move, and commands that put them elsewhere or push them. Such commands are applied
/// just before a system of the plugin runs, and what they write then has its tick. Expected: each of them
/// counts within two frames, whichever schedule they come from, for bodies that move and for one that rests.
#[test]
fn what_commands_write_just_before_the_plugin_counts() {
    #[derive(Resource)]
    struct Orders(Vec<Entity>, f32);
    fn obey(mut commands: Commands, mut orders: ResMut<Orders>) {
        let z = orders.1;
        for (place, body) in std::mem::take(&mut orders.0).into_iter().enumerate() {
            let at = Transform::from_xyz(3.0 * place as f32, 50.0, z);
            commands.entity(body).insert((at, Velocity::linear(Vec3::X)));
        }
    }
    let at = |labels: usize, app: &mut App| match labels {
        0 => drop(app.add_systems(PreUpdate, obey)),
        1 => drop(app.add_systems(RunFixedMainLoop, obey.before(RunFixedMainLoopSystems::FixedMainLoop))),
        2 => drop(app.add_systems(FixedFirst, obey)),
        3 => drop(app.add_systems(FixedUpdate, obey)),
        4 => drop(app.add_systems(FixedPostUpdate, obey.before(PhysicsSystems::Prepare))),
        5 => drop(app.add_systems(FixedPostUpdate, obey.after(PhysicsSystems::Report))),
        _ => drop(app.add_systems(FixedLast, obey)),
    };
    for schedule in 0..7 {
        let mut app = app();
        app.insert_resource(Orders(Vec::new(), 0.0));
        at(schedule, &mut app);
        let bodies: Vec<Entity> = (0..8).map(|_| ball(&mut app, 30.0)).collect();
        for (place, &body) in bodies.iter().enumerate() {
            app.world_mut().get_mut::<Transform>(body).unwrap().translation.x = 3.0 * place as f32;
        }
        let rests = (RigidBody::Kinematic, Shape::sphere(0.5), Transform::from_xyz(0.0, 90.0, 0.0));
        let rests = app.world_mut().spawn(rests).id();
        run(&mut app, 5);
        for z in [4.0, 8.0] {
            let all = bodies.iter().copied().chain([rests]).collect();
            app.insert_resource(Orders(all, z));
            run(&mut app, 2);
            bodies.iter().for_each(|&body| {
                let (pose, velocity) = (get::<PhysicsPose>(&app, body), get::<Velocity>(&app, body));
                let found = (schedule, pose.position.z, velocity.linear.x);
                assert_eq!(found, (schedule, f64::from(z), 1.0), "it is put there and pushed");
            });
            run(&mut app, 1);
            assert_eq!(get::<PhysicsPose>(&app, rests).position.z, f64::from(z), "schedule {schedule}");
        }
    }
}
