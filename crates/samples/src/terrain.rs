//! Ground with hills, and a pool.

use crate::parts::fixed;
use backstop::glam::{Quat, Vec2, Vec3};
use backstop::{BodyDesc, Error, Geometry, HeightField, ShapeDesc, World};
use std::f32::consts::FRAC_PI_2;

/// Width of a cell of the ground [m].
const CELL: f32 = 1.0;

/// Ground from `-half` to `half` along x and z [m], whole metres, with a height [m] for each (x, z).
///
/// # Errors
///
/// Those of [`HeightField::new`].
pub fn terrain(half: u16, height: impl Fn(f32, f32) -> f32) -> Result<BodyDesc, Error> {
    let (side, low) = (2 * usize::from(half) + 1, -f32::from(half));
    let at = |i: usize| low + i as f32 * CELL;
    let heights = (0..side * side).map(|i| height(at(i % side), at(i / side))).collect();
    let field = HeightField::new(side, side, Vec2::splat(CELL), heights)?;
    // The field begins at its corner.
    let shape = ShapeDesc::new(Geometry::height_field(field)).with_position(Vec3::new(low, 0.0, low));
    Ok(BodyDesc::fixed().with_shape(shape))
}

/// A pool 4 m deep, from `-half` to `half` along x and z [m]: its floor, and walls up to 1 m above y = 0.
///
/// # Errors
///
/// Those of [`World::add_body`].
pub fn add_pool(world: &mut World, half: f32) -> Result<(), Error> {
    world.add_body(&fixed(Geometry::cuboid(half, 0.1, half)).with_position(Vec3::Y * -4.0))?;
    for side in 0..4 {
        let turned = Quat::from_rotation_y(side as f32 * FRAC_PI_2);
        let wall = fixed(Geometry::cuboid(half, 2.5, 0.1)).with_rotation(turned);
        world.add_body(&wall.with_position(turned * Vec3::new(0.0, -1.5, half)))?;
    }
    Ok(())
}
