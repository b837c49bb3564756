//! The store of contacts: their headers in one column, their points in another.
//!
//! A contact has a slot and a place for as many points as it has.

use super::contact::{Contact, ContactMut, ContactRef, Header, NO_CONTACT, Point};
use super::places::{Place, Places};
use crate::broad_phase::Pair;
use crate::memory::{Allowance, Buffer, add_bytes, bytes_of};
use crate::threads::Shared;
use glam::Vec3;

/// The header of a contact, and where its points are. Free slots are linked by [`Header::next`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) header: Header,
    pub(super) place: Place,
}

/// A number of contacts, and of points of all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ContactCount {
    pub(crate) contacts: usize,
    pub(crate) points: usize,
}

impl ContactCount {
    pub(crate) fn bytes(self) -> usize {
        self.contacts * size_of::<Slot>() + self.points * size_of::<Point>()
    }

    /// The least that is enough for both.
    pub(crate) fn max(self, other: ContactCount) -> ContactCount {
        ContactCount { contacts: self.contacts.max(other.contacts), points: self.points.max(other.points) }
    }

    /// The difference to another count.
    fn without(self, other: ContactCount) -> ContactCount {
        ContactCount {
            contacts: self.contacts.saturating_sub(other.contacts),
            points: self.points.saturating_sub(other.points),
        }
    }
}

impl std::ops::Add for ContactCount {
    type Output = ContactCount;
    fn add(self, other: ContactCount) -> ContactCount {
        ContactCount { contacts: self.contacts + other.contacts, points: self.points + other.points }
    }
}

/// All contacts, with holes that are used again.
#[derive(Debug)]
pub(crate) struct Contacts {
    slots: Vec<Slot>,
    places: Places,
    /// The first free slot, or [`NO_CONTACT`].
    free: u32,
    live: usize,
    /// Places keep their size when they are moved together.
    keeps_rooms: bool,
    /// Angular impulse of each slot against rolling, on its shape `b`, in the world [N m s]; as far as the
    /// column goes, and empty while no shape resists rolling.
    rolling: Vec<Vec3>,
}

impl Default for Contacts {
    fn default() -> Self {
        Contacts {
            slots: Vec::new(),
            places: Places::default(),
            free: NO_CONTACT,
            live: 0,
            keeps_rooms: false,
            rolling: Vec::new(),
        }
    }
}

