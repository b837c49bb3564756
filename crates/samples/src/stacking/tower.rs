//! Tower: forty cubes carry a block which weighs as much as all of them.

use crate::parts::{level_world, solid};
use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Error, Geometry, ShapeDesc, World};

const CUBES: usize = 40;
/// Half of a cube's edge [m].
const HALF: f32 = 0.2;
/// Density of cubes, and of the block which has the size of one [kg/m³].
const DENSITY: f32 = 500.0;
const HEAVY: f32 = DENSITY * CUBES as f32;

/// The tower.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, BodyHandle), Error> {
    let (mut world, _) = level_world()?;
    let height = |i: usize| Vec3::Y * (HALF * (2 * i + 1) as f32);
    let cube = ShapeDesc::new(Geometry::cuboid(HALF, HALF, HALF)).with_density(DENSITY);
    for i in 0..CUBES {
        world.add_body(&BodyDesc::dynamic().with_position(height(i)).with_shape(cube.clone()))?;
    }
    let block = BodyDesc::dynamic().with_position(height(CUBES)).with_shape(cube.with_density(HEAVY));
    let block = world.add_body(&block)?;
    // Something for the eye to compare it with.
    for x in [-2.0, 2.0] {
        world.add_body(&solid(Geometry::capsule(0.6, 0.3)).with_position(Vec3::new(x, 0.9, 0.0)))?;
    }
    Ok((world, block))
}

#[test]
fn the_block_stays_up() -> Result<(), Error> {
    let (mut world, block) = build()?;
    crate::parts::run(&mut world, 20.0)?;
    let place = world.position(block)?.as_vec3();
    let full = HALF * (2 * CUBES + 1) as f32;
    assert!((place - Vec3::Y * full).length() < 0.05, "{place}, of {full} m");
    Ok(())
}
