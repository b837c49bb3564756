//! Pieces that are made one again: those of which the common hull has least more than both.

use super::super::hull::build;
use super::part::Part;
use glam::DVec3;

/// Two pieces, and what their common hull has beyond both.
struct Pair {
    cost: f64,
    pieces: [usize; 2],
}

/// Joins pieces while there are more than `most`, and while all hulls together have at most `allowed` more
/// than the volume of the solid.
pub(super) fn join(parts: Vec<Part>, most: usize, allowed: f64, volume: f64) -> Vec<Part> {
    let mut excess = parts.iter().map(|part| part.hull).sum::<f64>() - volume;
    let mut count = parts.len();
    let mut parts: Vec<Option<Part>> = parts.into_iter().map(Some).collect();
    let mut pairs = Vec::new();
    for b in 0..parts.len() {
        pairs.extend(with_all(&parts, b, b, true));
    }
    while count > 1 {
        if pairs.is_empty() && count > most {
            // None touch, but there are too many.
            for b in 0..parts.len() {
                pairs.extend(with_all(&parts, b, b, false));
            }
        }
        let least = (0..pairs.len()).min_by(|&i, &k| pairs[i].cost.total_cmp(&pairs[k].cost));
        let Some(Pair { cost, pieces: [a, b] }) = least.map(|least| pairs.swap_remove(least)) else { break };
        if count <= most && excess + cost > allowed {
            break;
        }
        let (Some(one), Some(other)) = (parts[a].take(), parts[b].take()) else { break };
        pairs.retain(|pair| !pair.pieces.contains(&a) && !pair.pieces.contains(&b));
        parts[a] = Some(union(one, other));
        pairs.extend(with_all(&parts, a, parts.len(), true));
        (excess, count) = (excess + cost, count - 1);
    }
    parts.into_iter().flatten().collect()
}

/// Pairs of a piece with each other one before `end`, if their boxes touch or need not.
fn with_all(parts: &[Option<Part>], of: usize, end: usize, touching: bool) -> Vec<Pair> {
    let Some(own) = &parts[of] else { return Vec::new() };
    let others = parts[..end].iter().enumerate().filter(|&(i, _)| i != of);
    others
        .filter_map(|(i, other)| {
            let other = other.as_ref()?;
            let touch = (0..3).all(|a| own.low[a] <= other.high[a] && other.low[a] <= own.high[a]);
            (touch || !touching).then(|| Pair {
                cost: build::measure(&both(own, other)).map_or(0.0, |(hull, _)| hull) - own.hull - other.hull,
                pieces: [of, i],
            })
        })
        .collect()
}

fn both(a: &Part, b: &Part) -> Vec<DVec3> {
    a.points.iter().chain(&b.points).copied().collect()
}

fn union(a: Part, b: Part) -> Part {
    let points = both(&a, &b);
    let (hull, corners) = build::measure(&points).unwrap_or_default();
    Part {
        low: std::array::from_fn(|i| a.low[i].min(b.low[i])),
        high: std::array::from_fn(|i| a.high[i].max(b.high[i])),
        volume: a.volume + b.volume,
        hull,
        points: corners.into_iter().map(|i| points[i as usize]).collect(),
        ..a
    }
}
