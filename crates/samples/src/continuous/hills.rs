//! Hills: bodies of every shape, fast and spinning, are thrown onto a valley, and none gets below it.

use crate::parts::{Driven, solid, spread};
use crate::terrain::terrain;
use backstop::glam::{Quat, Vec3};
use backstop::{ConvexHull, Error, Geometry, Settings, World};
use std::f32::consts::TAU;

/// Bodies, and the time between two [s].
const COUNT: usize = 150;
const PAUSE: f64 = 0.1;
/// Speed and spin of a body at the start [m/s], [rad/s].
const SPEED: f32 = 60.0;
const SPIN: f32 = 60.0;
/// Half the width of the ground [m].
const HALF: u16 = 30;

/// The valley, into which bodies are thrown from all sides.
pub fn start() -> Result<Driven, Error> {
    let mut world = World::new(Settings::default())?;
    world.add_body(&terrain(HALF, height)?)?;
    let wedge = ConvexHull::new(&[Vec3::ZERO, 0.8 * Vec3::X, 0.8 * Vec3::Y, 0.8 * Vec3::Z])?;
    let [ball, plate] = [Geometry::sphere(0.3), Geometry::cuboid(0.6, 0.05, 0.3)];
    let [rod, disc] = [Geometry::capsule(0.5, 0.08), Geometry::cylinder(0.05, 0.5)];
    let kinds = [ball, plate, rod, disc, Geometry::cone(0.4, 0.3), Geometry::hull(wedge)];
    Ok(Driven::new(world, move |world, tick| {
        for i in tick.due(PAUSE).filter(|&i| i < COUNT) {
            let angle = TAU * spread(i);
            let from = Vec3::new(8.0 * angle.cos(), 25.0, 8.0 * angle.sin());
            let to = Vec3::new(10.0 * spread(3 * i) - 5.0, 0.0, 10.0 * spread(7 * i) - 5.0);
            let body = solid(kinds[i % kinds.len()].clone())
                .with_position(from)
                .with_rotation(Quat::from_rotation_x(angle))
                .with_velocity((to - from).normalize() * SPEED, Vec3::new(SPIN, 0.5 * SPIN, 0.0));
            world.add_body(&body)?;
        }
        Ok(())
    }))
}

/// Height of the ground [m]: hills in a bowl with a steep rim.
fn height(x: f32, z: f32) -> f32 {
    let out = (x * x + z * z) / (30.0 * 30.0);
    1.2 * (0.5 * x).sin() * (0.4 * z).cos() + 15.0 * out + 25.0 * out.powi(3)
}

#[test]
fn none_is_below_the_ground() -> Result<(), Error> {
    let mut sample = start()?;
    crate::parts::run(&mut sample, 25.0)?;
    let world = crate::Running::world(&sample);
    for body in world.bodies() {
        let at = world.position(body)?.as_vec3();
        // Between its points, a metre apart, the ground is up to 0.1 m lower.
        assert!(at.y > height(at.x, at.z) - 0.1 && at.with_y(0.0).length() < f32::from(HALF), "{at}");
    }
    assert_eq!(world.body_count(), 1 + COUNT);
    Ok(())
}
