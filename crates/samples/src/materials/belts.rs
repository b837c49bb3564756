//! Surface velocity: belts take parcels along, as fast as friction allows at first, then at their own speed.

use crate::parts::{level_world, solid};
use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Material, ShapeDesc, World};

/// Speeds of the belts [m/s].
const SPEEDS: [f32; 5] = [-1.5, 0.5, 1.0, 2.0, 3.0];
/// Friction on the belts: that of both materials.
const FRICTION: f32 = 0.2;
const HALF: f32 = 6.0;

/// The belts, with a parcel on each.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let smooth = Material::default().with_friction(FRICTION);
    let mut parcels = Vec::new();
    for (i, speed) in SPEEDS.into_iter().enumerate() {
        let z = 1.2 * i as f32 - 2.4;
        let moving = smooth.with_surface_velocity(Vec3::X * speed);
        let belt = ShapeDesc::new(Geometry::cuboid(HALF, 0.2, 0.5)).with_material(moving);
        world.add_body(&BodyDesc::fixed().with_position(Vec3::new(0.0, 0.2, z)).with_shape(belt))?;
        let mut parcel = solid(Geometry::cuboid(0.3, 0.2, 0.3));
        parcel.shapes[0].material = smooth;
        // At the end from which its belt comes.
        let place = Vec3::new((1.0 - HALF) * speed.signum(), 0.6, z);
        parcels.push(world.add_body(&parcel.with_position(place))?);
    }
    Ok((world, parcels))
}

#[test]
fn friction_sets_the_pace() -> Result<(), Error> {
    let (mut world, parcels) = build()?;
    for time in [0.5_f32, 1.0, 1.5, 2.0] {
        crate::parts::run(&mut world, 0.5)?;
        for (&parcel, belt) in parcels.iter().zip(SPEEDS) {
            // v = mu g t, until it is as fast as the belt.
            let expected = belt.signum() * (FRICTION * 9.81 * time).min(belt.abs());
            let speed = world.linear_velocity(parcel)?.x;
            assert!((speed - expected).abs() < 0.05, "{speed} of {expected} m/s at {time} s");
        }
    }
    Ok(())
}
