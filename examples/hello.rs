//! Hello, world: a ball falls onto a floor and lies there.
//!
//!     cargo run --example hello

use backstop::glam::DVec3;
use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};

fn main() -> Result<(), backstop::Error> {
    let mut world = World::new(Settings::default())?;

    // A floor of 20 m by 20 m, its top at y = 0.
    let floor = ShapeDesc::new(Geometry::cuboid(10.0, 0.5, 10.0));
    world.add_body(&BodyDesc::fixed().with_position(DVec3::new(0.0, -0.5, 0.0)).with_shape(floor))?;

    // A ball of 0.5 m, 4 m above it.
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
    let ball =
        world.add_body(&BodyDesc::dynamic().with_position(DVec3::new(0.0, 4.5, 0.0)).with_shape(ball))?;

    for step in 1..=120 {
        let report = world.step(1.0 / 60.0)?;
        let took = report.times.step;
        if step % 30 == 0 {
            println!("step {step}: the ball is at {:.3} m, {took:.0} us", world.position(ball)?.y);
        }
    }
    assert!((world.position(ball)?.y - 0.5).abs() < 0.001, "it lies on the floor");
    Ok(())
}
