//! A conveyor belt, and a platform that lets through what comes from below: what hooks are for.
//!
//!     cargo run --example conveyor

use backstop::glam::{DVec3, Vec3};
use backstop::{
    BodyDesc, ContactHook, ContactHooks, Error, Geometry, Settings, ShapeDesc, ShapeHandle, World,
};

/// Which shapes are special. Told of each contact of a shape with hooks, before it is solved.
struct Rules {
    belt: ShapeHandle,
    platform: ShapeHandle,
}

impl ContactHooks for Rules {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        if let Some(side) = contact.side_of(self.belt) {
            // Friction takes along what lies on it. Only a number that isn't one is refused.
            let _ = contact.set_surface_velocity(side, Vec3::X * 2.0);
        }
        if let Some(side) = contact.side_of(self.platform) {
            let [own, other] = [contact.bodies()[side], contact.bodies()[1 - side]];
            let world = contact.world();
            let (Ok(own), Ok(at), Ok(velocity)) =
                (world.position(own), world.position(other), world.linear_velocity(other))
            else {
                return;
            };
            // From below, or still on its way up: it passes.
            if velocity.y > 0.01 || at.y < own.y + 0.5 {
                contact.veto();
            }
        }
    }
}

fn main() -> Result<(), Error> {
    let mut world = World::new(Settings::default())?;
    let belt = ShapeDesc::new(Geometry::cuboid(20.0, 0.5, 1.0)).with_hooks();
    let belt =
        world.add_body(&BodyDesc::fixed().with_position(DVec3::new(0.0, -0.5, 0.0)).with_shape(belt))?;
    let plate = ShapeDesc::new(Geometry::cuboid(2.0, 0.1, 2.0)).with_hooks();
    let platform =
        world.add_body(&BodyDesc::fixed().with_position(DVec3::new(0.0, 3.0, 10.0)).with_shape(plate))?;
    let (Some(belt), Some(platform)) = (world.shapes(belt)?.next(), world.shapes(platform)?.next()) else {
        return Ok(());
    };
    let rules = Rules { belt, platform };

    let cube = || ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    let parcel =
        world.add_body(&BodyDesc::dynamic().with_position(DVec3::new(-5.0, 0.5, 0.0)).with_shape(cube()))?;
    let thrown = BodyDesc::dynamic()
        .with_position(DVec3::new(0.0, 0.5, 10.0))
        .with_velocity(Vec3::Y * 10.0, Vec3::ZERO);
    let thrown = world.add_body(&thrown.with_shape(cube()))?;
    for _ in 0..180 {
        world.step_with(1.0 / 60.0, &rules)?;
    }
    let (speed, height) = (world.linear_velocity(parcel)?.x, world.position(thrown)?.y);
    println!("the parcel goes at {speed:.3} m/s, what was thrown up lies at {height:.3} m");
    assert!((speed - 2.0).abs() < 0.01, "as fast as the belt");
    assert!((height - 3.6).abs() < 0.01, "on top of the platform");
    Ok(())
}
