//! Stairs: characters climb steps of 10 to 30 cm, and one stands before steps that are too high for it.
//! Keys: arrows walk all of them, space jumps; without keys they walk up and down.

use crate::parts::{Driven, fixed, level_world};
use crate::walker::{Walker, walk_all, wish};
use backstop::glam::Vec3;
use backstop::{Error, Geometry, World};

/// Heights of the steps [m]. Characters climb up to 0.3 m by default.
const STEPS: [f32; 4] = [0.1, 0.2, 0.3, 0.4];
const COUNT: usize = 8;
/// Depth of a step, and half the width of a flight [m].
const DEPTH: f32 = 0.4;
const HALF: f32 = 0.8;
/// How fast they walk without keys [m/s], and how long up, and down [s].
const SPEED: f32 = 2.5;
const LEG: f64 = 3.2;

/// Four flights with a platform at the top, and a character before each.
pub fn start() -> Result<Driven, Error> {
    let (world, walkers) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let up = ((tick.time / LEG) as u32).is_multiple_of(2);
        let alone = Vec3::NEG_Z * if up { SPEED } else { -SPEED };
        walk_all(&walkers, world, wish(&tick.controls, alone), tick.dt)
    }))
}

fn build() -> Result<(World, Vec<Walker>), Error> {
    let (mut world, _) = level_world()?;
    let mut walkers = Vec::new();
    for (i, height) in STEPS.into_iter().enumerate() {
        let x = 2.0 * i as f32 - 3.0;
        for step in 0..COUNT {
            // The last one is the platform.
            let depth = if step == COUNT - 1 { 8.0 * DEPTH } else { DEPTH };
            let top = height * (step + 1) as f32;
            let middle = Vec3::new(x, 0.5 * top, -DEPTH * step as f32 - 0.5 * depth);
            let block = Geometry::cuboid(HALF, 0.5 * top, 0.5 * depth);
            world.add_body(&fixed(block).with_position(middle))?;
        }
        walkers.push(Walker::add_to(&mut world, Vec3::new(x, 0.0, 2.5))?);
    }
    Ok((world, walkers))
}

#[test]
fn three_reach_the_top() -> Result<(), Error> {
    let (mut sample, walkers) = (start()?, build()?.1);
    crate::parts::run(&mut sample, LEG)?;
    for (walker, height) in walkers.iter().zip(STEPS) {
        let feet = walker.feet(crate::Running::world(&sample))?.y as f32;
        let expected = if height > 0.301 { 0.0 } else { COUNT as f32 * height };
        assert!((feet - expected).abs() < 0.01, "{feet} of {expected} m");
    }
    Ok(())
}
