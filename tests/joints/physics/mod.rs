//! Limits, springs, motors and conservation laws of joints, against mechanics.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

mod beams;
mod limits;
mod momentum;
mod springs;

use crate::common::{self, G};
use backstop::glam::{DQuat, DVec3, Mat3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, Frame, JointDesc, JointHandle, Limit, MassProperties, Motion, Motor,
    Settings, Spring, World,
};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Substeps and iterations: small steps, and sequential impulses.
const SOLVERS: [(u32, u32); 2] = [(4, 1), (1, 8)];
const STEPS: [f64; 3] = [1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0];

fn world_with(gravity: Vec3, (substeps, iterations): (u32, u32)) -> World {
    World::new(Settings::default().with_gravity(gravity).with_substeps(substeps).with_iterations(iterations))
        .unwrap()
}

fn world(gravity: Vec3) -> World {
    world_with(gravity, SOLVERS[0])
}

fn ground(world: &mut World) -> BodyHandle {
    world.add_body(&BodyDesc::fixed()).unwrap()
}

/// A body without a shape.
fn lump(mass: f32, inertia: Vec3) -> BodyDesc {
    let mass = MassProperties { mass, centre_of_mass: Vec3::ZERO, inertia: Mat3::from_diagonal(inertia) };
    BodyDesc::dynamic().with_mass(Some(mass))
}

fn run(world: &mut World, seconds: f64, dt: f64) {
    common::steps(world, (seconds / dt).round() as u32, dt as f32);
}

/// Second frame as seen from the first: its origin, and the rotation.
fn seen(world: &World, joint: JointHandle) -> (DVec3, DQuat) {
    let [(a, p), (b, q)] = world.joint_frames(joint).unwrap();
    let (p, q) = (p.as_dquat().normalize(), q.as_dquat().normalize());
    (p.conjugate() * (b - a), p.conjugate() * q)
}

/// Angle about x that is left when the tilt of x is taken out.
fn twist(q: DQuat) -> f64 {
    let angle = 2.0 * q.x.atan2(q.w);
    if angle > std::f64::consts::PI {
        angle - 2.0 * std::f64::consts::PI
    } else if angle < -std::f64::consts::PI {
        angle + 2.0 * std::f64::consts::PI
    } else {
        angle
    }
}

/// Angle between the two frames' x.
fn tilt(q: DQuat) -> f64 {
    (q * DVec3::X).angle_between(DVec3::X)
}

fn whole(q: DQuat) -> f64 {
    2.0 * DVec3::new(q.x, q.y, q.z).length().atan2(q.w.abs())
}

/// Runs until rest, with all steps and solvers, and checks a measure at the end.
fn rests(
    what: &str,
    gravity: Vec3,
    within: f64,
    expected: f64,
    build: &dyn Fn(&mut World) -> JointHandle,
    measure: &dyn Fn(&World, JointHandle) -> f64,
) {
    for solver in SOLVERS {
        for dt in STEPS {
            let mut world = world_with(gravity, solver);
            let joint = build(&mut world);
            run(&mut world, 4.0, dt);
            let at = measure(&world, joint);
            println!("{what} {solver:?} {dt:.4}: {:.2e}", at - expected);
            assert!((at - expected).abs() < within, "{what} {solver:?} {dt:.4}: {at} for {expected}");
        }
    }
}

/// Fails with all that is wrong, not just the first.
fn none(wrong: &[String]) {
    assert!(wrong.is_empty(), "{wrong:#?}");
}

const MILLIMETRE: f64 = 1e-3;
const MILLIRADIANS: f64 = 2e-3;

/// A mass on an arm of half a metre along `arm`, turned by a rotation about the joint.
fn armed(world: &mut World, arm: Vec3, turn: Quat) -> ([BodyHandle; 2], [Frame; 2]) {
    let ground = ground(world);
    let at = (turn * arm * 0.5).as_dvec3();
    let mass = world.add_body(&lump(2.0, Vec3::splat(0.2)).with_position(at).with_rotation(turn)).unwrap();
    ([ground, mass], [Frame::default(), Frame::at(arm * -0.5)])
}
