//! Pushing crates: a character pushes crates that friction holds with less than its strength of 500 N.
//! Keys: arrows walk all of them, space jumps; without keys they push, and go back.

use crate::parts::{Driven, level_world};
use crate::walker::{Walker, walk_all, wish};
use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Error, Geometry, ShapeDesc, World};

/// Masses of the crates [kg]: friction of 0.6 holds up to 85 kg with less than 500 N.
const MASSES: [f32; 4] = [10.0, 40.0, 75.0, 120.0];
/// Half the edge of a crate [m].
const HALF: f32 = 0.5;
/// How fast they walk without keys [m/s], and how long to the crates, and back [s].
const SPEED: f32 = 1.5;
const LEG: f64 = 8.0;

/// Rows of crates, and a character before each.
pub fn start() -> Result<Driven, Error> {
    let (world, walkers, _) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let there = ((tick.time / LEG) as u32).is_multiple_of(2);
        let alone = Vec3::NEG_Z * if there { SPEED } else { -SPEED };
        walk_all(&walkers, world, wish(&tick.controls, alone), tick.dt)
    }))
}

fn build() -> Result<(World, Vec<Walker>, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let (mut walkers, mut crates) = (Vec::new(), Vec::new());
    for (i, mass) in MASSES.into_iter().enumerate() {
        let x = 2.0 * i as f32 - 3.0;
        let shape = ShapeDesc::new(Geometry::cuboid(HALF, HALF, HALF));
        let shape = shape.with_density(mass / (8.0 * HALF * HALF * HALF));
        let body = BodyDesc::dynamic().with_position(Vec3::new(x, HALF, 0.0)).with_shape(shape);
        crates.push(world.add_body(&body)?);
        walkers.push(Walker::add_to(&mut world, Vec3::new(x, 0.0, 2.0))?);
    }
    Ok((world, walkers, crates))
}

#[test]
fn the_light_ones_move() -> Result<(), Error> {
    let (mut sample, crates) = (start()?, build()?.2);
    crate::parts::run(&mut sample, LEG)?;
    for (body, mass) in crates.iter().zip(MASSES) {
        let way = -crate::Running::world(&sample).position(*body)?.z;
        // Friction holds 0.6 m g. A push is an impulse at the beginning of a step: it moves a heavy crate by
        // up to 0.2 mm before friction has taken it, in 430 steps.
        let expected = if 0.6 * mass * 9.81 < 500.0 { 1.5..=12.0 } else { 0.0..=0.09 };
        assert!(expected.contains(&way), "{mass} kg: {way} m");
    }
    Ok(())
}
