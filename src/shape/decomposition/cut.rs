//! Where a part is cut: where the hulls of both sides are smallest together.

use super::part::{Part, Plane};
use super::solid::Solid;

// Guard: a share of the excess, so that it decides between about equal planes only.
const PREFERENCE: f64 = 0.05;

/// The best plane of `resolution` ones along each axis; nothing if the part is too small to be cut.
pub(super) fn best(solid: &Solid, part: &Part, resolution: u32) -> Option<Plane> {
    let extent: [f64; 3] = std::array::from_fn(|a| (part.high[a] - part.low[a]) as f64);
    let longest = extent[0].max(extent[1]).max(extent[2]);
    let mut best: Option<(f64, Plane)> = None;
    for (axis, extent) in extent.into_iter().enumerate() {
        // Where many planes are alike, as across a ring, one across the middle of a long side leads to fewer
        // pieces.
        let short = 1.0 - extent / longest;
        for at in planes(part, axis, resolution) {
            let plane = Plane { axis, at };
            let [below, above] = [false, true].map(|is_above| part.hull_beyond(solid, plane, is_above));
            let aside = (below - above).abs() / (below + above).max(f64::MIN_POSITIVE);
            let cost = below + above + PREFERENCE * part.excess() * (aside + short);
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, plane));
            }
        }
    }
    best.map(|(_, plane)| plane)
}

/// Planes across a part, evenly, but at the nearest corners of polygons where there are some.
fn planes(part: &Part, axis: usize, resolution: u32) -> Vec<i64> {
    let mut corners: Vec<i64> = part.surface.points().iter().map(|p| p[axis].round() as i64).collect();
    corners.sort_unstable();
    corners.dedup();
    let (low, high) = (part.low[axis], part.high[axis]);
    let spacing = (high - low) / i64::from(resolution + 1);
    let mut planes: Vec<i64> = (1..=i64::from(resolution))
        .map(|k| {
            let even = low + (high - low) * k / i64::from(resolution + 1);
            let next = corners.partition_point(|&corner| corner < even);
            let near = corners[next.saturating_sub(1)..corners.len().min(next + 1)].iter();
            let nearest = near.copied().min_by_key(|corner| (corner - even).abs());
            nearest.filter(|corner| 2 * (corner - even).abs() <= spacing).unwrap_or(even)
        })
        .filter(|&at| low < at && at < high)
        .collect();
    planes.sort_unstable();
    planes.dedup();
    planes
}
