//! One buffer for arrays that are all filled anew in each step.
//!
//! It holds as much as they need together, not the most that each of them ever needed. And allocators widen
//! it where it is, or move it by its pages: it asks for no more alignment than they give anyway. A vector
//! whose elements want 32 bytes is moved by hand instead (new memory, a copy, and the old freed), and the
//! freed memory stays behind as a hole.

use super::{Allowance, Buffer};
use bytemuck::{Pod, Zeroable};

/// The unit in which memory is reserved.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(16))]
struct Piece([u64; 2]);

/// Alignment of elements of eight lanes [bytes].
const ALIGN: usize = 32;

/// See the module.
#[derive(Debug, Default)]
pub(crate) struct Slab {
    memory: Vec<Piece>,
}

/// Pieces that so many bytes take, wherever the first piece is.
const fn pieces(bytes: usize) -> usize {
    if bytes == 0 { 0 } else { (bytes + ALIGN - size_of::<Piece>()).div_ceil(size_of::<Piece>()) }
}

impl Slab {
    /// Bytes that it has beyond those needed to hold so many.
    pub(crate) fn spare(&self, bytes: usize) -> usize {
        self.memory.capacity().saturating_sub(pieces(bytes)) * size_of::<Piece>()
    }

    /// Gives up the bytes beyond that.
    pub(crate) fn shrink(&mut self, bytes: usize) {
        self.memory.truncate(pieces(bytes));
        self.memory.shrink_to(pieces(bytes));
    }

    /// Makes sure that so many bytes can be handed out, for which there is place or room without end.
    pub(crate) fn fit(&mut self, bytes: usize, allowance: &mut Allowance) {
        let pieces = allowance.fit(&mut self.memory, pieces(bytes));
        if self.memory.len() < pieces {
            self.memory.resize(pieces, Piece::zeroed());
        }
    }

    /// Makes place for so many of a type that is in it alone, as far as there is room; says for how many
    /// there is.
    pub(crate) fn reserve<T>(&mut self, len: usize, allowance: &mut Allowance) -> usize {
        self.fit(len * size_of::<T>(), allowance);
        len.min(size_of_val(self.memory.as_slice()) / size_of::<T>())
    }

    /// How many of such a type it has place for.
    pub(crate) fn holds<T>(&self) -> usize {
        self.capacity() / size_of::<T>()
    }

    /// `len` elements of the only type in the slab; they keep their values if the slab grows or shrinks.
    pub(crate) fn alone<T: Pod>(&mut self, len: usize) -> &mut [T] {
        const { assert!(align_of::<T>() <= align_of::<Piece>()) };
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut self.memory);
        bytemuck::cast_slice_mut(&mut bytes[..len * size_of::<T>()])
    }

    /// Its bytes from the first one on that is aligned for all.
    fn start(&self) -> usize {
        self.memory.as_ptr().align_offset(ALIGN).min(self.memory.len()) * size_of::<Piece>()
    }

    /// All of it, to be handed out piece by piece. Its content has no meaning.
    pub(crate) fn cut(&mut self) -> Cut<'_> {
        let start = self.start();
        Cut { rest: &mut bytemuck::cast_slice_mut(&mut self.memory)[start..] }
    }

    /// Live and reserved bytes, of which so many are handed out.
    pub(crate) fn bytes(&self, used: usize) -> (usize, usize) {
        let bytes = |pieces: usize| pieces * size_of::<Piece>();
        (bytes(pieces(used).min(self.memory.len())), bytes(self.memory.capacity()))
    }
}

/// The unit is a byte.
impl Buffer for Slab {
    fn capacity(&self) -> usize {
        self.memory.capacity() * size_of::<Piece>()
    }
    fn missing(&self, bytes: usize) -> usize {
        self.memory.missing(pieces(bytes))
    }
    fn reserve_total(&mut self, bytes: usize) {
        self.memory.reserve_total(pieces(bytes));
    }
}

/// The unused rest of a [`Slab`].
pub(crate) struct Cut<'a> {
    rest: &'a mut [u8],
}

impl<'a> Cut<'a> {
    /// The next so many of a type; those of the larger alignment come first.
    pub(crate) fn next<T: Pod>(&mut self, len: usize) -> &'a mut [T] {
        if len == 0 {
            return &mut [];
        }
        let (own, rest) = std::mem::take(&mut self.rest).split_at_mut(len * size_of::<T>());
        self.rest = rest;
        bytemuck::cast_slice_mut(own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::f32x8;

    #[test]
    fn arrays_lie_one_behind_the_other() {
        let (mut slab, mut allowance) = (Slab::default(), Allowance::ENDLESS);
        for (wide, narrow) in [(0, 0), (3, 5), (1, 900), (200, 7), (0, 2)] {
            let bytes = wide * 32 + narrow * 4;
            slab.fit(bytes, &mut allowance);
            let mut cut = slab.cut();
            let (a, b) = (cut.next::<f32x8>(wide), cut.next::<u32>(narrow));
            a.fill(f32x8::splat(wide as f32));
            b.fill(narrow as u32);
            assert!(a.iter().all(|x| x.to_array() == [wide as f32; 8]));
            assert!(b.iter().all(|&x| x == narrow as u32));
            let (live, reserved) = slab.bytes(bytes);
            assert!(live >= bytes && live <= reserved && live < bytes + 32 + 16);
        }
    }

    #[test]
    fn what_is_missing_is_what_it_takes() {
        let (mut slab, mut allowance) = (Slab::default(), Allowance::new(10_000));
        assert_eq!((slab.missing(0), slab.bytes(0)), (0, (0, 0)));
        let missing = slab.missing(1000);
        slab.reserve_total(1000);
        assert_eq!(slab.bytes(0), (0, missing));
        slab.fit(1000, &mut allowance);
        assert_eq!((slab.missing(1000), allowance.left()), (0, 10_000));
        let spare = slab.spare(100);
        slab.shrink(100);
        assert_eq!((slab.bytes(100).1, slab.missing(100)), (missing - spare, 0));
    }
}