impl Contacts {
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
        SharedContacts {
            slots: Shared::new(&mut self.slots),
            points: Shared::new(&mut self.places.points),
            rolling: Shared::new(&mut self.rolling),
        }
    }

    /// The contacts of a chain, each with its slot.
    #[inline(always)]
    pub(crate) fn chain(&self, first: u32) -> impl Iterator<Item = (u32, ContactRef<'_>)> {
        let mut next = first;
        std::iter::from_fn(move || {
            let slot = next;
            let contact = (slot != NO_CONTACT).then(|| self.at(slot))?;
            next = contact.next;
            Some((slot, contact))
        })
    }

    /// Number of slots, free ones included: one more than the highest index.
    pub(crate) fn slots(&self) -> usize {
        self.slots.len()
    }

    /// Says whether contacts keep the places that they have, even if they have fewer points now.
    pub(crate) fn keep_rooms(&mut self, keep: bool) {
        self.keeps_rooms = keep;
    }

    /// Number of contacts.
    pub(crate) fn live(&self) -> usize {
        self.live
    }

    /// For how many there is memory.
    pub(crate) fn capacity(&self) -> ContactCount {
        ContactCount { contacts: self.slots.capacity(), points: self.places.points.capacity() }
    }

    /// The missing room for so many more.
    pub(crate) fn lacking(&mut self, more: ContactCount) -> ContactCount {
        let wanted = |all: &Self| ContactCount { contacts: all.live, points: all.places.used() } + more;
        if wanted(self).points > self.places.points.capacity() {
            self.places.close_up(&mut self.slots, self.keeps_rooms);
        }
        wanted(self).without(self.capacity())
    }

    /// Reserves memory for so many more, as far as it suffices; returns for how many contacts.
    pub(crate) fn reserve(&mut self, more: ContactCount, allowance: &mut Allowance) -> usize {
        // Without a budget a part stays spare, so that places need not be moved together for every few.
        let spare = if allowance.is_endless() { self.places.used() / SPARE } else { 0 };
        let lacking = self.lacking(ContactCount { points: more.points + spare, ..more });
        if lacking != ContactCount::default() {
            let (bytes, left) = (lacking.bytes(), allowance.left());
            let part = |n: usize| {
                if bytes <= left { n } else { (n as u128 * left as u128 / bytes as u128) as usize }
            };
            let granted = ContactCount { contacts: part(lacking.contacts), points: part(lacking.points) };
            let to = self.capacity() + granted;
            if bytes <= left / 2 {
                allowance.fit(&mut self.slots, to.contacts);
                allowance.fit(&mut self.places.points, to.points);
            } else {
                self.each(to, &mut |buffer, len| {
                    allowance.take(buffer.missing(len));
                    buffer.reserve_total(len);
                });
            }
        }
        self.slots.capacity() - self.live
    }

    /// Calls `f` with each buffer and the capacity that it needs for so many.
    pub(crate) fn each(&mut self, all: ContactCount, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        f(&mut self.slots, all.contacts);
        f(&mut self.places.points, all.points);
    }

    /// Bytes that are lacking for so many.
    pub(crate) fn missing(&self, all: ContactCount) -> usize {
        self.slots.missing(all.contacts) + self.places.points.missing(all.points)
    }

    /// A place for so many points, if there are as many spare.
    fn take_place(&mut self, count: usize) -> Option<Place> {
        self.places.take(count).or_else(|| {
            if self.places.spare() == 0 {
                return None;
            }
            self.places.close_up(&mut self.slots, self.keeps_rooms);
            self.places.take(count)
        })
    }

    /// Inserts a contact, with place for at least `room` points, where [`Contacts::reserve`] reserved memory.
    /// Returns its slot, or [`NO_CONTACT`].
    pub(crate) fn insert(&mut self, contact: &Contact, room: usize) -> u32 {
        let room = room.max(contact.count.into());
        let is_full = self.live == self.slots.capacity();
        let place = if is_full { None } else { self.take_place(room) };
        let Some(place) = place else { return NO_CONTACT };
        let new = Slot { header: contact.header, place };
        self.places.points[place.range()].copy_from_slice(&contact.points[..place.room()]);
        self.live += 1;
        if self.free == NO_CONTACT {
            self.slots.push(new);
            return self.slots.len() as u32 - 1;
        }
        let slot = self.free;
        if let Some(rolling) = self.rolling.get_mut(slot as usize) {
            *rolling = Vec3::ZERO;
        }
        self.free = std::mem::replace(&mut self.slots[slot as usize], new).header.next;
        slot
    }

    /// [`Contacts::insert`] while there are fewer than so many.
    pub(crate) fn insert_within(&mut self, contact: &Contact, room: usize, most: usize) -> u32 {
        if self.live < most { self.insert(contact, room) } else { NO_CONTACT }
    }

    /// Gives a contact a place for so many points, or as many as there are spare, if its own is smaller.
    /// Returns for how many it has place. Its points stay.
    pub(crate) fn grow(&mut self, slot: u32, count: usize) -> usize {
        let own = self.slots[slot as usize].place;
        if own.room() >= count {
            return own.room();
        }
        let points = self.at(slot).to_owned().points;
        self.places.give(std::mem::replace(&mut self.slots[slot as usize].place, Place::NONE));
        // At least its own place is free now.
        let place = (own.room()..=count).rev().find_map(|count| self.take_place(count)).unwrap_or(own);
        self.places.points[place.range()].copy_from_slice(&points[..place.room()]);
        self.slots[slot as usize].place = place;
        place.room()
    }

    /// For how many points a contact has place.
    pub(crate) fn room(&self, slot: u32) -> usize {
        self.slots[slot as usize].place.room()
    }

    /// The same once places were moved together, which gives up room beyond the points in them.
    pub(crate) fn least_room(&self, slot: u32) -> usize {
        let Slot { header, place } = &self.slots[slot as usize];
        if self.keeps_rooms { place.room() } else { usize::from(header.count).clamp(1, place.room()) }
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

    /// Frees the contacts of a chain that have no points; returns the first of those that are left.
    pub(crate) fn remove_empty(&mut self, first: u32) -> u32 {
        let (mut slot, mut left, mut last) = (first, NO_CONTACT, NO_CONTACT);
        while slot != NO_CONTACT {
            let Header { next, count, .. } = self.slots[slot as usize].header;
            if count == 0 {
                self.slots[slot as usize].header.next = NO_CONTACT;
                self.remove_chain(slot);
            } else if last == NO_CONTACT {
                (left, last) = (slot, slot);
            } else {
                self.slots[last as usize].header.next = slot;
                last = slot;
            }
            slot = next;
        }
        if last != NO_CONTACT {
            self.slots[last as usize].header.next = NO_CONTACT;
        }
        left
    }

    /// Removes all contacts.
    pub(crate) fn clear(&mut self) {
        self.slots.clear();
        self.places.clear();
        self.rolling.clear();
        (self.free, self.live) = (NO_CONTACT, 0);
    }

    /// Inserts a contact of a snapshot, for which memory was reserved if there is a budget. Returns its slot.
    pub(crate) fn restore(&mut self, contact: &Contact, room: usize) -> u32 {
        match self.insert(contact, room) {
            NO_CONTACT => {
                let one = ContactCount { contacts: 1, points: room.max(contact.count.max(1).into()) };
                self.reserve(one, &mut { Allowance::ENDLESS });
                self.insert(contact, room)
            }
            slot => slot,
        }
    }

    /// The angular impulse against rolling of a contact: see [`Contacts::rolling`].
    pub(crate) fn rolling(&self, slot: u32) -> Vec3 {
        self.rolling.get(slot as usize).copied().unwrap_or_default()
    }

    /// The sum of them over a chain.
    pub(crate) fn rolling_of_chain(&self, first: u32) -> Vec3 {
        if self.rolling.is_empty() {
            return Vec3::ZERO;
        }
        self.chain(first).fold(Vec3::ZERO, |sum, (slot, _)| sum + self.rolling(slot))
    }

    /// Sets that of a contact; `allowance`: for the column.
    pub(crate) fn set_rolling(&mut self, slot: u32, rolling: Vec3, allowance: &mut Allowance) {
        // By bits: a zero may have a sign.
        if rolling.to_array().map(f32::to_bits) != [0; 3] {
            self.fit_rolling(allowance);
        }
        if let Some(own) = self.rolling.get_mut(slot as usize) {
            *own = rolling;
        }
    }

    /// Makes the column of rolling as long as there are slots, as far as memory allows: contacts beyond it
    /// start every step without an impulse.
    pub(crate) fn fit_rolling(&mut self, allowance: &mut Allowance) {
        let len = self.slots.len();
        if self.rolling.len() < len {
            let granted = allowance.fit(&mut self.rolling, len);
            self.rolling.resize(granted, Vec3::ZERO);
        }
    }

    /// Impulses against rolling are gone; their memory stays.
    pub(crate) fn clear_rolling(&mut self) {
        self.rolling.clear();
    }

    /// No shape resists rolling any more.
    pub(crate) fn forget_rolling(&mut self) {
        self.rolling = Vec::new();
    }

    /// Live and reserved bytes of the column of rolling.
    pub(crate) fn rolling_bytes(&self) -> (usize, usize) {
        bytes_of(&self.rolling)
    }

    /// The column of rolling, to be reserved.
    pub(crate) fn rolling_buffer(&mut self) -> &mut dyn Buffer {
        &mut self.rolling
    }

    /// How many contacts a chain has.
    pub(crate) fn count(&self, slot: u32) -> usize {
        self.chain(slot).count()
    }

    /// How many contacts of a chain pushed in the last step.
    pub(crate) fn count_pushed(&self, slot: u32) -> u32 {
        self.chain(slot).map(|(_, contact)| u32::from(contact.pushed)).sum()
    }

    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let live = self.live * size_of::<Slot>() + self.places.used() * size_of::<Point>();
        let of_contacts = add_bytes(bytes_of(&self.slots), bytes_of(&self.places.points)).1;
        let rolling = self.rolling_bytes();
        (live + rolling.0, of_contacts + rolling.1)
    }
}

/// The part of the points in use that stays spare without a budget.
const SPARE: usize = 16;

/// All contacts, for blocks of a stage that write to different ones.
pub(crate) struct SharedContacts<'a> {
    slots: Shared<'a, Slot>,
    points: Shared<'a, Point>,
    rolling: Shared<'a, Vec3>,
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

    /// The angular impulse of a contact against rolling, to be written; `None` beyond the column.
    ///
    /// # Safety
    /// As for [`SharedContacts::at`].
    #[allow(clippy::mut_from_ref, reason = "the contract is the caller's, see `Shared::get`")]
    pub(crate) unsafe fn rolling(&self, slot: u32) -> Option<&mut Vec3> {
        // SAFETY: by the contract; contacts have different entries.
        unsafe { self.rolling.find(slot as usize) }
    }
}

#[cfg(test)]
mod tests;
