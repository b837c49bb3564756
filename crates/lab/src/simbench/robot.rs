//! The tests of momentum and energy: a robot with four legs of three hinges each, without motors and limits.
//!
//! Momentum: without gravity a ball of 10 kg flies into it at 5 m/s. The momentum of both should stay 50 kg
//! m/s; the metric is the squared error. Energy: the trunk is pulled up with twice the robot's weight for a
//! second, and then let go; the metric is the squared error of the energy from there on.
//!
//! SimBenchmark's robot is ANYmal. This one has its dimensions and masses; its moments of inertia are
//! rounded, and its trunk alone collides.

use super::run::{Outcome, Run, Setting, sphere_density};
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::JointDesc;
use backstop::{Geometry, MassProperties, ShapeDesc};
use glam::{DVec3, Mat3, Quat, Vec3};
use std::ops::ControlFlow;

/// Height of the trunk [m].
const HEIGHT: f64 = 2.0;
/// Mass [kg] and half extents [m] of the trunk; x is ahead, y up.
const TRUNK: (f32, Vec3) = (21.39, Vec3::new(0.2655, 0.13, 0.116));
/// Of each part of a leg: mass [kg], moments [kg m²], and centre from its hinge [m].
const PARTS: [(f32, Vec3, Vec3); 3] = [
    (1.106, Vec3::new(0.0012, 0.0014, 0.0010), Vec3::new(0.054, 0.0, 0.0)),
    (1.51, Vec3::new(0.0148, 0.0018, 0.0144), Vec3::new(0.001, -0.1975, 0.054)),
    (0.51, Vec3::new(0.0122, 0.0006, 0.0122), Vec3::new(0.01, -0.165, -0.01)),
];
/// Hinges: of the hip on the trunk, the thigh on the hip and the shank on the thigh [m], of the leg in front
/// to the positive z.
const HINGES: [Vec3; 3] =
    [Vec3::new(0.2629, 0.0, 0.115), Vec3::new(0.0585, 0.0, 0.0315), Vec3::new(0.0, -0.25, 0.111)];
/// By which each part is bent at first [rad].
const BENT: [f32; 3] = [0.03, 0.4, -0.8];
/// Mass [kg], radius [m], distance [m] and speed [m/s] of the ball.
const BALL: (f32, f32, f64, f32) = (10.0, 0.2, 5.0, 5.0);
/// Time for which the trunk is pulled [s].
const PULLED: f32 = 1.0;

/// Adds the robot; its trunk comes first.
fn build(run: &mut Run) -> Result<Vec<BodyHandle>, Error> {
    let moments = Vec3::new(0.268, 0.829, 0.884);
    let lump = |mass, moments| {
        let inertia = Mat3::from_diagonal(moments);
        BodyDesc::dynamic().with_mass(Some(MassProperties { mass, centre_of_mass: Vec3::ZERO, inertia }))
    };
    let shape = ShapeDesc::new(Geometry::Box { half_extents: TRUNK.1 });
    let trunk = lump(TRUNK.0, moments).with_position(DVec3::Y * HEIGHT).with_shape(shape);
    let mut bodies = vec![run.world.add_body(&trunk)?];
    for leg in 0..4 {
        let side = Vec3::new(if leg < 2 { 1.0 } else { -1.0 }, 1.0, if leg % 2 == 0 { 1.0 } else { -1.0 });
        let (mut parent, mut at, mut turn) = (bodies[0], DVec3::Y * HEIGHT, Quat::IDENTITY);
        for (i, (mass, moments, centre)) in PARTS.into_iter().enumerate() {
            at += (turn * (HINGES[i] * side)).as_dvec3();
            let axis = if i == 0 { Vec3::X } else { Vec3::Z };
            // Legs at both ends bend towards the middle.
            let bent = BENT[i] * if i == 0 { side.z } else { side.x };
            let hinge = turn * axis;
            turn *= Quat::from_axis_angle(axis, bent);
            let place = at + (turn * (centre * side)).as_dvec3();
            let part = lump(mass, moments).with_position(place).with_rotation(turn.normalize());
            let part = run.world.add_body(&part)?;
            let frames = run.world.frames_about([parent, part], at, hinge)?;
            run.world.add_joint(&JointDesc::hinge([parent, part], frames))?;
            bodies.push(part);
            parent = part;
        }
    }
    Ok(bodies)
}

pub(super) fn momentum(setting: &Setting, seconds: f32) -> Result<Outcome, Error> {
    let mut run = Run::new(setting, seconds, 0.5)?;
    let settings = run.world.settings().clone().with_gravity(Vec3::ZERO);
    run.world.set_settings(settings)?;
    let mut bodies = build(&mut run)?;
    let (mass, radius, away, speed) = BALL;
    let ball = ShapeDesc::new(Geometry::Sphere { radius }).with_density(sphere_density(mass, radius));
    let ball = BodyDesc::dynamic().with_shape(ball).with_velocity(Vec3::Z * speed, Vec3::ZERO);
    bodies.push(run.world.add_body(&ball.with_position(DVec3::new(0.0, HEIGHT, -away)))?);
    let want = DVec3::Z * f64::from(mass * speed);
    let (mut errors, steps) = (0.0, f64::from(run.steps.max(1)));
    run.go(setting, |world, _| {
        let mut sum = DVec3::ZERO;
        for &body in &bodies {
            sum += world.linear_velocity(body)?.as_dvec3() * f64::from(world.mass(body)?);
        }
        errors += (sum - want).length_squared();
        Ok(ControlFlow::Continue(()))
    })?;
    let mean = errors / steps;
    Ok(run.outcome(mean, mean.sqrt() / want.length(), false))
}

pub(super) fn energy(setting: &Setting, seconds: f32) -> Result<Outcome, Error> {
    let mut run = Run::new(setting, seconds, 0.5)?;
    let bodies = build(&mut run)?;
    let mut mass = 0.0;
    for &body in &bodies {
        mass += run.world.mass(body)?;
    }
    let pull = Vec3::Y * (2.0 * mass * 9.81);
    let pulled = (PULLED / setting.dt).round() as u32;
    let (mut start, mut errors, mut count) = (0.0, 0.0, 0.0);
    run.go(setting, |world, step| {
        if step < pulled {
            world.add_force(bodies[0], pull)?;
            return Ok(ControlFlow::Continue(()));
        }
        if step == pulled {
            start = world.energy();
        }
        errors += (world.energy() - start).powi(2);
        count += 1.0;
        Ok(ControlFlow::Continue(()))
    })?;
    let mean = errors / f64::max(count, 1.0);
    let relative = if start > 0.0 { mean.sqrt() / start } else { 0.0 };
    Ok(run.outcome(mean, relative, false))
}
