//! Cones: rods on ball joints fall to all sides, each as far as its cone lets it.

use crate::parts::level_world;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, Error, Geometry, JointDesc, JointHandle, Limit, Motion, ShapeDesc, World,
};
use std::f32::consts::TAU;

const COUNT: usize = 10;
/// The narrowest cone, and by how much each is wider than the one before [rad].
const NARROW: f32 = 0.15;
const STEP: f32 = 0.12;
/// Half length of a rod without its caps [m], and its radius.
const HALF: f32 = 0.5;
const RADIUS: f32 = 0.06;

/// A ring of rods, nearly upright.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<JointHandle>), Error> {
    let (mut world, ground) = level_world()?;
    let rod = ShapeDesc::new(Geometry::capsule(HALF, RADIUS)).with_position(Vec3::Y * (HALF + RADIUS));
    let mut joints = Vec::new();
    for i in 0..COUNT {
        let angle = TAU * i as f32 / COUNT as f32;
        let at = DVec3::new(1.5 * f64::from(angle.cos()), 0.8, 1.5 * f64::from(angle.sin()));
        let rod = BodyDesc::dynamic().with_position(at).with_shape(rod.clone());
        let rod = world.add_body(&rod)?;
        // The axis of the cone is the frames' x: upright.
        let frames = world.frames_about([ground, rod], at, Vec3::Y)?;
        let cone = Limit::new(Motion::Angular, Axes::Perpendicular(Axis::X), 0.0, NARROW + STEP * i as f32);
        joints.push(world.add_joint(&JointDesc::ball([ground, rod], frames).with_limit(cone))?);
        // A push, outwards and along the ring.
        let push = Quat::from_rotation_y(-angle) * Vec3::new(0.3, 0.0, 0.5);
        world.set_angular_velocity(rod, Vec3::Y.cross(push) * 2.0)?;
        world.set_damping(rod, 0.0, 1.0)?;
    }
    Ok((world, joints))
}

#[test]
fn they_lean_on_their_cones() -> Result<(), Error> {
    let (mut world, joints) = build()?;
    crate::parts::run(&mut world, 15.0)?;
    for (i, joint) in joints.into_iter().enumerate() {
        let tilt = world.joint_position(joint, Motion::Angular, Axes::Perpendicular(Axis::X))?;
        assert!((tilt - (NARROW + STEP * i as f32)).abs() < 0.01, "{i}: {tilt} rad");
    }
    Ok(())
}
