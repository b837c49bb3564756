//! The new contacts that blocks of pairs find, and how they get a slot.
//!
//! Blocks run at the same time, so each has its own part of the shared buffers: a range of the new contacts,
//! and, if its pairs are of a mesh, buffers of its own. They run in waves, and one thread takes over the
//! results of a wave, in the order of the blocks. Under a budget new contacts lie in the memory of the last
//! step's rows and wait there until all blocks ran.

use super::admit::ContactMemory;
use super::contact::{Contact, FoundAt, NO_CONTACT};
use super::of_meshes::{Exchange, MeshBlock};
use super::store::{ContactCount, Contacts};
use super::way::{Way, make_way, reserve};
use super::weight::{Threshold, Weight};
use crate::broad_phase::Pair;
use crate::memory::{Allowance, Allowances, Buffer, Category, Marks, Slab, bytes_of, even_out};
use crate::narrow_phase::RawManifold;
use crate::narrow_phase::bins::{BLOCK as PAIRS, Bins, Block};
use crate::narrow_phase::input::Input;
use crate::narrow_phase::pair_state::{PackedState, PairState};
use crate::narrow_phase::relative::relative_pose;
use crate::threads::Shared;
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// A new contact, of a pair that had none; or a manifold of more points than its contact has place for.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Fresh {
    pub(super) pair: u32,
    /// Fraction of the step at which it was found.
    fraction: f32,
    pub(super) raw: RawManifold,
}

/// Bytes of a new contact until it has a slot.
pub(crate) const FRESH_BYTES: usize = size_of::<Fresh>();
/// Bytes of rows that bodies bring with them under a budget, so that one block always has place for its
/// results.
pub(crate) const LEAST_ROWS: usize = PAIRS as usize * FRESH_BYTES;

/// Treatment of a manifold that is new, or that its contact has no place for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Handed {
    /// It is among the new ones of the wave.
    Over,
    /// The block has to look at the pair again: there is no place for the manifold until then.
    Again,
    /// There never is any place.
    Nowhere,
}

/// Output of a block, apart from the contacts that its pairs have already.
pub(crate) struct BlockOutput<'a> {
    fresh: &'a mut [Fresh],
    pairs: &'a Shared<'a, Pair>,
    block: &'a mut Block,
    state: &'a Shared<'a, PackedState>,
    /// Whether it may have to look at pairs again.
    repeats: bool,
    pub(crate) mesh: Option<&'a mut MeshBlock>,
}

impl BlockOutput<'_> {
    /// Hands over the first contact of a pair, or a manifold that the contact of its pair has no place for.
    pub(crate) fn hand_over(&mut self, index: u32, raw: RawManifold, fraction: f32, is_new: bool) -> Handed {
        let block = &mut *self.block;
        if let Some(place) = self.fresh.get_mut(block.found as usize) {
            *place = Fresh { pair: index, fraction, raw };
            block.found += 1;
            block.grown |= !is_new;
            return Handed::Over;
        }
        if !self.repeats {
            return Handed::Nowhere;
        }
        // SAFETY: the pair is this block's.
        unsafe { self.state.get(index as usize) }.set(PairState::Crowded);
        block.crowded += 1;
        Handed::Again
    }

    /// Removes a pair's contacts.
    pub(crate) fn empty(&mut self, index: u32) {
        // SAFETY: the pair is this block's.
        unsafe { self.state.get(index as usize) }.set(PairState::Emptied);
        self.block.emptied += 1;
    }

    /// Marks a pair without a contact as clear: not touched on the whole predicted path, and not near at its
    /// start.
    pub(crate) fn clear(&mut self, index: u32) {
        // SAFETY: the pair is this block's.
        unsafe { self.state.get(index as usize) }.set(PairState::Clear);
    }

    /// Notes that the shapes of a pair without a contact are at least so far apart [m], and that they touch
    /// nowhere on the predicted path.
    pub(crate) fn note_apart(&mut self, input: &Input<'_>, index: u32, gap: f32) {
        self.clear(index);
        // SAFETY: the pair is this block's.
        input.note_apart(unsafe { self.pairs.get(index as usize) }, gap);
    }

    pub(crate) fn count_casts(&mut self, casts: u32) {
        self.block.casts += casts;
    }
    pub(crate) fn casts(&self) -> u32 {
        self.block.casts
    }
    pub(crate) fn set_casts(&mut self, casts: u32) {
        self.block.casts = casts;
    }
    pub(crate) fn count_ghost(&mut self) {
        self.block.ghosts += 1;
    }
    pub(crate) fn count_shed(&mut self, points: u32) {
        self.block.shed += points;
    }
}

/// Buffers that blocks write to while they run.
pub(crate) struct Places<'a> {
    fresh: Shared<'a, Fresh>,
    meshes: usize,
    mesh: Shared<'a, MeshBlock>,
    repeats: bool,
}

