//! Heap: boxes, balls, capsules, cylinders, cones and hulls fall into a pit, come to rest and sleep.

use crate::parts::{fixed, level_world_with, solid, spread};
use backstop::glam::{Quat, Vec3};
use backstop::{ConvexHull, Error, Geometry, Material, Settings, World};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

const COUNT: usize = 240;
/// Half the width of the pit, and half the height of its walls [m].
const PIT: f32 = 2.5;
const WALL: f32 = 0.75;
/// Lever arm of friction against rolling and spinning [m]: without it a ball may spin in its place for long.
const ROLLING: f32 = 0.01;

/// The pit, and the bodies above it.
pub fn start() -> Result<World, Error> {
    let (mut world, _) = level_world_with(Settings::default().with_sleeping(true))?;
    for side in 0..4 {
        let turned = Quat::from_rotation_y(side as f32 * 0.5 * PI);
        let wall = fixed(Geometry::cuboid(PIT + 0.2, WALL, 0.1)).with_rotation(turned);
        world.add_body(&wall.with_position(turned * Vec3::new(0.0, WALL, PIT + 0.1)))?;
    }
    let wedge = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(1.0, 0.0, 1.0)];
    let wedge = Arc::new(ConvexHull::new(&wedge.map(|corner| 0.5 * corner))?);
    let kinds = [
        Geometry::cuboid(0.25, 0.15, 0.2),
        Geometry::sphere(0.2),
        Geometry::capsule(0.2, 0.12),
        Geometry::cylinder(0.2, 0.15),
        Geometry::cone(0.25, 0.22),
        Geometry::hull(wedge),
    ];
    for i in 0..COUNT {
        let angle = TAU * spread(i);
        let (column, row, layer) = ((i % 6) as f32, (i / 6 % 6) as f32, (i / 36) as f32);
        let place = Vec3::new(0.7 * column - 1.75, 1.0 + 0.7 * layer, 0.7 * row - 1.75);
        let turned = Quat::from_euler(backstop::glam::EulerRot::XYZ, angle, 3.0 * angle, 0.0);
        let mut body = solid(kinds[i % kinds.len()].clone()).with_position(place).with_rotation(turned);
        body.shapes[0].material =
            Material::default().with_rolling_friction(ROLLING).with_spinning_friction(ROLLING);
        world.add_body(&body)?;
    }
    Ok(world)
}

#[test]
fn all_of_it_falls_asleep_in_the_pit() -> Result<(), Error> {
    let mut world = start()?;
    crate::parts::run(&mut world, 20.0)?;
    assert_eq!(world.sleeping_body_count(), COUNT);
    let inside = |body| world.position(body).is_ok_and(|at| at.y > -0.01 && at.y < 3.0);
    assert!(world.bodies().all(inside), "none is below the ground or out of the pit");
    Ok(())
}
