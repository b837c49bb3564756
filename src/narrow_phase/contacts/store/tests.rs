use super::*;
use crate::math::Quat;
use crate::narrow_phase::contacts::contact::FoundAt;
use crate::narrow_phase::{MAX_POINTS, RawManifold, Relative};
use crate::random::Random;
use glam::Vec3;
use std::collections::BTreeMap;

const AT: FoundAt = FoundAt {
    pose: Relative { position: Vec3::ZERO, rotation: Quat::IDENTITY },
    frame: Quat::IDENTITY,
    fraction: 0.0,
};

/// A contact of shapes and keys that no other one has.
fn contact(id: u32, points: usize) -> Contact {
    let mut raw = RawManifold { normal: Vec3::Y, count: points as u16, ..RawManifold::default() };
    for (point, k) in raw.points.iter_mut().zip(0..) {
        point.key = 10 * id + k;
    }
    let mut contact = Contact::found(id, id + 1, &raw, AT);
    contact.as_mut().points_mut().iter_mut().for_each(|point| point.impulse = point.key as f32);
    contact
}

/// The visible state of a contact: its shapes, its loads, and the keys and impulses of its points.
fn seen(contact: ContactRef<'_>) -> (u32, f32, Vec<(u32, f32)>) {
    let points = contact.points().iter().map(|point| (point.key, point.impulse)).collect();
    (contact.a, contact.twist, points)
}

/// Checks that every point is in one place, of a contact or a free one, and that the counts are right.
fn check(store: &Contacts, model: &BTreeMap<u32, Contact>) {
    let of_contacts = store.slots.iter().map(|slot| slot.place).filter(|place| *place != Place::NONE);
    let mut places: Vec<Place> = of_contacts.chain(store.places.free_places()).collect();
    places.sort_by_key(|place| place.range().start);
    let end = places.iter().fold(0, |end, place| {
        assert_eq!(place.range().start, end);
        place.range().end
    });
    assert_eq!(end, store.places.points.len());
    let spare: usize = store.places.free_places().iter().map(|place| place.room()).sum();
    assert_eq!((store.places.spare(), store.live()), (spare, model.len()));
    for (&slot, contact) in model {
        assert_eq!(seen(store.at(slot)), seen(contact.as_ref()));
    }
    let (live, reserved) = store.bytes();
    assert!(live <= reserved);
}

/// The naive store that the other is compared with: contacts by slot, and the slots that are free, of
/// which the last that became free is taken next.
#[derive(Default)]
struct Model {
    contacts: BTreeMap<u32, Contact>,
    free: Vec<u32>,
    slots: u32,
}

impl Model {
    fn pick(&self, random: &mut Random) -> Option<u32> {
        let count = self.contacts.len();
        (count > 0).then(|| *self.contacts.keys().nth(random.below(count)).unwrap())
    }

    fn insert(&mut self, contact: Contact) -> u32 {
        let slot = self.free.pop().unwrap_or(self.slots);
        self.slots = self.slots.max(slot + 1);
        self.contacts.insert(slot, contact);
        slot
    }
}

fn size_of(contact: &Contact) -> ContactCount {
    ContactCount { contacts: 1, points: contact.count.into() }
}

/// Inserts a contact, with memory without end.
fn add(store: &mut Contacts, contact: &Contact) -> u32 {
    store.reserve(size_of(contact), &mut { Allowance::ENDLESS });
    store.insert(contact, 0)
}

/// Gives a contact the points of another, which may be more or fewer than it had.
fn renew(store: &mut Contacts, slot: u32, new: &Contact) {
    let before = seen(store.at(slot));
    assert!(store.grow(slot, new.count.into()) >= new.count.into());
    assert_eq!(seen(store.at(slot)), before);
    let mut own = store.at_mut(slot);
    (own.a, own.count, own.twist) = (new.a, new.count, new.twist);
    own.points_mut().copy_from_slice(new.as_ref().points());
}

