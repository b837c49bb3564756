//! The new contacts that blocks of pairs find, and how they get a slot.
//!
//! Blocks run at the same time, so each has its own part of what all share: a range of the new contacts, and,
//! if its pairs are of a mesh, buffers of its own. One thread then commits them in the order of the blocks.
//! If the budget leaves too little memory, contacts with static geometry are kept longest.

use super::admit::ContactMemory;
use super::contact::{Contact, FoundAt, NO_CONTACT};
use super::of_meshes::{Exchange, MeshBlock};
use super::store::{ContactCount, Contacts};
use super::way::{Way, make_way, reserve};
use super::weight::Weight;
use crate::broad_phase::Pair;
use crate::memory::{Allowance, Allowances, Buffer, Category, Marks, Slab, bytes_of, even_out};
use crate::narrow_phase::bins::{BLOCK as PAIRS, Bins, Block};
use crate::narrow_phase::input::Input;
use crate::narrow_phase::pair_state::{PackedState, PairState};
use crate::narrow_phase::relative::relative_pose;
use crate::narrow_phase::{MAX_POINTS, RawManifold};
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

/// What becomes of a manifold that its contact has no place for.
pub(crate) enum Growth {
    /// The contact gets it once it has been given a place.
    Later,
    /// The block has to look at the pair again: there is no place for the manifold until then.
    Again,
    /// The contact gets the points that it has place for.
    Cut,
}

/// What a block writes, apart from the contacts that its pairs have already.
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
    /// Gives a pair its first contact.
    pub(crate) fn add(
        &mut self,
        input: &Input<'_>,
        pair: &Pair,
        index: u32,
        raw: RawManifold,
        fraction: f32,
    ) {
        let block = &mut *self.block;
        let class = usize::from(input.is_static(pair));
        let at = block.found();
        if block.used[class] < block.quota[class]
            && let Some(place) = self.fresh.get_mut(at)
        {
            *place = Fresh { pair: index, fraction, raw };
            block.used[class] += 1;
        } else if block.used[class] > 0 {
            // Replaces the lightest.
            let new = Fresh { pair: index, fraction, raw };
            let weight = new.weight(pair, input);
            // SAFETY: the pairs of a block are its own.
            let pair_of = |found: &Fresh| unsafe { *self.pairs.get(found.pair as usize) };
            let own = self.fresh[..at].iter_mut();
            let own = own.filter(|found| usize::from(input.is_static(&pair_of(found))) == class);
            let weight_of = |found: &Fresh| found.weight(&pair_of(found), input);
            let lightest = own.min_by_key(|found| weight_of(found));
            if let Some(lightest) = lightest.filter(|found| weight_of(found) < weight) {
                block.shed += lightest.raw.size();
                *lightest = new;
            } else {
                block.shed += raw.size();
            }
        } else {
            block.shed += raw.size();
        }
    }

    /// Takes a manifold that the contact of its pair has no place for.
    pub(crate) fn grow(&mut self, index: u32, raw: RawManifold, fraction: f32) -> Growth {
        let block = &mut *self.block;
        let at = block.found();
        if let Some(place) = self.fresh.get_mut(at).filter(|_| block.grown < block.growth) {
            *place = Fresh { pair: index, fraction, raw };
            block.grown += 1;
            return Growth::Later;
        }
        if !self.repeats {
            return Growth::Cut;
        }
        // SAFETY: the pair is this block's.
        unsafe { self.state.get(index as usize) }.set(PairState::Crowded);
        block.crowded += 1;
        Growth::Again
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

/// What blocks write to while they run.
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

/// Blocks that run before what they found is committed.
pub(crate) struct Wave<'a> {
    pub(crate) bins: &'a mut Bins,
    /// Range of the blocks.
    pub(crate) blocks: Range<usize>,
    /// Of each pair of the step.
    pub(crate) states: &'a mut [PackedState],
}

