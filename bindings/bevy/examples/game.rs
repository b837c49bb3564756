//! A small game: a ball rolls through crates, collects cubes, and takes a lift to the last of them. Cubes and
//! the lift are sensors with observers. Here it has no window, a pilot plays it, and the end is asserted; in
//! a window the arrow keys play it.
//!
//!     cargo run --manifest-path bindings/bevy/Cargo.toml --example game
//!     cargo run --manifest-path bindings/bevy/window/Cargo.toml -- game

use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::prelude::*;
use std::time::Duration;

/// Where the ball is to go [m/s].
#[derive(Component, Default)]
pub struct Wish(pub Vec3);

/// A cube to collect, in the order in which the pilot goes for them.
#[derive(Component)]
struct Cube(usize);

#[derive(Component)]
struct Crate;

/// The lift, which rises once something is on it.
#[derive(Component, Default)]
struct Lift {
    is_called: bool,
}

#[derive(Resource, Default)]
struct Game {
    score: usize,
    crates_hit: usize,
    errors: usize,
    /// When the last cube was collected [s].
    won_at: Option<f32>,
}

const CUBES: [Vec3; 4] = [
    Vec3::new(4.0, 0.5, 0.0),
    Vec3::new(3.0, 0.5, 5.0),
    Vec3::new(-3.0, 0.5, 3.0),
    Vec3::new(10.5, 2.5, 0.0),
];

/// Height to which the lift rises, and that of the deck beside it [m].
const DECK: f32 = 2.0;

fn spawn(mut commands: Commands) {
    let at = Transform::from_xyz;
    commands.spawn((RigidBody::Static, Shape::plane()));
    commands.spawn((RigidBody::Static, Shape::cuboid(2.0, 0.5 * DECK, 2.0), at(10.0, 0.5 * DECK, 0.0)));
    for i in 0..12_u8 {
        let (row, level) = (f32::from(i % 4), f32::from(i / 4));
        let place = at(2.0, 0.25 + 0.5 * level, 0.5 * row - 0.75);
        commands.spawn((RigidBody::Dynamic, Crate, Shape::cuboid(0.25, 0.25, 0.25), Density(100.0), place));
    }
    for (place, position) in CUBES.into_iter().enumerate() {
        let cube = (RigidBody::Static, Shape::cuboid(0.2, 0.2, 0.2), Sensor, Cube(place));
        commands.spawn((cube, Transform::from_translation(position))).observe(collect);
    }
    let lift = (RigidBody::Kinematic, Shape::cuboid(1.5, 0.1, 1.5), Lift::default(), at(6.5, -0.1, 0.0));
    let lift = commands.spawn(lift).observe(call_lift).id();
    // It notices what is on its middle.
    commands.spawn((Shape::cuboid(0.3, 0.3, 0.3), Sensor, at(0.0, 0.5, 0.0), ChildOf(lift)));

    let ball = (RigidBody::Dynamic, Shape::sphere(0.5), ShapeMaterial::friction(0.8), ContactMessages);
    let hit = |hit: On<CollisionStart>, crates: Query<(), With<Crate>>, mut game: ResMut<Game>| {
        game.crates_hit += usize::from(crates.contains(hit.other_body));
    };
    commands.spawn((ball, Wish::default(), ConstantForce::default(), at(0.0, 0.5, 0.0))).observe(hit);
}

/// A cube that the ball enters is gone.
fn collect(
    entered: On<SensorStart>,
    balls: Query<(), With<Wish>>,
    time: Res<Time<Fixed>>,
    mut game: ResMut<Game>,
    mut commands: Commands,
) {
    if !balls.contains(entered.crossing.body) {
        return;
    }
    commands.entity(entered.entity).despawn();
    game.score += 1;
    if game.score == CUBES.len() {
        game.won_at = Some(time.elapsed_secs());
    }
}

/// The sensor is below the lift in the hierarchy: the event comes up to it.
fn call_lift(entered: On<SensorStart>, balls: Query<(), With<Wish>>, mut lifts: Query<&mut Lift>) {
    if let Ok(mut lift) = lifts.get_mut(entered.entity) {
        lift.is_called |= balls.contains(entered.crossing.body);
    }
}

fn raise(mut lifts: Query<(&mut Transform, &Lift)>, time: Res<Time<Fixed>>) {
    for (mut transform, _) in lifts.iter_mut().filter(|(_, lift)| lift.is_called) {
        transform.translation.y = (transform.translation.y + time.delta_secs()).min(DECK - 0.1);
    }
}

/// Plays the game: to the next cube, and for one that is higher to the middle of the lift first.
fn pilot(
    mut balls: Query<(&mut Wish, &Transform)>,
    cubes: Query<(&Cube, &Transform)>,
    lifts: Query<&Transform, With<Lift>>,
) {
    let Some((_, cube)) = cubes.iter().min_by_key(|(cube, _)| cube.0) else { return };
    for (mut wish, ball) in &mut balls {
        let is_above = cube.translation.y > ball.translation.y + 0.1;
        let aim = lifts.iter().next().filter(|_| is_above).unwrap_or(cube).translation;
        let way = (aim - ball.translation).with_y(0.0);
        wish.0 = (2.0 * way).clamp_length_max(3.0);
    }
}

/// A force that brings the ball to the velocity that is wished for.
fn roll(mut balls: Query<(Entity, &Wish, &Velocity, &mut ConstantForce)>, physics: Res<PhysicsWorld>) {
    for (entity, wish, velocity, mut force) in &mut balls {
        let mass = physics.body(entity).and_then(|body| physics.mass(body).ok()).unwrap_or_default();
        force.force = (4.0 * mass * (wish.0 - velocity.linear)).with_y(0.0);
    }
}

/// The game, for an app with Bevy's time and transforms and somebody who writes [`Wish`].
pub fn scene(app: &mut App) {
    app.add_plugins(BackstopPlugin::default()).init_resource::<Game>();
    app.add_systems(Startup, spawn).add_systems(FixedUpdate, (roll, raise));
    app.add_systems(Update, |mut errors: MessageReader<PhysicsError>, mut game: ResMut<Game>| {
        game.errors += errors.read().count();
    });
}

fn main() {
    let mut app = App::new();
    app.add_plugins((TimePlugin, TransformPlugin, scene)).add_systems(FixedUpdate, pilot.before(roll));
    app.insert_resource(Time::<Fixed>::from_hz(60.0));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 144.0)));
    while app.world().resource::<Game>().won_at.is_none() {
        app.update();
        assert!(app.world().resource::<Time<Fixed>>().elapsed_secs() < 60.0, "the pilot is lost");
    }
    let game = app.world().resource::<Game>();
    let won_at = game.won_at.unwrap_or_default();
    println!("{} cubes in {won_at:.1} s, {} contacts with crates", game.score, game.crates_hit);
    assert!(game.score == CUBES.len() && game.crates_hit >= 3 && game.errors == 0);
    let world = app.world_mut();
    let lift = world.query_filtered::<&PhysicsPose, With<Lift>>().single(world).expect("one").position;
    assert!((lift.y - f64::from(DECK - 0.1)).abs() < 0.01, "the lift is at {}", lift.y);
}
