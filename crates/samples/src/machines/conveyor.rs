//! Conveyor: four belts carry parcels around and around.

use crate::parts::{level_world, solid};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Material, ShapeDesc, World};
use std::f32::consts::FRAC_PI_2;

/// Half the length of a belt, and half its width [m].
const LENGTH: f32 = 2.5;
const WIDTH: f32 = 0.6;
/// Height of the belts [m].
const HEIGHT: f32 = 0.8;
/// Speed of the belts [m/s].
const SPEED: f32 = 1.2;

/// The belts, with twelve parcels.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    for side in 0..4 {
        let turned = Quat::from_rotation_y(FRAC_PI_2 * side as f32);
        // Each belt ends at the side of the next. Its surface moves along its own x.
        let rubber = Material::default().with_friction(0.8).with_surface_velocity(Vec3::X * SPEED);
        let belt = ShapeDesc::new(Geometry::cuboid(LENGTH, 0.5 * HEIGHT, WIDTH)).with_material(rubber);
        let place = Vec3::new(-WIDTH, 0.5 * HEIGHT, LENGTH);
        // A rail along the outer edge, and one across the end that turns the parcels.
        let slide = Material::default().with_friction(0.1);
        let rail = ShapeDesc::new(Geometry::cuboid(LENGTH + WIDTH, 0.25, 0.05)).with_material(slide);
        let rail = rail.with_position(Vec3::new(WIDTH, 0.5 * HEIGHT + 0.25, WIDTH + 0.05));
        let body = BodyDesc::fixed().with_position(turned * place).with_rotation(turned);
        world.add_body(&body.with_shape(belt).with_shape(rail))?;
    }
    let mut parcels = Vec::new();
    for i in 0..12 {
        let turned = Quat::from_rotation_y(FRAC_PI_2 * i as f32);
        let place = Vec3::new((i / 4) as f32 - 2.0, HEIGHT + 0.3, LENGTH);
        let edge = 0.15 + 0.02 * (i % 5) as f32;
        let parcel = solid(Geometry::cuboid(edge, 0.15, edge));
        parcels.push(world.add_body(&parcel.with_position(turned * place).with_rotation(turned))?);
    }
    Ok((world, parcels))
}

#[test]
fn parcels_go_around() -> Result<(), Error> {
    let (mut world, parcels) = build()?;
    crate::parts::run(&mut world, 40.0)?;
    for parcel in parcels {
        let (place, velocity) = (world.position(parcel)?.as_vec3(), world.linear_velocity(parcel)?);
        assert!(place.y > HEIGHT, "none fell off: {place}");
        // Seen from above they go one way round.
        assert!(place.cross(velocity).y > 0.0 || velocity.length() < 0.3, "{place} {velocity}");
    }
    Ok(())
}
