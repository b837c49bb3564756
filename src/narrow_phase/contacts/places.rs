//! The column of contact points, in places of one to four: as many as a contact has.
//!
//! Free places are linked through the keys of their first points, a list for each size. A place that is taken
//! from a larger one leaves the rest as a smaller one. Where no free place is large enough although there
//! would be points enough in all, places are moved together; so the memory held follows from the points in
//! use, never from the order in which places came and went.

use super::contact::Point;
use super::manifold::MAX_POINTS;
use super::store::Slot;

/// A place in the column: its first point and for how many it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place(u32);

impl Place {
    /// None: of a slot without a contact.
    pub(crate) const NONE: Place = Place(u32::MAX);

    pub(super) fn new(first: u32, room: usize) -> Place {
        Place(first << 2 | (room as u32 - 1))
    }

    /// For how many points there is place.
    #[inline(always)]
    pub(crate) fn room(self) -> usize {
        (self.0 & 3) as usize + 1
    }

    /// The indices of its points.
    #[inline(always)]
    pub(crate) fn range(self) -> std::ops::Range<usize> {
        let first = (self.0 >> 2) as usize;
        first..first + self.room()
    }
}

/// No further free place of a size.
const NOWHERE: u32 = u32::MAX;
/// The key of a place's first point while places are moved together: this bit and the number of points of a
/// free one, or the contact's slot and, from the other bit on, one less than that number.
const FREE: u32 = 1 << 31;
const ROOM: u32 = 28;

/// The points of all contacts.
#[derive(Debug)]
pub(crate) struct Places {
    pub(super) points: Vec<Point>,
    /// The first free place for one point, two, three and four.
    free: [u32; MAX_POINTS],
    /// Points in free places.
    spare: usize,
}

impl Default for Places {
    fn default() -> Self {
        Places { points: Vec::new(), free: [NOWHERE; MAX_POINTS], spare: 0 }
    }
}

impl Places {
    /// Points in places that contacts have.
    pub(super) fn used(&self) -> usize {
        self.points.len() - self.spare
    }

    /// Points in free places.
    pub(super) fn spare(&self) -> usize {
        self.spare
    }

    /// Takes a place for so many points, if there is one without growing the column.
    pub(super) fn take(&mut self, count: usize) -> Option<Place> {
        let size = (count.max(1)..=MAX_POINTS).find(|size| self.free[size - 1] != NOWHERE);
        if let Some(size) = size {
            let first = self.free[size - 1];
            self.free[size - 1] = self.points[first as usize].key;
            self.spare -= size;
            let place = Place::new(first, count.max(1));
            if size > place.room() {
                self.give(Place::new(first + place.room() as u32, size - place.room()));
            }
            return Some(place);
        }
        let (len, room) = (self.points.len(), count.max(1));
        if len + room > self.points.capacity() {
            return None;
        }
        self.points.resize(len + room, Point::default());
        Some(Place::new(len as u32, room))
    }

    /// Frees a place.
    pub(super) fn give(&mut self, place: Place) {
        let (range, size) = (place.range(), place.room());
        self.points[range.start].key = self.free[size - 1];
        self.free[size - 1] = range.start as u32;
        self.spare += size;
    }

    /// Moves the places of all contacts together, in their order, and leaves none spare. Room beyond the
    /// points of a contact is given up, unless rooms are kept.
    pub(super) fn close_up(&mut self, slots: &mut [Slot], keep_rooms: bool) {
        for (list, size) in self.free.iter_mut().zip(1u32..) {
            while *list != NOWHERE {
                let key = &mut self.points[*list as usize].key;
                *list = std::mem::replace(key, FREE | size);
            }
        }
        // Each place says whose it is, in a key that its contact's slot keeps meanwhile.
        for (index, slot) in (0u32..).zip(&mut *slots).filter(|(_, slot)| slot.place != Place::NONE) {
            let owner = index | (slot.place.room() as u32 - 1) << ROOM;
            slot.place.0 = std::mem::replace(&mut self.points[slot.place.range().start].key, owner);
        }
        let (mut from, mut to) = (0, 0);
        while from < self.points.len() {
            let owner = self.points[from].key;
            if owner & FREE != 0 {
                from += (owner ^ FREE) as usize;
                continue;
            }
            let room = (owner >> ROOM) as usize + 1;
            let slot = &mut slots[(owner & ((1 << ROOM) - 1)) as usize];
            let stay = if keep_rooms { room } else { usize::from(slot.header.count).clamp(1, room) };
            self.points[from].key = slot.place.0;
            self.points.copy_within(from..from + stay, to);
            slot.place = Place::new(to as u32, stay);
            (from, to) = (from + room, to + stay);
        }
        self.points.truncate(to);
        self.spare = 0;
    }

    /// All free places, by size.
    #[cfg(test)]
    pub(super) fn free_places(&self) -> Vec<Place> {
        let mut places = Vec::new();
        for (&first, room) in self.free.iter().zip(1..) {
            let mut next = first;
            while next != NOWHERE {
                places.push(Place::new(next, room));
                next = self.points[next as usize].key;
            }
        }
        places
    }

    pub(super) fn clear(&mut self) {
        self.points.clear();
        (self.free, self.spare) = ([NOWHERE; MAX_POINTS], 0);
    }
}
