//! The contacts of pairs with meshes and height fields: each step exchanges all that a pair has.

use super::contact::{Contact, FoundAt, NO_CONTACT};
use super::store::{ContactCount, Contacts};
use crate::broad_phase::Pair;
use crate::memory::{Allowance, Buffer, Buffers, bytes_of};
use crate::narrow_phase::RawManifold;
use crate::narrow_phase::input::Input;
use crate::narrow_phase::mesh::MeshScratch;

/// A pair of a mesh that has manifolds, and their range among those of its block.
#[derive(Clone, Copy, Debug)]
struct Looked {
    pair: u32,
    start: u32,
    end: u32,
}

/// A manifold with a mesh, and the fraction of the step at which it was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct OfMesh {
    pub(super) raw: RawManifold,
    fraction: f32,
}

/// The buffers of a block of mesh pairs.
#[derive(Debug, Default)]
pub(crate) struct MeshBlock {
    looked: Vec<Looked>,
    many: Vec<OfMesh>,
    /// Manifolds of the pair at hand, from one call of a kernel.
    pub(crate) raw: Vec<RawManifold>,
    pub(crate) mesh: MeshScratch,
}

impl MeshBlock {
    /// Number of manifolds so far.
    pub(crate) fn count(&self) -> u32 {
        self.many.len() as u32
    }

    /// Adds a manifold that was found at a fraction of the step.
    pub(crate) fn add(&mut self, raw: RawManifold, fraction: f32) {
        if !self.mesh.allowance.push(&mut self.many, OfMesh { raw, fraction }) {
            self.mesh.shed += raw.size();
        }
    }

    /// Ends the work on a pair, whose manifolds are those from `start` on; returns whether it has any.
    pub(crate) fn end(&mut self, pair: u32, start: u32) -> bool {
        let end = self.count();
        if end == start {
            return false;
        }
        let listed = self.mesh.allowance.push(&mut self.looked, Looked { pair, start, end });
        if !listed {
            let lost = self.many.drain(start as usize..);
            self.mesh.shed += lost.map(|found| found.raw.size()).sum::<u32>();
        }
        listed
    }

    /// Manifolds beyond the contacts that their pair has already, pair by pair.
    pub(super) fn more<'a>(
        &'a self,
        pairs: &'a [Pair],
        contacts: &'a Contacts,
    ) -> impl Iterator<Item = (&'a [OfMesh], &'a Pair)> + 'a {
        self.looked.iter().map(|&Looked { pair, start, end }| {
            let pair = &pairs[pair as usize];
            let old = contacts.count(pair.contact);
            (&self.many[(start as usize + old).min(end as usize)..end as usize], pair)
        })
    }

    /// How many contacts [`MeshBlock::more`] are, and how many points more than now the pairs may have at any
    /// time.
    pub(super) fn count_more(&self, pairs: &[Pair], contacts: &Contacts) -> ContactCount {
        let mut count = ContactCount::default();
        for (&Looked { pair, start, end }, (more, _)) in self.looked.iter().zip(self.more(pairs, contacts)) {
            let new: u32 = self.many[start as usize..end as usize].iter().map(|found| found.raw.size()).sum();
            let slot = pairs[pair as usize].contact;
            let old: usize = contacts.chain(slot).map(|(_, contact)| contact.points().len()).sum();
            count.contacts += more.len();
            count.points += (new as usize).saturating_sub(old);
        }
        count
    }

    pub(super) fn bytes(&self) -> (usize, usize) {
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

/// Exchanges the contacts of mesh pairs for new ones, which inherit the loads of the old ones.
pub(super) struct Exchange<'a> {
    pub(super) contacts: &'a mut Contacts,
    /// The most contacts that there may be.
    pub(super) most: usize,
    /// Buffer for the old contacts of a pair.
    pub(super) chain: &'a mut Vec<Contact>,
    /// Set if a new contact touches.
    pub(super) touching: &'a mut bool,
    pub(super) input: &'a Input<'a>,
    /// Bytes that the buffer may still grow by.
    pub(super) allowance: &'a mut Allowance,
}

impl Exchange<'_> {
    /// Exchanges those of a block. Returns the number of points that got no place.
    pub(super) fn run(self, block: &mut MeshBlock, pairs: &mut [Pair]) -> u32 {
        let Exchange { contacts, most, chain, touching, input, allowance } = self;
        let mut shed = 0;
        for &Looked { pair, start, end } in &block.looked {
            let pair = &mut pairs[pair as usize];
            let now = FoundAt::of(pair, input, 0.0);
            chain.clear();
            for (_, contact) in contacts.chain(pair.contact) {
                // The worst case is an impulse that is not inherited.
                allowance.push(chain, contact.to_owned());
            }
            let rolling = contacts.rolling_of_chain(pair.contact);
            contacts.remove_chain(pair.contact);
            pair.contact = NO_CONTACT;
            let mut last = NO_CONTACT;
            for &OfMesh { ref raw, fraction } in &block.many[start as usize..end as usize] {
                let mut contact = Contact::found(pair.a, pair.b, raw, FoundAt { fraction, ..now });
                // The manifold of the last step on the same material whose normal is nearest.
                let same = chain.iter().filter(|old| u16::from(old.material) == raw.material);
                let nearest =
                    same.max_by(|x, y| x.normal.dot(raw.normal).total_cmp(&y.normal.dot(raw.normal)));
                if let Some(old) = nearest.filter(|old| old.normal.dot(raw.normal) > 0.9) {
                    contact.as_mut().inherit(old.as_ref(), input.match_limits(pair));
                    (contact.friction, contact.twist) = (old.friction, old.twist);
                    contact.mean_friction = old.mean_friction;
                }
                *touching |= contact.as_ref().touches_anew(input.touch_distance);
                let slot = contacts.insert_within(&contact, 0, most);
                if slot == NO_CONTACT {
                    shed += raw.size();
                } else if last == NO_CONTACT {
                    // The first one has all of it; the passes over the rows share it out.
                    contacts.set_rolling(slot, rolling, allowance);
                    pair.contact = slot;
                } else {
                    contacts.at_mut(last).next = slot;
                }
                last = if slot == NO_CONTACT { last } else { slot };
            }
        }
        block.looked.clear();
        block.many.clear();
        shed
    }
}
