//! Colouring: no dynamic body occurs twice in a colour, so that the rows of a colour can be solved at the
//! same time.

use crate::memory::buffers;

/// Maximum number of colours of a group; further contacts of a body are solved one by one.
pub(crate) const COLOURS: usize = 31;
/// Instead of a colour: none was left.
pub(crate) const OVERFLOW: usize = COLOURS;

/// The colours each body already has.
#[derive(Debug, Default)]
pub(crate) struct Colouring {
    taken: Vec<u32>,
}

buffers! { Colouring { each(dynamic: usize) { taken(dynamic) } } }

impl Colouring {
    pub(crate) fn reset(&mut self, bodies: usize) {
        self.taken.clear();
        self.taken.resize(bodies, 0);
    }

    /// The lowest colour that neither body has; a body outside the columns (static) conflicts with none.
    #[inline]
    pub(crate) fn assign(&mut self, a: usize, b: usize) -> usize {
        let mask = |bodies: &[u32], i: usize| bodies.get(i).copied().unwrap_or(0);
        let taken = mask(&self.taken, a) | mask(&self.taken, b);
        let colour = (!taken).trailing_zeros() as usize;
        if colour >= COLOURS {
            return OVERFLOW;
        }
        for i in [a, b] {
            if let Some(bits) = self.taken.get_mut(i) {
                *bits |= 1 << colour;
            }
        }
        colour
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_body_has_a_colour_twice() {
        let mut colouring = Colouring::default();
        colouring.reset(20);
        let mut seen = std::collections::BTreeSet::new();
        let mut x = 1u32;
        for _ in 0..300 {
            x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let (a, b) = ((x >> 8) as usize % 20, (x >> 20) as usize % 24);
            if a == b {
                continue;
            }
            let colour = colouring.assign(a, b);
            if colour != OVERFLOW {
                assert!(seen.insert((a, colour)));
                assert!(b >= 20 || seen.insert((b, colour)));
            }
        }
    }
}
