//! Friction: on a slope of 0.45 rad blocks slide whose coefficient is below its tangent, 0.48.

use crate::parts::{fixed, level_world};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Combine, Error, Geometry, Material, ShapeDesc, World};

/// Angle of the slope [rad].
const SLOPE: f32 = 0.45;
/// Coefficients of the blocks.
const FRICTION: [f32; 8] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.55, 0.7, 0.9];
/// Middle of the slope, and half of its length [m].
const MIDDLE: Vec3 = Vec3::new(0.0, 2.5, 0.0);
const HALF: f32 = 5.0;
/// Half the height of a block [m].
const LOW: f32 = 0.2;

/// The slope with its blocks.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<(BodyHandle, DVec3)>), Error> {
    let (mut world, _) = level_world()?;
    // The product of both coefficients, if both materials say so: that of the slope is 1.
    let rough = |mu: f32| Material::default().with_friction(mu).with_friction_combine(Combine::Multiply);
    let turned = Quat::from_rotation_z(-SLOPE);
    let mut slope = fixed(Geometry::cuboid(HALF, 0.1, 3.0)).with_position(MIDDLE).with_rotation(turned);
    slope.shapes[0].material = rough(1.0);
    world.add_body(&slope)?;
    let mut blocks = Vec::new();
    for (i, mu) in FRICTION.into_iter().enumerate() {
        let place = MIDDLE + turned * Vec3::new(1.0 - HALF, 0.1 + LOW, 0.7 * i as f32 - 2.45);
        let block = ShapeDesc::new(Geometry::cuboid(0.3, LOW, 0.25)).with_material(rough(mu));
        let block = BodyDesc::dynamic().with_position(place).with_rotation(turned).with_shape(block);
        blocks.push((world.add_body(&block)?, place.into()));
    }
    Ok((world, blocks))
}

#[test]
fn each_slides_as_far_as_it_has_to() -> Result<(), Error> {
    let (mut world, blocks) = build()?;
    let time = 1.5;
    crate::parts::run(&mut world, time.into())?;
    for ((block, place), mu) in blocks.into_iter().zip(FRICTION) {
        // s = g (sin a - mu cos a) t² / 2, if that is above zero.
        let expected = (0.5 * 9.81 * (SLOPE.sin() - mu * SLOPE.cos()) * time * time).max(0.0);
        let way = (world.position(block)? - place).length() as f32;
        assert!((way - expected).abs() < 0.02 + 0.02 * expected, "{mu}: {way} of {expected} m");
    }
    Ok(())
}
