//! Loop: a car rolls down a ramp and through a loop of 4 m radius, for which it needs the speed of the ramp.
//! Keys: E drives on.

use crate::car::Car;
use crate::parts::{Driven, level_world};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, Error, Geometry, ShapeDesc, TriangleMesh, World};
use std::f32::consts::TAU;

/// Speed that the car drives at [m/s]: with sqrt(5 g r) at the bottom it does not fall off at the top.
const SPEED: f32 = 18.0;
/// Radius of the loop, and half the width of the track [m].
const RADIUS: f32 = 5.0;
const HALF: f32 = 1.6;
/// The track: lengths [m] and curvatures [1/m]; a ramp, a bend to level, the loop, and a way out.
const TRACK: [(f32, f32); 5] =
    [(24.0, 0.0), (8.4, 0.1), (4.0, 0.0), (TAU * RADIUS, 1.0 / RADIUS), (55.0, 0.0)];
/// Slope of the ramp [rad], and how far the track goes aside by metre.
const SLOPE: f32 = 0.84;
const ASIDE: f32 = 0.12;
/// Length of a piece of the track [m].
const PIECE: f32 = 0.1;

/// The car at the top of the ramp.
pub fn start() -> Result<Driven, Error> {
    let (world, car) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let out = world.position(car.chassis)?.z < -36.0;
        car.drive(world, if out && !tick.controls.action { 0.0 } else { SPEED }, 0.0)
    }))
}

fn build() -> Result<(World, Car), Error> {
    let (mut world, _) = level_world()?;
    // The middle of the track from its lower end back to its top would be below zero: shift it up.
    let (mut middle, mut angle) = (vec![Vec3::ZERO], -SLOPE);
    for (length, curvature) in TRACK {
        for _ in 0..(length / PIECE).round() as usize {
            let at = *middle.last().unwrap_or(&Vec3::ZERO);
            middle.push(at + PIECE * Vec3::new(ASIDE, angle.sin(), -angle.cos()));
            angle += curvature * PIECE;
        }
    }
    let low = middle.iter().fold(0.0_f32, |low, at| low.min(at.y));
    let mut vertices = Vec::new();
    for at in &middle {
        vertices.extend([-HALF, HALF].map(|side| *at + Vec3::new(side, 0.05 - low, 0.0)));
    }
    let quads = (0..middle.len() as u32 - 1).map(|i| 2 * i);
    let triangles = quads.flat_map(|i| [[i, i + 1, i + 2], [i + 1, i + 3, i + 2]]).collect();
    let mesh = ShapeDesc::new(Geometry::mesh(TriangleMesh::new(vertices, triangles)?));
    world.add_body(&BodyDesc::fixed().with_shape(mesh))?;
    let top = middle[30] + Vec3::Y * (0.1 - low);
    let turned = Quat::from_rotation_x(-SLOPE) * Quat::from_rotation_y(-ASIDE.atan());
    let car = Car::add_to(&mut world, DVec3::from(top), turned)?;
    Ok((world, car))
}

#[test]
fn the_car_gets_through() -> Result<(), Error> {
    let (mut sample, car) = (start()?, build()?.1);
    for i in 0..50 {
    crate::parts::run(&mut sample, 0.2)?;
    let world = crate::Running::world(&sample);
    println!("{i} {} {} up {}", world.position(car.chassis)?, world.linear_velocity(car.chassis)?.length(), world.rotation(car.chassis)? * Vec3::Y);
    }
    assert!(false);
    Ok(())
}
