//! Far away: a tower stands ten thousand kilometres from the origin as it would at the origin.

use crate::parts::{level_world, solid};
use backstop::glam::DVec3;
use backstop::{BodyHandle, Error, Geometry, World};

/// Where the tower is [m].
const PLACE: DVec3 = DVec3::new(1e7, 0.0, -1e7);
/// Half the edge of a cube [m], and cubes along a side of the lowest layer.
const HALF: f64 = 0.25;
const SIDE: usize = 8;

/// The tower.
pub fn start() -> Result<World, Error> {
    Ok(build(PLACE)?.0)
}

fn build(place: DVec3) -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    // Positions in single precision, as a renderer reads them, count from here.
    world.set_origin(place)?;
    let cube = solid(Geometry::cuboid(HALF as f32, HALF as f32, HALF as f32));
    let mut cubes = Vec::new();
    for layer in 0..SIDE {
        for i in 0..SIDE - layer {
            let x = HALF * (2.0 * i as f64 - (SIDE - layer - 1) as f64);
            let at = place + DVec3::new(1.04 * x, HALF * (2 * layer + 1) as f64, 0.0);
            cubes.push(world.add_body(&cube.clone().with_position(at))?);
        }
    }
    Ok((world, cubes))
}

#[test]
fn it_stands_as_well_as_near_by() -> Result<(), Error> {
    for place in [DVec3::ZERO, PLACE] {
        let (mut world, cubes) = build(place)?;
        let before: Vec<_> = cubes.iter().flat_map(|&cube| world.position(cube)).collect();
        crate::parts::run(&mut world, 15.0)?;
        for (&cube, before) in cubes.iter().zip(before) {
            let moved = (world.position(cube)? - before).length();
            assert!(moved < 0.01, "{moved} m at {place}");
            // Single precision at 1e7 m has steps of a metre; from the origin of the world it has none.
            let local = place + world.local_position(cube)?.as_dvec3();
            assert!((local - world.position(cube)?).length() < 1e-5);
        }
    }
    Ok(())
}
