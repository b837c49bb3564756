//! What a world holds beside its budget, and which calls may have it hold more.

use super::call::{Call, OfBody, OfCharacter, OfJoint, OfShape};
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

/// Whether the world may hold more after a call. Forces are kept for the bodies that ever had one.
pub fn adds(call: &Call) -> bool {
    let moves = |what: &OfBody| {
        matches!(
            what,
            OfBody::Pose(..)
                | OfBody::SamePose
                | OfBody::Velocity(..)
                | OfBody::LinearVelocity(_)
                | OfBody::AngularVelocity(_)
                | OfBody::Impulse(..)
                | OfBody::AngularImpulse(_)
                | OfBody::UserData(_)
                | OfBody::Wake
                | OfBody::SendToSleep
        )
    };
    match call {
        Call::Body(_, what) => !moves(what),
        Call::Character(_, OfCharacter::Walk { .. }) | Call::Origin(_) => false,
        _ => true,
    }
}

/// Whether joints that are there are arranged in another way.
pub fn rearranges(call: &Call) -> bool {
    match call {
        Call::Body(_, what) => matches!(
            what,
            OfBody::SolvedAfter(_)
                | OfBody::Locks(..)
                | OfBody::Mass(_)
                | OfBody::Kind(_)
                | OfBody::Enable(_)
                | OfBody::AddShape(_)
        ),
        // The mass of the body may follow.
        Call::Shape(_, what) => {
            matches!(what, OfShape::Remove | OfShape::Geometry(_) | OfShape::Pose(..) | OfShape::Density(_))
        }
        Call::Joint(_, what) => matches!(what, OfJoint::SolvedAfter(_)),
        _ => false,
    }
}
