//! A restored world goes on to the bits of the run that never stopped.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

mod between_steps;
mod bytes;
mod calls;
mod changed_bytes;
mod game;
mod goes_on;

use crate::common::{self, random::Random};
use game::Game;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, ContinuousMode, Error, Filter, Frame, Geometry, JointDesc, JointHandle, Limit,
    Material, Motion, Motor, Settings, ShapeDesc, ShapeHandle, Snapshot, World,
};
use backstop_scene::{Scene, builtin};

const DT: f32 = 1.0 / 60.0;

fn pile_of(bodies: usize) -> Scene {
    let mut scene = builtin::pile();
    scene.bodies.truncate(5 + bodies);
    scene
}

fn bouncing() -> Scene {
    let mut scene = builtin::bullets(true);
    scene.bodies.truncate(100 + 200);
    for body in &mut scene.bodies {
        body.desc.shapes.iter_mut().for_each(|s| s.material.restitution = 0.5);
    }
    scene
}

fn fewer_bullets() -> Scene {
    let mut scene = builtin::bullets(false);
    scene.bodies.truncate(301);
    scene
}

/// Calls before a step.
type Act = fn(&mut World, &[BodyHandle], u32);

fn nothing(_: &mut World, _: &[BodyHandle], _: u32) {}

/// A table tilts under the bodies on it.
fn tilt(world: &mut World, bodies: &[BodyHandle], step: u32) {
    let angle = 0.2 * libm::sinf(step as f32 * 0.05);
    world.move_kinematic(bodies[0], DVec3::Y, Quat::from_rotation_z(angle), DT).unwrap();
    world.add_force_and_torque(bodies[5], Vec3::new(3.0, 20.0, 0.0), Vec3::Y).unwrap();
}

fn table() -> Scene {
    let mut scene = pile_of(40);
    let table = ShapeDesc::new(Geometry::cuboid(4.0, 0.2, 4.0));
    scene.bodies.remove(0);
    let table = BodyDesc::kinematic().with_position(DVec3::Y).with_shape(table);
    scene.bodies.insert(0, scene.bodies[0].clone());
    scene.bodies[0].desc = table;
    scene.bodies.iter_mut().skip(5).for_each(|body| body.desc.position.y += 0.5);
    scene
}

/// A scene, its settings, the caller's changes, the steps of snapshots, and steps to go on from there.
struct Case {
    name: &'static str,
    scene: Scene,
    sleeping: bool,
    act: Act,
    /// Length of the step with a number [s].
    dt: fn(u32) -> f32,
    at: &'static [u32],
    on: u32,
}

fn cases() -> Vec<Case> {
    let case = |name, scene, at, on| Case { name, scene, sleeping: false, act: nothing, dt: |_| DT, at, on };
    vec![
        // All hit the terrain between the steps 20 and 33.
        case("talk", builtin::talk(), &[0, 10, 24, 30, 60], 40),
        case("pile", pile_of(300), &[1, 40, 75, 110], 30),
        case("bullets", fewer_bullets(), &[1, 5, 12, 40], 25),
        case("pyramid", builtin::large_pyramid(12), &[3, 60], 30),
        case("bounce", bouncing(), &[2, 4, 6, 9, 20], 25),
        case("chain", builtin::chain(true), &[0, 10, 50], 40),
        case("joint_grid", builtin::joint_grid(8), &[0, 10, 30], 30),
        Case { sleeping: true, ..case("sleep", pile_of(120), &[100, 200, 280, 400], 120) },
        Case { act: tilt, ..case("table", table(), &[0, 1, 30, 90], 60) },
        // Mean forces are kept once the steps vary, from the 30th on, and the springs are between two
        // lengths.
        Case {
            dt: |step| if step > 30 && step % 3 == 0 { 0.04 } else { DT },
            ..case("varying", pile_of(100), &[29, 31, 34, 90], 40)
        },
    ]
}

fn world_of(case: &Case, threads: usize) -> (World, Vec<BodyHandle>) {
    let settings = Settings::default().with_threads(threads).with_sleeping(case.sleeping);
    common::world_of(&case.scene, settings)
}

fn advance(world: &mut World, bodies: &[BodyHandle], case: &Case, from: u32, count: u32) -> Vec<u64> {
    (from..from + count)
        .map(|step| {
            (case.act)(world, bodies, step);
            world.step((case.dt)(step)).unwrap();
            world.state_hash()
        })
        .collect()
}
