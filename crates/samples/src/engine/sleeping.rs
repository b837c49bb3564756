//! Sleep: towers at rest fall asleep, and a ball wakes those that it strikes and no others.
//! Keys: the action sends the ball again.

use crate::parts::{Driven, level_world_with, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyHandle, Error, Geometry, Settings, World};

/// Towers along each side of the square, cubes in each, and half the edge of a cube [m].
const SIDE: usize = 5;
const CUBES: usize = 6;
const HALF: f32 = 0.25;
/// When the ball comes [s], from where [m], and how fast [m/s].
const TIME: f64 = 4.0;
const PLACE: DVec3 = DVec3::new(0.0, 1.2, 9.0);
const SPEED: f32 = 15.0;

/// The towers, and the ball in front of them.
pub fn start() -> Result<Driven, Error> {
    let (world, ball) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let due = (TIME..TIME + f64::from(tick.dt)).contains(&tick.time);
        if due || tick.controls.action {
            world.set_pose(ball, PLACE, Quat::IDENTITY)?;
            world.set_velocity(ball, Vec3::NEG_Z * SPEED, Vec3::ZERO)?;
        }
        Ok(())
    }))
}

fn build() -> Result<(World, BodyHandle), Error> {
    let (mut world, _) = level_world_with(Settings::default().with_sleeping(true))?;
    let cube = solid(Geometry::cuboid(HALF, HALF, HALF));
    for tower in 0..SIDE * SIDE {
        let (x, z) = (2.0 * (tower % SIDE) as f32 - 4.0, 2.0 * (tower / SIDE) as f32 - 4.0);
        for i in 0..CUBES {
            let place = Vec3::new(x, HALF * (2 * i + 1) as f32, z);
            world.add_body(&cube.clone().with_position(place))?;
        }
    }
    let ball = solid(Geometry::sphere(0.4)).with_position(DVec3::new(0.0, 0.4, 9.0));
    let ball = world.add_body(&ball)?;
    Ok((world, ball))
}

#[test]
fn only_what_is_struck_wakes() -> Result<(), Error> {
    let all = SIDE * SIDE * CUBES + 1;
    let mut sample = start()?;
    for tick in crate::Tick::during(5.0) {
        crate::Running::step(&mut sample, &tick)?;
        let asleep = crate::Running::world(&sample).sleeping_body_count();
        // Everything is at rest from the start, and falls asleep after half a second.
        assert!(!(1.0..TIME - 0.1).contains(&tick.time) || asleep == all, "{asleep} at {} s", tick.time);
    }
    let awake = all - crate::Running::world(&sample).sleeping_body_count();
    assert!(awake > 3 && awake <= 1 + SIDE * CUBES, "{awake}");
    Ok(())
}
