//! What the plugin adds to a step: boxes in an app and in the engine alone, which take the same steps in
//! turn. Beside it what Bevy itself adds, in an app that has the same entities and moves their transforms.
//! Prints medians of 300 steps, and the tenth fastest of a hundred, which a machine with other work disturbs
//! less.
//!
//!     cargo run --release --manifest-path bindings/bevy/Cargo.toml --example cost

use backstop_bevy::backstop::{BodyDesc, Error, Geometry, Settings, ShapeDesc, World, glam};
use backstop_bevy::prelude::*;
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::prelude::*;
use std::time::{Duration, Instant};

/// Boxes of a scene: how many, in stacks how high and how far apart, and from how high they fall [m].
struct Scene {
    name: &'static str,
    count: u16,
    stack: u16,
    apart: f32,
    height: f32,
    /// Whether bodies may fall asleep.
    sleeps: bool,
    /// Steps before those that are timed.
    skip: u32,
}

const SCENES: [Scene; 4] = [
    Scene { name: "falling", count: 1000, stack: 10, apart: 3.0, height: 150.0, sleeps: false, skip: 10 },
    Scene {
        name: "stacks, awake",
        count: 1000,
        stack: 10,
        apart: 3.0,
        height: 0.55,
        sleeps: false,
        skip: 600,
    },
    Scene { name: "pile, awake", count: 5000, stack: 50, apart: 1.3, height: 0.55, sleeps: false, skip: 600 },
    Scene {
        name: "stacks, asleep",
        count: 5000,
        stack: 2,
        apart: 3.0,
        height: 0.55,
        sleeps: true,
        skip: 600,
    },
];

impl Scene {
    fn places(&self) -> impl Iterator<Item = Vec3> {
        let across = (f32::from(self.count) / f32::from(self.stack)).sqrt().ceil() as u16;
        (0..self.count).map(move |i| {
            let (stack, level) = (i / self.stack, i % self.stack);
            let (row, column) = (stack / across, stack % across);
            let y = self.height + 1.1 * f32::from(level);
            Vec3::new(self.apart * f32::from(row), y, self.apart * f32::from(column))
        })
    }

    fn settings(&self) -> Settings {
        Settings::default().with_sleeping(self.sleeps)
    }

    fn app(&self) -> Result<App, Error> {
        let mut app = clocked();
        app.add_plugins(BackstopPlugin::new(self.settings())?);
        app.world_mut().spawn((RigidBody::Static, Shape::plane()));
        for place in self.places() {
            let at = Transform::from_translation(place);
            app.world_mut().spawn((RigidBody::Dynamic, Shape::cuboid(0.5, 0.5, 0.5), at));
        }
        Ok(app)
    }

    fn engine(&self) -> Result<World, Error> {
        let mut world = World::new(self.settings())?;
        world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
        for place in self.places() {
            let desc = BodyDesc::dynamic().with_position(place.to_engine().as_dvec3());
            let shape = ShapeDesc::new(Geometry::Box { half_extents: glam::Vec3::splat(0.5) });
            world.add_body(&desc.with_shape(shape))?;
        }
        Ok(world)
    }

    /// An app without physics whose entities move, if those of the scene do.
    fn bevy(&self) -> App {
        let mut app = clocked();
        for place in self.places() {
            app.world_mut().spawn(Transform::from_translation(place));
        }
        if !self.sleeps {
            app.add_systems(Update, |mut all: Query<&mut Transform>| {
                all.iter_mut().for_each(|mut transform| transform.translation.y += 0.01);
            });
        }
        app
    }

    /// Times of the engine, of the app's frame and of Bevy's own, in turn [ms].
    fn times(&self) -> Result<[Vec<f64>; 3], Error> {
        let (mut engine, mut app, mut bevy) = (self.engine()?, self.app()?, self.bevy());
        let mut times = [Vec::new(), Vec::new(), Vec::new()];
        for step in 0..self.skip + 300 {
            let start = Instant::now();
            engine.step(1.0 / 60.0)?;
            let stepped = Instant::now();
            app.update();
            let shown = Instant::now();
            bevy.update();
            let ends = [(start, stepped), (stepped, shown), (shown, Instant::now())];
            if step >= self.skip {
                for (times, (from, to)) in times.iter_mut().zip(ends) {
                    times.push(1e3 * (to - from).as_secs_f64());
                }
            }
        }
        assert_eq!(app.world().resource::<PhysicsWorld>().state_hash(), engine.state_hash());
        Ok(times)
    }
}

/// An app whose frames are a step long.
fn clocked() -> App {
    let mut app = App::new();
    app.add_plugins((TimePlugin, TransformPlugin));
    app.insert_resource(Time::<Fixed>::from_hz(60.0));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    app.update();
    let step = app.world().resource::<Time<Fixed>>().timestep();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
    app
}

/// The times that half and a tenth of all are below.
fn ranked(mut times: Vec<f64>) -> [f64; 2] {
    times.sort_by(f64::total_cmp);
    [times[times.len() / 2], times[times.len() / 10]]
}

fn main() -> Result<(), Error> {
    println!("boxes  scene           time    engine [ms]  frame [ms]  added [us]  of which Bevy  added");
    for scene in SCENES {
        let [engine, frame, bevy] = scene.times()?.map(ranked);
        for (place, name) in ["median", "tenth "].into_iter().enumerate() {
            let (engine, frame, bevy) = (engine[place], frame[place], bevy[place]);
            let added = frame - engine;
            println!(
                "{:5}  {:14}  {name}  {engine:11.3}  {frame:10.3}  {:10.0}  {:13.0}  {:4.1} %",
                scene.count,
                scene.name,
                1e3 * added,
                1e3 * bevy,
                100.0 * added / engine
            );
        }
    }
    Ok(())
}
