//! How many new contacts there is room for, together with their rows.
//!
//! A contact without rows pushes nothing. If contacts took whatever room there is, rows, which come after them, would find none; so
//! under a budget a contact is only admitted with what its rows will take.

use super::collide::Input;
use super::contact::{Contact, Contacts, NONE};
use super::manifold::{MAX_POINTS, RawManifold};
use crate::broad_phase::Pair;
use crate::memory::{Amounts, Category, Room, Rooms};

/// Contacts by what their rows take: with what is static or not, such as may touch or do, and by the number of points.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Census(pub(crate) [[[usize; MAX_POINTS]; 2]; 2]);

impl Census {
    fn add(&mut self, is_static: bool, separations: impl ExactSizeIterator<Item = f32>, real: f32) {
        let points = separations.len();
        if points > 0 {
            let potential = separations.fold(f32::INFINITY, f32::min) > real;
            self.0[usize::from(is_static)][usize::from(potential)][points - 1] += 1;
        }
    }

    pub(super) fn add_new(&mut self, is_static: bool, raw: &RawManifold, input: &Input<'_>) {
        self.add(is_static, raw.points().iter().map(|p| p.separation), input.real);
    }

    fn add_old(&mut self, is_static: bool, contact: &Contact, input: &Input<'_>) {
        self.add(is_static, contact.points().iter().map(|p| p.separation), input.real);
    }

    /// All contacts that pairs have.
    pub(super) fn of(pairs: &[Pair], contacts: &Contacts, input: &Input<'_>) -> Census {
        let mut census = Census::default();
        for pair in pairs.iter().filter(|pair| !pair.is_idle(input.hot, input.dynamic)) {
            let mut slot = pair.contact;
            while slot != NONE {
                let contact = &contacts.all[slot as usize];
                census.add_old(input.is_static(pair), contact, input);
                slot = contact.next;
            }
        }
        census
    }

    /// How many.
    pub(crate) fn total(&self) -> usize {
        self.0.as_flattened().as_flattened().iter().sum()
    }

    /// With some of others: of those with what is static first, then of the rest in equal shares.
    fn with(mut self, new: &Census, count: usize) -> Census {
        let of_static = new.0[1].as_flattened().iter().sum::<usize>();
        let shares = [count.saturating_sub(of_static), count.min(of_static)];
        for ((here, new), share) in self.0.iter_mut().zip(&new.0).zip(shares) {
            let all = new.as_flattened().iter().sum::<usize>().max(1);
            for (here, new) in here.as_flattened_mut().iter_mut().zip(new.as_flattened()) {
                *here += (*new * share).div_ceil(all);
            }
        }
        self
    }
}

/// What was admitted.
pub(super) struct Admitted {
    /// How many new contacts.
    pub(super) count: usize,
    /// Bytes that are left to rows.
    pub(super) of_rows: usize,
}

/// Makes place for as many of `new` contacts beside those that are `here` as there is room for with their rows. `rows` says what
/// those of so many contacts lack.
pub(super) fn admit(
    contacts: &mut Contacts,
    (here, new): (&Census, &Census),
    rows: &dyn Fn(&Census) -> Amounts,
    rooms: &mut Rooms,
) -> Admitted {
    let of_rows = |count: usize| {
        let lacking = rows(&here.with(new, count));
        // What their own limit denies them they can't take from contacts.
        Category::ALL.into_iter().map(|c| lacking.of(c).min(rooms.own(c))).sum::<usize>()
    };
    let left = |of_rows: usize| rooms.own(Category::Manifolds).min(rooms.whole().saturating_sub(of_rows));
    let fits = |count: usize| {
        let of_rows = of_rows(count);
        of_rows <= rooms.whole() && contacts.missing_for(count) <= left(of_rows)
    };
    let total = new.total();
    let (mut count, mut too_many) = (0, total + 1);
    if fits(total) {
        (count, too_many) = (total, total);
    }
    while too_many > count + 1 {
        let middle = usize::midpoint(count, too_many);
        *if fits(middle) { &mut count } else { &mut too_many } = middle;
    }
    let of_rows = of_rows(count);
    let left = left(of_rows);
    let mut room = Room::new(left);
    let place = contacts.make_place(count, &mut room);
    rooms.within(Category::Manifolds, |all| all.take(left - room.left()));
    Admitted { count: count.min(place), of_rows }
}
