//! What blocks of pairs find that needs a slot, and how it gets one.
//!
//! Blocks run at the same time, so each has its own place in what all share: a stretch of the new contacts, and, if its
//! pairs are of a mesh, buffers of its own. One thread then commits them in the order of the blocks. Where the budget
//! leaves too little place, what protects from static geometry is kept longest.

use super::RawManifold;
use super::admit::{Census, admit};
use super::bins::{BLOCK as PAIRS, Bins, Block};
use super::collide::{Input, Same, relative_pose};
use super::contact::{Contact, Contacts, NONE};
use super::mesh::MeshScratch;
use crate::broad_phase::Pair;
use crate::memory::{Amounts, Buffer, Buffers, Category, Marks, Room, Rooms, bytes_of, even_out};
use crate::threads::Shared;

/// A contact of a pair that had none.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fresh {
    pair: u32,
    /// Of the step, where it was found.
    fraction: f32,
    raw: RawManifold,
}

/// What a block of mesh pairs works with.
#[derive(Debug, Default)]
pub(crate) struct MeshBlock {
    /// Pairs that were looked at, with the range of their manifolds in `many`.
    looked: Vec<(u32, u32, u32)>,
    many: Vec<(RawManifold, f32)>,
    /// Of the look that is under way.
    pub(crate) raw: Vec<RawManifold>,
    pub(crate) mesh: MeshScratch,
}

impl MeshBlock {
    /// How many manifolds there are by now.
    pub(crate) fn count(&self) -> u32 {
        self.many.len() as u32
    }

    /// Adds a manifold that was found at a fraction of the step.
    pub(crate) fn add(&mut self, raw: RawManifold, fraction: f32) {
        if !self.mesh.room.push(&mut self.many, (raw, fraction)) {
            self.mesh.shed += raw.count;
        }
    }

    /// Ends the look at a pair, whose manifolds are those from `start` on; says whether it has any.
    pub(crate) fn end(&mut self, pair: u32, start: u32) -> bool {
        let end = self.count();
        if end == start {
            return false;
        }
        let listed = self.mesh.room.push(&mut self.looked, (pair, start, end));
        if !listed {
            let lost = self.many.drain(start as usize..);
            self.mesh.shed += lost.map(|(raw, _)| raw.count).sum::<u32>();
        }
        listed
    }

    /// Manifolds that a pair has now and had no contact for, pair by pair.
    fn more<'a>(
        &'a self,
        pairs: &'a [Pair],
        contacts: &'a Contacts,
    ) -> impl Iterator<Item = (&'a [(RawManifold, f32)], &'a Pair)> + 'a {
        self.looked.iter().map(|&(index, start, end)| {
            let pair = &pairs[index as usize];
            let old = contacts.count(pair.contact);
            (&self.many[(start as usize + old).min(end as usize)..end as usize], pair)
        })
    }

    fn bytes(&self) -> (usize, usize) {
        [bytes_of(&self.looked), bytes_of(&self.many), bytes_of(&self.raw), self.mesh.bytes()]
            .into_iter()
            .fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }
}

impl Buffers for MeshBlock {
    fn each(&mut self, f: &mut dyn FnMut(&mut dyn Buffer)) {
        f(&mut self.looked);
        f(&mut self.many);
        f(&mut self.raw);
        self.mesh.each(f);
    }
}

/// What a block writes, beside the contacts that its pairs have.
pub(crate) struct Out<'a> {
    fresh: &'a mut [Fresh],
    block: &'a mut Block,
    state: &'a Shared<'a, u8>,
    pub(crate) mesh: Option<&'a mut MeshBlock>,
}

impl Out<'_> {
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
        let at = (block.used[0] + block.used[1]) as usize;
        if block.used[class] < block.quota[class]
            && let Some(place) = self.fresh.get_mut(at)
        {
            *place = Fresh { pair: index, fraction, raw };
            block.used[class] += 1;
        } else {
            block.shed += raw.count;
        }
    }

    /// Takes a pair's contacts away.
    pub(crate) fn empty(&mut self, index: u32) {
        // SAFETY: the pair is this block's.
        unsafe { *self.state.get(index as usize) = EMPTIED };
        self.block.emptied += 1;
    }

    /// Says that a pair, which has no contact, is not touched on the whole of the predicted way, nor near at its start.
    pub(crate) fn clear(&mut self, index: u32) {
        // SAFETY: the pair is this block's.
        unsafe { *self.state.get(index as usize) = CLEAR };
    }

    pub(crate) fn count_casts(&mut self, casts: u32) {
        self.block.casts += casts;
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
}