#[test]
fn contacts_keep_what_they_have_while_places_come_grow_and_go() {
    for seed in 0..if cfg!(miri) { 2 } else { 100 } {
        let (mut random, mut store, mut model) = (Random(seed), Contacts::default(), Model::default());
        for id in 0..300 {
            let mut new = contact(id, 1 + random.below(MAX_POINTS));
            new.twist = random.unit();
            match random.below(20) {
                0..7 => {
                    let mut allowance =
                        if id % 2 == 0 { Allowance::new(1 << 20) } else { Allowance::ENDLESS };
                    store.reserve(size_of(&new), &mut allowance);
                    assert_eq!(store.insert(&new, 0), model.insert(new));
                }
                7..12 => {
                    let Some(slot) = model.pick(&mut random) else { continue };
                    store.remove_chain(slot);
                    model.contacts.remove(&slot);
                    model.free.push(slot);
                    assert!(store.get(slot as usize).is_none());
                }
                _ => {
                    let Some(slot) = model.pick(&mut random) else { continue };
                    store.reserve(ContactCount { contacts: 0, ..size_of(&new) }, &mut { Allowance::ENDLESS });
                    renew(&mut store, slot, &new);
                    model.contacts.insert(slot, new);
                }
            }
            check(&store, &model.contacts);
        }
    }
}

#[test]
fn what_is_held_does_not_depend_on_the_order_of_sizes() {
    let mut store = Contacts::default();
    let mut slots: Vec<u32> = (0..64).map(|id| add(&mut store, &contact(id, 4))).collect();
    let most = store.bytes().1;
    for round in 0..200 {
        // Never more points than at first, in places of all sizes.
        let points = 1 + round % MAX_POINTS;
        slots.drain(..).for_each(|slot| store.remove_chain(slot));
        slots = (0..64).map(|id| add(&mut store, &contact(id, points))).collect();
        if points < MAX_POINTS {
            renew(&mut store, slots[round % 64], &contact(900, MAX_POINTS));
        }
        assert!(store.bytes().1 <= most, "{round}: {} {most}", store.bytes().1);
    }
}

#[test]
fn a_chain_is_removed_as_a_whole_and_its_slots_are_taken_last_first() {
    let mut store = Contacts::default();
    let slots: Vec<u32> = (0..3).map(|id| add(&mut store, &contact(id, 2))).collect();
    store.at_mut(slots[0]).next = slots[1];
    store.at_mut(slots[1]).next = slots[2];
    assert_eq!((store.count(slots[0]), store.live()), (3, 3));
    store.remove_chain(slots[0]);
    assert_eq!(store.live(), 0);
    let again: Vec<u32> = (0..3).map(|id| store.insert(&contact(id, 2), 0)).collect();
    assert_eq!(again, [2, 1, 0]);
    assert_eq!(store.places.points.len(), 6);
}

/// Expected: of each chain of up to four contacts, those that have points are left, in their order.
#[test]
fn contacts_without_points_leave_a_chain() {
    for pattern in 1_u32..16 {
        let count = 32 - pattern.leading_zeros();
        let mut store = Contacts::default();
        let slots: Vec<u32> = (0..count).map(|id| add(&mut store, &contact(id, 2))).collect();
        slots.windows(2).for_each(|pair| store.at_mut(pair[0]).next = pair[1]);
        let has = |k: u32| pattern >> k & 1 == 1;
        (0..count).filter(|&k| !has(k)).for_each(|k| store.at_mut(slots[k as usize]).empty());
        let mut left = store.remove_empty(slots[0]);
        assert_eq!(store.live(), pattern.count_ones() as usize, "{pattern:b}");
        for k in (0..count).filter(|&k| has(k)) {
            assert_eq!(seen(store.at(left)), seen(contact(k, 2).as_ref()), "{pattern:b}");
            left = store.at(left).next;
        }
        assert_eq!(left, NO_CONTACT, "{pattern:b}");
    }
}

#[test]
fn under_a_budget_nothing_is_reserved_beyond_it_and_what_finds_no_place_keeps_its_points() {
    let (mut store, one) = (Contacts::default(), ContactCount { contacts: 1, points: 1 });
    let mut allowance = Allowance::new(10 * one.bytes() + 7);
    let twenty = ContactCount { contacts: 20, points: 20 };
    assert_eq!(store.reserve(twenty, &mut allowance), 10);
    assert_eq!((allowance.left(), store.bytes().1), (7, 10 * one.bytes()));
    let slots: Vec<u32> = (0..10).map(|id| store.insert(&contact(id, 1), 0)).collect();
    assert_eq!(store.insert(&contact(10, 1), 0), NO_CONTACT);
    assert_eq!(store.grow(slots[0], MAX_POINTS), 1);
    // Places that others give up are theirs.
    slots[2..4].iter().for_each(|&slot| store.remove_chain(slot));
    assert_eq!(store.grow(slots[0], MAX_POINTS), 3);
    assert_eq!(store.insert(&contact(11, 1), 0), NO_CONTACT);
    assert_eq!((store.live(), store.bytes().1), (8, 10 * one.bytes()));
    assert_eq!(seen(store.at(slots[0])), seen(contact(0, 1).as_ref()));
}
