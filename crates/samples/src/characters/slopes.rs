//! Slopes: characters walk up ramps of 20 to 65 degrees; those steeper than 50 degrees they slide down.
//! Keys: arrows walk all of them, space jumps; without keys they walk up and down.

use crate::parts::{Driven, fixed, level_world};
use crate::walker::{Walker, walk_all, wish};
use backstop::glam::{Quat, Vec3};
use backstop::{Error, Geometry, World};

/// Angles of the ramps [degrees]. Characters walk on up to 50 by default.
const ANGLES: [f32; 5] = [20.0, 35.0, 45.0, 55.0, 65.0];
/// Length and half the width of a ramp [m].
const LENGTH: f32 = 9.0;
const HALF: f32 = 0.7;
/// How far up a ramp they begin [m].
const BEGIN: f32 = 4.5;
/// How fast they walk without keys [m/s], and how long up, and down [s].
const SPEED: f32 = 0.8;
const LEG: f64 = 4.0;

/// The ramps, and a character in the middle of each.
pub fn start() -> Result<Driven, Error> {
    let (world, walkers) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let alone = Vec3::NEG_Z * if ((tick.time / LEG) as u32).is_multiple_of(2) { SPEED } else { -SPEED };
        walk_all(&walkers, world, wish(&tick.controls, alone), tick.dt)
    }))
}

fn build() -> Result<(World, Vec<Walker>), Error> {
    let (mut world, _) = level_world()?;
    let mut walkers = Vec::new();
    for (i, degrees) in ANGLES.into_iter().enumerate() {
        let x = 1.6 * i as f32 - 3.2;
        let turned = Quat::from_rotation_x(degrees.to_radians());
        let foot = Vec3::X * x;
        let ramp = fixed(Geometry::cuboid(HALF, 0.1, 0.5 * LENGTH))
            .with_position(foot + turned * Vec3::new(0.0, -0.1, -0.5 * LENGTH))
            .with_rotation(turned);
        world.add_body(&ramp)?;
        // The round bottom of a capsule touches a ramp beside its feet.
        let gap = 0.32 * (1.0 / degrees.to_radians().cos() - 1.0);
        walkers.push(Walker::add_to(&mut world, foot + turned * Vec3::NEG_Z * BEGIN + Vec3::Y * gap)?);
    }
    Ok((world, walkers))
}

#[test]
fn they_get_up_what_is_not_too_steep() -> Result<(), Error> {
    let (mut sample, walkers) = (start()?, build()?.1);
    let before = |walker: &Walker| walker.position(crate::Running::world(&build()?.0));
    crate::parts::run(&mut sample, 2.0)?;
    for (walker, degrees) in walkers.iter().zip(ANGLES) {
        let way = walker.position(crate::Running::world(&sample))? - before(walker)?;
        // Its speed is that over level ground; on the steep ones it falls, and ends on the ground below.
        let climbed = 2.0 * SPEED * degrees.to_radians().tan();
        let right = if degrees < 50.0 { (way.y as f32 - climbed).abs() < 0.05 } else { way.y < -2.0 };
        assert!(right, "{degrees} degrees: {way} m, {climbed} m");
    }
    Ok(())
}
