//! Kinds of bodies: static cubes hang in the air as a helix, and each falls when it is made dynamic.

use crate::parts::{Driven, level_world, solid};
use backstop::glam::Vec3;
use backstop::{BodyHandle, BodyKind, Error, Geometry, World};
use std::f32::consts::TAU;

const CUBES: usize = 72;
/// Time between two cubes [s].
const PERIOD: f64 = 0.15;

/// A helix of cubes.
pub fn start() -> Result<Driven, Error> {
    let (world, cubes) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        // A cube that is dynamic already does not change.
        match cubes.get((tick.time / PERIOD) as usize) {
            Some(&cube) => world.set_kind(cube, BodyKind::Dynamic),
            None => Ok(()),
        }
    }))
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let cube = solid(Geometry::cuboid(0.2, 0.2, 0.2)).with_kind(BodyKind::Static);
    let mut cubes = Vec::new();
    for i in 0..CUBES {
        let angle = 3.0 * TAU * i as f32 / CUBES as f32;
        let place = Vec3::new(2.0 * angle.cos(), 0.5 + 0.07 * i as f32, 2.0 * angle.sin());
        cubes.push(world.add_body(&cube.clone().with_position(place))?);
    }
    Ok((world, cubes))
}

#[test]
fn as_many_fall_as_were_let_go() -> Result<(), Error> {
    let (mut sample, cubes) = (start()?, build()?.1);
    crate::parts::run(&mut sample, 5.0)?;
    let world = crate::Running::world(&sample);
    // 5 s / 0.15 s.
    let dynamic = cubes.iter().filter(|&&cube| world.kind(cube) == Ok(BodyKind::Dynamic)).count();
    assert_eq!(dynamic, 34);
    let low = cubes.iter().flat_map(|&cube| world.position(cube)).filter(|at| at.y < 1.0).count();
    assert!(low > 25, "{low}");
    Ok(())
}
