//! The store of contacts: their headers in one column, their points in another.
//!
//! A contact has a slot and a place for as many points as it has. Under a budget all places are whole, for
//! four points: what is admitted then can grow without asking for memory again.

use super::contact::{Contact, ContactMut, ContactRef, Header, NO_CONTACT, Point};
use super::manifold::MAX_POINTS;
use super::places::{Place, Places};
use crate::broad_phase::Pair;
use crate::memory::{Allowance, Buffer, add_bytes, bytes_of};
use crate::threads::Shared;

/// The header of a contact, and where its points are. Free slots are linked by [`Header::next`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) header: Header,
    pub(super) place: Place,
}

/// All contacts, with holes that are used again.
#[derive(Debug)]
pub(crate) struct Contacts {
    slots: Vec<Slot>,
    places: Places,
    /// The first free slot, or [`NO_CONTACT`].
    free: u32,
    live: usize,
    /// Every new place is for [`MAX_POINTS`].
    whole: bool,
}

impl Default for Contacts {
    fn default() -> Self {
        Contacts { slots: Vec::new(), places: Places::default(), free: NO_CONTACT, live: 0, whole: false }
    }
}

impl Contacts {
    /// Bytes of a contact with a whole place.
    const WHOLE: usize = size_of::<Slot>() + MAX_POINTS * size_of::<Point>();

    /// Bytes of a contact with so many points.
    pub(crate) const fn bytes_with(points: usize) -> usize {
        size_of::<Slot>() + points * size_of::<Point>()
    }

