//! Which contacts there is memory for, together with their rows.
//!
//! A contact without rows pushes nothing. If contacts took all the memory there is, rows, which come after
//! them, would find none. So under a budget contacts are admitted only with the memory of their rows. If that
//! is too much for all, old and new ones compete, and the lightest are shed ([`Weight`]): a contact that is
//! found late may be the one that bears a pile.

use super::contact::ContactRef;
use super::manifold::RawManifold;
use super::store::ContactCount;
use super::weight::{Threshold, Weight};
use crate::memory::{Allowances, Slab};

/// Bytes that the rows of a contact take, and bytes reserved for them.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RowCost {
    /// Bytes of a lane of a full batch with its friction: for two movable bodies and for one, touching or
    /// not, and by the number of points.
    pub(crate) lanes: [[[usize; 4]; 2]; 2],
    /// Bytes in lists that have an entry for each contact, or each point.
    pub(crate) lists: usize,
    /// Bytes in such lists and in buffers of rows, without the one that is lent.
    pub(crate) reserved: usize,
    /// Each point has rows of its own.
    pub(crate) per_point: bool,
}

/// The rows of the last step, whose memory contacts may use until this step's rows are made.
pub(crate) struct RowSpace {
    pub(crate) cost: RowCost,
    pub(crate) slab: Slab,
}

/// Memory that the contacts of a step and their rows may take.
pub(crate) struct ContactMemory<'a> {
    /// Bytes that each category may still grow by.
    pub(crate) allowances: &'a mut Allowances,
    /// The rows of the last step, which lend theirs.
    pub(crate) space: &'a mut RowSpace,
}

/// Quantities that determine the memory of a contact's rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kind {
    pub(crate) is_static: bool,
    /// The contact does not touch yet.
    pub(crate) potential: bool,
    pub(crate) points: usize,
    /// For how many points it has place.
    pub(crate) room: usize,
    /// The points that the contact can't do without.
    pub(crate) needed: usize,
}

impl Kind {
    pub(crate) fn of(contact: ContactRef<'_>, room: usize, is_static: bool, real: f32) -> Kind {
        let needed = contact.needed().count_ones() as usize;
        let potential = contact.points().iter().all(|p| p.separation > real);
        Kind { is_static, potential, points: contact.count as usize, room, needed }
    }

    pub(crate) fn of_new(raw: &RawManifold, room: usize, is_static: bool, real: f32) -> Kind {
        let within = |most: f32| raw.points().iter().filter(|p| p.separation <= most).count();
        Kind {
            is_static,
            potential: within(real) == 0,
            points: raw.count as usize,
            room: room.max(raw.count as usize),
            needed: within(0.0).max(1),
        }
    }
}

impl RowCost {
    fn of(&self, kind: Kind, points: usize) -> usize {
        let lanes = &self.lanes[usize::from(kind.is_static)][usize::from(kind.potential)];
        if self.per_point { points * (lanes[0] + self.lists) } else { lanes[points.max(1) - 1] + self.lists }
    }
}

/// Some contacts, their points, and the bytes of their rows: with all points, and with those that they need.
#[derive(Clone, Copy, Debug, Default)]
struct Load {
    contacts: u32,
    points: u32,
    rows: [usize; 2],
}

/// Contacts by weight; those that stay at any weight come last.
pub(crate) struct Census([Load; Weight::COUNT + 1]);

impl Census {
    pub(crate) fn new() -> Census {
        Census([Load::default(); Weight::COUNT + 1])
    }

    /// Adds a contact; without a weight it stays.
    pub(crate) fn add(&mut self, weight: Option<Weight>, kind: Kind, cost: &RowCost) {
        let load = &mut self.0[weight.map_or(Weight::COUNT, Weight::index)];
        load.contacts += 1;
        load.points += kind.room as u32;
        for (rows, points) in load.rows.iter_mut().zip([kind.points, kind.needed]) {
            *rows += cost.of(kind, points);
        }
    }

    /// Contacts from a weight on, and the bytes of their rows.
    fn from(&self, weight: Weight) -> (ContactCount, usize) {
        let sum = |(count, rows), load: &Load| (count + load.part(load.contacts), rows + load.rows[0]);
        self.0[weight.index()..].iter().fold((ContactCount::default(), 0), sum)
    }

    /// Bytes of all rows.
    pub(crate) fn rows(&self) -> usize {
        self.from(Weight::default()).1
    }

