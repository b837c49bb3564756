//! Handles of the caller: an index and a generation, so that a stale handle is noticed.

use crate::memory::{Allowance, buffers};

macro_rules! handle {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name {
            pub(crate) slot: u32,
            pub(crate) generation: u32,
        }

        impl $name {
            /// The handle as a number, for programs in other languages: never zero before 2^32 handles were
            /// given out for one place.
            pub const fn to_bits(self) -> u64 {
                (self.generation as u64) << 32 | self.slot as u64
            }

            /// The handle of a number from `to_bits`. Any other number makes a stale handle, or that of
            /// another object.
            pub const fn from_bits(bits: u64) -> Self {
                $name { slot: bits as u32, generation: (bits >> 32) as u32 }
            }
        }
    };
}

handle! {
    /// A body of a world. Goes stale when the body is removed; a stale handle is an error, never another
    /// body. It has no number of its world: in another world, from whose snapshot this one may have been
    /// restored, it names the body with its number.
    BodyHandle
}
handle! {
    /// A shape on a body. Goes stale when the shape or its body is removed.
    ShapeHandle
}

handle! {
    /// A joint between two bodies. Goes stale when it breaks, or when it or one of its bodies is removed.
    JointHandle
}

handle! {
    /// A character of a world. Goes stale when it is removed.
    CharacterHandle
}

handle! {
    /// A coupling of two joints. Goes stale when it breaks, or when it or one of its joints is removed.
    CouplingHandle
}

/// Hands out handles and finds the dense index behind one. Slots are reused, generations are not.
#[derive(Debug, Default)]
pub(crate) struct Slots {
    /// Per slot: its generation, and the dense index or the next free slot.
    slots: Vec<(u32, u32)>,
    free: Vec<u32>,
}

buffers! { Slots { each(n: usize) { slots(n), free(n) } } }

impl Slots {
    pub(crate) fn insert(&mut self, dense: u32) -> (u32, u32) {
        if let Some(slot) = self.free.pop() {
            let entry = &mut self.slots[slot as usize];
            entry.1 = dense;
            (slot, entry.0)
        } else {
            self.reserve(1);
            self.slots.push((1, dense));
            (self.slots.len() as u32 - 1, 1)
        }
    }

    /// Makes place for so many more.
    pub(crate) fn reserve(&mut self, more: usize) {
        let wanted = (self.slots.len() + more).saturating_sub(self.free.len());
        let mut allowance = Allowance::ENDLESS;
        allowance.fit(&mut self.slots, wanted);
    }

    /// The dense index, unless the handle is stale.
    pub(crate) fn get(&self, slot: u32, generation: u32) -> Option<u32> {
        let entry = self.slots.get(slot as usize)?;
        (entry.0 == generation && entry.1 != u32::MAX).then_some(entry.1)
    }

    /// Generation and dense index, if somebody is there.
    #[cfg(feature = "replay")]
    pub(crate) fn live(&self, slot: u32) -> Option<(u32, u32)> {
        self.slots.get(slot as usize).copied().filter(|entry| entry.1 != u32::MAX)
    }

    /// Whether a handle was ever given out.
    #[cfg(feature = "replay")]
    pub(crate) fn is_new(&self) -> bool {
        self.slots.is_empty()
    }

    /// The dense index of an element that is known to exist.
    #[inline]
    pub(crate) fn dense(&self, slot: u32) -> u32 {
        self.slots[slot as usize].1
    }

    pub(crate) fn generation(&self, slot: u32) -> u32 {
        self.slots[slot as usize].0
    }

    /// The dense index moved (swap-remove).
    pub(crate) fn moved(&mut self, slot: u32, dense: u32) {
        self.slots[slot as usize].1 = dense;
    }

    pub(crate) fn remove(&mut self, slot: u32) {
        let entry = &mut self.slots[slot as usize];
        entry.0 = entry.0.wrapping_add(1);
        entry.1 = u32::MAX;
        self.free.push(slot);
    }

    /// How many slots there are, free ones included.
    pub(crate) fn count(&self) -> usize {
        self.slots.len()
    }

    /// Writes the free slots with their generations, in the order of their return.
    pub(crate) fn save_free(&self, out: &mut Vec<u32>) {
        out.push(self.free.len() as u32);
        out.extend(self.free.iter().flat_map(|&slot| [slot, self.generation(slot)]));
    }

    /// Gives a value a slot, which is its index among all of its kind; returns it with its generation.
    pub(crate) fn place<T>(&mut self, value: T, all: &mut Vec<T>) -> (u32, u32) {
        let next = all.len() as u32;
        let (slot, generation) = self.insert(next);
        self.moved(slot, slot);
        if slot == next {
            all.push(value);
        } else {
            all[slot as usize] = value;
        }
        (slot, generation)
    }

    /// Builds them again from taken slots (slot, generation, dense index) and free ones.
    pub(crate) fn rebuild(
        &mut self,
        count: usize,
        taken: impl Iterator<Item = (u32, u32, u32)>,
        free: &[(u32, u32)],
    ) {
        self.slots.clear();
        self.slots.resize(count, (0, u32::MAX));
        self.free.clear();
        for (slot, generation, dense) in taken {
            self.slots[slot as usize] = (generation, dense);
        }
        for &(slot, generation) in free {
            self.slots[slot as usize].0 = generation;
            self.free.push(slot);
        }
    }

    /// How many may be named without a further slot.
    pub(crate) fn spare(&self) -> usize {
        self.free.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: by definition, the slot in the low half and the generation in the high one.
    #[test]
    fn handles_are_numbers_and_back() {
        let handle = BodyHandle { slot: 7, generation: 3 };
        assert_eq!(handle.to_bits(), 0x3_0000_0007);
        assert_eq!(BodyHandle::from_bits(handle.to_bits()), handle);
        assert!(Slots::default().get(BodyHandle::from_bits(u64::MAX).slot, u32::MAX).is_none());
    }
}
