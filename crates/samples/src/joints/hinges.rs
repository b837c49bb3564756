//! Hinges: flaps fall until the limits of their hinges stop them, each a little further than the one before.

use crate::parts::level_world;
use backstop::glam::{DVec3, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, Error, Geometry, JointDesc, JointHandle, Limit, Motion, ShapeDesc, World,
};

const COUNT: usize = 9;
/// How much further each flap falls [rad].
const STEP: f32 = 0.15;
/// Half of a flap's length [m].
const HALF: f32 = 0.6;

/// The flaps, all of them level.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<JointHandle>), Error> {
    let (mut world, ground) = level_world()?;
    let flap = ShapeDesc::new(Geometry::cuboid(HALF, 0.03, 0.18)).with_position(Vec3::X * HALF);
    let mut hinges = Vec::new();
    for i in 0..COUNT {
        let at = DVec3::new(-f64::from(HALF), 1.6, 0.4 * i as f64 - 1.6);
        let flap = BodyDesc::dynamic().with_position(at).with_shape(flap.clone());
        let flap = world.add_body(&flap)?;
        // About -z a positive angle leads down.
        let frames = world.frames_about([ground, flap], at, Vec3::NEG_Z)?;
        let limit = Limit::new(Motion::Angular, Axes::One(Axis::X), 0.0, STEP * (i + 1) as f32);
        hinges.push(world.add_joint(&JointDesc::hinge([ground, flap], frames).with_limit(limit))?);
    }
    Ok((world, hinges))
}

#[test]
fn each_hangs_at_its_limit() -> Result<(), Error> {
    let (mut world, hinges) = build()?;
    crate::parts::run(&mut world, 5.0)?;
    for (i, hinge) in hinges.into_iter().enumerate() {
        let angle = world.joint_position(hinge, Motion::Angular, Axes::One(Axis::X))?;
        assert!((angle - STEP * (i + 1) as f32).abs() < 0.01, "{i}: {angle} rad");
    }
    Ok(())
}
