//! Voxels: cubes of a block are removed one after another, and the balls on them fall.

use crate::parts::{Driven, fixed, level_world, solid};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyHandle, Error, Geometry, QueryFilter, Ray, World};

/// Cubes along each edge, and half the edge of one [m].
const SIDE: usize = 8;
const HALF: f32 = 0.5;
/// Time between two cubes [s].
const PERIOD: f64 = 0.1;

/// A block of cubes, with balls on top.
pub fn start() -> Result<Driven, Error> {
    let (world, _) = build()?;
    Ok(Driven::new(world, |world, tick| {
        let number = (tick.time / PERIOD) as usize;
        // Once in each period, in the step in which it begins.
        if ((tick.time + f64::from(tick.dt)) / PERIOD) as usize == number {
            return Ok(());
        }
        // The first cube below a place that goes around in a spiral.
        let (angle, radius) = (2.4 * number as f64, 0.25 * (number as f64).sqrt());
        let from = DVec3::new(radius * angle.cos(), 20.0, radius * angle.sin());
        match world.cast_ray(&Ray::new(from, Vec3::NEG_Y * 30.0), &QueryFilter::only_static())? {
            Some(hit) if hit.point.y > 0.5 => world.remove_body(hit.body),
            _ => Ok(()),
        }
    }))
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let cube = fixed(Geometry::cuboid(HALF, HALF, HALF));
    for i in 0..SIDE * SIDE * SIDE / 2 {
        let (x, z, y) = (i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE);
        let place = Vec3::new(x as f32 - 3.5, y as f32 + 0.5, z as f32 - 3.5) * 2.0 * HALF;
        world.add_body(&cube.clone().with_position(place))?;
    }
    let mut balls = Vec::new();
    for i in 0..64 {
        let place = Vec3::new((i % 8) as f32 - 3.4, 4.5, (i / 8) as f32 - 3.6);
        balls.push(world.add_body(&solid(Geometry::sphere(0.3)).with_position(place))?);
    }
    Ok((world, balls))
}

#[test]
fn balls_fall_as_cubes_go() -> Result<(), Error> {
    let mut sample = start()?;
    let before = crate::Running::world(&sample).body_count();
    crate::parts::run(&mut sample, 20.0)?;
    let world = crate::Running::world(&sample);
    // One cube a period, for as long as there are cubes where it digs.
    let gone = before - world.body_count();
    assert!((150..=200).contains(&gone), "{gone}");
    let deep = |&body: &BodyHandle| world.position(body).is_ok_and(|at| at.y > 0.0 && at.y < 1.0);
    assert!(world.awake_bodies().filter(deep).count() > 10);
    Ok(())
}