    /// A contact.
    #[inline(always)]
    pub(crate) fn at(&self, slot: u32) -> ContactRef<'_> {
        let Slot { header, place } = &self.slots[slot as usize];
        ContactRef::new(header, &self.places.points[place.range()])
    }

    /// A contact, to be written.
    #[inline(always)]
    pub(crate) fn at_mut(&mut self, slot: u32) -> ContactMut<'_> {
        let Slot { header, place } = &mut self.slots[slot as usize];
        ContactMut::new(header, &mut self.places.points[place.range()])
    }

    /// A contact, if the slot has one.
    pub(crate) fn get(&self, slot: usize) -> Option<ContactRef<'_>> {
        let taken = self.slots.get(slot).is_some_and(|slot| slot.place != Place::NONE);
        taken.then(|| self.at(slot as u32))
    }

    /// All contacts, for blocks of a stage that write to different ones.
    pub(crate) fn share(&mut self) -> SharedContacts<'_> {
        SharedContacts { slots: Shared::new(&mut self.slots), points: Shared::new(&mut self.places.points) }
    }

    /// Slots that a chain of contacts goes through.
    pub(crate) fn chain(&self, first: u32) -> impl Iterator<Item = ContactRef<'_>> {
        let mut slot = first;
        std::iter::from_fn(move || {
            let contact = (slot != NO_CONTACT).then(|| self.at(slot))?;
            slot = contact.next;
            Some(contact)
        })
    }

    /// Number of slots, free ones included: one more than the highest index.
    pub(crate) fn slots(&self) -> usize {
        self.slots.len()
    }

    /// The number of slots that there is memory for.
    pub(crate) fn capacity(&self) -> usize {
        self.slots.capacity()
    }

    /// Number of contacts.
    pub(crate) fn live(&self) -> usize {
        self.live
    }

    /// Slots missing for so many more contacts.
    fn lacking(&self, more: usize) -> usize {
        (self.live + more).saturating_sub(self.place().0)
    }

    /// [`Contacts::missing`] in bytes.
    pub(crate) fn missing_for(&self, more: usize) -> usize {
        self.lacking(more) * Self::WHOLE
    }

    /// For how many whole contacts there is place, and the bytes of one.
    pub(crate) fn place(&self) -> (usize, usize) {
        (self.slots.capacity().min(self.places.points.capacity() / MAX_POINTS), Self::WHOLE)
    }

    /// Reserves slots for so many more contacts, as far as memory allows; returns how many. Without a budget
    /// their points get places as they come.
    pub(crate) fn reserve(&mut self, more: usize, allowance: &mut Allowance) -> usize {
        if allowance.is_endless() {
            allowance.fit(&mut self.slots, self.live + more);
            return more;
        }
        let missing = self.lacking(more);
        if missing > 0 {
            let before = self.place().0;
            let granted = missing.min(allowance.left() / Self::WHOLE);
            let to = allowance.planned(before, before + granted, Self::WHOLE, usize::MAX);
            self.each(to, &mut |buffer, len| {
                allowance.take(buffer.missing(len));
                buffer.reserve_total(len);
            });
        }
        self.place().0 - self.live
    }

    /// Calls `f` with each buffer and the capacity that it needs for so many whole contacts.
    pub(crate) fn each(&mut self, contacts: usize, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        f(&mut self.slots, contacts);
        f(&mut self.places.points, MAX_POINTS * contacts);
    }

    /// Bytes that are lacking for so many whole contacts.
    pub(crate) fn missing(&self, contacts: usize) -> usize {
        self.slots.missing(contacts) + self.places.points.missing(MAX_POINTS * contacts)
    }

    /// Says whether the world has a budget. Contacts of a world that gets one have their places widened,
    /// whether or not the budget allows it: what it admits is counted in whole contacts.
    pub(crate) fn set_whole(&mut self, whole: bool) {
        if whole && !self.whole {
            self.widen();
        }
        self.whole = whole;
    }

    #[cold]
    fn widen(&mut self) {
        let mut points = Vec::new();
        points.reserve_exact(MAX_POINTS * self.slots.capacity());
        for slot in self.slots.iter_mut().filter(|slot| slot.place != Place::NONE) {
            let first = points.len();
            points.extend_from_slice(&self.places.points[slot.place.range()]);
            points.resize(first + MAX_POINTS, Point::default());
            slot.place = Place::new(first as u32, MAX_POINTS);
        }
        self.places.clear();
        self.places.points = points;
    }

    /// A place for so many points. Without a budget the column grows; under one there is place for as many
    /// contacts as have slots.
    fn take_place(&mut self, count: usize) -> Option<Place> {
        let count = if self.whole { MAX_POINTS } else { count };
        if let Some(place) = self.places.take(count) {
            return Some(place);
        }
        let points = self.places.points.len();
        if !self.whole {
            if self.places.spare() > points / SPARE {
                self.places.close_up(&mut self.slots);
            }
            let wanted = self.places.points.len() + count.max(1);
            let mut allowance = Allowance::ENDLESS;
            allowance.fit(&mut self.places.points, wanted);
        }
        self.places.take(count)
    }

    /// Inserts a contact; under a budget where [`Contacts::reserve`] reserved a slot. Returns its slot, or
    /// [`NO_CONTACT`].
    pub(crate) fn insert(&mut self, contact: &Contact) -> u32 {
        let is_full = self.whole && self.live >= self.place().0;
        let place = if is_full { None } else { self.take_place(contact.count.into()) };
        let Some(place) = place else { return NO_CONTACT };
        let new = Slot { header: contact.header, place };
        self.places.points[place.range()].copy_from_slice(&contact.points[..place.room()]);
        self.live += 1;
        if self.free == NO_CONTACT {
            if !self.whole {
                let (wanted, mut allowance) = (self.slots.len() + 1, Allowance::ENDLESS);
                allowance.fit(&mut self.slots, wanted);
            }
            self.slots.push(new);
            return self.slots.len() as u32 - 1;
        }
        let slot = self.free;
        self.free = std::mem::replace(&mut self.slots[slot as usize], new).header.next;
        slot
    }

    /// [`Contacts::insert`] while there are fewer than so many.
    pub(crate) fn insert_within(&mut self, contact: &Contact, most: usize) -> u32 {
        if self.live < most { self.insert(contact) } else { NO_CONTACT }
    }

    /// Gives a contact a place for so many points, if its own is smaller. Its points stay.
    pub(crate) fn grow(&mut self, slot: u32, count: usize) {
        let room = self.slots[slot as usize].place.room();
        if room >= count {
            return;
        }
        let Some(place) = self.take_place(count) else { return };
        // Its own place may have been moved.
        let own = std::mem::replace(&mut self.slots[slot as usize].place, place);
        self.places.points.copy_within(own.range(), place.range().start);
        self.places.give(own);
    }

    /// Calls `f` with each contact of these pairs, in their order.
    pub(crate) fn for_each_of<'p>(
        &mut self,
        pairs: impl IntoIterator<Item = &'p Pair>,
        mut f: impl FnMut(&Pair, &mut ContactMut<'_>),
    ) {
        for pair in pairs {
            let mut slot = pair.contact;
            while slot != NO_CONTACT {
                let mut contact = self.at_mut(slot);
                f(pair, &mut contact);
                slot = contact.next;
            }
        }
    }

    /// Frees a contact and all that follow it.
    pub(crate) fn remove_chain(&mut self, mut slot: u32) {
        while slot != NO_CONTACT {
            let Slot { header, place } = &mut self.slots[slot as usize];
            header.count = 0;
            let next = std::mem::replace(&mut header.next, self.free);
            self.places.give(std::mem::replace(place, Place::NONE));
            self.free = slot;
            self.live -= 1;
            slot = next;
        }
    }

    /// Removes all contacts and reserves slots for so many; `whole`: under a budget.
    pub(crate) fn reset(&mut self, contacts: usize, whole: bool) {
        self.whole = whole;
        self.slots.clear();
        self.places.clear();
        (self.free, self.live) = (NO_CONTACT, 0);
        if self.whole {
            self.each(contacts, &mut |buffer, len| buffer.reserve_total(len));
        } else {
            self.slots.reserve_total(contacts);
        }
    }

    /// How many contacts a chain has.
    pub(crate) fn count(&self, slot: u32) -> usize {
        self.chain(slot).count()
    }

    /// How many contacts of a chain pushed in the last step.
    pub(crate) fn count_pushed(&self, slot: u32) -> u32 {
        self.chain(slot).map(|contact| u32::from(contact.pushed)).sum()
    }

    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let live = self.live * size_of::<Slot>() + self.places.used() * size_of::<Point>();
        (live, add_bytes(bytes_of(&self.slots), bytes_of(&self.places.points)).1)
    }
}

