//! Level of detail: spinning wheels far from the player are disabled, and take no time.
//! Keys: forwards, back, left and right move the player.

use crate::parts::{Driven, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Settings, ShapeDesc, World};
use std::f32::consts::FRAC_PI_2;

/// Wheels along each side of the field, and their distance [m].
const SIDE: usize = 16;
const PITCH: f64 = 1.2;
/// Distance from the player beyond which wheels stand still [m].
const NEAR: f64 = 4.0;
/// Speed of the player [m/s].
const SPEED: f64 = 4.0;

/// The field, with the player in the middle. Without a user the player goes in a circle.
pub fn start() -> Result<Driven, Error> {
    let (world, player, wheels) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let keys = tick.controls;
        let asked = DVec3::new(keys.right.into(), 0.0, (-keys.forward).into());
        let circle = DVec3::new(tick.time.cos(), 0.0, tick.time.sin());
        let way = if asked == DVec3::ZERO { circle } else { asked };
        let place = world.position(player)? + way * SPEED * f64::from(tick.dt);
        world.set_pose(player, place, Quat::IDENTITY)?;
        wheels.iter().try_for_each(|&wheel| {
            let near = world.position(wheel)?.distance(place) < NEAR;
            world.set_enabled(wheel, near)
        })
    }))
}

fn build() -> Result<(World, BodyHandle, Vec<BodyHandle>), Error> {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO))?;
    let player = ShapeDesc::new(Geometry::capsule(0.5, 0.3)).as_sensor();
    let player = BodyDesc::kinematic().with_position(DVec3::new(0.0, 1.0, -4.0)).with_shape(player);
    let player = world.add_body(&player)?;
    let spoke = solid(Geometry::cuboid(0.5, 0.08, 0.08)).with_angular_velocity(Vec3::Y * 4.0);
    let turned = Quat::from_rotation_y(FRAC_PI_2);
    let spoke = spoke.with_shape(ShapeDesc::new(Geometry::cuboid(0.5, 0.08, 0.08)).with_rotation(turned));
    let mut wheels = Vec::new();
    for i in 0..SIDE * SIDE {
        let place = DVec3::new((i % SIDE) as f64 - 7.5, 0.0, (i / SIDE) as f64 - 7.5) * PITCH;
        wheels.push(world.add_body(&spoke.clone().with_position(place))?);
    }
    Ok((world, player, wheels))
}

#[test]
fn only_the_near_ones_turn() -> Result<(), Error> {
    let (mut sample, (_, player, wheels)) = (start()?, build()?);
    crate::parts::run(&mut sample, 5.0)?;
    let world = crate::Running::world(&sample);
    for wheel in wheels {
        let near = world.position(wheel)?.distance(world.position(player)?) < NEAR;
        assert_eq!(world.is_enabled(wheel)?, near);
    }
    Ok(())
}
