//! Motors: on three arms one motor keeps a speed, one holds an angle, and one only resists like friction.

use crate::parts::level_world;
use backstop::glam::{DVec3, Vec3};
use backstop::{
    Axis, BodyDesc, Error, Geometry, JointDesc, JointHandle, Motion, Motor, ShapeDesc, Spring, World,
};

/// Half length of an arm [m].
const HALF: f32 = 0.6;
/// Speed of the first arm [rad/s], and angle of the second from level [rad].
const SPEED: f32 = 1.0;
const ANGLE: f32 = 0.5;
/// Spring that holds the second arm: the weight m g l pulls it down by its share of the stiffness.
const SERVO: Spring = Spring::Coefficients { stiffness: 20_000.0, damping: 2_000.0 };
/// Share of the weight's torque on a level arm that friction of the third bears.
const SHARE: f32 = 0.5;

/// The arms, level at the start.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<JointHandle>, f32), Error> {
    let (mut world, ground) = level_world()?;
    let shape = ShapeDesc::new(Geometry::cuboid(HALF, 0.08, 0.15)).with_position(Vec3::X * HALF);
    let weight = 9.81 * HALF * 1000.0 * 8.0 * HALF * 0.08 * 0.15;
    let motors = [
        Motor::velocity(Motion::Angular, Axis::X, SPEED, 10.0 * weight),
        Motor::position(Motion::Angular, Axis::X, ANGLE, SERVO),
        Motor::friction(Motion::Angular, Axis::X, SHARE * weight),
    ];
    let mut hinges = Vec::new();
    for (i, motor) in motors.into_iter().enumerate() {
        let at = DVec3::new(2.0 * i as f64 - 2.0, 2.0, 0.0);
        let arm = BodyDesc::dynamic().with_position(at).with_shape(shape.clone());
        let arm = world.add_body(&arm)?;
        let frames = world.frames_about([ground, arm], at, Vec3::Z)?;
        hinges.push(world.add_joint(&JointDesc::hinge([ground, arm], frames).with_motor(motor))?);
    }
    Ok((world, hinges, weight))
}

#[test]
fn each_does_its_own() -> Result<(), Error> {
    let (mut world, hinges, weight) = build()?;
    crate::parts::run(&mut world, 20.0)?;
    let angle = |i: usize| world.joint_position(hinges[i], Motion::Angular, backstop::Axes::One(Axis::X));
    let speed = world.joint_velocity(hinges[0], Motion::Angular, Axis::X)?;
    assert!((speed - SPEED).abs() < 0.01, "{speed} rad/s");
    // The spring gives until its torque is that of the weight.
    let Spring::Coefficients { stiffness, .. } = SERVO else { unreachable!() };
    let expected = ANGLE - weight * angle(1)?.cos() / stiffness;
    assert!((angle(1)? - expected).abs() < 0.001, "{} of {expected} rad", angle(1)?);
    // Where the arm stops, the weight asks for no more than friction gives.
    assert!(angle(2)?.cos().abs() <= SHARE + 0.01, "{} rad", angle(2)?);
    Ok(())
}
