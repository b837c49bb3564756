//! What a world holds beside its budget.

use backstop::{Category, MemoryReport, World};

/// What is held, and so many bytes more, beyond the budget.
pub fn over(world: &World, promised: usize) -> Option<String> {
    let (budget, memory) = (world.settings().budget, world.memory());
    let total = memory.total() + promised;
    let whole = budget.limit().filter(|&limit| total > limit);
    if let Some(limit) = whole {
        return Some(format!("{total} of {limit} bytes"));
    }
    let of = |category: Category| {
        memory.category(category).reserved + if category == Category::Joints { promised } else { 0 }
    };
    let most = |category| Some((category, budget.limit_of(category).filter(|&limit| of(category) > limit)?));
    let (category, limit) = Category::ALL.into_iter().find_map(most)?;
    Some(format!("{} of {limit} bytes of {category}", of(category)))
}

/// The categories that grew, in bytes.
pub fn grown(before: &MemoryReport, now: &MemoryReport) -> String {
    let pairs = before.iter().zip(now.iter()).filter(|((_, old), (_, new))| new.reserved > old.reserved);
    let all =
        pairs.map(|((category, old), (_, new))| format!("{category} {} to {}", old.reserved, new.reserved));
    all.collect::<Vec<_>>().join(", ")
}
