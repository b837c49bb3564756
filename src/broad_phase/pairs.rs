//! Which pairs there are: a list in a stable order, and a hash table that finds a pair's place in it.
//!
//! The list belongs to [`BroadPhase`](super::BroadPhase), because the owner of the world writes into it
//! (where a pair keeps its contact); the table holds only places. Open addressing with linear probing and a
//! fixed hash, so that nothing here depends on a random seed, and a removal shifts later entries back instead
//! of leaving a mark: a table that lives for hours doesn't silt up.

use crate::memory::{Allowance, buffers};
use crate::shape::ColliderSummary;

/// Two colliders that may touch in this step; `a` has the lower kind, then the lower index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pair {
    pub(crate) a: u32,
    pub(crate) b: u32,
    /// The narrow phase's own: where it keeps the pair's contact. `u32::MAX`: none.
    pub(crate) contact: u32,
    /// Set while the relative motion of this step outruns the margin: the narrow phase casts.
    pub(crate) fast: bool,
    /// The listeners' own: the two touched in the last step.
    pub(crate) touching: bool,
    /// The narrow phase's own: up to which reading of their odometers the two, that have no contact, can't
    /// have one. Zero: unknown.
    pub(crate) apart: u16,
}

impl Pair {
    /// Whether neither body can be pushed in this step: one sleeps beside a kinematic body, which would wake
    /// it before anything is solved if it reached it; or one is a sensor. Such a pair has no rows, and its
    /// contacts stay as they are, for the step in which the island wakes.
    #[inline]
    pub(crate) fn is_idle(&self, summaries: &[ColliderSummary], dynamic: usize) -> bool {
        summaries[self.a as usize].body as usize >= dynamic
            && summaries[self.b as usize].body as usize >= dynamic
    }
}

/// From two colliders, in any order, to their pair.
///
/// A slot is five bytes in two columns. The tags, which most looks are content with, are few enough to stay
/// near; the hash itself is made again where a slot has to move.
#[derive(Debug, Default)]
pub(super) struct PairTable {
    /// Part of the hash of the pair in each slot; [`FREE`] if there is none. At most three quarters of the
    /// slots are taken.
    tags: Vec<u8>,
    /// The pair's place in the list.
    places: Vec<u32>,
}

/// The tag of a free slot.
const FREE: u8 = 0;

