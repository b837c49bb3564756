//! A sequence of 32-bit words: every number of a snapshot takes one or more, so that they can be copied
//! directly.

use crate::error::Error;
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

/// A hash of words: a folded product of 128 bits for each two words, as in wyhash (Wang Yi, *Modern
/// Non-Cryptographic Hash Function*, 2019), in four independent lanes.
pub(crate) fn hash(words: &[u32]) -> u64 {
    const KEYS: [u64; 4] =
        [0xa076_1d64_78bd_642f, 0xe703_7ed1_a0b4_28db, 0x8ebc_6af0_9c88_c6e3, 0x5899_65cc_7537_4cc3];
    let fold = |a: u64, b: u64| {
        let product = u128::from(a) * u128::from(b);
        product as u64 ^ (product >> 64) as u64
    };
    let mut lanes = KEYS;
    let two = |w: &[u32]| u64::from(w[0]) | u64::from(w.get(1).copied().unwrap_or(0)) << 32;
    for eight in words.chunks(8) {
        for (lane, pair) in eight.chunks(2).enumerate() {
            lanes[lane] = fold(lanes[lane] ^ two(pair), KEYS[lane] | 1).wrapping_add(two(pair));
        }
    }
    let ends =
        lanes.into_iter().fold(words.len() as u64, |h, lane| fold(h ^ lane, KEYS[0]).wrapping_add(lane));
    fold(ends ^ KEYS[1], KEYS[2])
}
