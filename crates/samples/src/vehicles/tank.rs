//! Tank: the surfaces of its two tracks move, drive it over logs and turn it where it stands.
//! Keys: arrows drive and turn; without keys it goes over the logs and turns round.

use crate::parts::{Driven, fixed};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, Error, Geometry, Material, ShapeDesc, ShapeHandle, World};
use std::f32::consts::FRAC_PI_2;

/// Speed of a track [m/s].
const SPEED: f32 = 3.0;
/// Radius and half length of a track, and its place aside [m].
const RADIUS: f32 = 0.45;
const HALF: f32 = 1.3;
const ASIDE: f32 = 1.1;
/// How long it drives, and turns [s].
const LEG: f64 = 6.0;
const TURN: f64 = 3.5;

/// The tank before the logs.
pub fn start() -> Result<Driven, Error> {
    let (world, tracks) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let keys = (tick.controls.forward, tick.controls.right);
        let alone = if tick.time % (LEG + TURN) < LEG { (1.0, 0.0) } else { (0.0, 1.0) };
        let (forward, right) = if keys == (0.0, 0.0) { alone } else { keys };
        for (track, share) in tracks.into_iter().zip([forward + right, forward - right]) {
            world.set_material(track, moving(share.clamp(-1.0, 1.0) * SPEED))?;
        }
        Ok(())
    }))
}

/// The material of a track at a speed [m/s]: below it the surface moves backwards.
fn moving(speed: f32) -> Material {
    Material::default().with_friction(1.0).with_surface_velocity(Vec3::Y * speed)
}

fn build() -> Result<(World, [ShapeHandle; 2]), Error> {
    let (mut world, _) = crate::parts::level_world_with(backstop::Settings::default().with_friction_model(backstop::FrictionModel::Point))?;
    // A capsule has its axis along y, a track along z.
    let lying = Quat::from_rotation_x(FRAC_PI_2);
    for i in 0..6 {
        let log = fixed(Geometry::capsule(2.5, 0.25)).with_rotation(Quat::from_rotation_z(FRAC_PI_2));
        world.add_body(&log.with_position(Vec3::new(0.0, 0.0, -2.0 - 2.0 * i as f32)))?;
    }
    let hull = ShapeDesc::new(Geometry::cuboid(0.8, 0.35, 1.4)).with_position(Vec3::Y * 0.35);
    let turret = ShapeDesc::new(Geometry::cylinder(0.2, 0.6)).with_position(Vec3::Y * 0.9);
    let gun = ShapeDesc::new(Geometry::capsule(0.9, 0.08)).with_rotation(lying);
    let gun = gun.with_position(Vec3::new(0.0, 0.9, -1.3));
    let tank = BodyDesc::dynamic().with_position(Vec3::new(0.0, RADIUS, 3.0)).with_shapes([hull, turret, gun]);
    let tank = world.add_body(&tank)?;
    let track = |x: f32| ShapeDesc::new(Geometry::capsule(HALF, RADIUS)).with_rotation(lying).with_position(Vec3::X * x);
    let tracks = [world.add_shape(tank, &track(-ASIDE))?, world.add_shape(tank, &track(ASIDE))?];
    Ok((world, tracks))
}

#[test]
fn it_drives_and_turns() -> Result<(), Error> {
    let mut sample = start()?;
    for tick in crate::Tick::during(22.0) { 
        crate::Running::step(&mut sample, &tick)?; let i = tick.time; if (tick.time * 60.0).round() as u32 % 30 != 0 { continue; } 
    let world = crate::Running::world(&sample);
    for body in world.bodies() { if world.kind(body)? == backstop::BodyKind::Dynamic { println!("{i} {} {} {}", world.position(body)?, world.rotation(body)? * Vec3::Z, world.angular_velocity(body)?); } }
    }
    assert!(false);
    Ok(())
}
