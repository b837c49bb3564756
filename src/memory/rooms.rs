//! Bytes that a step may still reserve in each category: the lesser of what its own limit and that of the
//! whole leave.

use super::{Amounts, Budget, Category, MemoryReport, Room};

/// Bytes that buffers may still grow by, in all and of each category.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rooms {
    whole: Room,
    of: [Room; Category::ALL.len()],
}

impl Rooms {
    /// No limits: the world has no budget.
    pub(crate) const ENDLESS: Rooms =
        Rooms { whole: Room::ENDLESS, of: [Room::ENDLESS; Category::ALL.len()] };

    /// The part of a budget that is left beside the bytes held, by category and in all.
    pub(crate) fn new(budget: &Budget, held: &MemoryReport, whole: usize) -> Rooms {
        if budget.is_none() {
            return Rooms::ENDLESS;
        }
        let left = |limit: Option<usize>, held: usize| {
            Room::new(limit.map_or(usize::MAX, |limit| limit.saturating_sub(held)))
        };
        let of = Category::ALL.map(|c| left(budget.limit_of(c), held.category(c).reserved));
        Rooms { whole: left(budget.limit(), whole), of }
    }

    #[inline]
    pub(crate) fn is_endless(&self) -> bool {
        self.whole.is_endless()
    }

    /// Bytes left for a category.
    pub(crate) fn left(&self, category: Category) -> usize {
        self.whole.left().min(self.of[category as usize].left())
    }

    /// Bytes left in all.
    pub(crate) fn whole(&self) -> usize {
        self.whole.left()
    }

    /// Bytes that a category's own limit leaves.
    pub(crate) fn own(&self, category: Category) -> usize {
        self.of[category as usize].left()
    }

    /// The room of a category alone.
    pub(crate) fn room(&self, category: Category) -> Room {
        if self.is_endless() { Room::ENDLESS } else { Room::new(self.left(category)) }
    }

    /// Lets `f` use the room of a category.
    pub(crate) fn within<R>(&mut self, category: Category, f: impl FnOnce(&mut Room) -> R) -> R {
        let before = self.room(category);
        let mut room = before;
        let result = f(&mut room);
        for own in [&mut self.whole, &mut self.of[category as usize]] {
            own.take(before.left().saturating_sub(room.left()));
            own.give(room.left().saturating_sub(before.left()));
        }
        result
    }

    /// One in `parts` of all that is left.
    pub(crate) fn part(&self, parts: usize) -> Rooms {
        Rooms { whole: self.whole.share(parts), of: self.of.map(|room| room.share(parts)) }
    }

    /// Takes bytes off that were used elsewhere.
    pub(crate) fn take(&mut self, used: &Amounts) {
        self.whole.take(used.total());
        Category::ALL.into_iter().for_each(|c| self.of[c as usize].take(used.of(c)));
    }

    /// Whether so much fits beside each other.
    pub(crate) fn fits(&self, asked: &Amounts) -> bool {
        asked.total() <= self.whole.left() && Category::ALL.into_iter().all(|c| asked.of(c) <= self.own(c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_category_has_the_less_of_its_own_and_the_whole() {
        let budget = Budget::total(1000).with(Category::Rows, 300);
        let mut rooms = Rooms::new(&budget, &MemoryReport::default(), 0);
        assert_eq!((rooms.left(Category::Rows), rooms.left(Category::Joints)), (300, 1000));
        rooms.within(Category::Joints, |room| room.take(800));
        assert_eq!((rooms.left(Category::Rows), rooms.left(Category::Joints)), (200, 200));
        rooms.within(Category::Rows, |room| room.take(150));
        assert_eq!((rooms.left(Category::Rows), rooms.own(Category::Rows), rooms.whole()), (50, 150, 50));
        rooms.within(Category::Rows, |room| room.give(100));
        assert_eq!((rooms.left(Category::Rows), rooms.whole()), (150, 150));
        let mut asked = Amounts::default();
        asked.add(Category::Scratch, 150);
        assert!(rooms.fits(&asked));
        asked.add(Category::Rows, 1);
        assert!(!rooms.fits(&asked));
    }

    #[test]
    fn a_limit_of_one_category_leaves_the_others_alone() {
        let budget = Budget::NONE.with(Category::Rows, 10);
        let rooms = Rooms::new(&budget, &MemoryReport::default(), 0);
        assert!(!rooms.is_endless());
        assert!(rooms.left(Category::Scratch) > usize::MAX / 2);
        assert!(Rooms::new(&Budget::NONE, &MemoryReport::default(), 0).is_endless());
    }
}
