//! Ragdoll: a figure falls down a flight of beams, and none of its joints opens.
//! Keys: E throws it up again.

use crate::parts::{Driven, fixed, level_world};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Error, Geometry, Ragdoll, Skeleton, World};

/// Torque of friction in each joint [N m].
const FRICTION: f32 = 4.0;
/// From how high it falls [m].
const HEIGHT: f64 = 6.0;
/// How the action key throws it [m/s].
const THROW: Vec3 = Vec3::new(-0.5, 9.0, 0.0);

/// Beams, and the figure above them.
pub fn start() -> Result<Driven, Error> {
    let (world, figure) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        for &body in figure.bodies.iter().filter(|_| tick.controls.action) {
            world.set_linear_velocity(body, THROW)?;
        }
        Ok(())
    }))
}

fn build() -> Result<(World, Ragdoll), Error> {
    let (mut world, _) = level_world()?;
    for (x, y) in [(-0.2, 5.0), (0.9, 4.0), (-0.9, 3.0), (0.3, 2.2), (1.4, 1.4), (-0.6, 0.9)] {
        let beam = fixed(Geometry::cuboid(0.12, 0.12, 1.0)).with_position(Vec3::new(x, y, 0.0));
        world.add_body(&beam.with_rotation(Quat::from_rotation_z(0.6)))?;
    }
    let turned = Quat::from_rotation_z(2.0) * Quat::from_rotation_y(0.5);
    let figure = Skeleton::humanoid().with_friction(FRICTION);
    let figure = figure.add_to(&mut world, DVec3::Y * HEIGHT, turned, Vec3::ZERO)?;
    Ok((world, figure))
}

#[test]
fn it_stays_together_and_comes_to_rest() -> Result<(), Error> {
    let (mut world, figure) = build()?;
    let mut widest = 0.0_f64;
    for _ in 0..60 * 10 {
        world.step(1.0 / 60.0)?;
        for &joint in &figure.joints {
            let [a, b] = world.joint_frames(joint)?;
            widest = widest.max(a.0.distance(b.0));
        }
    }
    // A hundred of them at 30 m/s open by 8 mm at most (docs/joints.md).
    assert!(widest < 0.008, "{widest} m");
    for &body in &figure.bodies {
        let speed = world.linear_velocity(body)?.length();
        assert!(speed < 0.05 && world.position(body)?.y > 0.0, "{speed} m/s");
    }
    Ok(())
}
