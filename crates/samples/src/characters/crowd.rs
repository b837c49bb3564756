//! Crowd: sixty characters walk through each other to the other side of a square, around a pillar and balls.
//! Keys: space makes all of them jump.

use crate::parts::{Driven, fixed, level_world, solid, spread};
use crate::walker::{JUMP, Walker};
use backstop::glam::Vec3;
use backstop::{Error, Geometry, World};
use std::f32::consts::TAU;

const COUNT: usize = 60;
/// How fast they walk [m/s], and how long before they turn back [s].
const SPEED: f32 = 2.0;
const LEG: f64 = 18.0;

/// The characters on a circle, each walks to the other side.
pub fn start() -> Result<Driven, Error> {
    let (world, walkers) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let jump = Vec3::Y * if tick.controls.jump { JUMP } else { 0.0 };
        for (i, walker) in walkers.iter().enumerate() {
            let goal = if ((tick.time / LEG) as u32).is_multiple_of(2) { -place(i) } else { place(i) };
            let way = (goal.as_dvec3() - walker.feet(world)?).as_vec3();
            // Each keeps to the right, and so they get past each other.
            let way = Vec3::new(way.x - way.z, 0.0, way.z + way.x).clamp_length_max(1.0);
            walker.walk(world, way * SPEED + jump, tick.dt)?;
        }
        Ok(())
    }))
}

/// Where a character begins [m].
fn place(i: usize) -> Vec3 {
    let angle = TAU * i as f32 / COUNT as f32;
    Vec3::new(angle.cos(), 0.0, angle.sin()) * (9.0 + (i % 2) as f32)
}

fn build() -> Result<(World, Vec<Walker>), Error> {
    let (mut world, _) = level_world()?;
    world.add_body(&fixed(Geometry::cylinder(1.0, 0.8)).with_position(Vec3::Y))?;
    for i in 0..12 {
        let at = Vec3::new(12.0 * spread(i) - 6.0, 0.3, 12.0 * spread(7 * i) - 6.0);
        world.add_body(&solid(Geometry::sphere(0.2)).with_position(at))?;
    }
    let walkers = (0..COUNT).map(|i| Walker::add_to(&mut world, place(i))).collect::<Result<_, _>>()?;
    Ok((world, walkers))
}

#[test]
fn they_get_across_and_not_into_each_other() -> Result<(), Error> {
    let (mut sample, walkers) = (start()?, build()?.1);
    crate::parts::run(&mut sample, LEG)?;
    let feet = |i: usize| walkers[i].feet(crate::Running::world(&sample)).unwrap_or_default();
    let across = (0..COUNT).filter(|&i| feet(i).distance(-place(i).as_dvec3()) < 1.0).count();
    assert_eq!(across, COUNT);
    // Two radii of 0.3 m, less the skin of 2 cm, into which another may walk.
    let apart = |i: usize| (0..i).all(|j| feet(i).distance(feet(j)) > 0.56);
    assert!((0..COUNT).all(apart));
    Ok(())
}
