//! Bodies at rest leave the step: they go behind all moving bodies, and their pairs and contacts out of the
//! lists that steps work through, so that a sleeping pile costs next to nothing.
//!
//! Bodies sleep and wake by islands: groups connected by contacts or joints (`islands.rs`). An island wakes
//! when something that moves comes near, or when the caller changes anything about it (`wake.rs`). The rest
//! of the engine treats sleeping bodies as static.

mod islands;
mod save;
mod wake;

pub(crate) use islands::{Groups, RestTime, Ties, count_rest};
pub(crate) use save::{SavedSleep, SleepLists};

use crate::body::{Bodies, Colliders};
use crate::broad_phase::{BroadPhase, Pair};
use crate::config::Measures;
use crate::handle::BodyHandle;
use crate::joint::Joints;
use crate::memory::{Buffer, buffers, bytes_of};
use crate::narrow_phase::Contacts;

/// End of a list, or no island.
const NONE: u32 = u32::MAX;

/// Sleeping islands, and the pairs that they keep.
#[derive(Debug, Default)]
pub(crate) struct Sleep {
    islands: Vec<Island>,
    free_islands: Vec<u32>,
    /// Indexed by body slot.
    bodies: Vec<Link>,
    /// Pairs of the islands, a list for each.
    pairs: Vec<(Pair, u32)>,
    free_pair: Option<u32>,
    /// Number of pairs that are kept.
    pair_count: u32,
    /// Connected bodies, as of the last search.
    pub(crate) groups: Groups,
    /// Islands to be woken.
    waking: Vec<u32>,
    /// Steps since the last search for islands.
    pub(crate) waited: u32,
    /// Numbers of bodies that woke and that fell asleep in the last step.
    pub(crate) woke: u32,
    pub(crate) slept: u32,
    /// Bodies that fell asleep since the last step began.
    pub(crate) fell_asleep: Vec<BodyHandle>,
}

/// The parts of a world that connect bodies, or that change when these fall asleep or wake.
pub(crate) struct Islands<'a> {
    pub(crate) sleep: &'a mut Sleep,
    pub(crate) bodies: &'a mut Bodies,
    pub(crate) colliders: &'a mut Colliders,
    pub(crate) broad: &'a mut BroadPhase,
    pub(crate) contacts: &'a mut Contacts,
    pub(crate) joints: &'a mut Joints,
    pub(crate) measures: Measures,
}

/// Bodies that sleep together.
#[derive(Clone, Copy, Debug)]
struct Island {
    /// Slot of the first body.
    body: u32,
    /// Index of the first pair.
    pair: u32,
}

/// A body's place in its island.
#[derive(Clone, Copy, Debug)]
struct Link {
    island: u32,
    /// Slot of the next body of the island.
    next: u32,
}

impl Link {
    const AWAKE: Link = Link { island: NONE, next: NONE };
}

buffers! {
    Sleep {
        /// For so many bodies, of which so many can be pushed; without the pairs that islands keep.
        each(all: usize, dynamic: usize) {
            islands(dynamic),
            free_islands(dynamic),
            waking(2 * dynamic),
            bodies(all),
            groups(dynamic),
            fell_asleep(dynamic),
        }
    }
}

impl Sleep {
    /// A new island without bodies.
    fn open(&mut self) -> u32 {
        let island = Island { body: NONE, pair: NONE };
        if let Some(free) = self.free_islands.pop() {
            self.islands[free as usize] = island;
            return free;
        }
        self.islands.push(island);
        self.islands.len() as u32 - 1
    }

    fn add_body(&mut self, island: u32, slot: u32) {
        if self.bodies.len() <= slot as usize {
            self.bodies.resize(slot as usize + 1, Link::AWAKE);
        }
        let first = &mut self.islands[island as usize].body;
        self.bodies[slot as usize] = Link { island, next: std::mem::replace(first, slot) };
    }

