//! What the plugin adds to a step: boxes in an app and in the engine alone, which take the same steps in
//! turn. Prints medians of 300 steps while all fall, and of 300 when all lie in piles, awake; and the tenth
//! fastest of a hundred, which a machine with other work disturbs less.
//!
//!     cargo run --release --manifest-path bindings/bevy/Cargo.toml --example cost

use backstop_bevy::backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World, glam};
use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_math::Vec3;
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::prelude::*;
use std::time::{Duration, Instant};

/// Where boxes start: in stacks of ten, 3 m apart.
fn places(count: u16) -> impl Iterator<Item = Vec3> {
    let across = (f32::from(count) / 10.0).sqrt().ceil() as u16;
    (0..count).map(move |i| {
        let (stack, level) = (i / 10, i % 10);
        let (row, column) = (stack / across, stack % across);
        Vec3::new(3.0 * f32::from(row), 150.0 + 1.1 * f32::from(level), 3.0 * f32::from(column))
    })
}

fn app(count: u16) -> App {
    let mut app = App::new();
    app.add_plugins((TimePlugin, TransformPlugin, BackstopPlugin::default()));
    app.insert_resource(Time::<Fixed>::from_hz(60.0));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    app.update();
    let step = app.world().resource::<Time<Fixed>>().timestep();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
    app.world_mut().spawn((RigidBody::Static, Shape::plane()));
    for place in places(count) {
        let at = Transform::from_translation(place);
        app.world_mut().spawn((RigidBody::Dynamic, Shape::cuboid(0.5, 0.5, 0.5), at));
    }
    app
}

fn alone(count: u16) -> Result<World, backstop_bevy::backstop::Error> {
    let mut world = World::new(Settings::default())?;
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    for place in places(count) {
        let desc = BodyDesc::dynamic().with_position(place.to_engine().as_dvec3());
        let shape = ShapeDesc::new(Geometry::Box { half_extents: glam::Vec3::splat(0.5) });
        world.add_body(&desc.with_shape(shape))?;
    }
    Ok(world)
}

/// The times that half and a tenth of all are below.
fn ranked(mut times: Vec<f64>) -> [f64; 2] {
    times.sort_by(f64::total_cmp);
    [times[times.len() / 2], times[times.len() / 10]]
}

fn main() -> Result<(), backstop_bevy::backstop::Error> {
    println!("bodies  phase    time    engine [ms]  frame [ms]  added");
    for count in [1000_u16, 4000] {
        let (mut app, mut alone) = (app(count), alone(count)?);
        for (phase, skip) in [("falling", 10), ("resting", 600)] {
            let mut times = [Vec::new(), Vec::new()];
            for step in 0..skip + 300 {
                let start = Instant::now();
                alone.step(1.0 / 60.0)?;
                let engine = start.elapsed();
                let start = Instant::now();
                app.update();
                let frame = start.elapsed();
                if step >= skip {
                    times[0].push(1e3 * engine.as_secs_f64());
                    times[1].push(1e3 * frame.as_secs_f64());
                }
            }
            assert_eq!(app.world().resource::<PhysicsWorld>().state_hash(), alone.state_hash());
            let [engine, frame] = times.map(ranked);
            for (place, name) in ["median", "tenth "].into_iter().enumerate() {
                let (engine, frame) = (engine[place], frame[place]);
                let added = 100.0 * (frame / engine - 1.0);
                println!("{count:6}  {phase}  {name}  {engine:11.3}  {frame:10.3}  {added:4.1} %");
            }
        }
    }
    Ok(())
}
