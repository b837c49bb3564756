//! Makes way for new contacts where memory is short: weighs them and the old ones, and sheds the lightest.

use super::admit::{Census, ContactMemory, Kind as Taken, Means};
use super::contact::NO_CONTACT;
use super::found::{FRESH_BYTES, FoundBy, Fresh, count, found_by};
use super::of_meshes::MeshBlock;
use super::store::{ContactCount, Contacts};
use super::weight::{Threshold, Weight};
use crate::broad_phase::Pair;
use crate::memory::{Allowance, Allowances, Category};
use crate::narrow_phase::RawManifold;
use crate::narrow_phase::input::Input;

/// Which contacts may stay, and which new ones are taken in.
pub(super) struct Way {
    /// The most contacts.
    pub(super) most: usize,
    pub(super) floor: Threshold,
    /// Bytes left for rows.
    pub(super) of_rows: usize,
    /// Points of contacts that were shed.
    pub(super) shed: u32,
}

impl Way {
    /// All contacts.
    pub(super) const FREE: Way = Way { most: usize::MAX, floor: Threshold::ALL, of_rows: 0, shed: 0 };
}

/// Weighs existing contacts and those that blocks found, sheds those that are too light, and reserves slots
/// for the others.
pub(super) fn make_way(
    FoundBy { blocks, place }: FoundBy<'_>,
    meshes: &[MeshBlock],
    of_meshes: ContactCount,
    pairs: &mut [Pair],
    contacts: &mut Contacts,
    input: &Input<'_>,
    memory: &mut ContactMemory<'_>,
) -> Way {
    let ContactMemory { allowances, space } = &mut *memory;
    let cost = space.cost;
    let mut census = Census::new();
    for pair in pairs.iter().filter(|pair| !pair.is_idle(input.summaries, input.dynamic)) {
        let (is_static, weight) = (input.is_static(pair), weight_of(pair, contacts, input));
        let mut slot = pair.contact;
        while slot != NO_CONTACT {
            let (contact, room) = (contacts.at(slot), contacts.room(slot));
            let taken = Taken::of(contact, room, is_static, input.touch_distance);
            match weight {
                Some(weight) => census.add(weight, taken, &cost),
                None => census.add_fixed(taken, &cost),
            }
            slot = contact.next;
        }
    }
    for (many, pair) in meshes.iter().flat_map(|block| block.more(pairs, contacts)) {
        let taken = |raw: &RawManifold| Taken::of_new(raw, 0, input.is_static(pair), input.touch_distance);
        many.iter().for_each(|found| census.add_fixed(taken(&found.raw), &cost));
    }
    for found in found_by(blocks, space.slab.alone(place)) {
        let pair = &pairs[found.pair as usize];
        let taken =
            Taken::of_new(&found.raw, input.room(pair, true), input.is_static(pair), input.touch_distance);
        census.add(found.weight(pair, input), taken, &cost);
    }
    let admitted = Means::new(allowances, space, contacts).admit(&census);
    let mut floor = admitted.floor;
    let shed = evict(&mut floor, pairs, contacts, input);
    let mut ahead = floor;
    let stays = |found: &&Fresh| ahead.keeps(found.weight(&pairs[found.pair as usize], input));
    let room = |found: &Fresh| input.room(&pairs[found.pair as usize], true);
    let more = count(found_by(blocks, space.slab.alone(place)).filter(stays), room) + of_meshes;
    let reserved = space.slab.bytes(0).1 + cost.reserved;
    let of_rows = admitted.rows.saturating_sub(reserved).min(allowances.own(Category::Rows));
    // Rows have more memory than they will need, because there were fewer contacts, or these had more points.
    let needed = admitted.rows.saturating_sub(cost.reserved).max(place * FRESH_BYTES);
    let place = reserve(more, contacts, needed, of_rows, memory);
    Way { most: contacts.live() + more.contacts.min(place), floor, of_rows, shed }
}

/// Reserves memory for so many more contacts; returns for how many there is. If it does not suffice, the last
/// step's rows give up theirs down to `needed` bytes; `of_rows` stay left for more rows.
pub(super) fn reserve(
    more: ContactCount,
    contacts: &mut Contacts,
    needed: usize,
    of_rows: usize,
    memory: &mut ContactMemory<'_>,
) -> usize {
    let ContactMemory { allowances, space } = memory;
    let left = |allowances: &Allowances| {
        allowances.own(Category::Manifolds).min(allowances.whole().saturating_sub(of_rows))
    };
    let lacking = contacts.lacking(more).bytes().saturating_sub(left(allowances));
    if lacking > 0 {
        let to = space.slab.bytes(0).1.saturating_sub(lacking).max(needed);
        allowances.within(Category::Rows, |allowance| allowance.give(space.slab.spare(to)));
        space.slab.shrink(to);
    }
    let left = left(allowances);
    let mut allowance = if allowances.is_endless() { Allowance::ENDLESS } else { Allowance::new(left) };
    let place = contacts.reserve(more, &mut allowance);
    allowances.within(Category::Manifolds, |all| all.take(left - allowance.left()));
    place
}

/// The weight of a pair's contact, if it has one. Contacts with meshes have none here: they are exchanged for
/// new ones.
fn weight_of(pair: &Pair, contacts: &Contacts, input: &Input<'_>) -> Option<Weight> {
    let of_mesh = input.summaries[pair.b as usize].kind.is_ground();
    (pair.contact != NO_CONTACT && !of_mesh).then(|| input.scale.of(contacts.at(pair.contact)))
}

/// Frees the contacts that do not stay. Returns the number of points shed.
fn evict(floor: &mut Threshold, pairs: &mut [Pair], contacts: &mut Contacts, input: &Input<'_>) -> u32 {
    let mut shed = 0;
    for pair in pairs.iter_mut().filter(|pair| !pair.is_idle(input.summaries, input.dynamic)) {
        if let Some(weight) = weight_of(pair, contacts, input)
            && !floor.keeps(weight)
        {
            shed += u32::from(contacts.at(pair.contact).count);
            contacts.remove_chain(std::mem::replace(&mut pair.contact, NO_CONTACT));
        }
    }
    shed
}