impl Places<'_> {
    /// What is a block's own.
    ///
    /// # Safety
    /// Each block may ask once.
    pub(crate) unsafe fn of<'a>(&'a self, block: &'a mut Block, state: &'a Shared<'a, u8>) -> Out<'a> {
        let (start, own) = (block.fresh as usize, block.mesh as usize);
        let is_mesh = block.bin.is_mesh() && own < self.meshes;
        // SAFETY: blocks' places don't overlap, and each mesh block has its own number.
        unsafe {
            let fresh = self.fresh.part(start..start + block.place as usize);
            Out { fresh, state, mesh: is_mesh.then(|| self.mesh.get(own)), block }
        }
    }
}

/// State of a pair: its contacts go. No bin has this number or a higher one.
pub(crate) const EMPTIED: u8 = u8::MAX - 2;
/// State of a pair once it was looked at: see [`Out::clear`]. No bin has this number.
pub(crate) const CLEAR: u8 = u8::MAX - 3;

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct Found {
    fresh: Vec<Fresh>,
    meshes: Vec<MeshBlock>,
    /// What each of them was granted.
    share: Room,
    marks: Marks,
    chain: Vec<Contact>,
    /// Whether a contact that was not there before touches.
    pub(super) touching: bool,
}

impl Found {
    /// See [`Scratch::missing_to_find`](super::Scratch::missing_to_find). What a block of meshes needs beside the triangles
    /// that it holds is taken to be as much again.
    pub(crate) fn missing(&self, fresh: usize, of_meshes: usize) -> usize {
        let blocks = of_meshes.div_ceil(PAIRS as usize);
        let each = MeshBlock::default().mesh.least() * 2;
        self.fresh.missing(fresh) + self.meshes.missing(blocks + blocks / 4) + blocks * each
    }

    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let own = [bytes_of(&self.fresh), bytes_of(&self.meshes), bytes_of(&self.chain)];
        own.into_iter()
            .chain(self.meshes.iter().map(MeshBlock::bytes))
            .fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }

    /// Gives each block its place. Mesh blocks come first: what they find is support.
    pub(crate) fn plan(&mut self, bins: &mut Bins, pairs: &[Pair], input: &Input<'_>, room: &mut Room) {
        let wanted = bins.blocks.iter().filter(|b| b.bin.is_mesh()).count();
        if wanted > self.meshes.len() {
            // A few more, or every other step would add one.
            room.within(2, |room| {
                let granted = room.fit(&mut self.meshes, wanted + wanted / 4);
                self.meshes.resize_with(granted, MeshBlock::default);
                even_out(&mut self.meshes, &mut self.marks, room);
            });
        }
        let (mut own, mut total) = (0, [0u32; 2]);
        for block in &mut bins.blocks {
            if block.bin.is_mesh() {
                block.mesh = own;
                own += 1;
                continue;
            }
            let order = &bins.order[block.start as usize..block.end as usize];
            let new = order.iter().map(|&i| &pairs[i as usize]).filter(|pair| pair.contact == NONE);
            if room.is_endless() {
                block.place = new.count() as u32;
                block.quota = [block.place; 2];
                continue;
            }
            new.for_each(|pair| block.quota[usize::from(input.is_static(pair))] += 1);
            block.place = block.quota[0] + block.quota[1];
            total[1] += block.quota[1];
            block.fresh = total[0];
            total[0] += block.place;
        }
        // Half for the blocks of meshes, in equal shares.
        self.share = room.share(2 * self.meshes.len());
        self.meshes.iter_mut().for_each(|block| block.mesh.room = self.share);
        if room.is_endless() {
            return;
        }
        let wanted = total[0] as usize;
        let granted = room.within(4, |room| room.fit(&mut self.fresh, wanted));
        if granted < wanted {
            cut(&mut bins.blocks, granted as u32, [total[0] - total[1], total[1]]);
        }
        if self.fresh.len() < granted {
            self.fresh.resize(granted, Fresh::default());
        }
    }

    /// Says where the blocks end that run before what they found is committed: those that there is place for. Under a
    /// budget all have theirs, because it is shared out by what all found.
    pub(crate) fn wave(&mut self, blocks: &mut [Block], first: usize, room: &mut Room) -> usize {
        if !room.is_endless() {
            return blocks.len();
        }
        let (mut end, mut total) = (first, 0);
        while let Some(block) = blocks.get_mut(end).filter(|b| end == first || total + b.place <= WAVE) {
            block.fresh = total;
            total += block.place;
            end += 1;
        }
        room.fit(&mut self.fresh, total as usize);
        if self.fresh.len() < total as usize {
            self.fresh.resize(total as usize, Fresh::default());
        }
        end
    }

    /// What blocks write to while they run.
    pub(crate) fn places(&mut self) -> Places<'_> {
        let meshes = self.meshes.len();
        Places { fresh: Shared::new(&mut self.fresh), meshes, mesh: Shared::new(&mut self.meshes) }
    }

    /// Gives slots to what some blocks found, and with the last of them to what those of meshes found. Says how many points
    /// found none.
    pub(crate) fn commit(
        &mut self,
        (bins, wave, state): (&Bins, std::ops::Range<usize>, &[u8]),
        pairs: &mut [Pair],
        contacts: &mut Contacts,
        input: &Input<'_>,
        (rooms, rows): (&mut Rooms, &dyn Fn(&Census) -> Amounts),
    ) -> u32 {
        let (blocks, last) = (&bins.blocks[wave.clone()], wave.end == bins.blocks.len());
        let mut shed = 0;
        for block in blocks.iter().filter(|block| block.emptied > 0) {
            let order = &bins.order[block.start as usize..block.end as usize];
            for &index in order.iter().filter(|&&i| state[i as usize] == EMPTIED) {
                let slot = std::mem::replace(&mut pairs[index as usize].contact, NONE);
                contacts.remove_chain(slot);
            }
        }
        let meshes = if last { self.meshes.as_mut_slice() } else { &mut [] };
        // By class: bodies that can move among themselves, and what protects from all else.
        let mut wanted = [0; 2];
        for block in blocks {
            wanted[0] += block.used[0] as usize;
            wanted[1] += block.used[1] as usize;
        }
        for block in &mut *meshes {
            wanted[1] += block.more(pairs, contacts).map(|(more, _)| more.len()).sum::<usize>();
            let used = self.share.left() - block.mesh.room.left();
            rooms.within(Category::Scratch, |room| room.take(used));
            shed += std::mem::take(&mut block.mesh.shed);
        }
        shed += blocks.iter().map(|block| block.shed).sum::<u32>();
        let total = wanted[0] + wanted[1];
        let (mut most, mut short, mut of_rows) = (usize::MAX, false, 0);
        if rooms.is_endless() {
            rooms.within(Category::Manifolds, |room| contacts.make_place(total, room));
        } else {
            let mut new = Census::default();
            for block in blocks {
                let (start, used) = (block.fresh as usize, (block.used[0] + block.used[1]) as usize);
                for found in &self.fresh[start..start + used] {
                    new.add_new(input.is_static(&pairs[found.pair as usize]), &found.raw, input);
                }
            }
            for (many, pair) in meshes.iter().flat_map(|block| block.more(pairs, contacts)) {
                many.iter().for_each(|(raw, _)| new.add_new(input.is_static(pair), raw, input));
            }
            let here = Census::of(pairs, contacts, input);
            let admitted = admit(contacts, (&here, &new), rows, rooms);
            (short, of_rows) = (admitted.count < total, admitted.of_rows);
            if short {
                // Support takes the place of others, those the rest.
                most = contacts.live() + admitted.count;
                shed += evict(wanted[1].saturating_sub(admitted.count), pairs, contacts, input);
            }
        }
        for block in meshes {
            shed += rooms.within(Category::Scratch, |room| {
                let found = (&mut self.chain, &mut self.touching);
                commit_meshes(block, pairs, (contacts, most), found, input, room)
            });
        }
        // In need, those of static geometry before the others.
        for class in if short { &[1, 0][..] } else { &[2] } {
            for block in blocks {
                let start = block.fresh as usize;
                let used = (block.used[0] + block.used[1]) as usize;
                for found in &self.fresh[start..start + used] {
                    let pair = &mut pairs[found.pair as usize];
                    if *class < 2 && usize::from(input.is_static(pair)) != *class {
                        continue;
                    }
                    let mut contact = Contact::new(pair.a, pair.b);
                    let frame = input.poses[pair.a as usize].rotation;
                    contact.take(&found.raw, relative_pose(pair, input.poses), frame);
                    contact.fraction = found.fraction;
                    self.touching |= contact.touches_anew(input.real);
                    pair.contact = contacts.insert_within(contact, most);
                    shed += if pair.contact == NONE { found.raw.count } else { 0 };
                }
            }
        }
        if last {
            rooms.within(Category::Scratch, |room| {
                let spare = room.left().saturating_sub(of_rows);
                let mut part = if room.is_endless() { *room } else { Room::new(spare / PART) };
                let before = part.left();
                even_out(&mut self.meshes, &mut self.marks, &mut part);
                room.take(before - part.left());
            });
        }
        shed
    }
}

