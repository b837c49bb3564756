//! Filters: of three kinds of balls, red pass the red wall, blue the blue one, and grey pass neither.

use crate::parts::{level_world, spread};
use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Error, Filter, Geometry, Material, ShapeDesc, World};

/// Categories of walls.
const RED: u64 = 2;
const BLUE: u64 = 4;
/// Walls that each kind of ball does not collide with.
const KINDS: [u64; 3] = [RED, BLUE, 0];
const BALLS: usize = 60;
/// Where the walls are along x [m].
const WALLS: [(f32, u64); 2] = [(0.0, RED), (3.0, BLUE)];

/// Balls which roll towards two walls.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    for (x, category) in WALLS {
        let wall = ShapeDesc::new(Geometry::cuboid(0.1, 0.6, 4.0));
        let wall = wall.with_filter(Filter::default().with_category(category));
        world.add_body(&BodyDesc::fixed().with_position(Vec3::new(x, 0.6, 0.0)).with_shape(wall))?;
    }
    // Rubber, which comes back.
    let rubber = Material::default().with_restitution(0.8).with_rolling_friction(0.002);
    let mut balls = Vec::new();
    for i in 0..BALLS {
        let filter = Filter::default().with_mask(!KINDS[i % 3]);
        let ball = ShapeDesc::new(Geometry::sphere(0.15)).with_filter(filter).with_material(rubber);
        let place = Vec3::new(-3.0 - 0.1 * i as f32, 0.15, 5.0 * spread(i) - 2.5);
        let ball = BodyDesc::dynamic().with_position(place).with_shape(ball).with_user_data(i as u64 % 3);
        balls.push(world.add_body(&ball.with_linear_velocity(Vec3::X * 4.0))?);
    }
    Ok((world, balls))
}

#[test]
fn each_goes_as_far_as_it_may() -> Result<(), Error> {
    let (mut world, balls) = build()?;
    for _ in 0..60 * 10 {
        world.step(1.0 / 60.0)?;
        for &ball in &balls {
            // Red ones stop at the blue wall, the others at the red one.
            let end = if world.user_data(ball)? == 0 { 3.0 } else { 0.0 };
            let place = world.position(ball)?;
            assert!(place.x < end - 0.24 || place.z.abs() > 4.0, "{place} m");
        }
    }
    Ok(())
}
