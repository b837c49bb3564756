//! Rotations of the untouched bodies of a block.

use crate::body::{FREE, FreeTurn};
use crate::math::Quat;
use crate::threads::per_block;
use glam::Vec3;

/// Bodies in a block of work.
pub(super) const BLOCK: usize = per_block(64, 1);

/// Rotations and angular velocities at the end of the step, by a body's place in its block; `None` for other
/// bodies.
pub(super) struct Turned([(Quat, Vec3); BLOCK]);

impl Turned {
    /// Turns the given bodies, each with its place. Those that take the same number of steps are turned
    /// together.
    pub(super) fn of(turns: impl Iterator<Item = (usize, FreeTurn)>) -> Turned {
        let mut turned = Turned([(Quat::IDENTITY, Vec3::ZERO); BLOCK]);
        let mut all = [(0, 0, FreeTurn::default()); BLOCK];
        let mut count = 0;
        for (place, turn) in turns {
            if let Some(end) = turn.as_top() {
                turned.0[place] = end;
            } else {
                all[count] = (turn.parts(), place, turn);
                count += 1;
            }
        }
        let all = &mut all[..count];
        all.sort_unstable_by_key(|&(parts, place, _)| (parts, place));
        for four in all.chunks(FREE) {
            let mut turns = [FreeTurn::default(); FREE];
            four.iter().zip(&mut turns).for_each(|(&(.., turn), lane)| *lane = turn);
            let ends = FreeTurn::all(&turns[..four.len()]);
            for (&(_, place, _), end) in four.iter().zip(ends) {
                turned.0[place] = end;
            }
        }
        turned
    }

    /// Rotation and angular velocity of the body at a place.
    pub(super) fn of_place(&self, place: usize) -> (Quat, Vec3) {
        self.0[place]
    }
}
