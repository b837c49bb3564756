//! The stability limit of penalty methods: a ball on a plane, by frequency and step.

use super::Stepper;
use crate::LabWorld;
use crate::{WorldMethod, WorldSolver};
use backstop::BodyDesc;
use backstop::Error;
use backstop::World;
use backstop::limits::{positive, within};
use backstop::{ContinuousMode, Settings};
use backstop::{Geometry, Material, ShapeDesc};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Steps that the ball is watched for.
const STEPS: u32 = 400;

/// Whether a ball stays at the depth at which the spring of a penalty method carries it, if it starts a tenth
/// of that away. `frequency` of the spring [Hz], `damping` its ratio, `dt` the step [s].
///
/// The explicit form, whose positions follow the new velocities, has `x' = x + dt v'`,
/// `v' = v - dt (ω² x + 2 ζ ω v)`. Its eigenvalues are within the unit circle for `(ω dt)² + 4 ζ ω dt < 4`
/// (Jury): see [`limit`].
///
/// # Errors
/// If a number is not positive, or the spring bears the ball deeper than its radius of 0.5 m.
pub fn is_stable(stepper: &'static Stepper, frequency: f64, damping: f64, dt: f32) -> Result<bool, Error> {
    positive("frequency", frequency as f32)?;
    within("damping", damping as f32, 0.0, 100.0, "in 0..=100")?;
    backstop::limits::step(dt)?;
    let gravity = 9.81;
    let depth = gravity / (TAU * frequency).powi(2);
    within("depth at rest", depth as f32, 0.0, 0.4, "at most 0.4 m: a higher frequency")?;
    let settings = Settings::default()
        .with_gravity(Vec3::NEG_Y * gravity as f32)
        .with_continuous(ContinuousMode::Discrete);
    let mut world = World::new(settings)?;
    let material = Material::default().with_friction(0.0).with_restitution(0.0);
    let shape = |geometry| ShapeDesc::new(geometry).with_material(material);
    world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Plane)))?;
    let ball = BodyDesc::dynamic().with_position(DVec3::Y * (0.5 - 0.9 * depth));
    let ball = world.add_body(&ball.with_shape(shape(Geometry::Sphere { radius: 0.5 })))?;
    let mut solver = WorldSolver::new(WorldMethod::Step(stepper));
    (solver.effort.frequency, solver.effort.damping) = (frequency, damping);
    world.solve_with(Some(solver));
    let mut farthest = 0.0_f64;
    for _ in 0..STEPS {
        world.step(dt)?;
        farthest = farthest.max((world.position(ball)?.y - (0.5 - depth)).abs());
    }
    // An oscillation that does not grow stays within its initial amplitude plus what one step adds.
    Ok(farthest < 0.3 * depth)
}

/// The greatest frequency at which the explicit form is stable [Hz].
pub fn limit(damping: f64, dt: f64) -> f64 {
    2.0 * ((damping * damping + 1.0).sqrt() - damping) / (TAU * dt)
}
