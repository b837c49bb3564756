//! Static geometry near the predicted paths of fast bodies.

use crate::broad_phase::Pair;
use crate::shape::ColliderSummary;

/// Static geometry near a body's predicted path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Beside {
    #[default]
    Nothing,
    /// There is some, which the narrow phase saw the body miss.
    Missed,
    /// There is some that it may touch.
    Static,
}

/// Marks the dynamic bodies that have static geometry near their predicted paths. None if no body is fast:
/// most slow bodies are known to be clear of it.
pub(super) fn mark_beside(
    beside: &mut Vec<Beside>,
    fast: u32,
    movers: usize,
    dynamic: usize,
    pairs: &[Pair],
    colliders: &[ColliderSummary],
    missed: impl Fn(usize, usize) -> bool,
) {
    beside.clear();
    if fast == 0 {
        return;
    }
    beside.resize(dynamic, Beside::Nothing);
    for (k, pair) in pairs.iter().enumerate() {
        let [a, b] = [pair.a, pair.b].map(|c| colliders[c as usize].body as usize);
        let body = a.min(b);
        if (a >= movers || b >= movers)
            && let Some(mark) = beside.get_mut(body)
        {
            *mark = (*mark).max(if missed(k, body) { Beside::Missed } else { Beside::Static });
        }
    }
}
