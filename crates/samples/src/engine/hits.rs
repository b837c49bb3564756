//! Hits: events tell where balls strike the ground and how fast, and marks grow with the speed.

use crate::parts::{Driven, level_world, spread};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Material, ShapeDesc, ShapeHandle, World};

const BALLS: usize = 40;
const RADIUS: f32 = 0.15;
/// Size of a mark [m] for a speed of 1 m/s.
const SIZE: f32 = 0.06;

/// Balls at several heights, and a mark for each.
pub fn start() -> Result<Driven, Error> {
    let (world, marks) = build()?;
    Ok(Driven::new(world, move |world, _| {
        // Those of the step before. The user data of a ball is its number.
        for hit in world.contact_hits().to_vec() {
            let number = hit.bodies.iter().flat_map(|&body| world.user_data(body)).max();
            let Some(&(mark, shape)) = number.and_then(|i| marks.get(i as usize - 1)) else { continue };
            world.set_pose(mark, hit.point, Quat::IDENTITY)?;
            world.set_geometry(shape, Geometry::cylinder(0.01, SIZE * hit.approach_speed))?;
        }
        Ok(())
    }))
}

fn build() -> Result<(World, Vec<(BodyHandle, ShapeHandle)>), Error> {
    let (mut world, _) = level_world()?;
    let rubber = Material::default().with_restitution(0.9);
    let mut marks = Vec::new();
    for i in 0..BALLS {
        let place = Vec3::new((i % 8) as f32 - 3.5, 1.0 + 5.0 * spread(i), (i / 8) as f32 - 2.0);
        let ball = ShapeDesc::new(Geometry::sphere(RADIUS)).with_material(rubber).with_events();
        let ball = BodyDesc::dynamic().with_position(place).with_shape(ball);
        world.add_body(&ball.with_user_data(i as u64 + 1))?;
        let mark = world.add_body(&BodyDesc::kinematic().with_position(place.with_y(-1.0)))?;
        let disc = ShapeDesc::new(Geometry::cylinder(0.01, 0.01)).as_sensor();
        marks.push((mark, world.add_shape(mark, &disc)?));
    }
    Ok((world, marks))
}

#[test]
fn they_strike_as_fast_as_they_fall() -> Result<(), Error> {
    let (mut world, _) = build()?;
    let mut first = [0.0_f32; BALLS];
    for _ in 0..70 {
        world.step(1.0 / 60.0)?;
        for hit in world.contact_hits() {
            let number = hit.bodies.iter().flat_map(|&body| world.user_data(body)).max().unwrap_or(1);
            first[number as usize - 1] = hit.approach_speed.max(first[number as usize - 1]);
        }
    }
    for (i, speed) in first.into_iter().enumerate() {
        // v² = 2 g h.
        let expected = (2.0 * 9.81 * (1.0 + 5.0 * spread(i) - RADIUS)).sqrt();
        assert!((speed / expected - 1.0).abs() < 0.02, "{i}: {speed} of {expected} m/s");
    }
    Ok(())
}
