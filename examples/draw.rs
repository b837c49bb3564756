//! Debug drawing without a renderer: a scene from the side as an SVG picture.
//!
//! `cargo run --example draw > scene.svg`

use backstop::debug::{DebugDraw, DrawOptions, Ink};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};

/// Lines and points as SVG: x to the right, y up, 100 pixels a metre.
#[derive(Default)]
struct Svg {
    body: String,
}

impl DebugDraw for Svg {
    fn line(&mut self, from: DVec3, to: DVec3, ink: Ink) {
        let [x1, y1, x2, y2] = [from.x, -from.y, to.x, -to.y].map(|v| 100.0 * v);
        let c = ink.colour;
        self.body += &format!(
            "<path d='M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}' stroke='rgb({},{},{})'/>\n",
            c.red, c.green, c.blue
        );
    }

    fn point(&mut self, at: DVec3, ink: Ink) {
        let (x, y, c) = (100.0 * at.x, -100.0 * at.y, ink.colour);
        self.body += &format!(
            "<circle cx='{x:.1}' cy='{y:.1}' r='4' fill='rgb({},{},{})'/>\n",
            c.red, c.green, c.blue
        );
    }
}

fn main() -> Result<(), backstop::Error> {
    let mut world = World::new(Settings::default())?;
    let shape = |geometry| ShapeDesc::new(geometry);
    world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::cuboid(2.5, 0.05, 1.0))))?;
    for i in 0..3 {
        let at = DVec3::new(0.1 * f64::from(i), 0.31 + 0.52 * f64::from(i), 0.0);
        world.add_body(
            &BodyDesc::dynamic().with_position(at).with_shape(shape(Geometry::cuboid(0.4, 0.25, 0.4))),
        )?;
    }
    // A ball on its way to the stack, and a capsule that falls.
    let ball = BodyDesc::dynamic()
        .with_position(DVec3::new(-2.0, 1.2, 0.0))
        .with_velocity(Vec3::X * 60.0, Vec3::ZERO);
    world.add_body(&ball.with_shape(shape(Geometry::Sphere { radius: 0.2 })))?;
    let capsule = BodyDesc::dynamic()
        .with_position(DVec3::new(1.6, 0.5, 0.0))
        .with_rotation(Quat::from_rotation_z(1.2));
    world.add_body(&capsule.with_shape(shape(Geometry::capsule(0.4, 0.15))))?;
    (0..2).try_for_each(|_| world.step(1.0 / 60.0).map(drop))?;

    let mut svg = Svg::default();
    let options = DrawOptions { motion: true, normals: true, ..DrawOptions::default() };
    world.draw(&options, &mut svg);
    let frame = "viewBox='-300 -250 600 300' style='background:#23262b'";
    println!("<svg xmlns='http://www.w3.org/2000/svg' {frame}>\n{}</svg>", svg.body);
    Ok(())
}
