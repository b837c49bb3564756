//! Which contacts there is memory for, together with their rows.
//!
//! A contact without rows pushes nothing. If contacts took all the memory there is, rows, which come after
//! them, would find none. So under a budget contacts are admitted only with what their rows will take. If
//! that is too much for all, old and new ones compete, and the lightest are shed ([`Weight`]): a contact that
//! is found late may be the one that bears a pile.

use super::contact::ContactRef;
use super::manifold::RawManifold;
use super::store::{ContactCount, Contacts};
use super::weight::{Threshold, Weight};
use crate::memory::{Allowances, Category, Slab};

/// Bytes that the rows of a contact take, and what is reserved for them.
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
    /// What each category may still grow by.
    pub(crate) allowances: &'a mut Allowances,
    /// The rows of the last step, which lend theirs.
    pub(crate) space: &'a mut RowSpace,
}

/// What determines the memory of a contact's rows.
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

/// Contacts by weight with their points, and the bytes of their rows: with all points, and with those that
/// they need.
pub(crate) struct Census {
    counts: [u32; Weight::COUNT],
    points: [u32; Weight::COUNT],
    rows: [[u32; Weight::COUNT]; 2],
    fixed: Fixed,
}

/// Contacts that stay whatever they weigh.
#[derive(Default)]
struct Fixed {
    all: ContactCount,
    rows: [usize; 2],
}

/// Some contacts, and the bytes of their rows.
#[derive(Clone, Copy)]
struct Load {
    all: ContactCount,
    rows: usize,
}

impl Load {
    fn and(self, other: Load) -> Load {
        Load { all: self.all + other.all, rows: self.rows + other.rows }
    }

    /// So many of its contacts, if they are alike.
    fn part(self, contacts: usize) -> Load {
        let share = |of: usize| contacts * (of / self.all.contacts.max(1));
        let points = (contacts * self.all.points).div_ceil(self.all.contacts.max(1));
        Load { all: ContactCount { contacts, points }, rows: share(self.rows) }
    }
}

impl Census {
    pub(crate) fn new() -> Census {
        Census {
            counts: [0; Weight::COUNT],
            points: [0; Weight::COUNT],
            rows: [[0; Weight::COUNT]; 2],
            fixed: Fixed::default(),
        }
    }

    pub(crate) fn add(&mut self, weight: Weight, kind: Kind, cost: &RowCost) {
        self.counts[weight.index()] += 1;
        self.points[weight.index()] += kind.room as u32;
        for (rows, points) in self.rows.iter_mut().zip([kind.points, kind.needed]) {
            rows[weight.index()] += cost.of(kind, points) as u32;
        }
    }

    /// Adds a contact that stays.
    pub(crate) fn add_fixed(&mut self, kind: Kind, cost: &RowCost) {
        self.fixed.all = self.fixed.all + ContactCount { contacts: 1, points: kind.room };
        for (rows, points) in self.fixed.rows.iter_mut().zip([kind.points, kind.needed]) {
            *rows += cost.of(kind, points);
        }
    }

    /// Contacts from a weight on. `rows`: 0 with all points, 1 with those that they need.
    fn above(&self, from: Weight, rows: usize) -> Load {
        let sum = |of: &[u32]| of[from.index()..].iter().map(|&n| n as usize).sum::<usize>();
        let all = ContactCount { contacts: sum(&self.counts), points: sum(&self.points) };
        self.fixed(rows).and(Load { all, rows: sum(&self.rows[rows]) })
    }

    fn fixed(&self, rows: usize) -> Load {
        Load { all: self.fixed.all, rows: self.fixed.rows[rows] }
    }

    /// Contacts of one weight.
    fn at(&self, index: usize, rows: usize) -> Load {
        let all = ContactCount { contacts: self.counts[index] as usize, points: self.points[index] as usize };
        Load { all, rows: self.rows[rows][index] as usize }
    }
}

/// What is admitted.
pub(crate) struct Admitted {
    pub(crate) floor: Threshold,
    /// Bytes of the rows of all contacts that stay, with only the needed points if there is not enough for
    /// all.
    pub(crate) rows: usize,
}

