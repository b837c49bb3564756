//! Tank: the surfaces of its two tracks move, drive it over logs and turn it where it stands.
//! Keys: arrows drive and turn; without keys it goes to and fro over the logs.

use crate::parts::{Driven, fixed, level_world_with};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, FrictionModel, Geometry, Material, Settings, ShapeDesc};
use backstop::{ShapeHandle, World};
use std::f32::consts::FRAC_PI_2;

/// Speed of a track [m/s].
const SPEED: f32 = 3.0;
/// How long it drives without keys, before it turns for 3.5 s [s].
const LEG: f64 = 6.0;

/// The tank before the logs.
pub fn start() -> Result<Driven, Error> {
    let (world, _, tracks) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let keys = (tick.controls.forward, tick.controls.right);
        let alone = if tick.time % (LEG + 3.5) < LEG { (1.0, 0.0) } else { (0.0, 1.0) };
        let (forward, right) = if keys == (0.0, 0.0) { alone } else { keys };
        for (track, share) in tracks.into_iter().zip([forward + right, forward - right]) {
            // Below the track its surface, here along y of a lying capsule, moves backwards.
            let surface = Vec3::Y * SPEED * share.clamp(-1.0, 1.0);
            world.set_material(track, Material::default().with_friction(1.0).with_surface_velocity(surface))?;
        }
        Ok(())
    }))
}

fn build() -> Result<(World, BodyHandle, [ShapeHandle; 2]), Error> {
    // Each end of a track slides by itself: as one patch a track would not let itself be turned.
    let (mut world, _) = level_world_with(Settings::default().with_friction_model(FrictionModel::Point))?;
    let log = fixed(Geometry::capsule(2.5, 0.25)).with_rotation(Quat::from_rotation_z(FRAC_PI_2));
    for i in 0..6 {
        world.add_body(&log.clone().with_position(Vec3::Z * (-2.0 - 2.0 * i as f32)))?;
    }
    let turned = Quat::from_rotation_x(FRAC_PI_2);
    let lying = |half, radius| ShapeDesc::new(Geometry::capsule(half, radius)).with_rotation(turned);
    let tank = BodyDesc::dynamic().with_position(Vec3::new(0.0, 0.45, 3.0)).with_shapes([
        ShapeDesc::new(Geometry::cuboid(0.8, 0.35, 1.4)).with_position(Vec3::Y * 0.35),
        ShapeDesc::new(Geometry::cylinder(0.2, 0.6)).with_position(Vec3::Y * 0.9),
        lying(0.9, 0.08).with_position(Vec3::new(0.0, 0.9, -1.3)),
    ]);
    let tank = world.add_body(&tank)?;
    let mut track = |x: f32| world.add_shape(tank, &lying(1.3, 0.45).with_position(Vec3::X * x));
    let tracks = [track(-1.1)?, track(1.1)?];
    Ok((world, tank, tracks))
}

#[test]
fn it_drives_over_the_logs_and_turns() -> Result<(), Error> {
    let (mut sample, tank) = (start()?, build()?.1);
    crate::parts::run(&mut sample, LEG + 3.5)?;
    let world = crate::Running::world(&sample);
    // It began at z = 3 m, drove at 3 m/s for 6 s and looked along -z; over the logs it is slower.
    let (at, ahead) = (world.position(tank)?, world.rotation(tank)? * Vec3::NEG_Z);
    assert!((-20.0..-12.0).contains(&at.z) && ahead.z > 0.5, "{at}, {ahead}");
    Ok(())
}