/// New contacts that there is place for at a time: enough for all of most steps, and where a whole scene falls onto the
/// ground at once, its blocks run in several goes.
const WAVE: u32 = 1024;

/// Of what is left, a part that may go into evening out: it only saves later steps the growth.
const PART: usize = 8;

/// Less place for new contacts than there are pairs without one: first for those that touch something static, and of a kind all
/// blocks get their share. Were it for the first blocks alone, pairs that have parted and stay pairs would keep it from those that
/// have not.
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

/// Frees contacts of bodies that can move among themselves, from the last pair on: first those that don't touch. Says
/// how many points went.
fn evict(mut wanted: usize, pairs: &mut [Pair], contacts: &mut Contacts, input: &Input<'_>) -> u32 {
    let mut shed = 0;
    for touching in [false, true] {
        for pair in pairs.iter_mut().rev() {
            if wanted == 0 {
                return shed;
            }
            if pair.contact == NONE || input.is_static(pair) {
                continue;
            }
            let contact = &contacts.all[pair.contact as usize];
            if touching || contact.points().iter().all(|p| p.separation > input.real) {
                shed += u32::from(contact.count);
                contacts.remove_chain(std::mem::replace(&mut pair.contact, NONE));
                wanted -= 1;
            }
        }
    }
    shed
}

