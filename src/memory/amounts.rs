//! Bytes by category.

use super::Category;

/// A number of bytes for each category.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Amounts([usize; Category::ALL.len()]);

impl Amounts {
    pub(crate) fn add(&mut self, category: Category, bytes: usize) {
        self.0[category as usize] += bytes;
    }

    pub(crate) fn of(&self, category: Category) -> usize {
        self.0[category as usize]
    }

    pub(crate) fn total(&self) -> usize {
        self.0.iter().sum()
    }

    /// The excess over another.
    pub(crate) fn without(&self, other: &Amounts) -> Amounts {
        Amounts(std::array::from_fn(|i| self.0[i].saturating_sub(other.0[i])))
    }

    /// The category that has most.
    pub(crate) fn largest(&self) -> Category {
        Category::ALL.into_iter().fold(Category::Bodies, |a, b| if self.of(b) > self.of(a) { b } else { a })
    }
}

impl std::ops::AddAssign for Amounts {
    fn add_assign(&mut self, other: Amounts) {
        self.0.iter_mut().zip(other.0).for_each(|(a, b)| *a += b);
    }
}
