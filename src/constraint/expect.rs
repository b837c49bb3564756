//! What the rows of contacts will take, before there are any: contacts leave it to them.

use super::arrange::PrepareScratch;
use super::rows::Rows;
use crate::memory::{Amounts, Buffer, Category};
use crate::narrow_phase::Census;

/// Bytes that rows lack for so many contacts, in batches that are full. `per_point`: each point has rows of its own.
pub(crate) fn missing_for(
    census: &Census,
    (rows, scratch): (&Rows, &PrepareScratch),
    (friction, per_point): (bool, bool),
) -> Amounts {
    let (mut bytes, mut parts) = (0, 0);
    for (is_static, side) in census.0.iter().enumerate() {
        let sizes = &Rows::SIZES[is_static];
        for (potential, by_points) in side.iter().enumerate() {
            let of_friction = if friction { sizes[5 + 2 * potential] } else { 0 };
            for (i, contacts) in by_points.iter().enumerate() {
                let (count, points) = if per_point { (contacts * (i + 1), 1) } else { (*contacts, i + 1) };
                bytes += (count * (sizes[points - 1] + of_friction)).div_ceil(8);
                parts += count;
            }
        }
    }
    let mut missing = Amounts::default();
    missing.add(Category::Rows, bytes.saturating_sub(rows.slab_bytes()) + rows.schedule.missing(parts));
    missing.add(Category::Scratch, scratch.missing(parts));
    missing
}