/// Exchanges the contacts of mesh pairs for new ones, which inherit what the old ones bore.
fn commit_meshes(
    block: &mut MeshBlock,
    pairs: &mut [Pair],
    (contacts, most): (&mut Contacts, usize),
    (chain, touching): (&mut Vec<Contact>, &mut bool),
    input: &Input<'_>,
    room: &mut Room,
) -> u32 {
    let mut shed = 0;
    for &(index, start, end) in &block.looked {
        let pair = &mut pairs[index as usize];
        let now = relative_pose(pair, input.poses);
        chain.clear();
        let mut slot = pair.contact;
        while slot != NONE {
            // At worst an impulse is not inherited.
            room.push(chain, contacts.all[slot as usize]);
            slot = contacts.all[slot as usize].next;
        }
        contacts.remove_chain(pair.contact);
        pair.contact = NONE;
        let mut last = NONE;
        for (raw, fraction) in &block.many[start as usize..end as usize] {
            let mut contact = Contact::new(pair.a, pair.b);
            contact.take(raw, now, input.poses[pair.a as usize].rotation);
            contact.fraction = *fraction;
            // The manifold of the last step whose normal is nearest.
            let nearest =
                chain.iter().max_by(|x, y| x.normal.dot(raw.normal).total_cmp(&y.normal.dot(raw.normal)));
            if let Some(old) = nearest.filter(|old| old.normal.dot(raw.normal) > 0.9) {
                contact.inherit(old, Same::of(input, pair));
                (contact.friction, contact.twist) = (old.friction, old.twist);
                contact.mean_friction = old.mean_friction;
            }
            *touching |= contact.touches_anew(input.real);
            let slot = contacts.insert_within(contact, most);
            if slot == NONE {
                shed += raw.count;
            } else if last == NONE {
                pair.contact = slot;
            } else {
                contacts.all[last as usize].next = slot;
            }
            last = if slot == NONE { last } else { slot };
        }
    }
    block.looked.clear();
    block.many.clear();
    shed
}
