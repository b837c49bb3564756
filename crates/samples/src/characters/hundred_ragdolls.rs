//! A hundred ragdolls: they rain onto a cone, slide off it and come to rest around it.

use crate::parts::{fixed, level_world_with, spread};
use backstop::glam::{DVec3, EulerRot, Quat, Vec3};
use backstop::{Error, Geometry, Settings, Skeleton, World};
use std::f32::consts::TAU;

const COUNT: usize = 100;
/// Torque of friction in each joint [N m].
const FRICTION: f32 = 4.0;
/// Half the height of the cone, and its radius [m].
const CONE: (f32, f32) = (1.5, 4.0);

/// The cone, and the figures above it.
pub fn start() -> Result<World, Error> {
    let (mut world, _) = level_world_with(Settings::default().with_sleeping(true))?;
    let (half, radius) = CONE;
    world.add_body(&fixed(Geometry::cone(half, radius)).with_position(Vec3::Y * half))?;
    let figure = Skeleton::humanoid().with_friction(FRICTION);
    for i in 0..COUNT {
        let (angle, out) = (TAU * spread(i), 3.0 * spread(7 * i).sqrt());
        let at = Vec3::new(out * angle.cos(), 3.5 + 0.35 * i as f32, out * angle.sin());
        let turned = Quat::from_euler(EulerRot::YXZ, 5.0 * angle, 3.0 * angle, angle);
        figure.add_to(&mut world, DVec3::from(at), turned, Vec3::ZERO)?;
    }
    Ok(world)
}

#[test]
fn all_of_them_come_to_rest_on_the_ground() -> Result<(), Error> {
    let mut world = start()?;
    crate::parts::run(&mut world, 15.0)?;
    // Friction brakes bodies on the ground, and limbs in their joints.
    assert_eq!(world.sleeping_body_count(), COUNT * Skeleton::humanoid().bones.len());
    for body in world.bodies() {
        let at = world.position(body)?;
        assert!(at.y > -0.01 && at.length() < 30.0, "{at}");
    }
    Ok(())
}
