//! Rolling friction: balls on a level floor stop the sooner the longer its lever arm.

use crate::parts::level_world;
use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Material, ShapeDesc, World};

/// Lever arms [m].
const ARMS: [f32; 6] = [0.01, 0.013, 0.017, 0.023, 0.032, 0.05];
const RADIUS: f32 = 0.2;
/// Speed at the start [m/s].
const SPEED: f32 = 2.5;

/// The balls, rolling.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let mut balls = Vec::new();
    for (i, arm) in ARMS.into_iter().enumerate() {
        let felt = Material::default().with_rolling_friction(arm);
        let ball = BodyDesc::dynamic()
            .with_position(Vec3::new(-4.0, RADIUS, 0.7 * i as f32 - 1.75))
            .with_velocity(Vec3::X * SPEED, Vec3::NEG_Z * SPEED / RADIUS)
            .with_shape(ShapeDesc::new(Geometry::sphere(RADIUS)).with_material(felt));
        balls.push(world.add_body(&ball)?);
    }
    Ok((world, balls))
}

#[test]
fn each_stops_where_it_has_to() -> Result<(), Error> {
    let (mut world, balls) = build()?;
    crate::parts::run(&mut world, 20.0)?;
    for (ball, arm) in balls.into_iter().zip(ARMS) {
        // A solid ball slows down by a = (5/7) g b / r, and stops after v² / (2 a).
        let expected = 0.5 * SPEED * SPEED / (5.0 / 7.0 * 9.81 * arm / RADIUS);
        let way = world.position(ball)?.x as f32 + 4.0;
        assert!((way - expected).abs() < 0.02 * expected + 0.02, "{arm}: {way} of {expected} m");
    }
    Ok(())
}
