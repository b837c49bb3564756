//! Bytes that a step may still reserve: buffers grow through it, so that a budget is never exceeded.

/// Bytes that buffers may still grow by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Allowance {
    left: usize,
}

impl Default for Allowance {
    fn default() -> Self {
        Allowance::ENDLESS
    }
}

/// A buffer grows by more than it needs, so that it seldom grows, while that takes no more than this part of
/// the rest.
const PART: usize = 8;
/// Buffers smaller than this double, larger ones grow by a quarter, and large ones by an eighth [bytes].
/// Doubled, the buffers of a scene would hold half more than they ever use. The large ones are moved by their
/// pages, which costs little.
const SMALL: usize = 1 << 14;
const LARGE: usize = 1 << 18;

/// How many elements of `size` bytes a buffer should have place for that has it for `before` and needs it for
/// `len`.
fn generous(before: usize, len: usize, size: usize) -> usize {
    let least = if size > 1024 { 1 } else { 4 };
    let more = match before.saturating_mul(size) {
        ..SMALL => before.max(least),
        SMALL..LARGE => before / 4,
        _ => before / 8,
    };
    len.max(before + more)
}

impl Allowance {
    /// No limit: the world has no budget.
    pub(crate) const ENDLESS: Allowance = Allowance { left: usize::MAX };

    pub(crate) fn new(left: usize) -> Allowance {
        // `usize::MAX` means no limit.
        Allowance { left: left.min(usize::MAX - 1) }
    }

    #[inline]
    pub(crate) fn is_endless(&self) -> bool {
        self.left == usize::MAX
    }

    pub(crate) fn left(&self) -> usize {
        self.left
    }

    /// An equal share for each of `parts`, which work at the same time and must not depend on each other.
    pub(crate) fn share(&self, parts: usize) -> Allowance {
        if self.is_endless() { *self } else { Allowance { left: self.left / parts.max(1) } }
    }

    /// Lets `f` use up to one of `parts` equal shares.
    pub(crate) fn within<R>(&mut self, parts: usize, f: impl FnOnce(&mut Allowance) -> R) -> R {
        let whole = self.share(parts);
        let mut share = whole;
        let result = f(&mut share);
        self.take(whole.left - share.left);
        result
    }

    /// Takes bytes off that were used elsewhere.
    pub(crate) fn take(&mut self, bytes: usize) {
        if !self.is_endless() {
            self.left = self.left.saturating_sub(bytes);
        }
    }

    /// Puts bytes back that were given up.
    pub(crate) fn give(&mut self, bytes: usize) {
        if !self.is_endless() {
            self.left = self.left.saturating_add(bytes).min(usize::MAX - 1);
        }
    }

    /// Makes place for `len` elements in all; says for how many there is place then, which is fewer than
    /// `len` only if the room doesn't suffice.
    #[inline]
    pub(crate) fn fit<T>(&mut self, buffer: &mut Vec<T>, len: usize) -> usize {
        if len <= buffer.capacity() { len } else { self.grow(buffer, len, usize::MAX) }
    }

    /// For how many elements of `size` bytes buffers should have place that have it for `before`, need it for
    /// `len` and never for more than `most`; fewer than `len` only if the room doesn't suffice.
    pub(crate) fn planned(&self, before: usize, len: usize, size: usize, most: usize) -> usize {
        let generous = generous(before, len, size).min(most.max(len));
        if self.is_endless() || (generous - before).saturating_mul(size) <= self.left / PART {
            generous
        } else {
            len.min(before + self.left / size)
        }
    }

    #[cold]
    fn grow<T>(&mut self, buffer: &mut Vec<T>, len: usize, most: usize) -> usize {
        let (size, before) = (size_of::<T>().max(1), buffer.capacity());
        let to = self.planned(before, len, size, most);
        if to > before {
            buffer.reserve_exact(to - buffer.len());
            self.take((buffer.capacity() - before) * size);
        }
        len.min(buffer.capacity())
    }

    /// Appends if there is place; says whether there was.
    #[inline]
    pub(crate) fn push<T>(&mut self, buffer: &mut Vec<T>, value: T) -> bool {
        self.push_within(buffer, value, usize::MAX)
    }

    /// The same for a buffer that never has to hold more than so many.
    #[inline]
    pub(crate) fn push_within<T>(&mut self, buffer: &mut Vec<T>, value: T, most: usize) -> bool {
        let len = buffer.len() + 1;
        let fits = len <= buffer.capacity() || self.grow(buffer, len, most) >= len;
        if fits {
            buffer.push(value);
        }
        fits
    }
}