    fn add_pair(&mut self, island: u32, pair: Pair) {
        let first = &mut self.islands[island as usize].pair;
        let entry = (pair, *first);
        self.pair_count += 1;
        match self.free_pair {
            Some(place) => {
                self.free_pair = Some(self.pairs[place as usize].1).filter(|&next| next != NONE);
                self.pairs[place as usize] = entry;
                *first = place;
            }
            None => {
                *first = self.pairs.len() as u32;
                self.pairs.push(entry);
            }
        }
    }

    /// The island that a body sleeps in.
    fn island_of(&self, slot: u32) -> Option<u32> {
        self.bodies.get(slot as usize).map(|link| link.island).filter(|&island| island != NONE)
    }

    /// The slot of the first body of the island that a body sleeps in.
    fn first_of(&self, slot: u32) -> Option<u32> {
        self.island_of(slot).map(|island| self.islands[island as usize].body)
    }

    /// Takes the bodies out of an island: calls `body` with the slot of each.
    fn take_bodies(&mut self, island: u32, mut body: impl FnMut(u32)) {
        let mut slot = std::mem::replace(&mut self.islands[island as usize].body, NONE);
        while slot != NONE {
            body(slot);
            slot = std::mem::replace(&mut self.bodies[slot as usize], Link::AWAKE).next;
        }
    }

    /// Ends an island without bodies: calls `pair` with each of its pairs.
    fn close(&mut self, island: u32, mut pair: impl FnMut(Pair)) {
        let mut place = self.islands[island as usize].pair;
        while place != NONE {
            let (own, next) = self.pairs[place as usize];
            pair(own);
            self.pairs[place as usize].1 = self.free_pair.unwrap_or(NONE);
            self.free_pair = Some(place);
            self.pair_count -= 1;
            place = next;
        }
        self.islands[island as usize] = Island { body: NONE, pair: NONE };
        self.free_islands.push(island);
        if self.pair_count == 0 {
            // The pool starts over in order.
            self.pairs.clear();
            self.free_pair = None;
        }
    }

    /// Pairs of all that sleeps, island by island: in this order [`Sleep::keep_pair`] takes them back.
    pub(crate) fn sleeping_pairs(&self) -> impl Iterator<Item = &Pair> {
        self.kept_by(&self.islands)
    }

    /// The same, but of the body's own island alone if it sleeps: it is in no others.
    pub(crate) fn sleeping_pairs_for(&self, slot: u32) -> impl Iterator<Item = &Pair> {
        self.kept_by(match self.island_of(slot) {
            Some(island) => &self.islands[island as usize..=island as usize],
            None => &self.islands,
        })
    }

    fn kept_by<'a>(&'a self, islands: &'a [Island]) -> impl Iterator<Item = &'a Pair> {
        let lists = islands.iter().map(|island| island.pair);
        lists.flat_map(|first| {
            let of = |&place: &u32| Some(self.pairs[place as usize].1).filter(|&next| next != NONE);
            std::iter::successors(Some(first).filter(|&first| first != NONE), of)
                .map(|place| &self.pairs[place as usize].0)
        })
    }

    /// Adds an island to those to be woken. Many pairs and joints name the same one, so duplicates are
    /// removed before the list grows: a capacity of twice the number of islands is always enough.
    fn note(waking: &mut Vec<u32>, island: u32) {
        if waking.len() == waking.capacity() {
            waking.sort_unstable();
            waking.dedup();
            if 2 * waking.len() > waking.capacity() {
                waking.reserve(waking.capacity());
            }
        }
        waking.push(island);
    }

    /// Number of sleeping islands.
    pub(crate) fn count(&self) -> usize {
        self.islands.len() - self.free_islands.len()
    }

    /// Live and reserved bytes of the pairs that islands keep.
    pub(crate) fn kept_bytes(&self) -> (usize, usize) {
        bytes_of(&self.pairs)
    }

    /// The pairs that islands keep.
    pub(crate) fn pair_buffer(&mut self) -> &mut dyn Buffer {
        &mut self.pairs
    }
}
