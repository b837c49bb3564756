//! Pendulums: balls on ball joints swing in step, as their lengths are those of 8 to 17 swings a minute.

use crate::parts::{fixed, solid};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyHandle, Error, Geometry, JointDesc, Settings, World};
use std::f64::consts::TAU;

const COUNT: usize = 10;
/// All pendulums are in step again after this time [s], in which the slowest swings so often.
const CYCLE: f64 = 30.0;
const SLOWEST: usize = 12;
/// Angle at the start [rad], and radius of a ball [m].
const ANGLE: f64 = 0.25;
const RADIUS: f32 = 0.15;
const HEIGHT: f64 = 3.0;

/// The beam with the pendulums.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let mut world = World::new(Settings::default())?;
    let beam = fixed(Geometry::cuboid(0.1, 0.1, 2.2)).with_position(DVec3::Y * HEIGHT);
    let beam = world.add_body(&beam)?;
    let mut balls = Vec::new();
    for i in 0..COUNT {
        let pivot = DVec3::new(0.0, HEIGHT, 0.4 * i as f64 - 1.8);
        let hanging = length(CYCLE / (SLOWEST + i) as f64);
        let place = pivot + hanging * DVec3::new(ANGLE.sin(), -ANGLE.cos(), 0.0);
        let ball = world.add_body(&solid(Geometry::sphere(RADIUS)).with_position(place))?;
        let frames = world.frames_about([beam, ball], pivot, Vec3::X)?;
        world.add_joint(&JointDesc::ball([beam, ball], frames))?;
        balls.push(ball);
    }
    Ok((world, balls))
}

/// Length of a pendulum with a period [m]. With its arm turns a ball: T = 2 pi sqrt((l² + 2 r² / 5) / (g l)),
/// and the angle makes it longer by its square over 16.
fn length(period: f64) -> f64 {
    let point = 9.81 * (period / (TAU * (1.0 + ANGLE * ANGLE / 16.0))).powi(2);
    0.5 * (point + (point * point - 1.6 * f64::from(RADIUS * RADIUS)).sqrt())
}

#[test]
fn all_are_back_after_a_cycle() -> Result<(), Error> {
    let (mut world, balls) = build()?;
    let before: Vec<_> = balls.iter().map(|&ball| world.position(ball)).collect::<Result<_, _>>()?;
    crate::parts::run(&mut world, CYCLE)?;
    for (&ball, before) in balls.iter().zip(before) {
        let off = (world.position(ball)? - before).length();
        assert!(off < 0.03, "{off} m");
    }
    Ok(())
}
