//! Wall: an iron ball at 20 m/s goes through a wall of bricks.

use crate::parts::{lawn, solid};
use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Error, Geometry, ShapeDesc, World};

const ROWS: usize = 10;
const COLUMNS: usize = 14;
/// Half extents of a brick [m]: it lies along x.
const BRICK: Vec3 = Vec3::new(0.4, 0.2, 0.2);
/// Speed of the ball [m/s].
const SPEED: f32 = 20.0;

/// The wall, and the ball on its way.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>, BodyHandle), Error> {
    let (mut world, _) = lawn()?;
    let brick = solid(Geometry::cuboid(BRICK.x, BRICK.y, BRICK.z));
    let mut bricks = Vec::new();
    for row in 0..ROWS {
        // Each row is shifted by half a brick.
        let shift = if row % 2 == 0 { 0.0 } else { BRICK.x };
        for column in 0..COLUMNS {
            let x = 2.0 * BRICK.x * (column as f32 - 0.5 * COLUMNS as f32) + shift;
            let y = BRICK.y * (2 * row + 1) as f32;
            bricks.push(world.add_body(&brick.clone().with_position(Vec3::new(x, y, 0.0)))?);
        }
    }
    let iron = ShapeDesc::new(Geometry::sphere(0.5)).with_density(7_900.0);
    let ball = BodyDesc::dynamic()
        .with_position(Vec3::new(0.0, 2.0, 12.0))
        .with_velocity(Vec3::NEG_Z * SPEED, Vec3::ZERO)
        .with_shape(iron);
    let ball = world.add_body(&ball)?;
    Ok((world, bricks, ball))
}

#[test]
fn the_ball_comes_out_slower() -> Result<(), Error> {
    let (mut world, bricks, ball) = build()?;
    crate::parts::run(&mut world, 1.2)?;
    assert!(world.position(ball)?.z < -0.7, "it is behind the wall");
    // It shares its momentum with some bricks, of which each has 1/32 of its mass.
    let speed = -world.linear_velocity(ball)?.z;
    assert!(speed > 0.3 * SPEED && speed < SPEED, "{speed} m/s");
    crate::parts::run(&mut world, 10.0)?;
    // The lowest bricks at both ends stay within a brick of where they were.
    for (brick, x) in [(bricks[0], -5.6), (bricks[COLUMNS - 1], 4.8)] {
        assert!((world.position(brick)?.x - x).abs() < 0.8, "{}", world.position(brick)?);
    }
    Ok(())
}
