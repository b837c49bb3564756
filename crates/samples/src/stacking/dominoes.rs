//! Dominoes: a push on the first of forty goes through the whole curved row.

use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, Error, Geometry, Settings, ShapeDesc, World};

const COUNT: usize = 40;

/// The row, with the first domino already falling.
pub fn start() -> Result<World, Error> {
    let mut world = World::new(Settings::default())?;
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    let domino = ShapeDesc::new(Geometry::cuboid(0.02, 0.25, 0.12));
    for i in 0..COUNT {
        // On an arc of 4 m, each turned towards the next.
        let angle = i as f32 * 0.05;
        let place = Vec3::new(4.0 * angle.sin(), 0.25, 4.0 * angle.cos());
        let body = BodyDesc::dynamic()
            .with_position(place)
            .with_rotation(Quat::from_rotation_y(angle))
            .with_shape(domino.clone());
        let body = world.add_body(&body)?;
        if i == 0 {
            world.set_angular_velocity(body, Vec3::NEG_Z * 2.0)?;
        }
    }
    Ok(world)
}

#[test]
fn the_last_one_falls() -> Result<(), Error> {
    let mut world = start()?;
    for _ in 0..60 * 8 {
        world.step(1.0 / 60.0)?;
    }
    // A domino which lies has its centre below half of its height.
    for body in world.bodies().skip(1) {
        assert!(world.position(body)?.y < 0.2);
    }
    Ok(())
}
