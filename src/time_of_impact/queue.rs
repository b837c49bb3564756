//! Touches in the order of their times.

use crate::memory::Allowance;
use crate::narrow_phase::Touch;

/// Two colliders that touch if neither is redirected before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    pub(super) touch: Touch,
    pub(super) a: u32,
    pub(super) b: u32,
    /// How often the bodies had been redirected when this was found: it is valid while these numbers stay the
    /// same.
    pub(super) turns: [u32; 2],
}

impl Hit {
    /// The earliest first, then the lower indices: an order in which no two of one moment are equal.
    fn key(&self) -> (u32, u32, u32) {
        // The bits of non-negative numbers have the same order.
        (self.touch.fraction.to_bits(), self.a, self.b)
    }
}

/// A binary heap that grows only as far as its allowance.
#[derive(Debug, Default)]
pub(super) struct Queue(Vec<Hit>);

impl Queue {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds a touch; returns whether the allowance was sufficient.
    pub(super) fn push(&mut self, hit: Hit, allowance: &mut Allowance) -> bool {
        let all = &mut self.0;
        if !allowance.push(all, hit) {
            return false;
        }
        let mut place = all.len() - 1;
        while place > 0 && all[place].key() < all[(place - 1) / 2].key() {
            all.swap(place, (place - 1) / 2);
            place = (place - 1) / 2;
        }
        true
    }

    /// Removes the earliest.
    pub(super) fn pop(&mut self) -> Option<Hit> {
        let all = &mut self.0;
        let last = all.pop()?;
        let Some(first) = all.first_mut() else { return Some(last) };
        let first = std::mem::replace(first, last);
        let mut place = 0;
        loop {
            let mut least = place;
            for child in [2 * place + 1, 2 * place + 2] {
                if child < all.len() && all[child].key() < all[least].key() {
                    least = child;
                }
            }
            if least == place {
                return Some(first);
            }
            all.swap(place, least);
            place = least;
        }
    }

    pub(super) fn bytes(&self) -> (usize, usize) {
        crate::memory::bytes_of(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::first_touch::NEVER;
    use super::*;

    #[test]
    fn touches_come_out_by_time_and_then_by_index() {
        let mut queue = Queue::default();
        let mut seed = 7u32;
        for i in 0..500 {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let time = (seed >> 28) as f32 / 16.0;
            assert!(queue.push(
                Hit { touch: Touch { fraction: time, ..NEVER }, a: i % 7, b: i, turns: [0; 2] },
                &mut Allowance::default()
            ));
        }
        let mut last = (0, 0, 0);
        for _ in 0..500 {
            let key = queue.pop().unwrap().key();
            assert!(key > last || last == (0, 0, 0));
            last = key;
        }
        assert!(queue.pop().is_none());
    }

    #[test]
    fn without_room_nothing_is_added() {
        let hit = Hit { touch: NEVER, a: 0, b: 1, turns: [0; 2] };
        assert!(!Queue::default().push(hit, &mut Allowance::new(8)));
    }
}