/// Share of lanes that stay empty, and the most of them, because the last batch of each colour is not full.
/// With too small an estimate contacts displace rows that they need; with too large a one they are shed for
/// nothing.
const EMPTY: usize = 5;
const MOST_EMPTY: usize = 64;

/// Bytes of empty lanes beside so many bytes of rows.
fn loose(contacts: usize, rows: usize) -> usize {
    (rows / EMPTY).min(rows / contacts.max(1) * MOST_EMPTY)
}

/// The memory for contacts and their rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Means {
    /// For how many contacts and points there is memory.
    pub(crate) held: ContactCount,
    /// The most bytes of contacts, by their own limit.
    pub(crate) contacts: usize,
    /// The most bytes of both together.
    pub(crate) whole: usize,
    /// The most bytes of rows, by their own limit.
    pub(crate) rows: usize,
}

impl Means {
    pub(crate) fn new(allowances: &Allowances, space: &RowSpace, contacts: &Contacts) -> Means {
        let reserved = space.slab.bytes(0).1 + space.cost.reserved;
        let (held, add) = (contacts.capacity(), usize::saturating_add);
        Means {
            held,
            contacts: add(held.bytes(), allowances.own(Category::Manifolds)),
            whole: add(allowances.whole(), held.bytes() + reserved),
            rows: add(allowances.own(Category::Rows), reserved),
        }
    }

    /// Whether contacts fit with their rows. Rows can't take from contacts what their own limit denies them.
    fn hold(&self, Load { all, rows }: Load) -> bool {
        // Memory for headers is not memory for points.
        all.max(self.held).bytes() <= self.contacts
            && all.bytes() + (rows + loose(all.contacts, rows)).min(self.rows) <= self.whole
    }

    /// Decides which contacts of a census stay. Those that nothing approaches are shed first; if there is
    /// still no memory for the rows of all points, that for the needed ones will do.
    pub(crate) fn admit(&self, census: &Census) -> Admitted {
        let all = census.above(Weight::default(), 0);
        if self.hold(all) {
            return Admitted { floor: Threshold::ALL, rows: all.rows };
        }
        let rows = usize::from(!self.hold(census.above(Weight::NEEDED, 0)));
        let fixed = census.fixed(rows);
        if !self.hold(fixed) {
            let fits = |n: &usize| self.hold(fixed.part(*n));
            let stay = (0..fixed.all.contacts).rev().find(fits).unwrap_or(0);
            return Admitted { floor: Threshold::new(Weight::COUNT, 0), rows: fixed.part(stay).rows };
        }
        let lowest = if rows == 0 { Weight::default() } else { Weight::NEEDED };
        let mut sum = fixed;
        for index in (lowest.index()..Weight::COUNT).rev() {
            let more = census.at(index, rows);
            if self.hold(sum.and(more)) {
                sum = sum.and(more);
                continue;
            }
            let fits = |n: &usize| self.hold(sum.and(more.part(*n)));
            let stay = (0..more.all.contacts).rev().find(fits).unwrap_or(0);
            let rows = sum.and(more.part(stay)).rows;
            return Admitted { floor: Threshold::new(index, stay as u32), rows };
        }
        Admitted { floor: if rows == 0 { Threshold::ALL } else { Threshold::NEEDED }, rows: sum.rows }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COST: RowCost =
        RowCost { lanes: [[[100, 150, 180, 200]; 2]; 2], lists: 0, reserved: 0, per_point: false };
    const FOUR: Kind = Kind { is_static: false, potential: false, points: 4, room: 4, needed: 1 };

    fn staying(whole: usize, census: &Census, weights: &[Weight]) -> Vec<bool> {
        let held = ContactCount::default();
        let means = Means { held, contacts: usize::MAX, whole, rows: usize::MAX };
        let mut floor = means.admit(census).floor;
        weights.iter().map(|w| floor.keeps(*w)).collect()
    }

    /// Two that nothing approaches, and two that are needed, of four points each. Rows and empty lanes take
    /// 240 bytes, or 120 with the point that is needed.
    #[test]
    fn first_go_those_that_nothing_approaches_then_points_then_the_lightest() {
        let weights = [10, 20, 600, 700].map(Weight::nth);
        let mut census = Census::new();
        weights.iter().for_each(|w| census.add(*w, FOUR, &COST));
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
