//! Lift: a platform which the program moves carries a stack of boxes up and down.

use crate::parts::{Driven, fixed, level_world, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, ShapeDesc, World};
use std::f64::consts::TAU;

/// Lowest and highest place of the platform [m], and the time for both ways [s].
const LOW: f64 = 0.1;
const HIGH: f64 = 3.5;
const PERIOD: f64 = 8.0;

/// The platform with its boxes.
pub fn start() -> Result<Driven, Error> {
    let (world, platform, _) = build()?;
    Ok(drive(world, platform))
}

fn drive(world: World, platform: BodyHandle) -> Driven {
    Driven::new(world, move |world, tick| {
        // Where it has to be at the end of this step.
        let share = 0.5 - 0.5 * (TAU * (tick.time + f64::from(tick.dt)) / PERIOD).cos();
        let place = DVec3::Y * (LOW + (HIGH - LOW) * share);
        world.move_kinematic(platform, place, Quat::IDENTITY, tick.dt)
    })
}

fn build() -> Result<(World, BodyHandle, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    for x in [-1.6, 1.6] {
        let tower = fixed(Geometry::cuboid(0.1, 2.5, 0.6));
        world.add_body(&tower.with_position(Vec3::new(x, 2.5, 0.0)))?;
    }
    let plate = ShapeDesc::new(Geometry::cuboid(1.4, 0.1, 1.0));
    let plate = BodyDesc::kinematic().with_position(DVec3::Y * LOW).with_shape(plate);
    let platform = world.add_body(&plate)?;
    let mut boxes = Vec::new();
    for i in 0..15 {
        let (layer, column) = (i / 3, i % 3);
        let place = DVec3::new(0.6 * column as f64 - 0.6, LOW + 0.3 + 0.4 * layer as f64, 0.0);
        boxes.push(world.add_body(&solid(Geometry::cuboid(0.25, 0.2, 0.25)).with_position(place))?);
    }
    Ok((world, platform, boxes))
}

#[test]
fn boxes_ride_along() -> Result<(), Error> {
    let (world, platform, boxes) = build()?;
    let mut lift = drive(world, platform);
    // Two and a half periods: it is at its highest.
    crate::parts::run(&mut lift, 2.5 * PERIOD)?;
    let world = crate::Running::world(&lift);
    assert!((world.position(platform)?.y - HIGH).abs() < 1e-3);
    for (i, cube) in boxes.into_iter().enumerate() {
        let above = world.position(cube)?.y - HIGH;
        assert!((above - (0.3 + 0.4 * (i / 3) as f64)).abs() < 0.01, "{above} m");
    }
    Ok(())
}
