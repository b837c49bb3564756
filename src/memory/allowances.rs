//! Bytes that a step may still reserve in each category: the lesser of the rests of its own limit and of the
//! whole.

use super::{Allowance, Amounts, Budget, Category};

/// Bytes that buffers may still grow by, in all and of each category.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Allowances {
    whole: Allowance,
    of: [Allowance; Category::ALL.len()],
}

impl Allowances {
    /// No limits: the world has no budget.
    pub(crate) const ENDLESS: Allowances =
        Allowances { whole: Allowance::ENDLESS, of: [Allowance::ENDLESS; Category::ALL.len()] };

    /// The part of a budget that is left once some of the bytes held are gone, by category and in all. Where
    /// more is held than the budget allows, the freed bytes may be reserved again.
    pub(crate) fn new(budget: &Budget, held: &Amounts, whole: usize, gone: &Amounts) -> Allowances {
        if budget.is_none() {
            return Allowances::ENDLESS;
        }
        let left = |limit: Option<usize>, held: usize, gone: usize| {
            let rest = held.saturating_sub(gone);
            Allowance::new(limit.map_or(usize::MAX, |limit| limit.max(held) - rest))
        };
        let of = Category::ALL.map(|c| left(budget.limit_of(c), held.of(c), gone.of(c)));
        Allowances { whole: left(budget.limit(), whole, gone.total()), of }
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
    pub(crate) fn allowance(&self, category: Category) -> Allowance {
        if self.is_endless() { Allowance::ENDLESS } else { Allowance::new(self.left(category)) }
    }

    /// Lets `f` use the room of a category.
    pub(crate) fn within<R>(&mut self, category: Category, f: impl FnOnce(&mut Allowance) -> R) -> R {
        let before = self.allowance(category);
        let mut allowance = before;
        let result = f(&mut allowance);
        for own in [&mut self.whole, &mut self.of[category as usize]] {
            own.take(before.left().saturating_sub(allowance.left()));
            own.give(allowance.left().saturating_sub(before.left()));
        }
        result
    }

    /// One in `parts` of all that is left.
    pub(crate) fn part(&self, parts: usize) -> Allowances {
        Allowances { whole: self.whole.share(parts), of: self.of.map(|allowance| allowance.share(parts)) }
    }

    /// Takes bytes off that were used elsewhere.
    pub(crate) fn take(&mut self, used: &Amounts) {
        self.whole.take(used.total());
        Category::ALL.into_iter().for_each(|c| self.of[c as usize].take(used.of(c)));
    }

    /// The most, from `least` up to `wanted`, that fits, with `asked` giving the bytes of a number; `least`
    /// in any case.
    pub(crate) fn most(&self, least: usize, wanted: usize, asked: &dyn Fn(usize) -> Amounts) -> usize {
        let (mut most, mut too_many) = (least, wanted + 1);
        while too_many - most > 1 {
            let middle = usize::midpoint(most, too_many);
            *if self.fits(&asked(middle)) { &mut most } else { &mut too_many } = middle;
        }
        most
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
        let mut allowances = Allowances::new(&budget, &Amounts::default(), 0, &Amounts::default());
        assert_eq!((allowances.left(Category::Rows), allowances.left(Category::Joints)), (300, 1000));
        allowances.within(Category::Joints, |allowance| allowance.take(800));
        assert_eq!((allowances.left(Category::Rows), allowances.left(Category::Joints)), (200, 200));
        allowances.within(Category::Rows, |allowance| allowance.take(150));
        assert_eq!(
            (allowances.left(Category::Rows), allowances.own(Category::Rows), allowances.whole()),
            (50, 150, 50)
        );
        allowances.within(Category::Rows, |allowance| allowance.give(100));
        assert_eq!((allowances.left(Category::Rows), allowances.whole()), (150, 150));
        let mut asked = Amounts::default();
        asked.add(Category::Scratch, 150);
        assert!(allowances.fits(&asked));
        asked.add(Category::Rows, 1);
        assert!(!allowances.fits(&asked));
    }

    #[test]
    fn a_limit_of_one_category_leaves_the_others_alone() {
        let budget = Budget::NONE.with(Category::Rows, 10);
        let allowances = Allowances::new(&budget, &Amounts::default(), 0, &Amounts::default());
        assert!(!allowances.is_endless());
        assert!(allowances.left(Category::Scratch) > usize::MAX / 2);
        assert!(Allowances::new(&Budget::NONE, &Amounts::default(), 0, &Amounts::default()).is_endless());
    }
}
