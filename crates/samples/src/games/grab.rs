//! Grab: a hand which the program moves holds a box by a spring and drags it over the others.
//! Keys: the action lets go.

use crate::parts::{Driven, level_world, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Axis, BodyDesc, BodyHandle, Error, Geometry, JointDesc, JointHandle, Motion, Motor, Spring, World};
use std::f64::consts::TAU;

/// How hard the hand pulls, and its greatest force along each axis [N].
const PULL: Spring = Spring::Frequency { hertz: 3.0, ratio: 0.7 };
const FORCE: f32 = 5_000.0;
/// Half the width and height of the way of the hand [m], and the time that it takes [s].
const WIDE: f64 = 2.5;
const HIGH: f64 = 1.0;
const PERIOD: f64 = 6.0;

/// The hand at its box, and boxes around.
pub fn start() -> Result<Driven, Error> {
    let (world, hand, _, grip) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        if tick.controls.action && world.contains_joint(grip) {
            world.remove_joint(grip)?;
        }
        world.move_kinematic_and_stop(hand, way(tick.time + f64::from(tick.dt)), Quat::IDENTITY, tick.dt)
    }))
}

/// A figure of eight.
fn way(time: f64) -> DVec3 {
    let angle = TAU * time / PERIOD;
    DVec3::new(WIDE * angle.sin(), 1.8 + HIGH * (2.0 * angle).sin(), 0.5)
}

fn build() -> Result<(World, BodyHandle, BodyHandle, JointHandle), Error> {
    let (mut world, _) = level_world()?;
    for i in 0..12 {
        let place = Vec3::new((i % 4) as f32 * 1.3 - 2.0, 0.3 + 0.6 * (i / 4) as f32, -0.4);
        world.add_body(&solid(Geometry::cuboid(0.3, 0.3, 0.3)).with_position(place))?;
    }
    let hand = world.add_body(&BodyDesc::kinematic().with_position(way(0.0)))?;
    let cube = solid(Geometry::cuboid(0.35, 0.35, 0.35)).with_position(way(0.0) - DVec3::Y * 0.35);
    let cube = world.add_body(&cube)?;
    // By a point of its upper face.
    let frames = world.frames_about([hand, cube], way(0.0), Vec3::X)?;
    let pull = |axis| Motor::position(Motion::Linear, axis, 0.0, PULL).with_max_force(FORCE);
    let grip = Axis::ALL.iter().fold(JointDesc::new([hand, cube], frames), |grip, &axis| grip.with_motor(pull(axis)));
    let grip = world.add_joint(&grip)?;
    Ok((world, hand, cube, grip))
}

#[test]
fn the_box_follows_the_hand() -> Result<(), Error> {
    let (mut sample, (_, hand, cube, _)) = (start()?, build()?);
    crate::parts::run(&mut sample, 5.0 * PERIOD)?;
    let world = crate::Running::world(&sample);
    // The spring is longer by g / (2 pi f)², and by what the way accelerates.
    let sag = world.position(hand)?.y - world.position(cube)?.y;
    assert!((sag - 0.35 - 9.81 / (TAU * 3.0).powi(2)).abs() < 0.1, "{sag} m");
    Ok(())
}
