//! Data of contacts for sorting, looked up by all threads: contacts lie far apart in memory, and the sorting
//! itself is for one thread.

use super::order::Group;
use crate::config::tuning::CROWD_OVERLAP;
use crate::constraint::contact::input::PrepareInput;
use crate::memory::{Allowance, buffers};
use crate::narrow_phase::{ContactRef, NO_CONTACT, Point};
use crate::threads::{Shared, Workers, per_block};
use std::ops::Range;

/// A contact, as far as it matters to the order of rows.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fact {
    pub(super) slot: u32,
    /// Its bodies.
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) count: u8,
    /// Points that touch.
    pub(super) touching: u8,
    flags: u8,
}

const DEEP: u8 = 1;
const AHEAD: u8 = 2;
const IN_TREE: u8 = 4;
const STATIC: u8 = 8;

impl Fact {
    #[inline]
    pub(super) fn of(input: &PrepareInput<'_>, slot: u32, contact: ContactRef<'_>) -> Fact {
        let body = |c: u32| input.colliders.summaries[c as usize].body;
        let (a, b) = (body(contact.a), body(contact.b));
        let touching = contact.points().iter().map(|p| u8::from(p.separation <= input.measures.touch)).sum();
        let deep = |p: &Point| p.separation < -CROWD_OVERLAP * input.measures.slop;
        let flag = |flag: u8, is_set: bool| if is_set { flag } else { 0 };
        let movers = input.bodies.movers() as u32;
        let is_static = a >= movers || b >= movers;
        let in_tree = |body: u32| input.tree_slots.of(body as usize).is_some();
        let flags = flag(DEEP, contact.points().iter().any(deep) && !is_soft(input, contact))
            | flag(AHEAD, contact.points().iter().all(|p| p.separation > 2.0 * input.measures.margin))
            | flag(STATIC, is_static)
            | flag(IN_TREE, is_static && in_tree(a.min(b)) && !is_soft(input, contact));
        Fact { slot, a, b, count: contact.count, touching, flags }
    }

    pub(super) fn group(&self) -> Group {
        Group::of(self.flags & STATIC != 0, self.touching == 0)
    }

    /// Whether a point is so deep that its bodies may be of a crowd.
    pub(super) fn is_deep(&self) -> bool {
        self.flags & DEEP != 0
    }

    /// Whether only continuous collision looks for its points.
    pub(super) fn is_ahead(&self) -> bool {
        self.flags & AHEAD != 0
    }

    /// Whether it is of static geometry and a body in a tree of joints.
    pub(super) fn is_in_tree(&self) -> bool {
        self.flags & IN_TREE != 0
    }
}

/// Buffers of one step.
#[derive(Debug, Default)]
pub(super) struct Facts {
    /// Of each block of pairs: its number of contacts, then where its facts begin.
    starts: Vec<u32>,
    /// Of the contacts of some blocks.
    wave: Vec<Fact>,
}

buffers! { Facts { bytes { starts, wave } } }

/// Pairs a block.
const BLOCK: usize = per_block(256, 4);
/// Contacts of a wave: they stay in the cache.
const WAVE: u32 = 2048;

impl Facts {
    /// Calls `f` with each contact that has rows, in the order of the pairs. Uses memory without a limit.
    pub(super) fn each(&mut self, workers: &Workers<'_>, input: &PrepareInput<'_>, mut f: impl FnMut(Fact)) {
        let Facts { starts, wave } = self;
        let mut allowance = Allowance::ENDLESS;
        let blocks = input.pairs.len().div_ceil(BLOCK);
        let pairs = |block: usize| block * BLOCK..((block + 1) * BLOCK).min(input.pairs.len());
        allowance.fit(starts, blocks);
        starts.clear();
        starts.resize(blocks, 0);
        let counts = Shared::new(starts);
        workers.run(blocks, &|block| {
            let mut count = 0;
            each_of(input, pairs(block), |_, _| count += 1);
            // SAFETY: there is one count for each block.
            unsafe { *counts.get(block) = count };
        });
        let mut first = 0;
        while first < blocks {
            let (mut end, mut total) = (first, 0);
            while end < blocks && (end == first || total + starts[end] <= WAVE) {
                total += std::mem::replace(&mut starts[end], total);
                end += 1;
            }
            allowance.fit(wave, total as usize);
            wave.resize(total as usize, Fact::default());
            let facts = Shared::new(wave);
            workers.run(end - first, &|block| {
                let mut at = starts[first + block] as usize;
                each_of(input, pairs(first + block), |slot, contact| {
                    // SAFETY: blocks have ranges of their own.
                    unsafe { *facts.get(at) = Fact::of(input, slot, contact) };
                    at += 1;
                });
            });
            wave.iter().copied().for_each(&mut f);
            first = end;
        }
    }

    #[cfg(debug_assertions)]
    pub(super) fn spoil(&mut self) {
        use crate::memory::spoil;
        spoil(&mut self.starts);
        spoil(&mut self.wave);
    }
}

/// Whether springs act between the two shapes.
fn is_soft(input: &PrepareInput<'_>, contact: ContactRef<'_>) -> bool {
    let soft = |c: u32, part: u8| input.colliders.all[c as usize].is_soft(part);
    input.beside.soft && (soft(contact.a, 0) || soft(contact.b, contact.material))
}

/// Calls `f` with each contact that has rows.
pub(super) fn each_contact<'a>(input: &PrepareInput<'a>, f: impl FnMut(u32, ContactRef<'a>)) {
    each_of(input, 0..input.pairs.len(), f);
}

/// Calls `f` with the contacts of some pairs that have rows.
#[inline(always)]
fn each_of<'a>(input: &PrepareInput<'a>, pairs: Range<usize>, mut f: impl FnMut(u32, ContactRef<'a>)) {
    let dynamic = input.bodies.dynamic();
    for pair in &input.pairs[pairs] {
        if pair.contact == NO_CONTACT || pair.is_idle(&input.colliders.summaries, dynamic) {
            continue;
        }
        for (slot, contact) in input.contacts.chain(pair.contact).filter(|(_, contact)| contact.count > 0) {
            f(slot, contact);
        }
    }
}