    /// The one cut by rank: the heaviest contacts that have place with their rows; `hold` tells whether so
    /// many contacts and bytes of rows fit. Those that nothing approaches are shed first, then points that
    /// the others don't need, then those others.
    pub(crate) fn cut(&self, hold: &dyn Fn(ContactCount, usize) -> bool) -> Cut {
        let (needed, all_rows) = self.from(Weight::NEEDED);
        let which = usize::from(!hold(needed, all_rows));
        let lowest = if which == 0 { Weight::default() } else { Weight::NEEDED };
        let mut full = if which == 0 { Threshold::ALL } else { Threshold::new(Weight::COUNT, 0) };
        let (mut count, mut rows) = (ContactCount::default(), 0);
        for (index, load) in self.0.iter().enumerate().skip(lowest.index()).rev() {
            let part = |n: u32| (count + load.part(n), rows + share(load.rows[which], n, load.contacts));
            let fits = |n: &u32| *n == 0 || hold(part(*n).0, part(*n).1);
            let stay = (0..=load.contacts).rev().find(fits).unwrap_or(0);
            (count, rows) = part(stay);
            if stay < load.contacts {
                return Cut { floor: Threshold::new(index, stay), full, rows };
            }
        }
        if which == 1 {
            // The rest is for points that are not needed.
            for (index, load) in self.0.iter().enumerate().rev() {
                let more = load.rows[0] - load.rows[1];
                if !hold(count, rows + more) {
                    break;
                }
                rows += more;
                full = Threshold::new(index, u32::MAX);
            }
        }
        Cut { floor: Threshold::new(lowest.index(), u32::MAX), full, rows }
    }
}

/// The share of some contacts in the memory of all, if they are alike.
fn share(of: usize, contacts: u32, all: u32) -> usize {
    (of * contacts as usize).div_ceil(all.max(1) as usize)
}

impl Load {
    /// So many of its contacts, if they are alike.
    fn part(&self, contacts: u32) -> ContactCount {
        let points = share(self.points as usize, contacts, self.contacts);
        ContactCount { contacts: contacts as usize, points }
    }
}

/// Which contacts stay.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut {
    pub(crate) floor: Threshold,
    /// Those above keep the rows of all points, others only of those that they need.
    full: Threshold,
    /// Bytes of the rows of all that stay.
    pub(crate) rows: usize,
}

impl Cut {
    /// The points of a contact that keep their rows, a bit each. To be called for all contacts, always in the
    /// same order.
    pub(crate) fn points(&mut self, contact: ContactRef<'_>, weight: Weight) -> u32 {
        let (stays, full) = (self.floor.keeps(weight), self.full.keeps(weight));
        match (stays, full) {
            (false, _) => 0,
            (_, false) => contact.needed(),
            _ => (1 << contact.count) - 1,
        }
    }
}

/// Share of lanes that stay empty, and the most of them, because the last batch of each colour is not full.
/// With too small an estimate contacts displace rows that they need; with too large a one they are shed for
/// nothing.
const EMPTY: usize = 5;
const MOST_EMPTY: usize = 64;

/// Bytes of rows of so many contacts, with those of empty lanes.
pub(super) fn with_empty(contacts: usize, rows: usize) -> usize {
    rows + (rows / EMPTY).min(rows / contacts.max(1) * MOST_EMPTY)
}

#[cfg(test)]
mod tests {
    use super::*;

    const COST: RowCost =
        RowCost { lanes: [[[100, 150, 180, 200]; 2]; 2], lists: 0, reserved: 0, per_point: false };
    const FOUR: Kind = Kind { is_static: false, potential: false, points: 4, room: 4, needed: 1 };

    fn staying(whole: usize, census: &Census, weights: &[Weight]) -> Vec<bool> {
        let hold = |all: ContactCount, rows: usize| all.bytes() + with_empty(all.contacts, rows) <= whole;
        let mut floor = census.cut(&hold).floor;
        weights.iter().map(|w| floor.keeps(*w)).collect()
    }

    /// Two that nothing approaches, and two that are needed, of four points each. Rows and empty lanes take
    /// 240 bytes, or 120 with the point that is needed.
    #[test]
    fn first_go_those_that_nothing_approaches_then_points_then_the_lightest() {
        let weights = [10, 20, 600, 700].map(Weight::nth);
        let mut census = Census::new();
        weights.iter().for_each(|w| census.add(Some(*w), FOUR, &COST));
        let contact = ContactCount { contacts: 1, points: 4 }.bytes();
        let (all, needed) = (contact + 240, contact + 120);
        for (whole, expected) in [
            (4 * all, [true; 4]),
            (4 * all - 1, [false, true, true, true]),
            (2 * all, [false, false, true, true]),
            (2 * needed, [false, false, true, true]),
            (2 * needed - 1, [false, false, false, true]),
            (needed - 1, [false; 4]),
        ] {
            assert_eq!(staying(whole, &census, &weights), expected, "{whole}");
        }
    }
}
