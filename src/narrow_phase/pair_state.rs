//! The treatment of each pair by the narrow phase of a step.

use super::bins::{BINS, Bin};
use bytemuck::{Pod, Zeroable};

/// State of a pair in the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PairState {
    /// The blocks of its bin look at it.
    Binned(Bin),
    /// Its block has to look at it again: its manifold needs a place first.
    Crowded,
    /// It has no contact: nothing is touched on the whole predicted path, nor near at its start.
    Clear,
    /// Its contacts are removed.
    Emptied,
    /// It gets no contact: it is too far apart, has nothing that could be pushed, or only reports overlaps
    /// with a sensor.
    Far,
    /// It keeps its contact.
    Kept,
}

/// A [`PairState`] in a byte: there is one for each pair of a step. The highest bit says whether one of the
/// two is ground: it cannot be pushed, and the other one can.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct PackedState(u8);

const OF_GROUND: u8 = 0x80;
const _: () = assert!(BINS + 4 < OF_GROUND);

impl PackedState {
    #[inline(always)]
    pub(crate) fn is(self, state: PairState) -> bool {
        self.0 & !OF_GROUND == PackedState::from(state).0
    }

    #[inline(always)]
    pub(crate) fn is_of_ground(self) -> bool {
        self.0 & OF_GROUND != 0
    }

    /// Another state of the same pair.
    #[inline(always)]
    pub(crate) fn set(&mut self, state: PairState) {
        *self = PackedState::from(state).of_ground(self.is_of_ground());
    }

    /// The same of a pair with ground.
    #[inline(always)]
    pub(crate) fn of_ground(self, ground: bool) -> PackedState {
        PackedState(self.0 | if ground { OF_GROUND } else { 0 })
    }

    /// The bin of a pair that a block looks at.
    #[inline(always)]
    pub(crate) fn bin(self) -> Option<Bin> {
        let state = self.0 & !OF_GROUND;
        (state < BINS).then_some(Bin(state))
    }
}

/// The pairs whose states are such, in order. Most callers need few of the pairs: the others are passed over
/// many at a time.
pub(crate) fn pairs_that(
    states: &[PackedState],
    are_such: impl Fn(PackedState) -> bool + Copy,
) -> impl Iterator<Item = u32> {
    const MANY: usize = 64;
    let any = move |many: &[PackedState]| many.iter().fold(false, |any, &state| any | are_such(state));
    let some = states.chunks(MANY).enumerate().filter(move |(_, many)| any(many));
    some.flat_map(move |(k, many)| {
        let first = (k * MANY) as u32;
        (first..).zip(many).filter(move |(_, state)| are_such(**state)).map(|(pair, _)| pair)
    })
}

impl From<PairState> for PackedState {
    #[inline(always)]
    fn from(state: PairState) -> PackedState {
        PackedState(match state {
            PairState::Binned(Bin(bin)) => bin,
            PairState::Crowded => BINS,
            PairState::Clear => BINS + 1,
            PairState::Emptied => BINS + 2,
            PairState::Far => BINS + 3,
            PairState::Kept => BINS + 4,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_state_has_a_byte_of_its_own() {
        use PairState::{Clear, Crowded, Emptied, Far, Kept};
        let states =
            (0..BINS).map(|bin| PairState::Binned(Bin(bin))).chain([Crowded, Clear, Emptied, Far, Kept]);
        let states: Vec<(PairState, PackedState)> = states.map(|state| (state, state.into())).collect();
        for (i, &(state, packed)) in states.iter().enumerate() {
            assert_eq!(packed.bin(), if let PairState::Binned(bin) = state { Some(bin) } else { None });
            for (k, &(other, _)) in states.iter().enumerate() {
                assert_eq!(packed.is(other), i == k, "{state:?} {other:?}");
            }
        }
    }
}
