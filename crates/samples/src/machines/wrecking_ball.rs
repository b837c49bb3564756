//! Wrecking ball: an iron ball on a chain swings into a house of blocks.

use crate::parts::{fixed, lawn, solid};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Frame, Geometry, JointDesc, ShapeDesc, World};

/// Where the chain hangs, and its length [m].
const HOOK: DVec3 = DVec3::new(0.0, 8.0, 0.0);
const CHAIN: f64 = 6.0;
/// Angle at the start [rad].
const ANGLE: f64 = 1.2;
const RADIUS: f32 = 0.6;

/// The ball, raised, and the house behind the lowest point of its way.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, BodyHandle), Error> {
    let (mut world, _) = lawn()?;
    let hook = world.add_body(&fixed(Geometry::cuboid(0.2, 0.2, 0.2)).with_position(HOOK))?;
    let place = HOOK + CHAIN * DVec3::new(-ANGLE.sin(), -ANGLE.cos(), 0.0);
    let iron = ShapeDesc::new(Geometry::sphere(RADIUS)).with_density(7_900.0);
    let ball = world.add_body(&BodyDesc::dynamic().with_position(place).with_shape(iron))?;
    let chain = JointDesc::distance([hook, ball], [Frame::default(); 2], 0.0, CHAIN as f32);
    world.add_joint(&chain)?;
    // Four walls of blocks, one on another, and a roof on each storey.
    for storey in 0..4 {
        let floor = 1.2 * storey as f32;
        for i in 0..12 {
            let (column, row) = ((i % 3) as f32, (i / 3) as f32);
            let place = Vec3::new(1.2 + column, floor + 0.5, row - 1.5);
            if column != 1.0 || row == 0.0 || row == 3.0 {
                world.add_body(&solid(Geometry::cuboid(0.25, 0.5, 0.25)).with_position(place))?;
            }
        }
        let slab = solid(Geometry::cuboid(1.4, 0.1, 1.9));
        world.add_body(&slab.with_position(Vec3::new(2.2, floor + 1.1, 0.0)))?;
    }
    Ok((world, ball))
}

#[test]
fn it_is_as_fast_as_a_pendulum_and_the_house_falls() -> Result<(), Error> {
    let (mut world, ball) = build()?;
    while world.position(ball)?.x < 0.0 {
        world.step(1.0 / 60.0)?;
    }
    // v² = 2 g l (1 - cos a) at the lowest point.
    let expected = (2.0 * 9.81 * CHAIN * (1.0 - ANGLE.cos())).sqrt();
    let speed = f64::from(world.linear_velocity(ball)?.length());
    assert!((speed - expected).abs() < 0.02 * expected, "{speed} of {expected} m/s");
    crate::parts::run(&mut world, 10.0)?;
    let high = |&body: &BodyHandle| world.position(body).is_ok_and(|at| at.y > 4.0 && at.y < 7.0);
    assert_eq!(world.bodies().filter(high).count(), 0, "the roof is down");
    Ok(())
}