/// The finaliser of SplitMix64 (Steele et al., *Fast Splittable Pseudorandom Number Generators*, 2014).
#[inline]
fn hash_of(i: u32, j: u32) -> u32 {
    let mut h = u64::from(i.min(j)) << 32 | u64::from(i.max(j));
    h = (h ^ h >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ h >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    (h ^ h >> 31) as u32
}

/// Never that of a free slot.
#[inline]
fn tag_of(hash: u32) -> u8 {
    (hash as u8).max(1)
}

buffers! { PairTable { bytes { tags, places } } }

impl PairTable {
    /// Where a pair is kept if nothing is in its way: by the high bits of the hash, so that any number of
    /// slots will do.
    #[inline]
    fn home_of(&self, hash: u32) -> usize {
        ((u64::from(hash) * self.tags.len() as u64) >> 32) as usize
    }

    #[inline]
    fn next(&self, at: usize) -> usize {
        if at + 1 == self.tags.len() { 0 } else { at + 1 }
    }

    /// How far one slot is behind another.
    fn way(&self, from: usize, to: usize) -> usize {
        if to >= from { to - from } else { to + self.tags.len() - from }
    }

    /// Where the pair of two colliders is in `pairs`.
    #[inline]
    pub(super) fn find(&self, pairs: &[Pair], i: u32, j: u32) -> Option<usize> {
        if self.tags.is_empty() {
            return None;
        }
        let hash = hash_of(i, j);
        let (mut at, wanted) = (self.home_of(hash), tag_of(hash));
        loop {
            let tag = self.tags[at];
            if tag == FREE {
                return None;
            }
            if tag == wanted {
                let place = self.places[at] as usize;
                let pair = &pairs[place];
                if (pair.a, pair.b) == (i, j) || (pair.a, pair.b) == (j, i) {
                    return Some(place);
                }
            }
            at = self.next(at);
        }
    }

    /// Appends a pair that isn't there yet.
    pub(super) fn push(&mut self, pairs: &mut Vec<Pair>, pair: Pair) {
        debug_assert!(self.find(pairs, pair.a, pair.b).is_none());
        let wanted = Self::size_for(pairs.len() + 1);
        if wanted > self.tags.len() {
            self.grow(pairs, wanted);
        }
        self.place(hash_of(pair.a, pair.b), pairs.len() as u32);
        // Under a budget there is place for it.
        let mut allowance = Allowance::ENDLESS;
        allowance.push(pairs, pair);
    }

    /// Takes a pair out; the last of the list moves to its place.
    pub(super) fn swap_remove(&mut self, pairs: &mut Vec<Pair>, place: usize) -> Pair {
        let last = pairs.len() - 1;
        let mut hole = self.slot_of(&pairs[place], place);
        if last != place {
            let moved = self.slot_of(&pairs[last], last);
            self.places[moved] = place as u32;
        }
        let gone = pairs.swap_remove(place);
        // Later entries of the run move up, unless that would put one before its home.
        let mut at = hole;
        loop {
            at = self.next(at);
            if self.tags[at] == FREE {
                break;
            }
            let pair = &pairs[self.places[at] as usize];
            let home = self.home_of(hash_of(pair.a, pair.b));
            if self.way(home, at) >= self.way(hole, at) {
                (self.tags[hole], self.places[hole]) = (self.tags[at], self.places[at]);
                hole = at;
            }
        }
        self.tags[hole] = FREE;
        gone
    }

    /// Makes the table of another list of pairs.
    pub(super) fn rebuild(&mut self, pairs: &[Pair]) {
        let size = Self::size_for(pairs.len()).max(self.tags.len());
        self.refill(pairs, size);
    }

    /// Bytes that are lacking for so many pairs.
    pub(super) fn missing(&self, pairs: usize) -> usize {
        Self::size_for(pairs).saturating_sub(self.tags.len()) * (size_of::<u8>() + size_of::<u32>())
    }

    /// Makes place for so many pairs, of which these are there.
    pub(super) fn reserve_total(&mut self, pairs: &[Pair], count: usize) {
        if Self::size_for(count) > self.tags.len() {
            self.refill(pairs, Self::size_for(count));
        }
    }

    fn size_for(pairs: usize) -> usize {
        if pairs == 0 { 0 } else { (pairs * 4).div_ceil(3).max(64) }
    }

    fn slot_of(&self, pair: &Pair, place: usize) -> usize {
        let mut at = self.home_of(hash_of(pair.a, pair.b));
        while self.places[at] != place as u32 || self.tags[at] == FREE {
            at = self.next(at);
        }
        at
    }

    fn place(&mut self, hash: u32, place: u32) {
        let mut at = self.home_of(hash);
        while self.tags[at] != FREE {
            at = self.next(at);
        }
        (self.tags[at], self.places[at]) = (tag_of(hash), place);
    }

    #[cold]
    fn grow(&mut self, pairs: &[Pair], wanted: usize) {
        // By more than is needed, so that it happens seldom.
        let size = self.tags.len();
        self.refill(pairs, wanted.max(size + if size < 4096 { size } else { size / 4 }));
    }

    /// Makes the table anew, with so many slots.
    fn refill(&mut self, pairs: &[Pair], size: usize) {
        self.tags.clear();
        self.tags.reserve_exact(size);
        self.tags.resize(size, FREE);
        self.places.reserve_exact(size - self.places.len());
        self.places.resize(size, 0);
        for (place, pair) in pairs.iter().enumerate() {
            self.place(hash_of(pair.a, pair.b), place as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_table_holds_what_a_set_would_hold() {
        let mut table = PairTable::default();
        let (mut pairs, mut set) = (Vec::new(), BTreeSet::new());
        let mut seed = 7u32;
        let mut next = |n: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) % n
        };
        for _ in 0..20_000 {
            let (i, j) = (next(40), 40 + next(40));
            match table.find(&pairs, j, i) {
                Some(place) => {
                    assert!(set.remove(&(i, j)));
                    let gone = table.swap_remove(&mut pairs, place);
                    assert_eq!((gone.a, gone.b), (i, j));
                }
                None => {
                    assert!(set.insert((i, j)));
                    table.push(
                        &mut pairs,
                        Pair { a: i, b: j, contact: u32::MAX, fast: false, touching: false, apart: 0 },
                    );
                }
            }
            assert_eq!(pairs.len(), set.len());
        }
        for (place, pair) in pairs.iter().enumerate() {
            assert_eq!(table.find(&pairs, pair.a, pair.b), Some(place));
        }
    }
}
