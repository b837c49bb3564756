//! A yard: crates fall, a chain hangs, a lift carries a crate, a character walks, a gate notices it. Without
//! a window here; everything ends within seconds and asserts what it shows.
//!
//!     cargo run --manifest-path bindings/bevy/Cargo.toml --example yard
//!     cargo run --manifest-path bindings/bevy/window/Cargo.toml -- yard

use backstop_bevy::backstop::Settings;
use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::prelude::*;
use std::time::Duration;

/// A lift that rises by a metre a second, up to 3 m.
#[derive(Component)]
struct Lift;

/// The end of the chain.
#[derive(Component)]
struct Lamp;

/// What the lift carries.
#[derive(Component)]
struct Cargo;

/// What was heard of.
#[derive(Resource, Default, Debug)]
struct Heard {
    hits: usize,
    visitors: Vec<Entity>,
    errors: usize,
    /// The hash of the world after each step.
    hashes: Vec<u64>,
}

fn spawn(mut commands: Commands) {
    let at = Transform::from_xyz;
    commands.spawn((RigidBody::Static, Shape::plane(), ContactMessages));
    for i in 0..20_u8 {
        let place = at(f32::from(i % 4) - 8.0, 1.0 + f32::from(i / 4), 0.2 * f32::from(i % 3));
        commands.spawn((RigidBody::Dynamic, Shape::cuboid(0.25, 0.25, 0.25), place));
    }
    // Five links of half a metre, and a lamp of a bulb and a shade.
    let mut above = commands.spawn((RigidBody::Static, at(0.0, 6.0, 0.0))).id();
    for i in 0..5_u8 {
        let y = 5.75 - 0.5 * f32::from(i);
        let link = commands.spawn((RigidBody::Dynamic, Shape::capsule(0.2, 0.03), at(0.0, y, 0.0))).id();
        commands.spawn(Joint::ball([above, link]).at(Vec3::new(0.0, y + 0.25, 0.0)));
        above = link;
    }
    let push = Velocity::linear(Vec3::new(2.0, 0.0, 0.0));
    let lamp = commands.spawn((RigidBody::Dynamic, Lamp, push, at(0.0, 3.25, 0.0))).id();
    commands.spawn((Shape::sphere(0.1), ChildOf(lamp)));
    commands.spawn((Shape::cylinder(0.05, 0.25), Density(300.0), at(0.0, 0.15, 0.0), ChildOf(lamp)));
    commands.spawn(Joint::fixed([above, lamp]).at(Vec3::new(0.0, 3.5, 0.0)));

    commands.spawn((RigidBody::Kinematic, Lift, Shape::cuboid(1.0, 0.1, 1.0), at(8.0, 0.1, 0.0)));
    commands.spawn((RigidBody::Dynamic, Cargo, Shape::cuboid(0.4, 0.4, 0.4), at(8.0, 0.6, 0.0)));

    // A character with a body, so that the gate notices it. It walks along x.
    let body = (RigidBody::Kinematic, Shape::capsule(0.6, 0.3));
    let walks = CharacterInput::walk(Vec3::new(1.5, 0.0, 0.0));
    commands.spawn((Character::default(), walks, body, at(-4.0, 1.0, 5.0)));
    commands.spawn((RigidBody::Static, Shape::cuboid(0.1, 2.0, 2.0), Sensor, at(0.0, 2.0, 5.0)));
}

fn lift(mut lifts: Query<&mut Transform, With<Lift>>, time: Res<Time<Fixed>>) {
    for mut transform in &mut lifts {
        transform.translation.y = (transform.translation.y + time.delta_secs()).min(3.1);
    }
}

fn hear(
    mut hits: MessageReader<ContactHit>,
    mut visitors: MessageReader<SensorEntered>,
    mut errors: MessageReader<PhysicsError>,
    mut heard: ResMut<Heard>,
) {
    heard.hits += hits.read().count();
    heard.visitors.extend(visitors.read().map(|message| message.0.body));
    heard.errors += errors.read().count();
}

fn note(physics: Res<PhysicsWorld>, mut heard: ResMut<Heard>) {
    heard.hashes.push(physics.state_hash());
}

/// The yard, for an app with Bevy's time and transforms.
pub fn scene(app: &mut App) {
    let settings = Settings::default().with_sleeping(true);
    app.add_plugins(BackstopPlugin::new(settings).expect("in range")).init_resource::<Heard>();
    app.add_systems(Startup, spawn).add_systems(FixedUpdate, lift);
    app.add_systems(FixedLast, note).add_systems(Update, hear);
}

/// The yard after six seconds, drawn at so many frames a second.
fn run(hz: f64) -> App {
    let mut app = App::new();
    app.add_plugins((TimePlugin, TransformPlugin, scene));
    app.insert_resource(Time::<Fixed>::from_hz(60.0));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / hz)));
    while app.world().resource::<Time<Fixed>>().elapsed_secs() < 6.0 {
        app.update();
    }
    app
}

fn main() {
    let mut app = run(144.0);
    let world = app.world_mut();
    let cargo = world.query_filtered::<&PhysicsPose, With<Cargo>>().single(world).expect("one").position;
    let lamp = world.query_filtered::<&PhysicsPose, With<Lamp>>().single(world).expect("one").position;
    let walker = world.query_filtered::<Entity, With<Character>>().single(world).expect("one");
    let (heard, physics) = (world.resource::<Heard>(), world.resource::<PhysicsWorld>());
    println!(
        "cargo at {cargo}, lamp at {lamp}, {} hits, {} asleep",
        heard.hits,
        physics.sleeping_body_count()
    );
    assert!((cargo.y - 3.6).abs() < 0.02 && (cargo.x - 8.0).abs() < 0.01, "it stands on the lift");
    let hook = bevy_math::DVec3::new(0.0, 6.0, 0.0);
    assert!((lamp - hook).length() < 2.76 && lamp.y < 4.0, "the chain holds");
    assert!(heard.hits >= 20 && heard.errors == 0, "every crate hits something");
    assert_eq!(heard.visitors, [walker], "the gate saw the character, once");
    assert!(physics.sleeping_body_count() >= 20, "crates lie still");

    // Frames of any length, the same world.
    let slow = run(30.0);
    assert_eq!(slow.world().resource::<Heard>().hashes[..360], heard.hashes[..360]);
}