/// Blocks, for what they found.
#[derive(Clone, Copy)]
pub(super) struct FoundBy<'a> {
    pub(super) blocks: &'a [Block],
    /// Capacity for new contacts in the memory of the last step's rows; zero if there is no budget.
    pub(super) place: usize,
}

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct FoundContacts {
    /// New contacts, if there is no budget; with one they lie in the memory of the last step's rows.
    fresh: Vec<Fresh>,
    /// Capacity for new contacts under a budget.
    place: usize,
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
        let own = [bytes_of(&self.fresh), bytes_of(&self.meshes), bytes_of(&self.chain)];
        own.into_iter()
            .chain(self.meshes.iter().map(MeshBlock::bytes))
            .fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }

    /// Gives each block its buffers. Mesh blocks come first: their contacts are support.
    pub(crate) fn plan(
        &mut self,
        bins: &mut Bins,
        pairs: &[Pair],
        contacts: &Contacts,
        input: &Input<'_>,
        allowances: &mut Allowances,
        slab: &mut Slab,
    ) {
        let endless = allowances.is_endless();
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
        let (mut own, mut total, mut growing) = (0, [0u32; 2], 0);
        for block in &mut bins.blocks {
            if block.bin.is_mesh() {
                block.mesh = own;
                own += 1;
                continue;
            }
            let order = &bins.order[block.start as usize..block.end as usize];
            let new = order.iter().map(|&i| &pairs[i as usize]).filter(|pair| pair.contact == NO_CONTACT);
            if endless {
                let new = new.count() as u32;
                block.growth = block.growing(order.len() as u32 - new).div_ceil(GROWING) as u8;
                block.place = new + u32::from(block.growth);
                block.quota = [new; 2];
                continue;
            }
            new.for_each(|pair| block.quota[usize::from(input.is_static(pair))] += 1);
            // Contacts that are older than the budget, and a few that outgrow what is usual for their kind.
            let (mut older, mut others) = (0, 0);
            let old = order.iter().map(|&i| &pairs[i as usize]).filter(|pair| pair.contact != NO_CONTACT);
            for (pair, room) in old.map(|pair| (pair, contacts.room(pair.contact))) {
                let is_older = room < input.room(pair, true);
                older += u32::from(is_older);
                others += u32::from(!is_older && room < MAX_POINTS);
            }
            block.growth = (older + block.growing(others).div_ceil(GROWING)) as u8;
            growing += u32::from(block.growth);
            total[0] += block.quota[0] + block.quota[1];
            total[1] += block.quota[1];
        }
        // Half for the blocks of meshes, in equal shares.
        self.share = allowances.allowance(Category::Scratch).share(2 * self.meshes.len());
        self.meshes.iter_mut().for_each(|block| block.mesh.allowance = self.share);
        if endless {
            self.place = 0;
            return;
        }
        let wanted = (total[0] + growing) as usize;
        let part = |allowance: &mut Allowance| {
            allowance.within(4, |allowance| slab.reserve::<Fresh>(wanted, allowance))
        };
        self.place = allowances.within(Category::Rows, part);
        if self.place < wanted {
            // Contacts that there are keep the points that they have place for.
            bins.blocks.iter_mut().for_each(|block| block.growth = 0);
            self.place = self.place.min(total[0] as usize);
        }
        if self.place < total[0] as usize {
            cut(&mut bins.blocks, self.place as u32, [total[0] - total[1], total[1]]);
        } else {
            let mut start = 0;
            for block in bins.blocks.iter_mut().filter(|block| !block.bin.is_mesh()) {
                block.place = block.quota[0] + block.quota[1] + u32::from(block.growth);
                block.fresh = start;
                start += block.place;
            }
        }
    }

    /// The end of the blocks that run before their contacts are committed: as many as there is capacity for.
    /// Under a budget all run, because it is shared out by what all found.
    pub(crate) fn wave(&mut self, blocks: &mut [Block], first: usize, allowance: &mut Allowance) -> usize {
        if !allowance.is_endless() {
            return blocks.len();
        }
        let (mut end, mut total) = (first, 0);
        while let Some(block) = blocks.get_mut(end).filter(|b| end == first || total + b.place <= WAVE) {
            block.fresh = total;
            total += block.place;
            end += 1;
        }
        allowance.fit(&mut self.fresh, total as usize);
        if self.fresh.len() < total as usize {
            self.fresh.resize(total as usize, Fresh::default());
        }
        end
    }

    /// What blocks write to while they run.
    pub(crate) fn places<'a>(&'a mut self, slab: &'a mut Slab) -> Places<'a> {
        let meshes = self.meshes.len();
        let fresh = if self.place > 0 { slab.alone(self.place) } else { &mut self.fresh };
        let repeats = self.share.is_endless();
        Places { fresh: Shared::new(fresh), meshes, mesh: Shared::new(&mut self.meshes), repeats }
    }

    /// Gives slots to the contacts of some blocks, and with the last of them to those of mesh blocks. Returns
    /// the number of points that got none.
    pub(crate) fn commit(
        &mut self,
        wave: &mut Wave<'_>,
        pairs: &mut [Pair],
        contacts: &mut Contacts,
        input: &Input<'_>,
        memory: &mut ContactMemory<'_>,
    ) -> u32 {
        let Wave { bins, blocks, states } = wave;
        let last = blocks.end == bins.blocks.len();
        if self.place > 0 {
            self.place = close_up(&mut bins.blocks, memory.space.slab.alone(self.place));
        }
        let blocks = &bins.blocks[blocks.clone()];
        let mut shed = 0;
        for block in blocks.iter().filter(|block| block.emptied > 0) {
            let order = &bins.order[block.start as usize..block.end as usize];
            for &index in order.iter().filter(|&&i| states[i as usize].is(PairState::Emptied)) {
                let slot = std::mem::replace(&mut pairs[index as usize].contact, NO_CONTACT);
                contacts.remove_chain(slot);
            }
        }
        if blocks.iter().any(|block| block.grown > 0) {
            let found = FoundBy { blocks, place: self.place };
            shed += found.renew_grown(&mut self.fresh, pairs, contacts, input, memory);
        }
        let meshes = if last { self.meshes.as_mut_slice() } else { &mut [] };
        let mut of_meshes = ContactCount::default();
        for block in &mut *meshes {
            of_meshes = of_meshes + block.count_more(pairs, contacts);
            let used = self.share.left() - block.mesh.allowance.left();
            memory.allowances.within(Category::Scratch, |allowance| allowance.take(used));
            shed += std::mem::take(&mut block.mesh.shed);
        }
        shed += blocks.iter().map(|block| block.shed).sum::<u32>();
        let mut way = Way::FREE;
        if memory.allowances.is_endless() {
            let more = count(found_by(blocks, &self.fresh), |_| 0) + of_meshes;
            memory.allowances.within(Category::Manifolds, |allowance| contacts.reserve(more, allowance));
        } else {
            let found = FoundBy { blocks, place: self.place };
            way = make_way(found, meshes, of_meshes, pairs, contacts, input, memory);
            shed += way.shed;
        }
        let ContactMemory { allowances, space } = memory;
        for block in meshes {
            shed += allowances.within(Category::Scratch, |allowance| {
                let (chain, touching) = (&mut self.chain, &mut self.touching);
                Exchange { contacts, most: way.most, chain, touching, input, allowance }.run(block, pairs)
            });
        }
        let fresh = if self.place > 0 { space.slab.alone(self.place) } else { &mut self.fresh };
        for found in found_by(blocks, fresh) {
            let pair = &mut pairs[found.pair as usize];
            if !allowances.is_endless() && !way.floor.keeps(found.weight(pair, input)) {
                shed += found.raw.size();
                continue;
            }
            let at = FoundAt::of(pair, input, found.fraction);
            let contact = Contact::found(pair.a, pair.b, &found.raw, at);
            self.touching |= contact.as_ref().touches_anew(input.touch_distance);
            let room = input.room(pair, !allowances.is_endless());
            pair.contact = contacts.insert_within(&contact, room, way.most);
            shed += if pair.contact == NO_CONTACT { found.raw.size() } else { 0 };
        }
        if last {
            allowances.within(Category::Scratch, |allowance| {
                let spare = allowance.left().saturating_sub(way.of_rows);
                let mut part = if allowance.is_endless() { *allowance } else { Allowance::new(spare / PART) };
                let before = part.left();
                even_out(&mut self.meshes, &mut self.marks, &mut part);
                allowance.take(before - part.left());
            });
        }
        shed
    }
}

