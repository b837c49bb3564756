//! The memory budget of a world.

use super::Category;

/// Bytes that a world may reserve, in all and of each category; see
/// [`Settings::budget`](crate::Settings::budget). A category without a limit of its own is only bound by that
/// of the whole.
///
/// ```
/// use backstop::{Budget, Category};
/// let budget = Budget::total(16 << 20).with(Category::Manifolds, 4 << 20);
/// assert_eq!(budget.limit(), Some(16 << 20));
/// assert_eq!(budget.limit_of(Category::Rows), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(from = "Limits", into = "Limits")
)]
pub struct Budget {
    whole: Option<usize>,
    of: [Option<usize>; Category::ALL.len()],
}

impl Budget {
    /// No limit.
    pub const NONE: Budget = Budget { whole: None, of: [None; Category::ALL.len()] };

    /// So many bytes in all.
    pub const fn total(bytes: usize) -> Budget {
        Budget { whole: Some(bytes), ..Budget::NONE }
    }

    /// The same with a limit for one category [bytes].
    #[must_use]
    pub const fn with(mut self, category: Category, bytes: usize) -> Budget {
        self.of[category as usize] = Some(bytes);
        self
    }

    /// Bytes in all, if that is limited.
    pub const fn limit(&self) -> Option<usize> {
        self.whole
    }

    /// Bytes of a category, if it has a limit of its own.
    pub const fn limit_of(&self, category: Category) -> Option<usize> {
        self.of[category as usize]
    }

    /// The same with no more than so many bytes in all.
    #[cfg(feature = "replay")]
    pub(crate) fn at_most(mut self, bytes: usize) -> Budget {
        self.whole = Some(self.whole.map_or(bytes, |whole| whole.min(bytes)));
        self
    }

    /// Whether nothing is limited.
    pub fn is_none(&self) -> bool {
        *self == Budget::NONE
    }
}

/// A budget as it is written: only limited categories are named.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
struct Limits {
    total: Option<usize>,
    categories: std::collections::BTreeMap<Category, usize>,
}

#[cfg(feature = "serde")]
impl From<Budget> for Limits {
    fn from(budget: Budget) -> Limits {
        let of = |category| budget.limit_of(category).map(|bytes| (category, bytes));
        Limits { total: budget.whole, categories: Category::ALL.into_iter().filter_map(of).collect() }
    }
}

#[cfg(feature = "serde")]
impl From<Limits> for Budget {
    fn from(limits: Limits) -> Budget {
        let whole = Budget { whole: limits.total, ..Budget::NONE };
        limits.categories.into_iter().fold(whole, |budget, (category, bytes)| budget.with(category, bytes))
    }
}

#[cfg(all(test, feature = "bake"))]
mod tests {
    use super::*;

    #[test]
    fn budgets_are_written_by_name_and_read_again() {
        let budget = Budget::total(1000).with(Category::BroadPhase, 200).with(Category::Events, 0);
        let text = serde_json::to_string(&budget).unwrap();
        assert_eq!(text, r#"{"total":1000,"categories":{"broad_phase":200,"events":0}}"#);
        assert_eq!(serde_json::from_str::<Budget>(&text).unwrap(), budget);
        // As a recording stores it.
        let bytes = postcard::to_stdvec(&budget).unwrap();
        assert_eq!(postcard::from_bytes::<Budget>(&bytes).unwrap(), budget);
        assert_eq!(postcard::to_stdvec(&Budget::NONE).unwrap(), [0, 0]);
    }
}