impl Places<'_> {
    /// The output of one block.
    ///
    /// # Safety
    /// To be called at most once for each block.
    pub(crate) unsafe fn of<'a>(
        &'a self,
        block: &'a mut Block,
        state: &'a Shared<'a, PackedState>,
        pairs: &'a Shared<'a, Pair>,
    ) -> BlockOutput<'a> {
        let (start, own) = (block.fresh as usize, block.mesh as usize);
        let is_mesh = block.bin.is_mesh() && own < self.meshes;
        // SAFETY: blocks' places don't overlap, and each mesh block has its own number.
        unsafe {
            let fresh = self.fresh.part(start..start + block.place as usize);
            let mesh = is_mesh.then(|| self.mesh.get(own));
            BlockOutput { fresh, pairs, state, repeats: self.repeats, mesh, block }
        }
    }
}

/// Blocks that run before their results are committed.
pub(crate) struct Wave<'a> {
    pub(crate) bins: &'a mut Bins,
    /// Range of the blocks.
    pub(crate) blocks: Range<usize>,
    /// Of each pair of the step.
    pub(crate) states: &'a mut [PackedState],
}

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct FoundContacts {
    /// Without a budget new contacts have memory of their own.
    own: Slab,
    /// New contacts that wait for a slot: under a budget until all are found, and then all are weighed at
    /// once.
    waiting: usize,
    /// Places for these and for the new contacts of the wave.
    place: usize,
    /// Points of contacts that gave up their place to heavier ones.
    shed: u32,
    meshes: Vec<MeshBlock>,
    /// Memory granted to each of them.
    share: Allowance,
    marks: Marks,
    chain: Vec<Contact>,
    /// Whether a new contact touches.
    pub(crate) touching: bool,
}

