//! A stack of ten boxes on a floor, for two seconds.
//!
//!     cargo run --example hello

use backstop::glam::DVec3;
use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};

fn main() -> Result<(), backstop::Error> {
    let mut world = World::new(Settings::default())?;

    // A floor of 20 m by 20 m, its top at y = 0.
    let floor = ShapeDesc::new(Geometry::cuboid(10.0, 0.5, 10.0));
    world.add_body(&BodyDesc::fixed().at(DVec3::new(0.0, -0.5, 0.0)).with_shape(floor))?;

    // Boxes of 1 m, 1 cm apart. Many are added in one call.
    let boxes: Vec<BodyDesc> = (0..10)
        .map(|i| {
            let height = 0.5 + 1.01 * f64::from(i);
            let shape = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
            BodyDesc::dynamic().at(DVec3::new(0.0, height, 0.0)).with_shape(shape)
        })
        .collect();
    let boxes = world.add_bodies(&boxes)?;
    let Some(&top) = boxes.last() else { return Ok(()) };

    for step in 1..=120 {
        let report = world.step(1.0 / 60.0)?;
        let (manifolds, took) = (report.manifolds, report.times.step);
        if step % 30 == 0 {
            let height = world.position(top)?.y;
            println!("step {step}: top box at {height:.3} m, {manifolds} contacts, {took:.0} us");
        }
    }
    println!("{} bytes in all", world.memory().total());
    Ok(())
}