/// Any vector, when only its place matters.
pub(crate) trait Buffer {
    fn capacity(&self) -> usize;
    /// Bytes that it would take to have place for `len` elements in all.
    fn missing(&self, len: usize) -> usize;
    /// Makes place for `len` elements in all, not for more.
    fn reserve_total(&mut self, len: usize);
}

impl<T> Buffer for Vec<T> {
    fn capacity(&self) -> usize {
        self.capacity()
    }
    fn missing(&self, len: usize) -> usize {
        len.saturating_sub(self.capacity()) * size_of::<T>()
    }
    fn reserve_total(&mut self, len: usize) {
        if len > self.capacity() {
            self.reserve_exact(len - self.len());
        }
    }
}

/// A vector of things that hold place from the start.
pub(crate) struct Made<'a, T> {
    pub(crate) all: &'a mut Vec<T>,
    /// Makes one.
    pub(crate) make: fn() -> T,
    /// Bytes that one holds from the start.
    pub(crate) holds: usize,
}

impl<T> Buffer for Made<'_, T> {
    fn capacity(&self) -> usize {
        self.all.len()
    }
    fn missing(&self, len: usize) -> usize {
        self.all.missing(len) + len.saturating_sub(self.all.len()) * self.holds
    }
    fn reserve_total(&mut self, len: usize) {
        self.all.reserve_total(len);
        self.all.resize_with(len.max(self.all.len()), self.make);
    }
}

/// Calls a function for each of something's buffers, always in the same order.
pub(crate) trait Buffers {
    fn each(&mut self, f: &mut dyn FnMut(&mut dyn Buffer));
}

/// The most that any block's buffers were widened to.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Marks([usize; MAX_MARKS]);

/// Buffers that [`even_out`] can keep apart.
const MAX_MARKS: usize = 12;

/// Gives the buffers of all blocks the capacities of the largest. Which block needs most changes from step to
/// step; when the next one needs as much, there is place already, so a scene that moves doesn't make buffers
/// grow for ever.
pub(crate) fn even_out<B: Buffers>(blocks: &mut [B], marks: &mut Marks, allowance: &mut Allowance) {
    // The second pass is for those that came before the one that has grown.
    for _ in 0..2 {
        let before = marks.0;
        for block in &mut *blocks {
            let mut i = 0;
            block.each(&mut |buffer| {
                let mark = &mut marks.0[i];
                *mark = buffer.capacity().max(*mark);
                let missing = buffer.missing(*mark);
                if missing > 0 && missing <= allowance.left() {
                    allowance.take(missing);
                    buffer.reserve_total(*mark);
                }
                i += 1;
            });
        }
        if marks.0 == before {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Two(Vec<u8>, Vec<u64>);

    impl Buffers for Two {
        fn each(&mut self, f: &mut dyn FnMut(&mut dyn Buffer)) {
            f(&mut self.0);
            f(&mut self.1);
        }
    }

    #[test]
    fn a_buffer_grows_as_far_as_the_room_goes_and_no_further() {
        let mut allowance = Allowance::new(100);
        let mut buffer: Vec<u64> = Vec::new();
        assert_eq!((allowance.fit(&mut buffer, 10), allowance.left()), (10, 20));
        // Three more would take 24 bytes.
        assert_eq!((allowance.fit(&mut buffer, 13), allowance.left()), (12, 4));
        let pushed = (0..20).filter(|&i| allowance.push(&mut buffer, i)).count();
        assert_eq!((pushed, buffer.len(), buffer.capacity()), (12, 12, 12));
    }

    #[test]
    fn without_a_budget_everything_fits() {
        let mut allowance = Allowance::ENDLESS;
        let mut buffer: Vec<u64> = Vec::new();
        assert_eq!(allowance.fit(&mut buffer, 1000), 1000);
        assert!((0..5000).all(|i| allowance.push(&mut buffer, i)));
        assert!(allowance.is_endless() && allowance.share(7).is_endless());
    }

    #[test]
    fn all_blocks_have_the_place_of_the_largest() {
        let mut blocks: Vec<Two> = (0..4).map(|i| Two(Vec::with_capacity(i), Vec::new())).collect();
        blocks[1].1.reserve_exact(7);
        let (mut marks, mut allowance) = (Marks::default(), Allowance::new(1000));
        even_out(&mut blocks, &mut marks, &mut allowance);
        assert!(blocks.iter().all(|b| b.0.capacity() == 3 && b.1.capacity() == 7));
        assert_eq!(allowance.left(), 1000 - (3 + 2 + 1) - 3 * 7 * 8);
        even_out(&mut blocks, &mut marks, &mut allowance);
        assert_eq!(allowance.left(), 1000 - (3 + 2 + 1) - 3 * 7 * 8);
    }
}
