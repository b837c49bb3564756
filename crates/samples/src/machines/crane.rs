//! Crane: its jib turns, and its winch shortens the rope on which a load hangs.
//! Keys: right and left turn the jib, forwards winds up the rope, back lets it down.

use crate::parts::{Driven, fixed, level_world, solid};
use backstop::glam::{DVec3, Vec3};
use backstop::{
    Axes, Axis, BodyHandle, Error, Frame, Geometry, JointDesc, JointHandle, Limit, Motion, Motor, World,
};

/// Top of the mast [m], and the rope when it is let down and when it is wound up.
const TOP: DVec3 = DVec3::new(0.0, 6.0, 0.0);
const ROPE: [f32; 2] = [5.2, 1.5];
/// Speeds of the jib [rad/s] and of the winch [m/s].
const TURN: f32 = 0.5;
const WIND: f32 = 0.8;

/// The crane above a load.
pub fn start() -> Result<Driven, Error> {
    let (world, [hinge, rope], _) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let keys = tick.controls;
        world.set_joint_target(hinge, Motion::Angular, Axis::X, 0.0, -TURN * keys.right)?;
        let length = world.joint_limits(rope)?.next().map_or(ROPE[0], |limit| limit.max);
        let length = (length - keys.forward * WIND * tick.dt).clamp(ROPE[1], ROPE[0]);
        world.set_joint_limit(rope, Limit::new(Motion::Linear, Axes::All, 0.0, length))
    }))
}

fn build() -> Result<(World, [JointHandle; 2], BodyHandle), Error> {
    let (mut world, ground) = level_world()?;
    let mast = fixed(Geometry::cuboid(0.2, 0.5 * TOP.y as f32, 0.2));
    world.add_body(&mast.with_position(0.5 * TOP))?;
    let jib = solid(Geometry::cuboid(2.5, 0.15, 0.2)).with_position(TOP + DVec3::new(1.5, 0.16, 0.0));
    let jib = world.add_body(&jib)?;
    let frames = world.frames_about([ground, jib], TOP, Vec3::Y)?;
    let turn = Motor::velocity(Motion::Angular, Axis::X, 0.0, 200_000.0);
    let hinge = world.add_joint(&JointDesc::hinge([ground, jib], frames).with_motor(turn))?;
    // Below the tip of the jib.
    let load = solid(Geometry::cuboid(0.4, 0.4, 0.4)).with_position(TOP.with_x(3.8).with_y(0.4));
    let load = world.add_body(&load)?;
    let frames = [Frame::at(Vec3::X * 2.3), Frame::at(Vec3::Y * 0.4)];
    let rope = world.add_joint(&JointDesc::distance([jib, load], frames, 0.0, ROPE[0]))?;
    Ok((world, [hinge, rope], load))
}

#[test]
fn the_winch_lifts_the_load() -> Result<(), Error> {
    let (mut crane, load) = (start()?, build()?.2);
    for mut tick in crate::Tick::during(10.0) {
        tick.controls.forward = 1.0;
        crate::Running::step(&mut crane, &tick)?;
    }
    // It hangs on the shorter rope, by its upper face.
    let height = crate::Running::world(&crane).position(load)?.y;
    let expected = TOP.y + 0.16 - f64::from(ROPE[1]) - 0.4;
    assert!((height - expected).abs() < 0.02, "{height} of {expected} m");
    Ok(())
}
