//! Gears: a motor turns the first of four wheels, and each turns the next by the ratio of their teeth.

use crate::parts::level_world;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axis, BodyDesc, CouplingDesc, Error, Filter, Geometry, JointDesc, JointHandle, Motion, Motor, ShapeDesc,
    World,
};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Teeth of the wheels, and the way along a wheel's edge that one takes [m].
const TEETH: [f32; 4] = [16.0, 40.0, 10.0, 24.0];
const PITCH: f32 = 0.15;
/// Speed of the first [rad/s].
const SPEED: f32 = 1.5;

/// The wheels on a wall.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<JointHandle>), Error> {
    let (mut world, ground) = level_world()?;
    let mut hinges = Vec::new();
    let mut x = -2.5;
    for (i, teeth) in TEETH.into_iter().enumerate() {
        let radius = PITCH * teeth / TAU;
        let at = DVec3::new((x + radius).into(), 1.6, 0.0);
        let own = Filter::default().with_mask(0);
        let disc = ShapeDesc::new(Geometry::cylinder(0.1, radius - 0.05)).with_filter(own);
        let disc = disc.with_rotation(Quat::from_rotation_x(FRAC_PI_2));
        let mut wheel = BodyDesc::dynamic().with_position(at).with_shape(disc);
        for tooth in 0..teeth as usize {
            let turned = Quat::from_rotation_z(TAU / teeth * (tooth as f32 + 0.5 * (i % 2) as f32));
            let shape = ShapeDesc::new(Geometry::cuboid(0.06, 0.03, 0.1)).with_filter(own);
            wheel = wheel.with_shape(shape.with_rotation(turned).with_position(turned * Vec3::X * radius));
        }
        let pair = [ground, world.add_body(&wheel)?];
        let frames = world.frames_about(pair, at, Vec3::Z)?;
        hinges.push(world.add_joint(&JointDesc::hinge(pair, frames))?);
        x += 2.0 * radius;
    }
    world.set_joint_motor(hinges[0], Motor::velocity(Motion::Angular, Axis::X, SPEED, 5_000.0))?;
    for (pair, teeth) in hinges.windows(2).zip(TEETH.windows(2)) {
        world.add_coupling(&CouplingDesc::gear([pair[0], pair[1]], [teeth[0].into(), teeth[1].into()]))?;
    }
    Ok((world, hinges))
}

#[test]
fn speeds_are_as_teeth() -> Result<(), Error> {
    let (mut world, hinges) = build()?;
    crate::parts::run(&mut world, 20.0)?;
    for (i, hinge) in hinges.into_iter().enumerate() {
        let expected = [SPEED, -SPEED][i % 2] * TEETH[0] / TEETH[i];
        let speed = world.joint_velocity(hinge, Motion::Angular, Axis::X)?;
        assert!((speed / expected - 1.0).abs() < 0.001, "{i}: {speed} of {expected} rad/s");
    }
    Ok(())
}
