//! Ground with hills.

use backstop::glam::{Vec2, Vec3};
use backstop::{BodyDesc, Error, Geometry, HeightField, ShapeDesc};

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
