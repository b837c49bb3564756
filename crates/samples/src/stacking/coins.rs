//! Coins: rolls of coins stand, and one coin which spins on its edge falls over.

use crate::parts::{level_world, solid, spread};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyHandle, Error, Geometry, World};
use std::f32::consts::FRAC_PI_2;

const ROLLS: usize = 9;
const COINS: usize = 24;
/// Half the thickness, and the radius of a coin [m].
const THIN: f32 = 0.03;
const RADIUS: f32 = 0.3;
/// Angle of the spinning coin from upright [rad].
const LEAN: f32 = 0.3;
/// How far a coin may lie beside the one below it [m].
const ASIDE: f32 = 0.05;

/// The rolls, and the coin in front of them.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>, BodyHandle), Error> {
    let (mut world, _) = level_world()?;
    let coin = solid(Geometry::cylinder(THIN, RADIUS));
    let mut rolls = Vec::new();
    for roll in 0..ROLLS {
        let corner = Vec3::new(0.9 * (roll % 3) as f32 - 0.9, THIN, 0.9 * (roll / 3) as f32 - 2.0);
        for i in 0..COINS - 2 * roll {
            let index = COINS * roll + i;
            let aside = Vec3::new(spread(index) - 0.5, 0.0, spread(3 * index) - 0.5) * ASIDE;
            let place = corner + aside + Vec3::Y * (2.0 * THIN * i as f32);
            rolls.push(world.add_body(&coin.clone().with_position(place))?);
        }
    }
    let upright = coin
        .with_position(Vec3::new(0.0, RADIUS, 1.2))
        .with_rotation(Quat::from_rotation_x(FRAC_PI_2 - LEAN))
        .with_velocity(Vec3::X * 0.1, Vec3::Y * 25.0);
    let spinning = world.add_body(&upright)?;
    Ok((world, rolls, spinning))
}

#[test]
fn the_rolls_stand_and_the_coin_lies_down() -> Result<(), Error> {
    let (mut world, rolls, spinning) = build()?;
    let before: Vec<_> = rolls.iter().map(|&coin| world.position(coin)).collect::<Result<_, _>>()?;
    crate::parts::run(&mut world, 5.0)?;
    let axis = |world: &World| world.rotation(spinning).map(|turned| (turned * Vec3::Y).y.abs());
    crate::parts::run(&mut world, 25.0)?;
    // A coin that lies has its axis upright.
    assert!(axis(&world)? > 0.999, "{}", axis(&world)?);
    for (&coin, before) in rolls.iter().zip(before) {
        let moved = (world.position(coin)? - before).length();
        assert!(moved < 0.02, "{moved} m");
    }
    Ok(())
}
