//! The 666 test: a cube of 6 x 6 x 6 balls with gaps of a tenth of their radius, each slightly displaced,
//! falls by 1 mm and collapses, without friction and restitution. Nothing should overlap; the metric is the
//! sum of squared overlaps over all pairs, and over balls and the ground. SimBenchmark's random numbers are
//! those of its own generator, so individual balls take other paths here.
//!
//! In the elastic test they fall by 1 m instead and bounce with restitution 1 from each other and the ground:
//! their energy should stay the same.

use super::run::{Outcome, Run, Setting, sphere_density};
use crate::arnoldi::noise;
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::{Geometry, Material, ShapeDesc};
use glam::DVec3;
use std::ops::ControlFlow;

/// [kg]
const MASS: f32 = 10.0;
/// [m]
const RADIUS: f32 = 0.1;
/// From centre to centre [m].
const PITCH: f64 = 0.21;
/// Height of the lowest centres [m], and in the elastic test.
const HEIGHT: f64 = 0.101;
const ELASTIC_HEIGHT: f64 = 1.101;
/// Greatest displacement of a ball along each axis [m].
const PERTURBATION: f64 = 0.001;
/// Balls along an edge.
const SIDE: u32 = 6;
const SEED: u64 = 42;

pub(super) fn run(setting: &Setting, seconds: f32) -> Result<Outcome, Error> {
    let mut run = Run::new(setting, seconds, 2.0 * RADIUS)?;
    let balls = fill(&mut run, HEIGHT, 0.0)?;
    let (mut errors, steps) = (0.0, f64::from(run.steps.max(1)));
    let mut places = Vec::new();
    run.go(setting, |world, _| {
        places.clear();
        for &ball in &balls {
            places.push(world.position(ball)?);
        }
        errors += squared_overlaps(&places);
        Ok(ControlFlow::Continue(()))
    })?;
    let mean = errors / steps;
    let relative = (mean / balls.len() as f64).sqrt() / f64::from(RADIUS);
    Ok(run.outcome(mean, relative, false))
}

pub(super) fn run_elastic(setting: &Setting, seconds: f32) -> Result<Outcome, Error> {
    let mut run = Run::new(setting, seconds, 2.0 * RADIUS)?;
    fill(&mut run, ELASTIC_HEIGHT, 1.0)?;
    run.energy(setting)
}

/// Adds the ground and the balls.
fn fill(run: &mut Run, height: f64, restitution: f32) -> Result<Vec<BodyHandle>, Error> {
    let material = Material::default().with_friction(0.0).with_restitution(restitution);
    run.ground(material)?;
    let density = sphere_density(MASS, RADIUS);
    let ball =
        ShapeDesc::new(Geometry::Sphere { radius: RADIUS }).with_material(material).with_density(density);
    let mut random = noise(SEED);
    let mut balls = Vec::new();
    for i in 0..SIDE * SIDE * SIDE {
        let at = DVec3::new(f64::from(i / (SIDE * SIDE)), f64::from(i % SIDE), f64::from(i / SIDE % SIDE));
        let out = DVec3::from_array(std::array::from_fn(|_| 0.5 + 0.5 * random()));
        let at = at * PITCH + out * PERTURBATION + DVec3::Y * height;
        balls.push(run.world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(ball.clone()))?);
    }
    Ok(balls)
}

/// Sum of squared overlaps over all pairs of balls, and over balls and the ground [m²].
fn squared_overlaps(places: &[DVec3]) -> f64 {
    let radius = f64::from(RADIUS);
    let mut sum = 0.0;
    for (i, a) in places.iter().enumerate() {
        for b in &places[i + 1..] {
            let squared = a.distance_squared(*b);
            if squared < 4.0 * radius * radius {
                sum += (2.0 * radius - squared.sqrt()).powi(2);
            }
        }
        sum += (radius - a.y).max(0.0).powi(2);
    }
    sum
}
