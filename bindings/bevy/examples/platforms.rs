//! Platforms that let through what comes from below: a ball jumps from each to the next, up to the last.
//! Hooks that ask the app decide about contacts, an observer jumps, and what is drawn is ahead of the last
//! step. Without a window here, and the end is asserted.
//!
//!     cargo run --manifest-path bindings/bevy/Cargo.toml --example platforms
//!     cargo run --manifest-path bindings/bevy/window/Cargo.toml -- platforms

use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::prelude::*;
use std::time::Duration;

#[derive(Component)]
struct OneWay;

#[derive(Component)]
struct Jumper;

#[derive(Resource, Default)]
struct Jumps(usize);

/// Heights of the platforms' tops [m].
const TOPS: [f32; 3] = [2.0, 4.0, 6.0];

/// Contacts of one-way platforms count for what comes down on them alone.
#[derive(SystemParam)]
struct OneWays<'w, 's> {
    platforms: Query<'w, 's, (), With<OneWay>>,
    velocities: Query<'w, 's, &'static Velocity>,
}

impl CollisionHooks for OneWays<'_, '_> {
    fn contact(&self, contact: &mut HookedContact<'_, '_>) {
        let [Some(first), Some(second)] = contact.bodies() else { return };
        let (guest, up) = match (self.platforms.contains(first), self.platforms.contains(second)) {
            (true, false) => (second, contact.normal().y),
            (false, true) => (first, -contact.normal().y),
            _ => return,
        };
        let rises = self.velocities.get(guest).is_ok_and(|velocity| velocity.linear.y > 0.0);
        if rises || up < 0.5 {
            contact.veto();
        }
    }
}

fn spawn(mut commands: Commands) {
    commands.spawn((RigidBody::Static, Shape::plane()));
    for top in TOPS {
        let platform = (RigidBody::Static, Shape::cuboid(2.0, 0.1, 2.0), OneWay, ContactHooked);
        commands.spawn((platform, Transform::from_xyz(0.0, top - 0.1, 0.0)));
    }
    let ball = (RigidBody::Dynamic, Shape::sphere(0.3), ContactMessages, Jumper);
    commands.spawn((ball, Transform::from_xyz(0.0, 0.5, 0.0))).observe(jump);
}

/// Jumps 2.9 m high from what it lands on, unless that is the highest platform.
fn jump(landed: On<CollisionStart>, mut velocities: Query<&mut Velocity>, mut jumps: ResMut<Jumps>) {
    let is_at_top = landed.contact.point.y > TOPS[TOPS.len() - 1] - 0.1;
    if let Ok(mut velocity) = velocities.get_mut(landed.body)
        && !is_at_top
    {
        velocity.linear.y = 7.5;
        jumps.0 += 1;
    }
}

/// The platforms and the ball, for an app with Bevy's time and transforms.
pub fn scene(app: &mut App) {
    let plugin = BackstopPlugin::default().with_hooks::<OneWays>().with_extrapolation();
    app.add_plugins(plugin).init_resource::<Jumps>().add_systems(Startup, spawn);
}

fn main() {
    let mut app = App::new();
    app.add_plugins((TimePlugin, TransformPlugin, scene));
    app.insert_resource(Time::<Fixed>::from_hz(60.0));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 144.0)));
    let mut top = 0.0_f32;
    while app.world().resource::<Time<Fixed>>().elapsed_secs() < 8.0 {
        app.update();
        let world = app.world_mut();
        let drawn =
            world.query_filtered::<&Transform, With<Jumper>>().single(world).expect("one").translation;
        top = top.max(drawn.y);
    }
    let world = app.world_mut();
    let rest = world.query_filtered::<&PhysicsPose, With<Jumper>>().single(world).expect("one").position;
    let jumps = world.resource::<Jumps>().0;
    println!("{jumps} jumps, up to {top:.1} m, at rest at {rest}");
    assert!((3..=5).contains(&jumps), "{jumps} jumps");
    assert!((rest.y - 6.3).abs() < 0.02, "it is on the highest platform: {rest}");
}
