//! Rocks: ninety-six convex hulls, no two alike, slide down a chute and pile up.

use crate::parts::{fixed, level_world, solid, spread};
use backstop::glam::{Quat, Vec3};
use backstop::{ConvexHull, Error, Geometry, World};
use std::f32::consts::TAU;

const COUNT: usize = 96;
/// Corners of a rock, and its mean radius [m].
const CORNERS: usize = 14;
const RADIUS: f32 = 0.3;
/// Slope of the chute [rad]; friction of 0.6 would hold a block up to 0.54.
const SLOPE: f32 = 0.7;

/// The chute, and the rocks above it.
pub fn start() -> Result<World, Error> {
    let (mut world, _) = level_world()?;
    let down = Quat::from_rotation_z(-SLOPE);
    let chute = Vec3::new(-3.0, 2.6, 0.0);
    world.add_body(&fixed(Geometry::cuboid(3.0, 0.1, 1.5)).with_position(chute).with_rotation(down))?;
    for side in [-1.5, 1.5] {
        let rail = fixed(Geometry::cuboid(3.0, 0.4, 0.1)).with_rotation(down);
        world.add_body(&rail.with_position(chute + Vec3::Z * side + down * Vec3::Y * 0.4))?;
    }
    for i in 0..COUNT {
        let place = Vec3::new(
            -4.9 + 0.7 * (i % 3) as f32,
            5.2 + 0.7 * (i / 9) as f32,
            0.7 * (i / 3 % 3) as f32 - 0.7,
        );
        world.add_body(&solid(rock(i)?).with_position(place))?;
    }
    Ok(world)
}

/// A hull of points near a ball.
fn rock(index: usize) -> Result<Geometry, Error> {
    let corner = |i: usize| {
        let (turn, height) = (TAU * spread(i + 31 * index), 2.0 * spread(17 * i + 3 * index) - 1.0);
        let across = (1.0 - height * height).sqrt();
        let stretch = RADIUS * (0.8 + 0.4 * spread(5 * i + index));
        stretch * Vec3::new(across * turn.cos(), height, across * turn.sin())
    };
    let corners: Vec<Vec3> = (0..CORNERS).map(corner).collect();
    Ok(Geometry::hull(ConvexHull::new(&corners)?))
}

#[test]
fn they_come_to_rest_on_the_ground() -> Result<(), Error> {
    let mut world = start()?;
    crate::parts::run(&mut world, 25.0)?;
    let mut moving = 0;
    for body in world.bodies() {
        assert!(world.position(body)?.y > -0.01, "none is below the ground");
        moving += usize::from(world.linear_velocity(body)?.length() > 0.1);
    }
    assert_eq!(moving, 0);
    Ok(())
}
