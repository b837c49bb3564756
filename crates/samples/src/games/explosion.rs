//! Explosion: a charge goes off between stacks of crates, and a wall gives shelter to one of them.
//! Keys: the action sets off another one.

use crate::parts::{Driven, fixed, lawn, solid};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyHandle, Error, Explosion, Geometry, World};

/// Half the edge of a crate [m], where the charge is, and its time [s].
const HALF: f32 = 0.25;
const CHARGE: DVec3 = DVec3::new(0.0, 0.3, 0.0);
const TIME: f64 = 1.5;
/// Impulse on a square metre [N s/m²], and the distance up to which it is whole [m].
const IMPULSE: f32 = 2_000.0;
const RADIUS: f32 = 3.0;

/// Stacks around the charge, one of them behind a wall.
pub fn start() -> Result<Driven, Error> {
    let (world, _) = build()?;
    Ok(Driven::new(world, |world, tick| {
        let due = (TIME..TIME + f64::from(tick.dt)).contains(&tick.time);
        if due || tick.controls.action { world.apply_explosion(&charge()).map(drop) } else { Ok(()) }
    }))
}

fn charge() -> Explosion {
    let wave = Explosion::default().with_position(CHARGE).with_radius(RADIUS);
    wave.with_impulse_per_area(IMPULSE).with_occluded(true)
}

fn build() -> Result<(World, [BodyHandle; 2]), Error> {
    let (mut world, _) = lawn()?;
    let wall = fixed(Geometry::cuboid(0.1, 0.8, 0.9));
    world.add_body(&wall.with_position(Vec3::new(1.5, 0.8, 0.0)))?;
    let cube = solid(Geometry::cuboid(HALF, HALF, HALF));
    let mut lowest = Vec::new();
    for corner in [Vec3::NEG_X, Vec3::X, Vec3::NEG_Z, Vec3::Z] {
        for layer in 0..3 {
            for aside in [-1.0, 0.0, 1.0] {
                let place = corner * 2.5 + corner.cross(Vec3::Y) * aside * 2.04 * HALF;
                let place = place + Vec3::Y * HALF * (2 * layer + 1) as f32;
                lowest.push(world.add_body(&cube.clone().with_position(place))?);
            }
        }
    }
    // The middle crates of the lowest layers, on the side of the charge and behind the wall.
    Ok((world, [lowest[1], lowest[10]]))
}

#[test]
fn the_wall_gives_shelter() -> Result<(), Error> {
    let (mut world, [open, sheltered]) = build()?;
    world.apply_explosion(&charge())?;
    // A face of (2 HALF)² of a crate of 1000 kg/m³: v = J A / m = J / (1000 * 2 HALF).
    let speed = world.linear_velocity(open)?.length();
    assert!((speed / (IMPULSE / (1000.0 * 2.0 * HALF)) - 1.0).abs() < 0.1, "{speed} m/s");
    assert_eq!(world.linear_velocity(sheltered)?, Vec3::ZERO);
    Ok(())
}