impl FoundBy<'_> {
    /// Gives the contacts of the blocks places for the manifolds that they had none for, and then these. What
    /// was found about them is done with. Returns the number of points that got no place. `fresh`: what was
    /// found, if there is no budget.
    fn renew_grown(
        self,
        fresh: &mut [Fresh],
        pairs: &[Pair],
        contacts: &mut Contacts,
        input: &Input<'_>,
        memory: &mut ContactMemory<'_>,
    ) -> u32 {
        let FoundBy { blocks, place } = self;
        let bounded = !memory.allowances.is_endless();
        let grown = |fresh: &[Fresh]| {
            let grown =
                found_by(blocks, fresh).filter(|found| pairs[found.pair as usize].contact != NO_CONTACT);
            let points = grown.map(|found| {
                let pair = &pairs[found.pair as usize];
                input.room(pair, bounded).max(found.raw.count as usize) - contacts.least_room(pair.contact)
            });
            ContactCount { contacts: 0, points: points.sum() }
        };
        let more = grown(if place > 0 { memory.space.slab.alone(place) } else { fresh });
        reserve(more, contacts, place * FRESH_BYTES, 0, memory);
        let fresh = if place > 0 { memory.space.slab.alone(place) } else { fresh };
        let mut shed = 0;
        for block in blocks.iter().filter(|block| block.grown > 0) {
            for found in &mut fresh[block.fresh as usize..][..block.found()] {
                let pair = &pairs[found.pair as usize];
                if pair.contact != NO_CONTACT {
                    let wanted = input.room(pair, bounded).max(found.raw.count as usize);
                    let room = contacts.grow(pair.contact, wanted);
                    shed += found.raw.keep(room);
                    let at = FoundAt::of(pair, input, found.fraction);
                    contacts.at_mut(pair.contact).renew(&found.raw, at, input.match_limits(pair));
                    found.raw.count = 0;
                }
            }
        }
        shed
    }
}

