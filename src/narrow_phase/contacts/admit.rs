//! Which contacts there is memory for, together with their rows.
//!
//! A contact without rows pushes nothing. If contacts took all the memory there is, rows, which come after
//! them, would find none. So under a budget contacts are admitted only with what their rows will take. If
//! that is too much for all, old and new ones compete, and the lightest are shed ([`Weight`]): a contact that
//! is found late may be the one that bears a pile.

use super::contact::ContactRef;
use super::manifold::RawManifold;
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

/// What determines the memory of a contact's rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kind {
    pub(crate) is_static: bool,
    /// The contact does not touch yet.
    pub(crate) potential: bool,
    pub(crate) points: usize,
    /// The points that the contact can't do without.
    pub(crate) needed: usize,
}

impl Kind {
    pub(crate) fn of(contact: ContactRef<'_>, is_static: bool, real: f32) -> Kind {
        let needed = contact.needed().count_ones() as usize;
        let potential = contact.points().iter().all(|p| p.separation > real);
        Kind { is_static, potential, points: contact.count as usize, needed }
    }

    pub(crate) fn of_new(raw: &RawManifold, is_static: bool, real: f32) -> Kind {
        let within = |most: f32| raw.points().iter().filter(|p| p.separation <= most).count();
        Kind {
            is_static,
            potential: within(real) == 0,
            points: raw.count as usize,
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

/// Contacts by weight, and the bytes of their rows: with all points, and with those that they need.
pub(crate) struct Census {
    counts: [u32; Weight::COUNT],
    rows: [[u32; Weight::COUNT]; 2],
    /// Contacts that stay whatever they weigh.
    fixed: (u32, [usize; 2]),
}

impl Census {
    pub(crate) fn new() -> Census {
        Census { counts: [0; Weight::COUNT], rows: [[0; Weight::COUNT]; 2], fixed: (0, [0; 2]) }
    }

    pub(crate) fn add(&mut self, weight: Weight, kind: Kind, cost: &RowCost) {
        self.counts[weight.index()] += 1;
        for (rows, points) in self.rows.iter_mut().zip([kind.points, kind.needed]) {
            rows[weight.index()] += cost.of(kind, points) as u32;
        }
    }

    /// Adds a contact that stays.
    pub(crate) fn add_fixed(&mut self, kind: Kind, cost: &RowCost) {
        self.fixed.0 += 1;
        for (rows, points) in self.fixed.1.iter_mut().zip([kind.points, kind.needed]) {
            *rows += cost.of(kind, points);
        }
    }

    /// The number of contacts, and the bytes of their rows, from a weight on.
    fn above(&self, from: Weight, rows: usize) -> (usize, usize) {
        let sum = |of: &[u32]| of[from.index()..].iter().map(|&n| n as usize).sum::<usize>();
        (self.fixed.0 as usize + sum(&self.counts), self.fixed.1[rows] + sum(&self.rows[rows]))
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
    /// The most contacts, by their own limit.
    pub(crate) slots: usize,
    /// Bytes of a contact.
    pub(crate) each: usize,
    /// The most bytes of both together.
    pub(crate) whole: usize,
    /// The most bytes of rows, by their own limit.
    pub(crate) rows: usize,
}

impl Means {
    pub(crate) fn new(allowances: &Allowances, space: &RowSpace, (capacity, each): (usize, usize)) -> Means {
        let reserved = space.slab.bytes(0).1 + space.cost.reserved;
        let add = usize::saturating_add;
        Means {
            slots: add(capacity, allowances.own(Category::Manifolds) / each),
            each,
            whole: add(allowances.whole(), capacity * each + reserved),
            rows: add(allowances.own(Category::Rows), reserved),
        }
    }

    /// Whether so many contacts fit with so many bytes of rows. Rows can't take from contacts what their own
    /// limit denies them.
    fn hold(&self, (contacts, rows): (usize, usize)) -> bool {
        contacts <= self.slots
            && contacts * self.each + (rows + loose(contacts, rows)).min(self.rows) <= self.whole
    }

    /// Decides which contacts of a census stay. Those that nothing approaches are shed first; if there is
    /// still no memory for the rows of all points, that for the needed ones will do.
    pub(crate) fn admit(&self, census: &Census) -> Admitted {
        let all = census.above(Weight::default(), 0);
        if self.hold(all) {
            return Admitted { floor: Threshold::ALL, rows: all.1 };
        }
        let rows = usize::from(!self.hold(census.above(Weight::NEEDED, 0)));
        let fixed = (census.fixed.0 as usize, census.fixed.1[rows]);
        if !self.hold(fixed) {
            let each = fixed.1 / fixed.0;
            let fits = |n: &usize| self.hold((*n, n * each));
            let stay = (0..fixed.0).rev().find(fits).unwrap_or(0);
            return Admitted { floor: Threshold::new(Weight::COUNT, 0), rows: stay * each };
        }
        let lowest = if rows == 0 { Weight::default() } else { Weight::NEEDED };
        let (mut contacts, mut bytes) = fixed;
        for index in (lowest.index()..Weight::COUNT).rev() {
            let (count, of_rows) = (census.counts[index] as usize, census.rows[rows][index] as usize);
            if self.hold((contacts + count, bytes + of_rows)) {
                (contacts, bytes) = (contacts + count, bytes + of_rows);
                continue;
            }
            let each = of_rows / count.max(1);
            let fits = |n: &usize| self.hold((contacts + n, bytes + n * each));
            let stay = (0..count).rev().find(fits).unwrap_or(0);
            return Admitted { floor: Threshold::new(index, stay as u32), rows: bytes + stay * each };
        }
        Admitted { floor: if rows == 0 { Threshold::ALL } else { Threshold::NEEDED }, rows: bytes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COST: RowCost =
        RowCost { lanes: [[[100, 150, 180, 200]; 2]; 2], lists: 0, reserved: 0, per_point: false };
    const FOUR: Kind = Kind { is_static: false, potential: false, points: 4, needed: 1 };

    fn staying(whole: usize, census: &Census, weights: &[Weight]) -> Vec<bool> {
        let means = Means { slots: usize::MAX, each: 200, whole, rows: usize::MAX };
        let mut floor = means.admit(census).floor;
        weights.iter().map(|w| floor.keeps(*w)).collect()
    }

    /// Two that nothing approaches, and two that are needed, of four points each: 440 bytes, or 320 with the
    /// point that is needed.
    #[test]
    fn first_go_those_that_nothing_approaches_then_points_then_the_lightest() {
        let weights = [10, 20, 600, 700].map(Weight::nth);
        let mut census = Census::new();
        weights.iter().for_each(|w| census.add(*w, FOUR, &COST));
        for (whole, expected) in [
            (1760, [true; 4]),
            (1759, [false, true, true, true]),
            (880, [false, false, true, true]),
            (640, [false, false, true, true]),
            (639, [false, false, false, true]),
            (319, [false; 4]),
        ] {
            assert_eq!(staying(whole, &census, &weights), expected, "{whole}");
        }
    }
}
