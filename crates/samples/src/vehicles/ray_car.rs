//! Ray-cast car: `backstop::vehicle` with springs, tyres, an engine and gears; its wheels are only drawn.
//! Keys: arrows drive and steer, space pulls the hand brake; without keys it goes round over bumps.

use crate::car::{add_tyres, move_tyres};
use crate::parts::{Driven, fixed, level_world, spread};
use backstop::glam::{Quat, Vec3};
use backstop::vehicle::{Controls, Vehicle, VehicleDesc};
use backstop::{BodyDesc, Error, Geometry, MassProperties, ShapeDesc, World};
use std::f32::consts::PI;

/// Mass of the car [kg]; without keys its speed [m/s] and share of the steering to the right.
const MASS: f32 = 1200.0;
const SPEED: f32 = 6.0;
const STEER: f32 = 0.4;

/// The car among bumps.
pub fn start() -> Result<Driven<Vehicle>, Error> {
    let (mut world, car) = build()?;
    let tyres = add_tyres(&mut world, &car)?;
    // Gears and spins of wheels are not in the world: a game keeps a copy of them with each snapshot.
    Ok(Driven::with_state(world, car, move |world, car, tick| {
        let (keys, mut controls) = (tick.controls, Controls::default());
        (controls.throttle, controls.steer) = match keys == crate::Controls::default() {
            true => ((SPEED - car.speed(world)?).clamp(0.0, 1.0), -STEER),
            false => (keys.forward, -keys.right),
        };
        controls.hand_brake = if keys.jump { 1.0 } else { 0.0 };
        car.update(world, tick.dt, &controls)?;
        move_tyres(world, car, &tyres)
    }))
}

fn build() -> Result<(World, Vehicle), Error> {
    let (mut world, _) = level_world()?;
    for i in 0..60 {
        let at = 36.0 * Vec3::new(spread(i) - 0.5, -0.92 / 36.0, spread(7 * i) - 0.5);
        world.add_body(&fixed(Geometry::sphere(1.0)).with_position(at))?;
    }
    let hull = Geometry::cuboid(0.9, 0.35, 2.1);
    // A vehicle looks along the z of its chassis.
    let chassis = BodyDesc::dynamic()
        .with_position(Vec3::new(-6.0, 0.8, 0.0))
        .with_rotation(Quat::from_rotation_y(PI))
        .with_mass(MassProperties::of(&hull, 1.0).scaled_to(MASS))
        .with_shape(ShapeDesc::new(hull).with_position(Vec3::Y * 0.3));
    let chassis = world.add_body(&chassis)?;
    let desc = VehicleDesc::car(Vec3::Y * -0.3, [0.95, 1.3], MASS);
    Vehicle::new(&mut world, chassis, &desc).map(|car| (world, car))
}

#[test]
fn it_goes_round_as_it_is_steered() -> Result<(), Error> {
    let (mut sample, car) = (start()?, build()?.1);
    crate::parts::run(&mut sample, 20.0)?;
    let world = crate::Running::world(&sample);
    let expected = SPEED * (0.6 * STEER).tan() / 2.6; // Steering by at most 0.6 rad; wheelbase.
    assert!((world.angular_velocity(car.chassis())?.y / -expected - 1.0).abs() < 0.1);
    Ok(())
}
