//! Ten boxes fall onto each other: `cargo run --example hello`.

use backstop::glam::DVec3;
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Settings, ShapeDesc, World};

fn main() -> Result<(), Error> {
    let mut world = World::new(Settings::default())?;
    // Everything below y = 0.
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane)))?;

    let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    let boxes = (0..10).map(|i| {
        // Not quite above each other.
        let (x, y) = (0.1 * f64::from(i % 3), 1.0 + 1.2 * f64::from(i));
        BodyDesc::dynamic().at(DVec3::new(x, y, 0.0)).with_shape(cube.clone())
    });
    let boxes: Vec<BodyHandle> = world.add_bodies(&boxes.collect::<Vec<_>>())?;

    for second in 1..=4 {
        for _ in 0..60 {
            world.step(1.0 / 60.0)?;
        }
        println!("after {second} s");
        for &body in &boxes {
            println!("  {:7.3}", world.position(body)?);
        }
    }
    let report = world.report();
    println!("the last step: {} pairs, {} points that touch", report.pairs, report.real);
    println!("{} bytes", world.memory().total());
    Ok(())
}
