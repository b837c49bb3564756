//! Decides what gets no rows where memory is short, by how little it is missed, and limits the memory of what
//! only continuous collision makes.

use super::arrange::ahead_lanes;
use super::facts::{Fact, each_contact};
use super::order::Group;
use crate::constraint::contact::input::PrepareInput;
use crate::narrow_phase::{ContactCount, ContactRef, Threshold, Weight};

/// The savings where memory does not suffice for all, beginning with what is missed least. All savings of one
/// kind come before any of the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Thrift {
    /// Capacity of the lists of the step for parts.
    pub(super) place: usize,
    /// Batches that are mostly empty become single rows: slower, and otherwise the same.
    pub(super) thin: bool,
    /// Contacts without approach keep their rows above this weight.
    idle: Threshold,
    /// Others keep points that they could do without above the first, and any points above the second.
    spare: Threshold,
    any: Threshold,
}

impl Thrift {
    /// No savings, except for the capacity of the lists.
    pub(super) fn none(place: usize) -> Thrift {
        let all = Threshold::ALL;
        Thrift { place, thin: false, idle: all, spare: all, any: all }
    }

    /// The savings after so many of [`Thrift::steps`], with so many contacts of each weight.
    pub(super) fn after(step: u32, counts: &[u32; Weight::COUNT], place: usize) -> Thrift {
        let (idle, needed) = Self::classes(counts);
        let mut left = step.saturating_sub(1);
        let mut next = |from: Weight, all: u32| {
            let gone = left.min(all);
            left -= gone;
            Threshold::without(counts, from, gone)
        };
        Thrift {
            place,
            thin: step > 0,
            idle: next(Weight::default(), idle),
            spare: next(Weight::NEEDED, needed),
            any: next(Weight::NEEDED, needed),
        }
    }

    /// Number of steps until no row is left.
    pub(super) fn steps(counts: &[u32; Weight::COUNT]) -> u32 {
        let (idle, needed) = Self::classes(counts);
        1 + idle + 2 * needed
    }

    fn classes(counts: &[u32; Weight::COUNT]) -> (u32, u32) {
        let (idle, needed) = counts.split_at(Weight::NEEDED.index());
        (idle.iter().sum(), needed.iter().sum())
    }

    /// The points of a contact that keep their rows, a bit each. To be called for all contacts, always in the
    /// same order.
    pub(super) fn points(&mut self, contact: ContactRef<'_>, weight: Weight) -> u32 {
        let all = (1 << contact.count) - 1;
        if !weight.is_needed() {
            return if self.idle.keeps(weight) { all } else { 0 };
        }
        match [&mut self.any, &mut self.spare].map(|floor| floor.keeps(weight)) {
            [false, _] => 0,
            [_, false] => contact.needed(),
            _ => all,
        }
    }
}

/// Memory that is left for contacts that only continuous collision makes: of bodies among themselves, and
/// with static geometry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead {
    pub(super) left: [usize; 2],
    /// Bytes of the contact and a lane of a batch: for bodies that may move and for static ones, by number of
    /// points.
    cost: [[usize; 4]; 2],
}

impl Ahead {
    /// Without a limit.
    pub(super) const ANY: Ahead = Ahead { left: [usize::MAX; 2], cost: [[0; 4]; 2] };

    /// The limit of the step, which goes to contacts with static geometry first.
    pub(super) fn new(input: &PrepareInput<'_>) -> Ahead {
        if input.ahead == usize::MAX {
            return Ahead::ANY;
        }
        let whole = Ahead {
            left: [input.ahead, 0],
            cost: ahead_lanes(input).map(|side| {
                let contact = |points: usize| ContactCount { contacts: 1, points }.bytes();
                std::array::from_fn(|i| side[i].div_ceil(8) + contact(i + 1))
            }),
        };
        let mut of_static = 0;
        each_contact(input, |slot, contact| {
            let fact = Fact::of(input, slot, contact);
            if fact.is_ahead() && fact.group().is_static() {
                of_static += whole.cost(fact.count.into(), fact.group());
            }
        });
        let of_static = of_static.min(input.ahead);
        Ahead { left: [input.ahead - of_static, of_static], ..whole }
    }

    fn cost(&self, points: u32, group: Group) -> usize {
        self.cost[usize::from(group.is_static())][points as usize - 1]
    }

    /// Whether enough is left for a contact of a group, of so many points; subtracts it if so.
    pub(super) fn admits(&mut self, points: u32, group: Group) -> bool {
        let cost = self.cost(points, group);
        let left = &mut self.left[usize::from(group.is_static())];
        let rest = left.checked_sub(cost);
        *left = rest.unwrap_or(*left);
        rest.is_some()
    }
}