/// Once more than this part of the column is spare, places are moved together rather than that it grows. With
/// a smaller part, moving them would cost more than the places that it makes.
const SPARE: usize = 8;

/// All contacts, for blocks of a stage that write to different ones.
pub(crate) struct SharedContacts<'a> {
    slots: Shared<'a, Slot>,
    points: Shared<'a, Point>,
}

impl SharedContacts<'_> {
    /// A contact, to be written. Panics if there is none.
    ///
    /// # Safety
    /// Until the stage is over no other thread may ask for the same contact, and this one may hold it only
    /// once.
    #[inline(always)]
    pub(crate) unsafe fn at(&self, slot: u32) -> ContactMut<'_> {
        // SAFETY: by the contract; contacts have different places.
        unsafe {
            let Slot { header, place } = self.slots.get(slot as usize);
            ContactMut::new(header, self.points.part(place.range()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::narrow_phase::contacts::contact::FoundAt;
    use crate::narrow_phase::{RawManifold, Relative};
    use crate::random::Random;
    use glam::{Quat, Vec3};
    use std::collections::BTreeMap;

    const AT: FoundAt = FoundAt {
        pose: Relative { position: Vec3::ZERO, rotation: Quat::IDENTITY },
        frame: Quat::IDENTITY,
        fraction: 0.0,
    };

    /// A contact of shapes and keys that no other one has.
    fn contact(id: u32, points: usize) -> Contact {
        let mut raw = RawManifold { normal: Vec3::Y, count: points as u32, ..RawManifold::default() };
        for (point, k) in raw.points.iter_mut().zip(0..) {
            point.key = 10 * id + k;
        }
        let mut contact = Contact::found(id, id + 1, &raw, AT);
        contact.as_mut().points_mut().iter_mut().for_each(|point| point.impulse = point.key as f32);
        contact
    }

    /// What is seen of a contact: its shapes, its loads, and the keys and impulses of its points.
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
            assert!(!store.whole || store.slots[slot as usize].place.room() == MAX_POINTS);
        }
        let (live, reserved) = store.bytes();
        assert!(live <= reserved);
    }

    /// The naive store that the other is compared with: contacts by slot, and the slots that are free, of which
    /// the last that became free is taken next.
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

    /// A manifold of so many points, which may be more or fewer than there were.
    fn renew(store: &mut Contacts, slot: u32, new: &Contact) {
        let before = seen(store.at(slot));
        store.grow(slot, new.count.into());
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
                            if store.whole { Allowance::new(1 << 20) } else { Allowance::ENDLESS };
                        store.reserve(1, &mut allowance);
                        assert_eq!(store.insert(&new), model.insert(new));
                    }
                    7..12 => {
                        let Some(slot) = model.pick(&mut random) else { continue };
                        store.remove_chain(slot);
                        model.contacts.remove(&slot);
                        model.free.push(slot);
                        assert!(store.get(slot as usize).is_none());
                    }
                    12..19 => {
                        let Some(slot) = model.pick(&mut random) else { continue };
                        renew(&mut store, slot, &new);
                        model.contacts.insert(slot, new);
                    }
                    _ => store.set_whole(random.below(3) == 0),
                }
                check(&store, &model.contacts);
            }
        }
    }

    #[test]
    fn what_is_held_does_not_depend_on_the_order_of_sizes() {
        let mut store = Contacts::default();
        let mut slots: Vec<u32> = (0..64).map(|id| store.insert(&contact(id, 4))).collect();
        let most = store.bytes().1;
        for round in 0..200 {
            // Never more points than at first, in places of all sizes.
            let points = 1 + round % MAX_POINTS;
            slots.drain(..).for_each(|slot| store.remove_chain(slot));
            slots = (0..64).map(|id| store.insert(&contact(id, points))).collect();
            let slot = slots[round % 64];
            renew(&mut store, slot, &contact(900, MAX_POINTS));
            assert!(store.bytes().1 <= most, "{round}: {} {most}", store.bytes().1);
        }
    }

    #[test]
    fn a_chain_is_removed_as_a_whole_and_its_slots_are_taken_last_first() {
        let mut store = Contacts::default();
        let slots: Vec<u32> = (0..3).map(|id| store.insert(&contact(id, 2))).collect();
        store.at_mut(slots[0]).next = slots[1];
        store.at_mut(slots[1]).next = slots[2];
        assert_eq!((store.count(slots[0]), store.live()), (3, 3));
        store.remove_chain(slots[0]);
        assert_eq!(store.live(), 0);
        let again: Vec<u32> = (0..3).map(|id| store.insert(&contact(id, 2))).collect();
        assert_eq!(again, [2, 1, 0]);
        assert_eq!(store.places.points.len(), 6);
    }

    #[test]
    fn under_a_budget_as_many_are_admitted_as_are_whole_in_what_is_left() {
        let mut store = Contacts::default();
        store.set_whole(true);
        let mut allowance = Allowance::new(10 * Contacts::WHOLE + 7);
        assert_eq!(store.reserve(20, &mut allowance), 10);
        assert_eq!((allowance.left(), store.bytes().1), (7, 10 * Contacts::WHOLE));
        let slots: Vec<u32> = (0..10).map(|id| store.insert(&contact(id, 1))).collect();
        assert_eq!(store.insert(&contact(10, 1)), NO_CONTACT);
        // Each may get all its points now, without asking for memory.
        slots.iter().for_each(|&slot| store.grow(slot, MAX_POINTS));
        assert!(slots.iter().all(|&slot| store.at_mut(slot).room() == MAX_POINTS));
        assert_eq!(store.bytes().1, 10 * Contacts::WHOLE);
        store.remove_chain(slots[3]);
        assert_eq!(store.insert(&contact(11, 4)), slots[3]);
    }
}
