//! Rack and pinion: a wheel which turns to and fro moves a sledge by its radius times its angle.

use crate::parts::{Driven, level_world, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axis, BodyDesc, CouplingDesc, Error, Geometry, JointDesc, JointHandle, Motion, Motor, ShapeDesc, Spring,
    World,
};
use std::f32::consts::FRAC_PI_2;

/// Radius of the pinion [m].
const RADIUS: f32 = 0.4;
/// Angle to either side [rad], and how fast it goes to and fro [rad/s].
const SWING: f32 = 4.0;
const RATE: f64 = 0.8;

/// The pinion, and the rack below it with a load.
pub fn start() -> Result<Driven, Error> {
    let (world, hinge, _) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let target = SWING * (RATE * tick.time).sin() as f32;
        world.set_joint_target(hinge, Motion::Angular, Axis::X, target, 0.0)
    }))
}

fn build() -> Result<(World, JointHandle, JointHandle), Error> {
    let (mut world, ground) = level_world()?;
    let disc = ShapeDesc::new(Geometry::cylinder(0.1, RADIUS));
    let disc = disc.with_rotation(Quat::from_rotation_x(FRAC_PI_2));
    let spoke = ShapeDesc::new(Geometry::cuboid(0.9 * RADIUS, 0.04, 0.14));
    let at = DVec3::Y * 1.5;
    let wheel = BodyDesc::dynamic().with_position(at).with_shape(disc).with_shape(spoke);
    let wheel = world.add_body(&wheel)?;
    let frames = world.frames_about([ground, wheel], at, Vec3::Z)?;
    let servo = Motor::position(Motion::Angular, Axis::X, 0.0, Spring::Frequency { hertz: 4.0, ratio: 1.0 });
    let hinge = world.add_joint(&JointDesc::hinge([ground, wheel], frames).with_motor(servo))?;
    let at = at - DVec3::Y * f64::from(RADIUS + 0.1);
    let rack = world.add_body(&solid(Geometry::cuboid(2.0, 0.1, 0.4)).with_position(at))?;
    let frames = world.frames_about([ground, rack], at, Vec3::X)?;
    let slider = world.add_joint(&JointDesc::slider([ground, rack], frames))?;
    world.add_coupling(&CouplingDesc::rack(hinge, slider, RADIUS.into()))?;
    for x in [-1.5, 1.5] {
        let load = solid(Geometry::cuboid(0.2, 0.2, 0.2));
        world.add_body(&load.with_position(at + DVec3::new(x, 0.3, 0.0)))?;
    }
    Ok((world, hinge, slider))
}

#[test]
fn the_rack_follows_the_pinion() -> Result<(), Error> {
    let (mut world, hinge, slider) = build()?;
    world.set_joint_target(hinge, Motion::Angular, Axis::X, 3.0, 0.0)?;
    crate::parts::run(&mut world, 10.0)?;
    let way = world.joint_position(slider, Motion::Linear, backstop::Axes::One(Axis::X))?;
    assert!((way - 3.0 * RADIUS).abs() < 0.001, "{way} m");
    Ok(())
}
