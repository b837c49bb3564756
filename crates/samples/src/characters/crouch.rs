//! Crouching: a character ducks where a beam is in the way, and gets up once there is room above it.
//! Keys: arrows walk, space jumps, E ducks; without keys it walks to and fro.

use crate::parts::{Driven, fixed, level_world};
use crate::walker::{RUN, Walker, wish};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Error, Geometry, QueryFilter, World};

/// How long it walks one way [s].
const LEG: f64 = 8.0;
/// How far ahead it looks for a beam [m].
const AHEAD: f32 = 0.4;
/// Half the height of its cylinder when it ducks [m]: 1 m tall instead of 1.8 m.
const DUCKED: f32 = 0.2;
/// The bottom of the beams [m].
const BEAM: f32 = 1.3;

/// Beams of different width, and the character before them.
pub fn start() -> Result<Driven, Error> {
    let (world, walker) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let alone = Vec3::X * if ((tick.time / LEG) as u32).is_multiple_of(2) { RUN } else { -RUN };
        let wish = wish(&tick.controls, alone);
        // Whether a character that stands would hit a beam here, or a little further.
        let middle = walker.feet(world)? + DVec3::Y * 0.92;
        let standing = Geometry::capsule(0.6, 0.3);
        let hits = |at| world.overlap_any(&standing, at, Quat::IDENTITY, &QueryFilter::only_static());
        let ahead = (wish.with_y(0.0).normalize_or_zero() * AHEAD).as_dvec3();
        let ducks = tick.controls.action || hits(middle)? || hits(middle + ahead)?;
        walker.set_half_height(world, if ducks { DUCKED } else { 0.6 })?;
        walker.walk(world, wish * if ducks { 0.5 } else { 1.0 }, tick.dt).map(drop)
    }))
}

fn build() -> Result<(World, Walker), Error> {
    let (mut world, _) = level_world()?;
    for (x, half) in [(-4.0, 0.2), (0.0, 1.0), (3.0, 0.1), (4.0, 0.1)] {
        let beam = Geometry::cuboid(half, 0.25, 1.5);
        world.add_body(&fixed(beam).with_position(Vec3::new(x, BEAM + 0.25, 0.0)))?;
    }
    let walker = Walker::add_to(&mut world, Vec3::X * -7.0)?;
    Ok((world, walker))
}

#[test]
fn it_gets_through_and_up_again() -> Result<(), Error> {
    let (mut sample, walker) = (start()?, build()?.1);
    for tick in crate::Tick::during(LEG) {
        crate::Running::step(&mut sample, &tick)?;
        let (world, half) = (crate::Running::world(&sample), 0.9);
        let (at, head) = (walker.feet(world)?, 2.0 * walker.position(world)?.y - walker.feet(world)?.y);
        // Its middle is never below a beam unless it is 1 m tall.
        assert!(at.x.abs() > 1.0 || head < BEAM.into(), "{head} m at {at}");
        assert!(tick.time < 7.0 || at.x > 5.0 && head > 2.0 * half - 0.01, "{head} m at {at}");
    }
    Ok(())
}
