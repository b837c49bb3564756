//! Gravity gun: crates nearby float in front of the gun, and are shot away.
//! Keys: left and right turn the gun; while the action is held it attracts, and when it is let go it shoots.

use crate::parts::{Driven, lawn, solid, spread};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyKind, Error, Geometry};
use std::f32::consts::TAU;

/// Where the gun is, its reach, and how far in front of it things float [m].
const GUN: DVec3 = DVec3::new(0.0, 1.5, 0.0);
const REACH: f64 = 4.0;
const FRONT: f32 = 2.0;
/// Stiffness [1/s²] and damping [1/s] of the pull, and how fast it turns [rad/s] and shoots [m/s].
const PULL: f32 = 30.0;
const DAMPING: f32 = 8.0;
const TURN: f32 = 1.5;
const SPEED: f32 = 10.0;

/// Crates around the gun. Without a user it attracts for two seconds of three.
pub fn start() -> Result<Driven, Error> {
    let (mut world, _) = lawn()?;
    let gun = solid(Geometry::cuboid(0.5, 0.1, 0.1)).with_position(GUN);
    let gun = world.add_body(&gun.with_kind(BodyKind::Kinematic))?;
    for i in 0..60 {
        let turned = Quat::from_rotation_y(TAU * spread(i));
        let place = turned * Vec3::new(1.5 + 0.12 * i as f32, 0.25, 0.0);
        world.add_body(&solid(Geometry::cuboid(0.2, 0.2, 0.2)).with_position(place))?;
    }
    Ok(Driven::new(world, move |world, tick| {
        world.set_angular_velocity(gun, Vec3::NEG_Y * TURN * tick.controls.right)?;
        let aim = world.rotation(gun)? * Vec3::X;
        let focus = GUN + (aim * FRONT).as_dvec3();
        let attracts = tick.controls.action || tick.time % 3.0 < 2.0;
        for body in world.bodies().collect::<Vec<_>>() {
            let away = focus - world.position(body)?;
            if attracts && away.length() < REACH {
                let pull = PULL * away.as_vec3() - DAMPING * world.linear_velocity(body)?;
                world.add_force(body, world.mass(body)? * (pull - world.settings().gravity))?;
            } else if !attracts && away.length() < 1.0 {
                world.set_linear_velocity(body, aim * SPEED)?;
            }
        }
        Ok(())
    }))
}

#[test]
fn it_attracts_and_shoots() -> Result<(), Error> {
    for (seconds, expected) in [(1.9, 6..60), (2.4, 0..4)] {
        let mut sample = start()?;
        crate::parts::run(&mut sample, seconds)?;
        let (world, focus) = (crate::Running::world(&sample), GUN + DVec3::X * f64::from(FRONT));
        let away = world.bodies().flat_map(|body| world.position(body)).map(|at| (at - focus).length());
        assert!(expected.contains(&away.filter(|&away| away < 1.0).count()), "after {seconds} s");
    }
    Ok(())
}
