//! Crank: a wheel at constant speed moves a piston to and fro by a rod.

use crate::parts::{level_world, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Axis, BodyDesc, Error, Geometry, JointDesc, JointHandle, Motion, Motor, ShapeDesc, World};
use std::f32::consts::FRAC_PI_2;

/// Radius of the crank, and length of the rod [m].
const CRANK: f32 = 0.6;
const ROD: f32 = 2.0;
/// Speed of the wheel [rad/s].
const SPEED: f32 = 2.0;

/// The engine, with the crank level.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, [JointHandle; 2]), Error> {
    let (mut world, ground) = level_world()?;
    let axle = DVec3::new(-1.2, 1.5, 0.0);
    let disc = ShapeDesc::new(Geometry::cylinder(0.08, CRANK + 0.15));
    let disc = disc.with_rotation(Quat::from_rotation_x(FRAC_PI_2));
    let pin = ShapeDesc::new(Geometry::sphere(0.1)).with_position(Vec3::new(CRANK, 0.0, 0.15));
    let wheel = BodyDesc::dynamic().with_position(axle).with_shape(disc).with_shape(pin);
    let wheel = world.add_body(&wheel)?;
    // Moves in front of the wheel, from the pin to the piston.
    let from = axle + DVec3::new(CRANK.into(), 0.0, 0.2);
    let to = from + DVec3::X * f64::from(ROD);
    let rod = solid(Geometry::cuboid(0.5 * ROD, 0.06, 0.04)).with_position(0.5 * (from + to));
    let rod = world.add_body(&rod)?;
    let piston = world.add_body(&solid(Geometry::cuboid(0.3, 0.25, 0.25)).with_position(to))?;
    let frames = world.frames_about([ground, wheel], axle, Vec3::Z)?;
    let motor = Motor::velocity(Motion::Angular, Axis::X, SPEED, 50_000.0);
    let hinge = world.add_joint(&JointDesc::hinge([ground, wheel], frames).with_motor(motor))?;
    let frames = world.frames_about([wheel, rod], from, Vec3::Z)?;
    world.add_joint(&JointDesc::hinge([wheel, rod], frames))?;
    let frames = world.frames_about([rod, piston], to, Vec3::Z)?;
    world.add_joint(&JointDesc::ball([rod, piston], frames))?;
    let frames = world.frames_about([ground, piston], to, Vec3::X)?;
    let slider = world.add_joint(&JointDesc::slider([ground, piston], frames))?;
    Ok((world, [hinge, slider]))
}

#[test]
fn the_piston_is_where_the_crank_puts_it() -> Result<(), Error> {
    let (mut world, [hinge, slider]) = build()?;
    for _ in 0..20 {
        crate::parts::run(&mut world, 0.5)?;
        let angle = world.joint_position(hinge, Motion::Angular, backstop::Axes::One(Axis::X))?;
        let way = world.joint_position(slider, Motion::Linear, backstop::Axes::One(Axis::X))?;
        // From the axle r cos(a) + sqrt(l² - r² sin(a)²); at the start r + l.
        let expected = CRANK * angle.cos() + (ROD * ROD - (CRANK * angle.sin()).powi(2)).sqrt() - CRANK - ROD;
        assert!((way - expected).abs() < 0.005, "{way} of {expected} m");
    }
    Ok(())
}
