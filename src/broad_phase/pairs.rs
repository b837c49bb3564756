//! Which pairs there are: a list in a stable order, and a hash table that finds a pair's place in it.
//!
//! The list belongs to [`BroadPhase`](super::BroadPhase), because the owner of the world writes into it (where a
//! pair keeps its contact); the table holds only places. Open addressing with linear probing and a fixed hash, so
//! that nothing here depends on a random seed, and a removal shifts later entries back instead of leaving a mark:
//! a table that lives for hours doesn't silt up.

use super::Pair;
use crate::memory::bytes_of;

const FREE: u32 = u32::MAX;

/// The hash of the pair that is kept there (its home slot comes from it too), and the pair's place in the list.
#[derive(Clone, Copy, Debug)]
struct Slot {
    hash: u32,
    place: u32,
}

/// From two colliders, in any order, to their pair.
#[derive(Debug, Default)]
pub(super) struct PairTable {
    /// A power of two, at most three quarters full.
    slots: Vec<Slot>,
}

/// The finaliser of SplitMix64 (Steele et al., *Fast Splittable Pseudorandom Number Generators*, 2014).
#[inline]
fn hash_of(i: u32, j: u32) -> u32 {
    let mut h = u64::from(i.min(j)) << 32 | u64::from(i.max(j));
    h = (h ^ h >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ h >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    (h ^ h >> 31) as u32
}

impl PairTable {
    /// Where the pair of two colliders is in `pairs`.
    #[inline]
    pub(super) fn find(&self, pairs: &[Pair], i: u32, j: u32) -> Option<usize> {
        if self.slots.is_empty() {
            return None;
        }
        let (hash, mask) = (hash_of(i, j), self.slots.len() - 1);
        let mut at = hash as usize & mask;
        loop {
            let slot = self.slots[at];
            if slot.place == FREE {
                return None;
            }
            if slot.hash == hash {
                let pair = &pairs[slot.place as usize];
                if (pair.a, pair.b) == (i, j) || (pair.a, pair.b) == (j, i) {
                    return Some(slot.place as usize);
                }
            }
            at = (at + 1) & mask;
        }
    }

    /// Appends a pair that isn't there yet.
    pub(super) fn push(&mut self, pairs: &mut Vec<Pair>, pair: Pair) {
        debug_assert!(self.find(pairs, pair.a, pair.b).is_none());
        if (pairs.len() + 1) * 4 > self.slots.len() * 3 {
            self.grow();
        }
        self.place(Slot { hash: hash_of(pair.a, pair.b), place: pairs.len() as u32 });
        pairs.push(pair);
    }

    /// Takes a pair out; the last of the list moves to its place.
    pub(super) fn swap_remove(&mut self, pairs: &mut Vec<Pair>, place: usize) -> Pair {
        let mask = self.slots.len() - 1;
        let last = pairs.len() - 1;
        let mut hole = self.slot_of(&pairs[place], place);
        if last != place {
            let moved = self.slot_of(&pairs[last], last);
            self.slots[moved].place = place as u32;
        }
        // Later entries of the run move up, unless that would put one before its home.
        let mut at = hole;
        loop {
            at = (at + 1) & mask;
            let slot = self.slots[at];
            if slot.place == FREE {
                break;
            }
            let from_home = at.wrapping_sub(slot.hash as usize) & mask;
            if from_home >= at.wrapping_sub(hole) & mask {
                self.slots[hole] = slot;
                hole = at;
            }
        }
        self.slots[hole].place = FREE;
        pairs.swap_remove(place)
    }

    /// Makes the table of another list of pairs.
    pub(super) fn rebuild(&mut self, pairs: &[Pair]) {
        let size = Self::size_for(pairs.len()).max(self.slots.len());
        self.slots.clear();
        self.slots.resize(size, Slot { hash: 0, place: FREE });
        for (place, pair) in pairs.iter().enumerate() {
            self.place(Slot { hash: hash_of(pair.a, pair.b), place: place as u32 });
        }
    }

    /// Bytes that are lacking for so many pairs.
    pub(super) fn missing(&self, pairs: usize) -> usize {
        (Self::size_for(pairs).saturating_sub(self.slots.len())) * size_of::<Slot>()
    }

    /// Makes place for so many pairs.
    pub(super) fn widen(&mut self, pairs: usize) {
        while self.slots.len() < Self::size_for(pairs) {
            self.grow();
        }
    }

    fn size_for(pairs: usize) -> usize {
        if pairs == 0 { 0 } else { (pairs * 4).div_ceil(3).next_power_of_two().max(64) }
    }

    pub(super) fn bytes(&self) -> (usize, usize) {
        bytes_of(&self.slots)
    }

    fn slot_of(&self, pair: &Pair, place: usize) -> usize {
        let mask = self.slots.len() - 1;
        let mut at = hash_of(pair.a, pair.b) as usize & mask;
        while self.slots[at].place != place as u32 {
            at = (at + 1) & mask;
        }
        at
    }

    fn place(&mut self, slot: Slot) {
        let mask = self.slots.len() - 1;
        let mut at = slot.hash as usize & mask;
        while self.slots[at].place != FREE {
            at = (at + 1) & mask;
        }
        self.slots[at] = slot;
    }

    fn grow(&mut self) {
        let size = (self.slots.len() * 2).max(64);
        let old = std::mem::replace(&mut self.slots, vec![Slot { hash: 0, place: FREE }; size]);
        for slot in old {
            if slot.place != FREE {
                self.place(slot);
            }
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
                        Pair { a: i, b: j, contact: u32::MAX, fast: false, touching: false },
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
