//! Pyramid: two hundred cubes stand on each other, and a ball lies on the top one.

use crate::parts::{level_world, solid};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyHandle, Error, Geometry, World};

/// Cubes along an edge of the lowest layer.
const LAYERS: usize = 8;
/// Half of a cube's edge [m].
const HALF: f32 = 0.25;
/// Room between neighbours [m].
const GAP: f32 = 0.02;

/// The pyramid.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, BodyHandle), Error> {
    let (mut world, _) = level_world()?;
    let cube = solid(Geometry::cuboid(HALF, HALF, HALF));
    let pitch = 2.0 * HALF + GAP;
    for layer in 0..LAYERS {
        let side = LAYERS - layer;
        let first = -0.5 * pitch * (side - 1) as f32;
        for i in 0..side * side {
            let (row, column) = (i / side, i % side);
            let x = first + pitch * column as f32;
            let z = first + pitch * row as f32;
            let y = HALF * (2 * layer + 1) as f32;
            world.add_body(&cube.clone().with_position(Vec3::new(x, y, z)))?;
        }
    }
    let top = DVec3::Y * f64::from(2.0 * HALF * LAYERS as f32 + 0.15);
    let ball = world.add_body(&solid(Geometry::sphere(0.15)).with_position(top))?;
    Ok((world, ball))
}

#[test]
fn the_ball_stays_on_top() -> Result<(), Error> {
    let (mut world, ball) = build()?;
    crate::parts::run(&mut world, 10.0)?;
    // Eight cubes of 0.5 m and the radius of the ball.
    let place = world.position(ball)?;
    assert!((place - DVec3::Y * 4.15).length() < 0.01, "{place}");
    Ok(())
}
