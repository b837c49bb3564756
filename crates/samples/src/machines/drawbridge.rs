//! Drawbridge: winches shorten the two chains of a bridge until it stands, and let it down again.

use crate::parts::{Driven, fixed, level_world};
use backstop::glam::{DVec3, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, Error, Frame, Geometry, JointDesc, JointHandle, Limit, Motion, ShapeDesc, World,
};
use std::f64::consts::TAU;

/// Length of the bridge, height of the winches above its hinge, and the longest and shortest chains [m].
const LENGTH: f32 = 4.0;
const HEIGHT: f32 = 3.0;
const LONG: f32 = 5.0;
const SHORT: f32 = 1.8;
/// The time for both ways [s].
const PERIOD: f64 = 16.0;

/// The bridge, down.
pub fn start() -> Result<Driven, Error> {
    let (world, _, chains) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let length = 0.5 * (LONG + SHORT) + 0.5 * (LONG - SHORT) * (TAU * tick.time / PERIOD).cos() as f32;
        let limit = Limit::new(Motion::Linear, Axes::All, 0.0, length);
        chains.iter().try_for_each(|&chain| world.set_joint_limit(chain, limit))
    }))
}

fn build() -> Result<(World, JointHandle, Vec<JointHandle>), Error> {
    let (mut world, _) = level_world()?;
    let bank = fixed(Geometry::cuboid(1.5, 0.5, 1.5));
    let near = world.add_body(&bank.clone().with_position(Vec3::new(-1.55, 0.5, 0.0)))?;
    world.add_body(&bank.with_position(Vec3::new(LENGTH + 1.5, 0.5, 0.0)))?;
    let pivot = DVec3::Y * 0.95;
    let half = 0.5 * LENGTH;
    let deck = ShapeDesc::new(Geometry::cuboid(half, 0.05, 1.0)).with_position(Vec3::X * half);
    let deck = world.add_body(&BodyDesc::dynamic().with_position(pivot).with_shape(deck))?;
    let frames = world.frames_about([near, deck], pivot, Vec3::Z)?;
    let level = Limit::new(Motion::Angular, Axes::One(Axis::X), 0.0, 1.5);
    let hinge = world.add_joint(&JointDesc::hinge([near, deck], frames).with_limit(level))?;
    let mut chains = Vec::new();
    for z in [-1.0, 1.0] {
        let tower = fixed(Geometry::cuboid(0.15, 0.5 * HEIGHT, 0.15));
        let tower = world.add_body(&tower.with_position(Vec3::new(-0.3, 0.95 + 0.5 * HEIGHT, 1.2 * z)))?;
        let frames = [Vec3::new(0.3, 0.5 * HEIGHT, -0.2 * z), Vec3::new(LENGTH, 0.0, z)].map(Frame::at);
        chains.push(world.add_joint(&JointDesc::distance([tower, deck], frames, 0.0, LONG))?);
    }
    Ok((world, hinge, chains))
}

#[test]
fn it_is_as_steep_as_the_chains_are_short() -> Result<(), Error> {
    let (mut bridge, hinge) = (start()?, build()?.1);
    crate::parts::run(&mut bridge, 0.5 * PERIOD)?;
    let angle = crate::Running::world(&bridge).joint_position(hinge, Motion::Angular, Axes::One(Axis::X))?;
    // The law of cosines.
    let sine = (LENGTH * LENGTH + HEIGHT * HEIGHT - SHORT * SHORT) / (2.0 * LENGTH * HEIGHT);
    let expected = sine.asin();
    assert!((angle - expected).abs() < 0.02, "{angle} of {expected} rad");
    Ok(())
}
