//! Car on hills: springs keep the wheels of a car on rough ground, and four cars drive up and down on it.
//! Keys: arrows drive and steer all of them, space brakes.

use crate::car::Car;
use crate::parts::Driven;
use crate::terrain::terrain;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Error, Settings, World};

/// How fast they drive without keys [m/s], and for how long to and fro [s].
const SPEED: f32 = 6.0;
const LEG: f64 = 5.5;
/// Half the width of the ground [m].
const HALF: u16 = 40;

/// Height of the ground [m]: waves and ripples in a flat bowl with a steep rim.
fn height(x: f32, z: f32) -> f32 {
    let out = (x * x + z * z) / (40.0 * 40.0);
    1.0 * (0.2 * x).cos() * (0.25 * z).sin() + 0.12 * (0.9 * z + 0.4 * x).sin() + 20.0 * out.powi(4)
}

/// The cars, side by side.
pub fn start() -> Result<Driven, Error> {
    let (world, cars) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let speed = if ((tick.time / LEG) as u32).is_multiple_of(2) { SPEED } else { -SPEED };
        cars.iter().try_for_each(|car| car.follow(world, &tick.controls, (speed, 0.0)))
    }))
}

fn build() -> Result<(World, [Car; 4]), Error> {
    let mut world = World::new(Settings::default())?;
    world.add_body(&terrain(HALF, height)?)?;
    let mut car = |x: f32| {
        let ground = Vec3::new(x, height(x, 16.0) + 0.5, 16.0);
        Car::add_to(&mut world, DVec3::from(ground), Quat::IDENTITY)
    };
    let cars = [car(-9.0)?, car(-3.0)?, car(3.0)?, car(9.0)?];
    Ok((world, cars))
}

#[test]
fn they_stay_on_their_wheels() -> Result<(), Error> {
    let (mut sample, cars) = (start()?, build()?.1);
    crate::parts::run(&mut sample, LEG)?;
    for car in cars {
        let world = crate::Running::world(&sample);
        // At 6 m/s for 5.5 s they get 33 m far, less the start and the way over waves.
        let way = 16.0 - world.position(car.chassis)?.z;
        assert!((20.0..33.0).contains(&way), "{way} m");
    }
    crate::parts::run(&mut sample, 3.0 * LEG)?;
    for car in cars {
        let world = crate::Running::world(&sample);
        let (at, up) = (world.position(car.chassis)?.as_vec3(), world.rotation(car.chassis)? * Vec3::Y);
        assert!(up.y > 0.7 && at.y > height(at.x, at.z), "{up} at {at}");
    }
    Ok(())
}
