//! Limits the memory that only continuous collision needs.

use super::arrange::ahead_lanes;
use super::facts::{Fact, each_contact};
use super::order::Group;
use crate::constraint::contact::input::PrepareInput;
use crate::narrow_phase::ContactCount;

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
    /// The limit of the step, which goes to contacts with static geometry first.
    pub(super) fn new(input: &PrepareInput<'_>) -> Ahead {
        if input.ahead == usize::MAX {
            return Ahead { left: [usize::MAX; 2], cost: [[0; 4]; 2] };
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

    /// Whether enough is left for a contact, if only continuous collision makes it; subtracts it if so.
    pub(super) fn admits(&mut self, fact: &Fact) -> bool {
        if !fact.is_ahead() {
            return true;
        }
        let cost = self.cost(fact.count.into(), fact.group());
        let left = &mut self.left[usize::from(fact.group().is_static())];
        let rest = left.checked_sub(cost);
        *left = rest.unwrap_or(*left);
        rest.is_some()
    }
}
