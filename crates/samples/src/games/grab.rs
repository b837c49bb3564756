//! Grab: a hand which the program moves holds a box by a spring and drags it over the others.
//! Keys: the action lets go.

use crate::parts::{Driven, level_world, solid};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyHandle, Error, Geometry, Grab, GrabSettings, World};
use std::f64::consts::TAU;

/// Frequency of the spring [Hz].
const HERTZ: f32 = 3.0;
/// Half the width and height of the way of the hand [m], and the time that it takes [s].
const WIDE: f64 = 2.5;
const HIGH: f64 = 1.0;
const PERIOD: f64 = 6.0;
/// Half the edge of the box [m].
const HALF: f64 = 0.35;

/// The hand at its box, and boxes around.
pub fn start() -> Result<Driven, Error> {
    let (world, grab) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        if !world.contains_joint(grab.joint()) {
            return Ok(());
        }
        if tick.controls.action { grab.release(world) } else { grab.move_to(world, way(tick.time)) }
    }))
}

/// A figure of eight.
fn way(time: f64) -> DVec3 {
    let angle = TAU * time / PERIOD;
    DVec3::new(WIDE * angle.sin(), 1.8 + HIGH * (2.0 * angle).sin(), 0.5)
}

fn build() -> Result<(World, Grab), Error> {
    let (mut world, _) = level_world()?;
    for i in 0..12 {
        let place = Vec3::new((i % 4) as f32 * 1.3 - 2.0, 0.3 + 0.6 * (i / 4) as f32, -0.4);
        world.add_body(&solid(Geometry::cuboid(0.3, 0.3, 0.3)).with_position(place))?;
    }
    let half = HALF as f32;
    let cube = solid(Geometry::cuboid(half, half, half)).with_position(way(0.0) - DVec3::Y * HALF);
    let cube: BodyHandle = world.add_body(&cube)?;
    // By the middle of its upper face.
    let grab = Grab::with_settings(&mut world, cube, way(0.0), &GrabSettings::default().with_hertz(HERTZ))?;
    Ok((world, grab))
}

#[test]
fn the_box_follows_the_hand() -> Result<(), Error> {
    let (mut sample, grab) = (start()?, build()?.1);
    crate::parts::run(&mut sample, 5.0 * PERIOD)?;
    let world = crate::Running::world(&sample);
    // The box is behind by g / w² for its weight, and by 2 v / w while the hand goes up at v.
    let (omega, speed) = (TAU * f64::from(HERTZ), 2.0 * HIGH * TAU / PERIOD);
    let expected = 9.81 / (omega * omega) + 2.0 * speed / omega;
    let behind = grab.target(world)?.y - world.position(grab.body())?.y - HALF;
    assert!((behind - expected).abs() < 0.04, "{behind} of {expected} m");
    Ok(())
}
