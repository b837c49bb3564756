//! Car: of bodies and joints, with springs and steering, it goes round a circle and through a wall of boxes.
//! Keys: arrows drive and steer, space brakes.

use crate::car::{Car, HUB};
use crate::parts::{Driven, level_world, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Error, Geometry, World};

/// Speed [m/s] and steering angle [rad] without keys: a circle of 2 HUB.z / tan(0.2) = 12.8 m.
const SPEED: f32 = 6.0;
const ANGLE: f32 = 0.2;

/// The car, and a wall of boxes on the circle.
pub fn start() -> Result<Driven, Error> {
    let (world, car) = build()?;
    Ok(Driven::new(world, move |world, tick| car.follow(world, &tick.controls, (SPEED, ANGLE))))
}

fn build() -> Result<(World, Car), Error> {
    let (mut world, _) = level_world()?;
    let car = Car::add_to(&mut world, DVec3::X * -8.0, Quat::IDENTITY)?;
    let radius = 2.0 * HUB.z / ANGLE.tan();
    for i in 0..40 {
        let (column, row) = (i % 8, i / 8);
        let x = -8.0 + 2.0 * radius + 0.5 * column as f32 - 1.75;
        let mut body = solid(Geometry::cuboid(0.24, 0.25, 0.24));
        body.shapes[0].density = 80.0;
        world.add_body(&body.with_position(Vec3::new(x, 0.25 + 0.5 * row as f32, 0.0)))?;
    }
    Ok((world, car))
}

#[test]
fn it_turns_as_its_wheels_point() -> Result<(), Error> {
    let (mut sample, car) = (start()?, build()?.1);
    crate::parts::run(&mut sample, 5.0)?;
    // By the wheelbase and the steering angle, within a tenth, by which tyres slide in the bend.
    let world = crate::Running::world(&sample);
    let speed = world.linear_velocity(car.chassis)?.length();
    let turn = -world.angular_velocity(car.chassis)?.y;
    let expected = speed * ANGLE.tan() / (2.0 * HUB.z);
    assert!((speed / SPEED - 1.0).abs() < 0.1 && (turn / expected - 1.0).abs() < 0.1, "{speed}, {turn}");
    crate::parts::run(&mut sample, 20.0)?;
    let world = crate::Running::world(&sample);
    assert!((world.rotation(car.chassis)? * Vec3::Y).y > 0.99, "it stands on its wheels");
    Ok(())
}
