//! Loop: a car drives down a ramp and through a loop 13 m high, which it would not without the ramp's speed.
//! Keys: E drives on after the loop, where it brakes.

use crate::car::Car;
use crate::parts::{Driven, fixed, level_world};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Error, Geometry, TriangleMesh, World};

/// Speed that the engine drives at [m/s].
const SPEED: f32 = 20.0;
/// Half the width of the track, how far it goes aside by metre, and the length of its pieces [m].
const HALF: f32 = 2.5;
const ASIDE: f32 = 0.14;
const PIECE: f32 = 0.1;
/// Slope of the ramp [rad].
const SLOPE: f32 = 0.84;
/// The track by length [m] and curvature [1/m]: the ramp, a bend to level, the loop, whose way in and out
/// are less bent, and a way out. The bends of the loop make a full turn.
const TRACK: [(f32, f32); 6] =
    [(28.0, 0.0), (8.4, 0.1), (9.42, 1.0 / 12.0), (28.28, 1.0 / 6.0), (9.42, 1.0 / 12.0), (60.0, 0.0)];

/// The car at the top of the ramp.
pub fn start() -> Result<Driven, Error> {
    let (world, car) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let brakes = world.position(car.chassis)?.z < -38.0 && !tick.controls.action;
        // Unrolled, the track is straight: its direction is as much aside everywhere.
        let aside = (world.rotation(car.chassis)? * Vec3::NEG_Z).x;
        car.drive(world, if brakes { 0.0 } else { SPEED }, ASIDE - aside)
    }))
}

fn build() -> Result<(World, Car), Error> {
    let (mut world, _) = level_world()?;
    let (mut at, mut angle, mut middle) = (Vec3::Y * 24.3, -SLOPE, Vec::new());
    for (length, curvature) in TRACK {
        for _ in 0..(length / PIECE).round() as usize {
            middle.push(at);
            at += PIECE * Vec3::new(ASIDE, angle.sin(), -angle.cos());
            angle += curvature * PIECE;
        }
    }
    let vertices = middle.iter().flat_map(|&at| [at - HALF * Vec3::X, at + HALF * Vec3::X]).collect();
    let quads = (0..middle.len() as u32 - 1).map(|i| 2 * i);
    let triangles = quads.flat_map(|i| [[i, i + 1, i + 2], [i + 1, i + 3, i + 2]]).collect();
    world.add_body(&fixed(Geometry::mesh(TriangleMesh::new(vertices, triangles)?)))?;
    let turned = Quat::from_rotation_x(-SLOPE) * Quat::from_rotation_y(-ASIDE.atan());
    let car = Car::add_to(&mut world, DVec3::from(middle[30]), turned)?;
    Ok((world, car))
}

#[test]
fn the_car_gets_through() -> Result<(), Error> {
    let (mut sample, car) = (start()?, build()?.1);
    crate::parts::run(&mut sample, 15.0)?;
    let world = crate::Running::world(&sample);
    // The loop ends at z = -36 m, and the car stops on its wheels beyond.
    assert!(world.position(car.chassis)?.z < -50.0 && (world.rotation(car.chassis)? * Vec3::Y).y > 0.99);
    Ok(())
}
