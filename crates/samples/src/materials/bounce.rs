//! Restitution: balls come back with the share e of their speed, and so to the share e² of their height.

use crate::parts::fixed;
use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Combine, Error, Geometry, Material, Settings, ShapeDesc, World};

const BALLS: usize = 11;
const RADIUS: f32 = 0.2;
/// Height of the fall [m].
const HEIGHT: f32 = 3.0;

/// The balls in the air, of e = 0 to 1.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let mut world = World::new(Settings::default())?;
    // The greater of two coefficients counts if both materials say so.
    let bouncy = |e: f32| Material::default().with_restitution(e).with_restitution_combine(Combine::Maximum);
    let mut ground = fixed(Geometry::plane());
    ground.shapes[0].material = bouncy(0.0);
    world.add_body(&ground)?;
    let mut balls = Vec::new();
    for i in 0..BALLS {
        let place = Vec3::new(0.6 * i as f32 - 3.0, HEIGHT + RADIUS, 0.0);
        let ball = ShapeDesc::new(Geometry::sphere(RADIUS)).with_material(bouncy(0.1 * i as f32));
        balls.push(world.add_body(&BodyDesc::dynamic().with_position(place).with_shape(ball))?);
    }
    Ok((world, balls))
}

#[test]
fn heights_are_the_squares() -> Result<(), Error> {
    let (mut world, balls) = build()?;
    // To the ground within 0.782 s; up and down again takes at most twice as long.
    crate::parts::run(&mut world, 0.8)?;
    let mut highest = [0.0_f32; BALLS];
    for _ in 0..80 {
        world.step(1.0 / 60.0)?;
        for (&ball, highest) in balls.iter().zip(&mut highest) {
            *highest = highest.max(world.position(ball)?.y as f32 - RADIUS);
        }
    }
    for (i, highest) in highest.into_iter().enumerate() {
        let expected = HEIGHT * (0.1 * i as f32).powi(2);
        assert!((highest - expected).abs() < 0.02 * HEIGHT, "{i}: {highest} of {expected} m");
    }
    Ok(())
}
