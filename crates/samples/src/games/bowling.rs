//! Bowling: a ball slides, then rolls, and knocks down ten pins.

use crate::parts::{fixed, level_world};
use backstop::glam::Vec3;
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Material, ShapeDesc, World};

/// Length of the lane to the first pin, and distance of two pins [m].
const LANE: f32 = 8.0;
const PITCH: f32 = 0.305;
/// Radius [m], mass [kg] and speed [m/s] of the ball, which does not turn at first.
const RADIUS: f32 = 0.108;
const MASS: f32 = 7.0;
const SPEED: f32 = 8.0;
/// Friction on the lane, 0.6, and of the oiled ball: between the two it is the mean.
const OILED: f32 = 0.1;

/// The lane, with the ball on its way.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, BodyHandle, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let rail = fixed(Geometry::cuboid(0.5 * LANE, 0.1, 0.05));
    for z in [-0.7, 0.7] {
        world.add_body(&rail.clone().with_position(Vec3::new(-0.5 * LANE, 0.1, z)))?;
    }
    world.add_body(&fixed(Geometry::cuboid(0.1, 0.5, 0.9)).with_position(Vec3::new(2.5, 0.5, 0.0)))?;
    // A pin: a belly, a neck and a head, 0.38 m high and of 1.5 kg.
    let wood = |geometry, y: f32| ShapeDesc::new(geometry).with_density(650.0).with_position(Vec3::Y * y);
    let part = |low, top, half: f32, y| wood(Geometry::tapered_cylinder(half, low, top), y);
    let (foot, belly) = (part(0.028, 0.06, 0.06, 0.06), part(0.06, 0.025, 0.07, 0.19));
    let pin = [foot, belly, part(0.025, 0.03, 0.045, 0.305), wood(Geometry::sphere(0.032), 0.35)];
    let mut pins = Vec::new();
    for row in 0..4 {
        for i in 0..=row {
            let place = Vec3::new(0.866 * PITCH * row as f32, 0.0, PITCH * (i as f32 - 0.5 * row as f32));
            pins.push(world.add_body(&BodyDesc::dynamic().with_position(place).with_shapes(pin.clone()))?);
        }
    }
    let oiled = Material::default().with_friction(OILED);
    let ball = ShapeDesc::new(Geometry::sphere(RADIUS)).with_density(MASS / 0.00528).with_material(oiled);
    let ball = BodyDesc::dynamic().with_position(Vec3::new(-LANE, RADIUS, 0.04)).with_shape(ball);
    let ball = world.add_body(&ball.with_linear_velocity(Vec3::X * SPEED))?;
    Ok((world, ball, pins))
}

#[test]
fn the_ball_rolls_and_pins_fall() -> Result<(), Error> {
    let (mut world, ball, pins) = build()?;
    crate::parts::run(&mut world, 1.0)?;
    // Friction turns two sevenths of the speed into rotation, within 2 v / (7 mu g) = 0.67 s.
    let speed = world.linear_velocity(ball)?.x;
    assert!((speed - SPEED * 5.0 / 7.0).abs() < 0.02 * SPEED, "{speed} m/s");
    crate::parts::run(&mut world, 8.0)?;
    let lies = |&&pin: &&BodyHandle| world.rotation(pin).is_ok_and(|turned| (turned * Vec3::Y).y < 0.5);
    let down = pins.iter().filter(lies).count();
    assert!(down >= 6, "{down}");
    Ok(())
}
