//! A sequence of 32-bit words: every number of a snapshot takes one or more, so that they can be copied
//! directly.

use crate::error::Error;
use crate::math::Quat;
use bytemuck::{NoUninit, Pod, Zeroable};

/// The error for invalid words.
pub(crate) fn broken(what: &'static str) -> Error {
    Error::BrokenSnapshot { what }
}

/// The words of a number or a record of numbers.
pub(crate) fn words<const N: usize>(value: impl NoUninit) -> [u32; N] {
    bytemuck::cast(value)
}

/// A record from its words.
pub(crate) fn record<T: Pod, const N: usize>(words: &[u32]) -> T {
    let mut all = [0; N];
    all.copy_from_slice(words);
    bytemuck::cast(all)
}

/// Bytes, four to a word.
#[derive(Default)]
pub(crate) struct Packer {
    word: u32,
    count: u32,
}

impl Packer {
    pub(crate) fn push(&mut self, out: &mut Vec<u32>, byte: u8) {
        self.word |= u32::from(byte) << (8 * (self.count % 4));
        self.count += 1;
        if self.count.is_multiple_of(4) {
            out.push(std::mem::take(&mut self.word));
        }
    }
    pub(crate) fn end(self, out: &mut Vec<u32>) {
        if !self.count.is_multiple_of(4) {
            out.push(self.word);
        }
    }
}

/// The byte at an index of packed ones.
#[inline]
pub(crate) fn byte(words: &[u32], i: usize) -> u8 {
    (words[i / 4] >> (8 * (i % 4))) as u8
}

/// Reads words from the front.
#[derive(Clone, Copy)]
pub(crate) struct Reader<'a>(pub(crate) &'a [u32]);

impl<'a> Reader<'a> {
    /// The next `count` words.
    #[inline]
    pub(crate) fn take(&mut self, count: usize) -> Result<&'a [u32], Error> {
        let (head, rest) = self.0.split_at_checked(count).ok_or_else(|| broken("it ends too early"))?;
        self.0 = rest;
        Ok(head)
    }

    /// `count` records of `size` words each.
    pub(crate) fn table(&mut self, count: u32, size: usize) -> Result<&'a [u32], Error> {
        let words = (count as usize).checked_mul(size).ok_or_else(|| broken("a count is too large"))?;
        self.take(words)
    }

    #[inline]
    pub(crate) fn one(&mut self) -> Result<u32, Error> {
        Ok(self.take(1)?[0])
    }

    pub(crate) fn long(&mut self) -> Result<u64, Error> {
        self.record::<u64, 2>()
    }

    #[inline]
    pub(crate) fn record<T: Pod + Zeroable, const N: usize>(&mut self) -> Result<T, Error> {
        Ok(record::<T, N>(self.take(N)?))
    }

    /// Numbers that are finite.
    pub(crate) fn finite<T: Pod, const N: usize>(&mut self) -> Result<T, Error> {
        let words = self.take(N)?;
        all_finite(words)?;
        Ok(record::<T, N>(words))
    }

    /// A rotation: nearly of unit length, or `what` is broken.
    pub(crate) fn rotation(&mut self, what: &'static str) -> Result<Quat, Error> {
        let rotation = Quat::from_array(self.finite::<[f32; 4], 4>()?);
        if (0.9..1.1).contains(&rotation.length_squared()) { Ok(rotation) } else { Err(broken(what)) }
    }

    /// Free slots with their generations.
    pub(crate) fn free_slots(&mut self) -> Result<Vec<(u32, u32)>, Error> {
        let count = self.one()?;
        Ok(self.table(count, 2)?.as_chunks::<2>().0.iter().map(|&[slot, of]| (slot, of)).collect())
    }
}

/// Whether free slots are exactly the unused ones, in any order.
pub(crate) fn are_free(slots: &[(u32, u32)], nobodys: impl Iterator<Item = u32>) -> bool {
    let mut slots: Vec<u32> = slots.iter().map(|(slot, _)| *slot).collect();
    slots.sort_unstable();
    nobodys.eq(slots)
}

/// Refuses words that are not finite numbers.
pub(crate) fn all_finite(words: &[u32]) -> Result<(), Error> {
    if words.iter().all(|&w| f32::from_bits(w).is_finite()) {
        Ok(())
    } else {
        Err(broken("a number is none"))
    }
}

/// Refuses forces and impulses that no step can produce.
pub(crate) fn all_loads(words: &[u32]) -> Result<(), Error> {
    let sound = words.iter().all(|&w| f32::from_bits(w).abs() <= crate::limits::MAX_LOAD);
    if sound { Ok(()) } else { Err(broken("a load")) }
}
