//! Ten boxes fall onto the ground: `cargo run --example hello`.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Settings, ShapeDesc, World};

fn main() -> Result<(), Error> {
    let mut world = World::new(Settings::default())?;
    // Everything below y = 0.
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane)))?;

    let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    let boxes = (0..10).map(|i| {
        let i = f64::from(i);
        BodyDesc::dynamic()
            .at(DVec3::new(0.1 * i, 1.0 + 1.2 * i, 0.0))
            .rotated(Quat::from_axis_angle(Vec3::Y, 0.3))
            .with_shape(cube.clone())
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
