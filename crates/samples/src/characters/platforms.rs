//! Moving ground: a lift, a ferry, a turntable and a swing carry the characters that stand on them.
//! Keys: arrows walk all of them, space jumps.

use crate::parts::{Driven, level_world};
use crate::walker::{Walker, walk_all, wish};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, ShapeDesc, World};

/// Angular frequency of the lift, the ferry and the swing, and speed of the turntable [rad/s].
const OMEGA: f64 = 0.8;
/// Half the thickness of the platforms [m].
const HALF: f32 = 0.1;

/// Where the platform of an index is, and how it is turned.
fn pose(i: usize, time: f64) -> (DVec3, Quat) {
    let (place, wave) = (DVec3::new(4.0 * i as f64 - 6.0, 0.4, 0.0), (OMEGA * time).sin());
    match i {
        0 => (place + DVec3::Y * (1.5 - 1.5 * (OMEGA * time).cos()), Quat::IDENTITY),
        1 => (place + DVec3::Z * (3.0 * wave), Quat::IDENTITY),
        2 => (place, Quat::from_rotation_y((OMEGA * time) as f32)),
        _ => (place + DVec3::Y, Quat::from_rotation_x(0.3 * wave as f32)),
    }
}

/// The platforms, and a character on each, on the outer part of the turntable.
pub fn start() -> Result<Driven, Error> {
    let (world, platforms, walkers) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        for (i, &platform) in platforms.iter().enumerate() {
            let (at, turned) = pose(i, tick.time + f64::from(tick.dt));
            world.move_kinematic_and_stop(platform, at, turned, tick.dt)?;
        }
        walk_all(&walkers, world, wish(&tick.controls, Vec3::ZERO), tick.dt)
    }))
}

fn build() -> Result<(World, Vec<BodyHandle>, Vec<Walker>), Error> {
    let (mut world, _) = level_world()?;
    let (mut platforms, mut walkers) = (Vec::new(), Vec::new());
    for i in 0..4 {
        let shape = if i == 2 { Geometry::cylinder(HALF, 1.6) } else { Geometry::cuboid(1.2, HALF, 1.2) };
        let (at, shape) = (pose(i, 0.0).0, ShapeDesc::new(shape));
        platforms.push(world.add_body(&BodyDesc::kinematic().with_position(at).with_shape(shape))?);
        walkers.push(Walker::add_to(&mut world, at + DVec3::new(0.8, HALF.into(), 0.0))?);
    }
    Ok((world, platforms, walkers))
}

#[test]
fn they_stay_where_they_stand() -> Result<(), Error> {
    let (mut sample, walkers) = (start()?, build()?.2);
    crate::parts::run(&mut sample, 30.0)?;
    for (i, walker) in walkers.iter().enumerate() {
        // Ground that moves in a step carries them in the next.
        let (at, turned) = pose(i, 30.0 - 1.0 / 60.0);
        let place = at + (turned * Vec3::new(0.8, HALF, 0.0)).as_dvec3();
        assert!(walker.feet(crate::Running::world(&sample))?.distance(place) < 0.05, "platform {i}");
    }
    Ok(())
}
