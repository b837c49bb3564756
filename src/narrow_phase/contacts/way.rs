//! Makes way for new contacts where memory is short: weighs them and the old ones, and sheds the lightest.

use super::admit::{Census, ContactMemory, Kind as Taken, with_empty};
use super::contact::NO_CONTACT;
use super::found::{FRESH_BYTES, Fresh, LEAST_ROWS};
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
    /// Without a budget all stay.
    pub(super) floor: Option<Threshold>,
    /// Bytes left for rows.
    pub(super) of_rows: usize,
    /// Points of contacts that were shed.
    pub(super) shed: u32,
}

/// Reserves slots for so many that wait for one. Under a budget weighs them and the existing contacts, and
/// sheds those that are too light for all to fit with their rows.
pub(super) fn make_way(
    waiting: usize,
    meshes: &[MeshBlock],
    pairs: &mut [Pair],
    contacts: &mut Contacts,
    input: &Input<'_>,
    memory: &mut ContactMemory<'_>,
) -> Way {
    let mut way = Way { most: 0, floor: None, of_rows: 0, shed: 0 };
    let mut needed = 0;
    if !memory.allowances.is_endless() {
        let mut census = Census::new();
        count_all(&mut census, waiting, meshes, pairs, contacts, input, memory);
        let ContactMemory { allowances, space } = &*memory;
        let reserved = space.slab.bytes(0).1 + space.cost.reserved;
        let (held, of_rows) = (contacts.capacity(), allowances.own(Category::Rows));
        let most = held.bytes().saturating_add(allowances.own(Category::Manifolds));
        let whole = allowances.whole().saturating_add(held.bytes() + reserved);
        // Memory for headers is not memory for points; and rows can't take memory from contacts that their
        // own limit denies them.
        let cut = census.cut(&|all, rows| {
            let rows = with_empty(all.contacts, rows).min(of_rows.saturating_add(reserved));
            all.max(held).bytes() <= most && all.bytes() + rows <= whole
        });
        let mut floor = cut.floor;
        way.shed = evict(&mut floor, pairs, contacts, input);
        way.floor = Some(floor);
        way.of_rows = cut.rows.saturating_sub(reserved).min(of_rows);
        // Rows have more memory than they will need, because there were fewer contacts, or these had more
        // points.
        needed = cut.rows.saturating_sub(space.cost.reserved).max(waiting * FRESH_BYTES);
    }
    let mut floor = way.floor;
    let fresh: &[Fresh] = memory.space.slab.alone(waiting);
    let more = fresh.iter().filter_map(|found| {
        let pair = &pairs[found.pair as usize];
        let bounded = floor.is_some();
        let stays = floor.as_mut().is_none_or(|floor| floor.keeps(found.weight(pair, input)));
        let points = input.room(pair, bounded).max(found.raw.count as usize);
        stays.then_some(ContactCount { contacts: 1, points })
    });
    let of_meshes = meshes.iter().map(|block| block.count_more(pairs, contacts));
    let more = more.chain(of_meshes).fold(ContactCount::default(), std::ops::Add::add);
    let place = reserve(more, contacts, needed, way.of_rows, memory);
    way.most = contacts.live() + more.contacts.min(place);
    way
}

/// Counts the existing contacts and the new ones by weight.
fn count_all(
    census: &mut Census,
    waiting: usize,
    meshes: &[MeshBlock],
    pairs: &[Pair],
    contacts: &Contacts,
    input: &Input<'_>,
    memory: &mut ContactMemory<'_>,
) {
    let space = &mut *memory.space;
    let (cost, touch) = (space.cost, input.touch_distance);
    for pair in pairs.iter().filter(|pair| !pair.is_idle(input.summaries, input.dynamic)) {
        let (is_static, weight) = (input.is_static(pair), weight_of(pair, contacts, input));
        let mut slot = pair.contact;
        while slot != NO_CONTACT {
            let contact = contacts.at(slot);
            census.add(weight, Taken::of(contact, contacts.room(slot), is_static, touch), &cost);
            slot = contact.next;
        }
    }
    for (many, pair) in meshes.iter().flat_map(|block| block.more(pairs, contacts)) {
        let taken = |raw: &RawManifold| Taken::of_new(raw, 0, input.is_static(pair), touch);
        many.iter().for_each(|found| census.add(None, taken(&found.raw), &cost));
    }
    for found in &*space.slab.alone::<Fresh>(waiting) {
        let pair = &pairs[found.pair as usize];
        let taken = Taken::of_new(&found.raw, input.room(pair, true), input.is_static(pair), touch);
        census.add(Some(found.weight(pair, input)), taken, &cost);
    }
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
        let to = space.slab.bytes(0).1.saturating_sub(lacking).max(needed).max(LEAST_ROWS);
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