impl FoundContacts {
    /// See [`Scratch::missing_to_find`](crate::narrow_phase::Scratch::missing_to_find). Beside the triangles
    /// that it gathers, a block of mesh pairs is assumed to need as much again.
    pub(crate) fn missing(&self, of_meshes: usize) -> usize {
        let blocks = of_meshes.div_ceil(PAIRS as usize);
        let each = MeshBlock::default().mesh.least() * 2;
        self.meshes.missing(blocks + blocks / 4) + blocks * each
    }

    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let fresh = self.own.bytes(self.place * FRESH_BYTES);
        let own = [fresh, bytes_of(&self.meshes), bytes_of(&self.chain)];
        own.into_iter()
            .chain(self.meshes.iter().map(MeshBlock::bytes))
            .fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }

    /// Takes the memory of its own for that of the last step's rows, or gives these theirs back.
    pub(crate) fn swap_own(&mut self, memory: &mut ContactMemory<'_>) {
        if memory.allowances.is_endless() {
            std::mem::swap(&mut self.own, &mut memory.space.slab);
        }
    }

    /// Gives each block its buffers, and counts the places that it needs. Mesh blocks come first: their
    /// contacts are support.
    pub(crate) fn plan(&mut self, bins: &mut Bins, pairs: &[Pair], allowances: &mut Allowances) {
        let wanted = bins.blocks.iter().filter(|b| b.bin.is_mesh()).count();
        if wanted > self.meshes.len() {
            // A few more than needed, or every other step would add one.
            let half = |allowance: &mut Allowance| {
                allowance.within(2, |allowance| {
                    let granted = allowance.fit(&mut self.meshes, wanted + wanted / 4);
                    self.meshes.resize_with(granted, MeshBlock::default);
                    even_out(&mut self.meshes, &mut self.marks, allowance);
                });
            };
            allowances.within(Category::Scratch, half);
        }
        let mut own = 0;
        for block in &mut bins.blocks {
            if block.bin.is_mesh() {
                block.mesh = own;
                own += 1;
                continue;
            }
            let order = &bins.order[block.start as usize..block.end as usize];
            let new = order.iter().filter(|&&i| pairs[i as usize].contact == NO_CONTACT).count() as u32;
            block.place = new + block.growing(order.len() as u32 - new).div_ceil(GROWING);
        }
        // Also the leftovers of a step that panicked.
        (self.place, self.waiting, self.shed) = (0, 0, 0);
        // Half for the blocks of meshes, in equal shares.
        self.share = allowances.allowance(Category::Scratch).share(2 * self.meshes.len());
        self.meshes.iter_mut().for_each(|block| block.mesh.allowance = self.share);
    }

    /// Makes places for the new contacts of the next blocks, from `first` on, behind those that wait, and
    /// returns the end of those that there are enough for. Only one block alone may have too few.
    pub(crate) fn wave(
        &mut self,
        blocks: &mut [Block],
        first: usize,
        pairs: &[Pair],
        input: &Input<'_>,
        memory: &mut ContactMemory<'_>,
    ) -> usize {
        let ContactMemory { allowances, space } = &mut *memory;
        let (bounded, held) = (!allowances.is_endless(), space.slab.holds::<Fresh>());
        let most = if bounded { usize::MAX } else { held.max(WAVE) };
        let (mut end, mut total) = spread(blocks, first, self.waiting, most);
        // Under a budget for all blocks at once: wave by wave it would become ever more.
        let asked = bounded && self.place > 0;
        self.place = if asked {
            held.min(total)
        } else {
            allowances.within(Category::Rows, |allowance| {
                allowance.within(4, |allowance| space.slab.reserve::<Fresh>(total, allowance))
            })
        };
        if self.place < total {
            self.keep_heaviest(self.place / 2, pairs, input, memory);
            (end, total) = spread(blocks, first, self.waiting, self.place);
        }
        self.place = total;
        end
    }

    /// Leaves so many of those that wait for a slot.
    fn keep_heaviest(
        &mut self,
        most: usize,
        pairs: &[Pair],
        input: &Input<'_>,
        memory: &mut ContactMemory<'_>,
    ) {
        if self.waiting <= most {
            return;
        }
        let fresh: &mut [Fresh] = memory.space.slab.alone(self.waiting);
        let weight = |found: &Fresh| found.weight(&pairs[found.pair as usize], input);
        let mut floor = Threshold::of_heaviest(most, fresh.iter().map(weight));
        self.waiting = 0;
        for i in 0..fresh.len() {
            if floor.keeps(weight(&fresh[i])) {
                fresh[self.waiting] = fresh[i];
                self.waiting += 1;
            } else {
                self.shed += fresh[i].raw.size();
            }
        }
    }

    /// Buffers that blocks write to while they run.
    pub(crate) fn places<'a>(&'a mut self, slab: &'a mut Slab) -> Places<'a> {
        let (meshes, repeats) = (self.meshes.len(), self.place > 0);
        let fresh = slab.alone(self.place);
        Places { fresh: Shared::new(fresh), meshes, mesh: Shared::new(&mut self.meshes), repeats }
    }

    /// Takes over the results of some blocks. Without a budget it gets slots at once. Returns the number of
    /// points that got none.
    pub(crate) fn commit(
        &mut self,
        wave: &mut Wave<'_>,
        pairs: &mut [Pair],
        contacts: &mut Contacts,
        input: &Input<'_>,
        memory: &mut ContactMemory<'_>,
    ) -> u32 {
        let Wave { bins, blocks, states } = wave;
        let blocks = &bins.blocks[blocks.clone()];
        let mut shed = blocks.iter().map(|block| block.shed).sum::<u32>();
        for block in blocks.iter().filter(|block| block.emptied > 0) {
            let order = &bins.order[block.start as usize..block.end as usize];
            for &index in order.iter().filter(|&&i| states[i as usize].is(PairState::Emptied)) {
                let slot = std::mem::replace(&mut pairs[index as usize].contact, NO_CONTACT);
                contacts.remove_chain(slot);
            }
        }
        shed += self.close_up(blocks, pairs, contacts, input, memory);
        if memory.allowances.is_endless() && self.waiting > 0 {
            let mut way = make_way(self.waiting, &[], pairs, contacts, input, memory);
            shed += self.insert(&mut way, pairs, contacts, input, memory);
        }
        shed
    }

    /// Moves the results of blocks behind those that wait, in the order of the blocks; but gives contacts
    /// places for manifolds that they had none for, and then these. Returns the number of points that got no
    /// place.
    fn close_up(
        &mut self,
        blocks: &[Block],
        pairs: &[Pair],
        contacts: &mut Contacts,
        input: &Input<'_>,
        memory: &mut ContactMemory<'_>,
    ) -> u32 {
        let bounded = !memory.allowances.is_endless();
        let wanted =
            |found: &Fresh| input.room(&pairs[found.pair as usize], bounded).max(found.raw.count as usize);
        if blocks.iter().any(|block| block.grown) {
            let fresh: &[Fresh] = memory.space.slab.alone(self.place);
            let found = blocks.iter().filter(|block| block.grown).flat_map(|block| &fresh[block.found()]);
            let slot = |found: &Fresh| pairs[found.pair as usize].contact;
            let grown = found.filter(|found| slot(found) != NO_CONTACT);
            let points = grown.map(|found| wanted(found) - contacts.least_room(slot(found))).sum();
            let more = ContactCount { contacts: 0, points };
            reserve(more, contacts, self.place * FRESH_BYTES, 0, memory);
        }
        let fresh: &mut [Fresh] = memory.space.slab.alone(self.place);
        let mut shed = 0;
        for index in blocks.iter().flat_map(Block::found) {
            let (mut found, pair) = (fresh[index], &pairs[fresh[index].pair as usize]);
            if pair.contact == NO_CONTACT {
                fresh[self.waiting] = found;
                self.waiting += 1;
                continue;
            }
            let room = contacts.grow(pair.contact, wanted(&found));
            shed += found.raw.keep(room);
            let at = FoundAt::of(pair, input, found.fraction);
            contacts.at_mut(pair.contact).renew(&found.raw, at, input.match_limits(pair));
        }
        shed
    }

    /// Gives slots to those that wait, as far as the way is free. Returns the number of points that got none.
    fn insert(
        &mut self,
        way: &mut Way,
        pairs: &mut [Pair],
        contacts: &mut Contacts,
        input: &Input<'_>,
        memory: &mut ContactMemory<'_>,
    ) -> u32 {
        let bounded = !memory.allowances.is_endless();
        let mut shed = way.shed;
        for found in &*memory.space.slab.alone::<Fresh>(std::mem::take(&mut self.waiting)) {
            let pair = &mut pairs[found.pair as usize];
            if way.floor.as_mut().is_some_and(|floor| !floor.keeps(found.weight(pair, input))) {
                shed += found.raw.size();
                continue;
            }
            let at = FoundAt::of(pair, input, found.fraction);
            let contact = Contact::found(pair.a, pair.b, &found.raw, at);
            self.touching |= contact.as_ref().touches_anew(input.touch_distance);
            pair.contact = contacts.insert_within(&contact, input.room(pair, bounded), way.most);
            shed += if pair.contact == NO_CONTACT { found.raw.size() } else { 0 };
        }
        shed
    }

    /// Once all blocks ran: makes way for all contacts that have no slot yet, and for the rows of all.
    /// Returns the number of points that got no slot.
    pub(crate) fn finish(
        &mut self,
        pairs: &mut [Pair],
        contacts: &mut Contacts,
        input: &Input<'_>,
        memory: &mut ContactMemory<'_>,
    ) -> u32 {
        for block in &self.meshes {
            let used = self.share.left() - block.mesh.allowance.left();
            memory.allowances.within(Category::Scratch, |allowance| allowance.take(used));
        }
        let mut way = make_way(self.waiting, &self.meshes, pairs, contacts, input, memory);
        let mut shed = std::mem::take(&mut self.shed);
        shed += self.insert(&mut way, pairs, contacts, input, memory);
        memory.allowances.within(Category::Scratch, |allowance| {
            for block in &mut self.meshes {
                shed += std::mem::take(&mut block.mesh.shed);
                let (chain, touching) = (&mut self.chain, &mut self.touching);
                shed += Exchange { contacts, most: way.most, chain, touching, input, allowance }
                    .run(block, pairs);
            }
            let spare = allowance.left().saturating_sub(way.of_rows);
            let mut part = if allowance.is_endless() { *allowance } else { Allowance::new(spare / PART) };
            let before = part.left();
            even_out(&mut self.meshes, &mut self.marks, &mut part);
            allowance.take(before - part.left());
        });
        shed
    }
}

