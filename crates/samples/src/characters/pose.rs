//! Driven ragdolls: springs in the joints hold a pose, wave and run, while balls fall on the figures.

use crate::parts::{Driven, level_world, solid, spread};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyKind, Error, Geometry, Ragdoll, Skeleton, Spring, World};

/// Springs in the joints, and the most torque of each [N m].
const SPRING: Spring = Spring::Coefficients { stiffness: 500.0, damping: 20.0 };
const TORQUE: f32 = 200.0;
/// How fast the figures wave and run [rad/s], and how far the arms of the first are raised [rad].
const OMEGA: f64 = 5.0;
const RAISED: f32 = 0.9;

/// Three figures whose pelvis is held, and balls above them.
pub fn start() -> Result<Driven, Error> {
    let (world, figures) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let wave = (OMEGA * tick.time).sin() as f32;
        let drive = |(i, figure): (usize, &Ragdoll)| figure.drive_to(world, &pose(i, wave), SPRING, TORQUE);
        figures.iter().enumerate().try_for_each(drive)
    }))
}

/// The rotation of each bone: pelvis, torso, head, then arm, forearm, thigh and shin of both sides.
fn pose(figure: usize, wave: f32) -> [Quat; 11] {
    let (x, y, z) = (Quat::from_rotation_x, Quat::from_rotation_y, Quat::from_rotation_z);
    let turns = match figure {
        0 => [(3, z(-RAISED)), (4, z(-RAISED)), (7, z(RAISED)), (8, z(RAISED))],
        1 => [(3, z(1.2)), (4, z(1.2)), (7, Quat::IDENTITY), (8, y(-1.0 - wave))],
        _ => [(5, x(-wave)), (6, x(0.9 - wave)), (9, x(wave)), (10, x(0.9 + wave))],
    };
    let mut pose = [Quat::IDENTITY; 11];
    turns.into_iter().for_each(|(bone, turn)| pose[bone] = turn);
    pose
}

fn build() -> Result<(World, Vec<Ragdoll>), Error> {
    let (mut world, mut figures) = (level_world()?.0, Vec::new());
    for i in 0..3 {
        let at = DVec3::new(2.4 * i as f64 - 2.4, 0.3, 0.0);
        let figure = Skeleton::humanoid().add_to(&mut world, at, Quat::IDENTITY, Vec3::ZERO)?;
        world.set_kind(figure.bodies[0], BodyKind::Kinematic)?;
        figures.push(figure);
    }
    for i in 0..60 {
        let at = Vec3::new(7.0 * spread(i) - 3.5, 4.0 + 0.2 * i as f32, spread(7 * i) - 0.5);
        world.add_body(&solid(Geometry::sphere(0.1)).with_position(at))?;
    }
    Ok((world, figures))
}

#[test]
fn the_first_has_its_arms_up() -> Result<(), Error> {
    let (mut sample, figures) = (start()?, build()?.1);
    crate::parts::run(&mut sample, 12.0)?;
    // A bone lies along the y of its body. An arm of 3.9 kg turns its spring by 7 N m, which is 0.015 rad.
    let up = crate::Running::world(&sample).rotation(figures[0].bodies[3])? * Vec3::Y;
    assert!((up.y.abs().asin() - RAISED).abs() < 0.03, "{up}");
    Ok(())
}
