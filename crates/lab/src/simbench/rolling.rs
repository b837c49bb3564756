//! The rolling test: a box on the ground, 25 balls on the box, and a force on the box that is oblique to both
//! axes.
//!
//! The box (mass M, pushed by F, friction mu1 with the ground) slides, and the n balls (mass m, radius r)
//! roll on it without slip. The only horizontal force on a ball is the friction f of its contact: m a_ball =
//! f, and about its centre 2/5 m r² alpha = f r. Its lowest point therefore accelerates by a_ball + r alpha =
//! f/m + 5/2 f/m = 7/2 f/m, which has to be the acceleration a of the box: f = 2/7 m a. For the box F - mu1
//! (M + n m) g - n f = M a, so
//!
//! a = (F - mu1 (M + n m) g) / (M + 2/7 n m), and a_ball = 2/7 a.
//!
//! With SimBenchmark's numbers a = 0.7385 m/s². A pyramid of friction along the axes can bear F: its
//! components, 75 N and 130 N, are both below mu1 (M + n m) g = 137.3 N, and nothing moves.

use super::run::{Outcome, Run, Setting, sphere_density};
use backstop::BodyDesc;
use backstop::Error;
use backstop::{Combine, Geometry, Material, ShapeDesc};
use glam::{DVec3, Vec3};
use std::ops::ControlFlow;

/// [kg]
const BOX_MASS: f32 = 10.0;
/// [kg]
const BALL_MASS: f32 = 1.0;
/// Balls along a side.
const SIDE: u32 = 5;
/// [N]
const FORCE: f32 = 150.0;
/// Overlap that each body starts with [m].
const PENETRATION: f64 = 2e-5;
/// Friction of ground, box and balls; that of a pair is the product, 0.4 and 0.8.
const FRICTION: [f32; 3] = [0.5, 0.8, 1.0];
/// 60 degrees from the first axis. The page says "in the xy direction"; this is what the program does.
const DIRECTION: Vec3 = Vec3::new(0.5, 0.0, 0.866_025_4);
/// Metres along an edge of the box, and its height.
const BOX: [f32; 2] = [20.0, 1.0];
/// [m]
const RADIUS: f32 = 0.5;

/// Accelerations of the box and of a ball by Coulomb's law and rolling without slip [m/s²].
pub fn accelerations() -> (f64, f64) {
    let (m, mass, n) = (f64::from(BALL_MASS), f64::from(BOX_MASS), f64::from(SIDE * SIDE));
    let friction = 0.4 * (mass + n * m) * 9.81;
    let a = (f64::from(FORCE) - friction) / (mass + 2.0 / 7.0 * n * m);
    (a, 2.0 / 7.0 * a)
}

pub(super) fn run(setting: &Setting, seconds: f32) -> Result<Outcome, Error> {
    let mut run = Run::new(setting, seconds, 1.0)?;
    let [ground, crate_, ball] =
        FRICTION.map(|mu| Material::default().with_friction(mu).with_friction_combine(Combine::Multiply));
    run.ground(ground)?;
    let [edge, height] = BOX;
    let geometry = Geometry::cuboid(0.5 * edge, 0.5 * height, 0.5 * edge);
    let density = BOX_MASS / (edge * edge * height);
    let shape = ShapeDesc::new(geometry).with_material(crate_).with_density(density);
    let at = DVec3::Y * (0.5 * f64::from(height) - PENETRATION);
    let pushed = run.world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(shape))?;
    let density = sphere_density(BALL_MASS, RADIUS);
    let shape = ShapeDesc::new(Geometry::Sphere { radius: RADIUS }).with_material(ball).with_density(density);
    let high = f64::from(height) + f64::from(RADIUS) - 3.0 * PENETRATION;
    let mut first = None;
    for i in 0..SIDE * SIDE {
        let at = DVec3::new(f64::from(i / SIDE) * 2.0 - 4.0, high, f64::from(i % SIDE) * 2.0 - 4.0);
        let ball = run.world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(shape.clone()))?;
        first.get_or_insert(ball);
    }
    // As in SimBenchmark, the first ball represents all.
    let rolls = first.unwrap_or(pushed);
    let (a, a_ball) = accelerations();
    let (mut errors, mut expected) = (0.0, 0.0);
    let (steps, dt) = (run.steps, f64::from(setting.dt));
    run.go(setting, |world, step| {
        world.add_force(pushed, DIRECTION * FORCE)?;
        for (body, a) in [(pushed, a), (rolls, a_ball)] {
            let should = DIRECTION.as_dvec3() * (a * dt * f64::from(step));
            errors += (world.linear_velocity(body)?.as_dvec3() - should).length_squared();
            expected += should.length_squared();
        }
        Ok(ControlFlow::Continue(()))
    })?;
    let relative = if expected > 0.0 { (errors / expected).sqrt() } else { 0.0 };
    Ok(run.outcome(errors / f64::from(steps.max(1)), relative, false))
}
