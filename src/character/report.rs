//! What a walk came to.

use crate::body::BodyKind;
use crate::error::Error;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::world::World;
use glam::{DVec3, Vec3};

/// Hits that a report keeps.
pub(super) const MOST_HITS: usize = 8;

/// What a mover stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// An obstacle that a mover ran into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoverHit {
    /// Whose shape it is.
    pub body: BodyHandle,
    /// Which shape.
    pub shape: ShapeHandle,
    /// Where, in the world [m].
    pub point: DVec3,
    /// Unit, from the obstacle towards the mover.
    pub normal: Vec3,
    /// What the push would give a dynamic body, zero for others [N s]; [`MoverReport::push`] applies it.
    pub impulse: Vec3,
}

/// What a walk came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MoverReport {
    /// The whole way from where the mover was [m].
    pub moved: Vec3,
    /// What of it moving ground did [m].
    pub carried: Vec3,
    /// By how much the ground turned about `up` meanwhile [rad]: for the direction that a character looks in.
    pub turned: f32,
    /// What of it took the mover out of what had moved into it [m].
    pub pushed_out: Vec3,
    /// How far steps were climbed [m].
    pub stepped: f32,
    /// What it stands on; none in the air, and on what is too steep.
    pub ground: Option<Ground>,
    /// What obstacles left of the velocity [m/s]: over the ground if there is one, otherwise in the world.
    pub velocity: Vec3,
    /// How deep the capsule, without its skin, is still in something [m]; above zero only where it is squeezed.
    pub overlap: f32,
    /// For ground that can move [N s].
    pub(super) weight: Vec3,
    pub(super) hits: [Option<MoverHit>; MOST_HITS],
}

impl MoverReport {
    /// What it ran into, in order, up to eight of them.
    pub fn hits(&self) -> impl Iterator<Item = &MoverHit> {
        self.hits.iter().flatten()
    }

    pub(super) fn hit(&mut self, hit: MoverHit) {
        let free = self.hits.iter_mut().find(|h| h.as_ref().is_none_or(|h| h.shape == hit.shape));
        if let Some(place) = free
            && place.is_none()
        {
            *place = Some(hit);
        }
    }

    /// Pushes the dynamic bodies that the mover ran into, and its weight on the one that it stands on.
    ///
    /// # Errors
    /// If one of the bodies was removed since.
    pub fn push(&self, world: &mut World) -> Result<(), Error> {
        for hit in self.hits() {
            if hit.impulse != Vec3::ZERO {
                world.apply_impulse(hit.body, hit.impulse, hit.point)?;
            }
        }
        let Some(ground) = &self.ground else { return Ok(()) };
        if world.kind(ground.body)? == BodyKind::Dynamic {
            world.apply_impulse(ground.body, self.weight, ground.point)?;
        }
        Ok(())
    }
}
