//! How a new tree groups its leaves.

use super::bvh::Item;
use crate::lanes::{Lanes, f32x4};
use glam::Vec3;

/// From this many leaves down a range is halved by count, so that the last nodes are full: a node costs the
/// same whether one of its lanes is used or four.
const SMALL: u32 = 16;

/// Parts a range of items in up to four groups, each a range again (empty: start = end).
///
/// The fullest group is halved until there are four or none has more than a node's worth.
pub(super) fn four_groups(items: &mut [Item], start: u32, end: u32) -> [(u32, u32); 4] {
    let mut groups = [(end, end); 4];
    if end - start <= 4 {
        for (i, group) in groups.iter_mut().enumerate() {
            let at = start + i as u32;
            *group = (at.min(end), (at + 1).min(end));
        }
        return groups;
    }
    groups[0] = (start, end);
    for used in 1..4 {
        let mut fullest = 0;
        for i in 1..used {
            if groups[i].1 - groups[i].0 > groups[fullest].1 - groups[fullest].0 {
                fullest = i;
            }
        }
        let (from, to) = groups[fullest];
        if to - from <= 4 {
            break;
        }
        let middle = from + halve(&mut items[from as usize..to as usize]);
        groups[fullest] = (from, middle);
        groups[used] = (middle, to);
    }
    groups
}

/// Orders items so that those before the returned index lie on one side and the others on the other.
///
/// The plane is the middle of the box of centres along its longest side; a range too small or too uneven for
/// that is halved by count. So no part gets less than an eighth, and the depth stays logarithmic in any
/// scene.
fn halve(items: &mut [Item]) -> u32 {
    let count = items.len() as u32;
    let (mut low, mut high) = (f32x4::splat(f32::INFINITY), f32x4::splat(f32::NEG_INFINITY));
    for item in items.iter() {
        low = Lanes::min(item.lanes(), low);
        high = Lanes::max(item.lanes(), high);
    }
    let xyz = |v: f32x4| Vec3::from_slice(&v.to_array());
    let (min, max) = (xyz(low), xyz(high));
    let size = max - min;
    let axis = if size.x >= size.y.max(size.z) { 0 } else { 1 + usize::from(size.z > size.y) };
    if count > SMALL {
        let plane = min[axis] * 0.5 + max[axis] * 0.5;
        let mut low = 0;
        // No branch on where an item lies: it would be mispredicted every other time. And it is asked before
        // the swap: afterwards the answer would wait for the store (nearly twice the time for the whole
        // build).
        for i in 0..items.len() {
            let below = items[i].centre()[axis] < plane;
            items.swap(i, low);
            low += usize::from(below);
        }
        let low = low as u32;
        if low.min(count - low) * 8 >= count {
            return low;
        }
    }
    let middle = if count > SMALL { count / 2 } else { (count / 2).next_multiple_of(4) };
    items.select_nth_unstable_by(middle as usize, |p, q| {
        let key = |item: &Item| item.centre()[axis];
        key(p).total_cmp(&key(q)).then(p.collider().cmp(&q.collider()))
    });
    middle
}
