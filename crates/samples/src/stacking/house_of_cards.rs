//! House of cards: cards that lean on each other carry three more storeys.

use crate::parts::{level_world, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyHandle, Error, Geometry, World};

/// Half height, half width and half thickness of a card [m].
const CARD: [f32; 3] = [0.5, 0.35, 0.012];
/// Angle of a card from the vertical [rad]. Two cards hold while its tangent is below twice the coefficient
/// of friction, which is 0.6.
const LEAN: f32 = 0.35;
const STOREYS: usize = 4;

/// The house.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<(BodyHandle, DVec3)>), Error> {
    let (mut world, _) = level_world()?;
    let [half, width, thin] = CARD;
    let (sin, cos) = LEAN.sin_cos();
    let card = solid(Geometry::cuboid(thin, half, width));
    // From the middle of a leaning card to the line where it meets the other, and half of its height.
    let (aside, rise) = (half * sin + thin * cos, half * cos + thin * sin);
    let pitch = 4.0 * aside;
    let floor = solid(Geometry::cuboid(0.5 * pitch - 0.001, thin, width));
    let mut cards = Vec::new();
    let mut add = |card: backstop::BodyDesc| {
        cards.push((world.add_body(&card)?, card.position));
        Ok::<(), Error>(())
    };
    for storey in 0..STOREYS {
        let tents = STOREYS - storey;
        let base = storey as f32 * 2.0 * (rise + thin);
        for tent in 0..tents {
            let x = pitch * (tent as f32 - 0.5 * (tents - 1) as f32);
            for side in [-1.0, 1.0] {
                let turned = card.clone().with_rotation(Quat::from_rotation_z(side * LEAN));
                add(turned.with_position(Vec3::new(x + side * aside, base + rise, 0.0)))?;
            }
            if tent > 0 {
                add(floor.clone().with_position(Vec3::new(x - 0.5 * pitch, base + 2.0 * rise + thin, 0.0)))?;
            }
        }
    }
    Ok((world, cards))
}

#[test]
fn no_card_slides() -> Result<(), Error> {
    let (mut world, cards) = build()?;
    crate::parts::run(&mut world, 20.0)?;
    for (card, place) in cards {
        assert!((world.position(card)? - place).length() < 0.02, "{place} {}", world.position(card)?);
    }
    Ok(())
}
