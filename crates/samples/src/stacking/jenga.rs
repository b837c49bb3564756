//! Block tower: a motor pulls a block out of a tower, and the tower stays.

use crate::parts::{level_world, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Axes, Axis, BodyHandle, Error, Geometry, JointDesc, Limit, Motion, Motor, World};
use std::f32::consts::FRAC_PI_2;

const LAYERS: usize = 15;
/// Half extents of a block [m].
const BLOCK: Vec3 = Vec3::new(0.75, 0.15, 0.25);
/// The layer from which a block is pulled, and the speed [m/s] and the way [m].
const PULLED: usize = 6;
const SPEED: f32 = 0.3;
const WAY: f32 = 1.8;

/// The tower, with the motor at work.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

/// The world, the block that is pulled, and one of the highest.
fn build() -> Result<(World, BodyHandle, BodyHandle), Error> {
    let (mut world, ground) = level_world()?;
    let block = solid(Geometry::cuboid(BLOCK.x, BLOCK.y, BLOCK.z - 0.002));
    let mut blocks = Vec::new();
    for layer in 0..LAYERS {
        let turned = Quat::from_rotation_y(if layer % 2 == 0 { 0.0 } else { FRAC_PI_2 });
        for row in [-1.0, 0.0, 1.0] {
            let place = turned * Vec3::Z * (2.0 * BLOCK.z * row) + Vec3::Y * BLOCK.y * (2 * layer + 1) as f32;
            blocks.push(world.add_body(&block.clone().with_position(place).with_rotation(turned))?);
        }
    }
    // The middle of its layer, along its own length, by a slider with a motor.
    let pulled = blocks[3 * PULLED + 1];
    let at: DVec3 = world.position(pulled)?;
    let frames = world.frames_about([ground, pulled], at, Vec3::X)?;
    let slider = JointDesc::slider([ground, pulled], frames)
        .with_limit(Limit::new(Motion::Linear, Axes::One(Axis::X), 0.0, WAY))
        .with_motor(Motor::velocity(Motion::Linear, Axis::X, SPEED, 50_000.0));
    world.add_joint(&slider)?;
    Ok((world, pulled, blocks[3 * LAYERS - 2]))
}

#[test]
fn the_block_is_out_and_the_tower_stands() -> Result<(), Error> {
    let (mut world, pulled, highest) = build()?;
    let before = world.position(highest)?;
    crate::parts::run(&mut world, 12.0)?;
    let way = world.position(pulled)?.x;
    assert!((way - f64::from(WAY)).abs() < 0.01, "{way}");
    let moved = (world.position(highest)? - before).length();
    assert!(moved < 0.1, "{moved} m");
    Ok(())
}