impl FoundAt {
    /// At the poses of the start of the step, for a manifold of a fraction of it.
    pub(in crate::narrow_phase) fn of(pair: &Pair, input: &Input<'_>, fraction: f32) -> FoundAt {
        let frame = input.poses[pair.a as usize].rotation;
        FoundAt { pose: relative_pose(pair, input.poses), frame, fraction }
    }
}

impl Fresh {
    pub(super) fn weight(&self, pair: &Pair, input: &Input<'_>) -> Weight {
        let nearest = self.raw.points().iter().map(|p| p.separation).fold(f32::INFINITY, f32::min);
        let normal = input.poses[pair.a as usize].rotation * self.raw.normal;
        input.scale.weigh([pair.a, pair.b], normal, nearest, 0.0)
    }
}

/// Spreads places over blocks, from `start` to `most`; returns the end of those that have enough, and of
/// their places. The first takes all there is.
fn spread(blocks: &mut [Block], first: usize, start: usize, most: usize) -> (usize, usize) {
    let (mut end, mut total) = (first, start);
    let fits = |block: &Block, total: usize| most == 0 || total + block.place as usize <= most;
    while let Some(block) = blocks.get_mut(end).filter(|block| end == first || fits(block, total)) {
        block.place = (block.place as usize).min(most - total) as u32;
        block.fresh = total as u32;
        total += block.place as usize;
        end += 1;
    }
    (end, total)
}

/// The part of a block's contacts that may outgrow their places at a time.
const GROWING: u32 = 8;

/// New contacts that are held at a time, or as many as there is memory for already: enough for all in most
/// steps. If a whole scene falls onto the ground at once, its blocks run in several waves.
const WAVE: usize = 1024;

/// Share of the remaining memory that may be spent on even capacities: they only save growth in later steps.
const PART: usize = 8;
