//! Galton board: balls fall through rows of pins, and most of them end in the bins in the middle.

use crate::parts::{Driven, fixed, solid, spread};
use backstop::glam::{Quat, Vec3};
use backstop::{Error, Geometry, Settings, World};
use std::f32::consts::FRAC_PI_2;

const ROWS: usize = 10;
const COLUMNS: usize = 13;
const BALLS: usize = 48;
/// Distance of two pins in a row, and of two rows [m].
const PITCH: f32 = 0.4;
const DROP: f32 = 0.35;
/// Radii of pins and balls, half the depth of the board, and height of the bins [m].
const PIN: f32 = 0.06;
const RADIUS: f32 = 0.12;
const DEPTH: f32 = 0.1;
const BINS: f32 = 3.0;

/// The board. A ball comes twice a second.
pub fn start() -> Result<Driven, Error> {
    let mut world = World::new(Settings::default())?;
    world.add_body(&fixed(Geometry::cuboid(3.5, 0.1, 1.0)).with_position(Vec3::Y * -0.1))?;
    let pin = fixed(Geometry::cylinder(DEPTH, PIN)).with_rotation(Quat::from_rotation_x(FRAC_PI_2));
    let x = |i: usize, count: usize| PITCH * (i as f32 - 0.5 * (count - 1) as f32);
    for row in 0..ROWS {
        let count = COLUMNS + row % 2;
        for i in 0..count {
            let place = Vec3::new(x(i, count), BINS + DROP * (ROWS - row) as f32, 0.0);
            world.add_body(&pin.clone().with_position(place))?;
        }
    }
    for i in 0..COLUMNS + 2 {
        let high = if i % (COLUMNS + 1) == 0 { BINS + DROP * ROWS as f32 } else { BINS };
        let wall = fixed(Geometry::cuboid(0.02, 0.5 * high, DEPTH));
        world.add_body(&wall.with_position(Vec3::new(x(i, COLUMNS + 2), 0.5 * high, 0.0)))?;
    }
    let empty = world.body_count();
    Ok(Driven::new(world, move |world, tick| {
        let there = world.body_count() - empty;
        // They stay in the plane of the board.
        let ball = solid(Geometry::sphere(RADIUS)).with_lock_translation([false, false, true]);
        let place = Vec3::new(0.02 * (spread(there) - 0.5), BINS + DROP * (ROWS + 1) as f32, 0.0);
        let due = there < BALLS && 2.0 * tick.time >= there as f64;
        if due { world.add_body(&ball.with_position(place)).map(drop) } else { Ok(()) }
    }))
}

#[test]
fn most_are_in_the_middle() -> Result<(), Error> {
    let mut sample = start()?;
    crate::parts::run(&mut sample, 32.0)?;
    let world = crate::Running::world(&sample);
    let places: Vec<_> = world.awake_bodies().flat_map(|ball| world.position(ball)).collect();
    let mean = places.iter().map(|at| at.x).sum::<f64>() / BALLS as f64;
    let deviation = (places.iter().map(|at| at.x * at.x).sum::<f64>() / BALLS as f64).sqrt();
    // Independent steps of half a pitch would deviate by sqrt(10) / 2 pitches: 0.63 m.
    assert!(mean.abs() < 0.15 && deviation > 0.2 && deviation < 0.63, "{mean} m, {deviation} m");
    Ok(())
}