/// So many contacts, and the points of their places: of those that they have, but not fewer than `room` says.
pub(super) fn count<'a>(
    found: impl Iterator<Item = &'a Fresh>,
    room: impl Fn(&Fresh) -> usize,
) -> ContactCount {
    let of = |found: &Fresh| ContactCount { contacts: 1, points: room(found).max(found.raw.count as usize) };
    found.map(of).fold(ContactCount::default(), std::ops::Add::add)
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

/// Closes the gaps between what blocks found; returns the total.
fn close_up(blocks: &mut [Block], fresh: &mut [Fresh]) -> usize {
    let mut end = 0;
    for block in blocks {
        let (start, used) = (block.fresh as usize, block.found());
        fresh.copy_within(start..start + used, end);
        block.fresh = end as u32;
        end += used;
    }
    end
}

/// What blocks found, in their order, apart from what is done with.
pub(super) fn found_by<'a>(blocks: &'a [Block], fresh: &'a [Fresh]) -> impl Iterator<Item = &'a Fresh> + 'a {
    blocks.iter().flat_map(|block| {
        let (start, used) = (block.fresh as usize, block.found());
        fresh[start..start + used].iter().filter(|found| found.raw.count > 0)
    })
}

/// The part of a block's contacts that may outgrow their places at a time.
const GROWING: u32 = 8;

/// New contacts that are held at a time: enough for all in most steps. If a whole scene falls onto the ground
/// at once, its blocks run in several waves.
const WAVE: u32 = 1024;

/// Share of the remaining memory that may be spent on even capacities: they only save growth in later steps.
const PART: usize = 8;

/// Distributes capacity for new contacts that is less than the number of pairs without one: first to pairs
/// with static geometry, and within a kind every block gets its share. If the first blocks alone got it,
/// pairs that have parted but are still pairs would keep it from those that have not.
fn cut(blocks: &mut [Block], granted: u32, total: [u32; 2]) {
    let of_static = granted.min(total[1]);
    let shares = [granted - of_static, of_static];
    let (mut passed, mut start) = ([0u64; 2], 0);
    for block in blocks {
        for (kind, quota) in block.quota.iter_mut().enumerate() {
            let upto = |pairs: u64| pairs * u64::from(shares[kind]) / u64::from(total[kind].max(1));
            let before = upto(passed[kind]);
            passed[kind] += u64::from(*quota);
            *quota = (upto(passed[kind]) - before) as u32;
        }
        (block.fresh, block.place) = (start, block.quota[0] + block.quota[1]);
        start += block.place;
    }
}
