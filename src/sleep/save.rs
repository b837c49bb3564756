//! Sleeping islands in a snapshot: their bodies, in order, and their pairs.

use super::{Island, Link, NONE, Sleep};
use crate::broad_phase::Pair;
use crate::error::Error;
use crate::words::{Reader, broken};

/// Lengths of the lists of saved islands.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct SleepLists {
    islands: u32,
    free: u32,
    bodies: u32,
    waited: u32,
    woke: u32,
    slept: u32,
}

/// Saved islands, as words.
#[derive(Clone, Copy)]
pub(crate) struct SavedSleep<'a> {
    lists: SleepLists,
    free: &'a [u32],
    /// For each island, its numbers of bodies and pairs.
    islands: &'a [u32],
    /// Slots of their bodies, island by island.
    bodies: &'a [u32],
}

impl Sleep {
    /// Number of pairs that islands keep.
    pub(crate) fn pair_count(&self) -> usize {
        self.pair_count as usize
    }

    fn slots(&self, island: &Island) -> impl Iterator<Item = u32> + '_ {
        let slot = |slot: u32| Some(slot).filter(|&slot| slot != NONE);
        std::iter::successors(slot(island.body), move |&at| slot(self.bodies[at as usize].next))
    }

    fn pairs_of(&self, island: &Island) -> usize {
        let place = |place: u32| Some(place).filter(|&place| place != NONE);
        std::iter::successors(place(island.pair), move |&at| place(self.pairs[at as usize].1)).count()
    }

    /// Writes everything but the pairs.
    pub(crate) fn save(&self, out: &mut Vec<u32>) -> SleepLists {
        let Sleep {
            islands,
            free_islands,
            waited,
            woke,
            slept,
            // Lists within the islands; places that nothing depends on.
            bodies: _,
            pairs: _,
            free_pair: _,
            pair_count: _,
            // Of one search, and of the last step.
            groups: _,
            waking: _,
            fell_asleep: _,
        } = self;
        out.extend(free_islands);
        for island in islands {
            out.extend([self.slots(island).count() as u32, self.pairs_of(island) as u32]);
        }
        let before = out.len();
        islands.iter().for_each(|island| out.extend(self.slots(island)));
        SleepLists {
            islands: islands.len() as u32,
            free: free_islands.len() as u32,
            bodies: (out.len() - before) as u32,
            waited: *waited,
            woke: *woke,
            slept: *slept,
        }
    }

    /// No body sleeps, and none may: with a budget the memory stays, so that none has to be asked for when
    /// they may again, or a snapshot of before comes back.
    pub(crate) fn switch_off(&mut self, keep: bool) {
        if keep {
            self.restore(&SavedSleep { lists: SleepLists::default(), free: &[], islands: &[], bodies: &[] });
            self.fell_asleep.clear();
        } else {
            *self = Sleep::default();
        }
    }

    /// Restores the islands; [`Sleep::keep_pair`] then adds the pairs.
    pub(crate) fn restore(&mut self, saved: &SavedSleep<'_>) {
        let SleepLists { waited, woke, slept, .. } = saved.lists;
        (self.waited, self.woke, self.slept) = (waited, woke, slept);
        self.free_islands.clear();
        self.free_islands.extend(saved.free);
        self.bodies.fill(Link::AWAKE);
        self.islands.clear();
        self.pairs.clear();
        (self.free_pair, self.pair_count) = (None, 0);
        let mut bodies = saved.bodies;
        for (i, &[of_bodies, _]) in saved.islands.as_chunks::<2>().0.iter().enumerate() {
            self.islands.push(Island { body: NONE, pair: NONE });
            let (own, rest) = bodies.split_at(of_bodies as usize);
            // Each goes to the front of its list.
            own.iter().rev().for_each(|&slot| self.add_body(i as u32, slot));
            bodies = rest;
        }
    }

    /// Adds the next pair of an island: in the order in which they were saved.
    pub(crate) fn keep_pair(&mut self, island: u32, pair: Pair) {
        let (place, first) = (self.pairs.len() as u32, self.islands[island as usize].pair);
        match self.pairs.last_mut().filter(|_| first != NONE) {
            Some(last) => last.1 = place,
            None => self.islands[island as usize].pair = place,
        }
        self.pairs.push((pair, NONE));
        self.pair_count += 1;
    }
}

impl<'a> SavedSleep<'a> {
    pub(crate) fn read(from: &mut Reader<'a>, lists: SleepLists) -> Result<SavedSleep<'a>, Error> {
        let free = from.table(lists.free, 1)?;
        Ok(SavedSleep {
            lists,
            free,
            islands: from.table(lists.islands, 2)?,
            bodies: from.table(lists.bodies, 1)?,
        })
    }

    /// For each of so many body slots, the island in which the body sleeps, or `u32::MAX`. Everything has to
    /// be consistent.
    pub(crate) fn island_of(&self, slots: usize) -> Vec<u32> {
        let mut island_of = vec![NONE; slots];
        let sizes = self.islands.as_chunks::<2>().0.iter().map(|island| island[0] as usize);
        let numbers = (0u32..).zip(sizes).flat_map(|(island, bodies)| std::iter::repeat_n(island, bodies));
        self.bodies.iter().zip(numbers).for_each(|(&slot, island)| island_of[slot as usize] = island);
        island_of
    }

    /// The island of each pair that islands keep.
    pub(crate) fn islands_of_pairs(&self) -> impl Iterator<Item = u32> + '_ {
        let sizes = self.islands.as_chunks::<2>().0.iter().map(|island| island[1] as usize);
        (0u32..).zip(sizes).flat_map(|(island, pairs)| std::iter::repeat_n(island, pairs))
    }

    /// Whether all lists are consistent. `asleep`: slots of the sleeping bodies; `pair_count`: number of
    /// pairs.
    pub(crate) fn check(&self, asleep: &[u32], pair_count: usize) -> Result<(), Error> {
        let islands = self.islands.as_chunks::<2>().0;
        let (bodies, pairs) = islands
            .iter()
            .fold((0u64, 0u64), |(b, p), island| (b + u64::from(island[0]), p + u64::from(island[1])));
        let mut sorted = [self.bodies.to_vec(), asleep.to_vec()];
        sorted.iter_mut().for_each(|list| list.sort_unstable());
        let mut free = self.free.to_vec();
        free.sort_unstable();
        free.dedup();
        // An island is free if and only if it is empty.
        let empty = (0..islands.len() as u32).filter(|&i| islands[i as usize][0] == 0);
        let fits = bodies == self.bodies.len() as u64
            && pairs == pair_count as u64
            && sorted[0] == sorted[1]
            && free.len() == self.free.len()
            && empty.eq(free.iter().copied())
            && [self.lists.waited, self.lists.woke, self.lists.slept].iter().all(|&n| n <= u32::MAX / 2)
            && islands.iter().all(|&[bodies, pairs]| bodies > 0 || pairs == 0);
        if fits { Ok(()) } else { Err(broken("an island")) }
    }
}
