//! The result of a walk.

use crate::body::BodyKind;
use crate::error::Error;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::world::World;
use glam::{DVec3, Vec3};

/// Hits that a report keeps.
pub(super) const MAX_HITS: usize = 8;

/// The ground under a character.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ground {
    /// Whose shape it is.
    pub body: BodyHandle,
    /// Which shape.
    pub shape: ShapeHandle,
    /// Where, in the world [m].
    pub point: DVec3,
    /// Unit, out of the ground.
    pub normal: Vec3,
    /// How fast the ground moves at that point [m/s].
    pub velocity: Vec3,
}

/// An obstacle that a character ran into.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CharacterHit {
    /// Whose shape it is.
    pub body: BodyHandle,
    /// Which shape.
    pub shape: ShapeHandle,
    /// Where, in the world [m].
    pub point: DVec3,
    /// Unit, from the obstacle towards the character.
    pub normal: Vec3,
    /// Impulse of the push on a dynamic body, zero for others [N s]; [`CharacterReport::push`] applies it.
    pub impulse: Vec3,
}

/// The result of a walk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CharacterReport {
    /// The whole displacement [m].
    pub moved: Vec3,
    /// The part of it by moving ground [m].
    pub carried: Vec3,
    /// By how much the ground turned about `up` meanwhile [rad]: for the direction that a character looks in.
    pub turned: f32,
    /// The part of it out of bodies that had moved into the character [m].
    pub pushed_out: Vec3,
    /// How far steps were climbed [m].
    pub stepped: f32,
    /// The ground; none in the air, and on surfaces that are too steep.
    pub ground: Option<Ground>,
    /// The velocity after obstacles [m/s]: relative to the ground if there is one, else in the world.
    pub velocity: Vec3,
    /// Remaining overlap of its shape, without the skin [m]; above zero only if it is squeezed.
    pub overlap: f32,
    /// Impulse of the character's weight on ground that can move [N s].
    pub(super) weight: Vec3,
    pub(super) hits: [Option<CharacterHit>; MAX_HITS],
}

impl CharacterReport {
    /// The shapes that it ran into, in order, up to eight.
    pub fn hits(&self) -> impl Iterator<Item = &CharacterHit> {
        self.hits.iter().flatten()
    }

    pub(super) fn hit(&mut self, hit: CharacterHit) {
        let free = self.hits.iter_mut().find(|h| h.as_ref().is_none_or(|h| h.shape == hit.shape));
        if let Some(place) = free
            && place.is_none()
        {
            *place = Some(hit);
        }
    }

    /// Pushes the dynamic bodies that the character ran into, and its weight on the one that it stands on.
    ///
    /// # Errors
    /// If one of the bodies was removed since.
    pub fn push(&self, world: &mut World) -> Result<(), Error> {
        for hit in self.hits() {
            if hit.impulse != Vec3::ZERO {
                world.apply_impulse_at(hit.body, hit.impulse, hit.point)?;
            }
        }
        let Some(ground) = &self.ground else { return Ok(()) };
        if world.kind(ground.body)? == BodyKind::Dynamic {
            world.apply_impulse_at(ground.body, self.weight, ground.point)?;
        }
        Ok(())
    }
}
