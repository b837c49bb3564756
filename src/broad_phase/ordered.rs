//! Walks that meet the nearest boxes first and leave out what is beyond the best answer so far.
//!
//! A walk orders boxes by a *key*: the fraction at which a path enters it, or the squared distance of a point
//! from it. Keys are never too large (`shape/slabs.rs`), so nothing is left out that would have been an
//! answer, and an answer doesn't depend on the shape of the tree.

use super::bvh::{LEAF, NONE, Node, Tree};
use crate::lanes::{Lanes, Mask, f32x4};

/// Nodes and leaves that wait; should they be more, the rest is walked in a stack of its own.
const STACK: usize = 64;

impl Tree {
    /// Calls `leaf(collider, most)` for the leaves whose key is at most `most`, about the smallest first; it
    /// returns the new `most`.
    #[inline(always)]
    pub(super) fn visit_ordered(
        &self,
        key: &impl Fn(&Node, f32) -> f32x4,
        most: f32,
        leaf: &mut impl FnMut(u32, f32) -> f32,
    ) -> f32 {
        if self.leaves() == 0 { most } else { self.visit_from(0, key, most, leaf) }
    }

    pub(super) fn visit_from(
        &self,
        start: u32,
        key: &impl Fn(&Node, f32) -> f32x4,
        mut most: f32,
        leaf: &mut impl FnMut(u32, f32) -> f32,
    ) -> f32 {
        let mut stack = [(0u32, 0.0f32); STACK];
        let mut waiting = 0;
        let mut next = start;
        loop {
            if next & LEAF != 0 {
                most = leaf(next & !LEAF, most);
            } else {
                let node = &self.nodes()[next as usize];
                let keys = key(node, most);
                let mut bits = Lanes::le(keys, f32x4::splat(most)).bits();
                let keys = keys.to_array();
                let base = waiting;
                while bits != 0 {
                    let lane = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    let (child, key_of) = (node.child(lane), keys[lane]);
                    if child == NONE {
                        continue;
                    }
                    if waiting == STACK {
                        most = self.visit_from(child, key, most, leaf);
                        continue;
                    }
                    // The nearest on top.
                    let mut at = waiting;
                    while at > base && stack[at - 1].1 < key_of {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = (child, key_of);
                    waiting += 1;
                }
            }
            loop {
                if waiting == 0 {
                    return most;
                }
                waiting -= 1;
                let (child, key_of) = stack[waiting];
                if key_of <= most {
                    next = child;
                    break;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::broad_phase::Aabb;
    use crate::lanes::Vec3;
    use crate::random::Random;
    use crate::shape::Slabs;

    #[test]
    fn an_ordered_walk_finds_the_same_as_a_list() {
        let mut random = Random(9);
        let boxes: Vec<Aabb> = (0..3000)
            .map(|_| {
                let (at, half) = (random.cube(50.0), random.cube(1.0).abs());
                Aabb { min: at - half, max: at + half }
            })
            .collect();
        let ids: Vec<u32> = (0..3000).collect();
        let mut tree = Tree::default();
        tree.add(&ids, |c| boxes[c as usize], |_, _| {});
        for _ in 0..300 {
            let (from, path) = (random.cube(60.0).as_dvec3(), random.cube(100.0));
            let slabs = Slabs::<f32x4>::new(from, path, glam::Vec3::ZERO);
            let one = Slabs::<f32>::new(from, path, glam::Vec3::ZERO);
            let of = |c: u32| {
                let b = &boxes[c as usize];
                one.enter(&Vec3::splat(b.min), &Vec3::splat(b.max), 1.0)
            };
            let mut expected: Vec<u32> = ids.iter().copied().filter(|&c| of(c) <= 1.0).collect();
            let key = |node: &Node, most: f32| slabs.enter(&node.min, &node.max, most);
            let mut found = Vec::new();
            tree.visit_ordered(&key, 1.0, &mut |c, most| {
                found.push(c);
                most
            });
            found.sort_unstable();
            assert_eq!(found, expected);
            // Cut at the first: nothing nearer is missed.
            expected.sort_by(|&a, &b| of(a).total_cmp(&of(b)));
            let mut first = f32::INFINITY;
            tree.visit_ordered(&key, 1.0, &mut |c, most| {
                first = first.min(of(c));
                most.min(of(c))
            });
            assert_eq!(first, expected.first().map_or(f32::INFINITY, |&c| of(c)));
        }
    }
}
