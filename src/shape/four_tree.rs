//! Trees of four children a node, and the walk that meets the nearest boxes first.
//!
//! A walk computes a *key* of each box: the fraction at which a path enters it, or the squared distance of a
//! point from it. Keys are never too large (`shape/slabs.rs`), so nothing is left out that would have been an
//! answer, and an answer doesn't depend on the shape of the tree.

use super::slabs::Slabs;
use crate::lanes::{Lanes, Mask, Vec3, f32x4};

/// A child with this bit is a leaf, and the rest says which.
pub(crate) const LEAF: u32 = 1 << 31;
/// No child.
pub(crate) const NONE: u32 = u32::MAX;
/// Nodes and leaves that wait; should they be more, the rest is walked in a stack of its own.
const STACK: usize = 64;

/// A tree of four children a node, its root node 0.
pub(crate) trait FourTree {
    /// Least and greatest x, y and z of the boxes of a node's children.
    fn sides(&self, node: u32) -> [f32x4; 6];
    /// A node, a leaf (see [`LEAF`]) or [`NONE`].
    fn child(&self, node: u32, lane: usize) -> u32;

    /// Calls `leaf(leaf, key, most)` for the leaves from a node on whose key is at most `most`, about the
    /// smallest first; it returns the new `most`. `key` gets the low and the high corners of four boxes, and
    /// `most`.
    #[inline(always)]
    fn visit_ordered(
        &self,
        start: u32,
        key: &impl Fn(&Vec3<f32x4>, &Vec3<f32x4>, f32) -> f32x4,
        mut most: f32,
        leaf: &mut impl FnMut(u32, f32, f32) -> f32,
    ) -> f32 {
        let mut stack = [(0u32, 0.0f32); STACK];
        let mut waiting = 0;
        let (mut next, mut entry) = (start, 0.0);
        loop {
            if next & LEAF != 0 {
                most = leaf(next & !LEAF, entry, most);
            } else {
                let [x, y, z, high_x, high_y, high_z] = self.sides(next);
                let keys = key(&Vec3 { x, y, z }, &Vec3 { x: high_x, y: high_y, z: high_z }, most);
                let mut bits = Lanes::le(keys, f32x4::splat(most)).bits();
                let keys = keys.to_array();
                let base = waiting;
                while bits != 0 {
                    let lane = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    let child = self.child(next, lane);
                    if child == NONE {
                        continue;
                    }
                    if waiting == STACK {
                        most = self.visit_deeper(child, key, most, leaf);
                        continue;
                    }
                    // The nearest on top.
                    let mut at = waiting;
                    while at > base && stack[at - 1].1 < keys[lane] {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = (child, keys[lane]);
                    waiting += 1;
                }
            }
            loop {
                if waiting == 0 {
                    return most;
                }
                waiting -= 1;
                if stack[waiting].1 <= most {
                    (next, entry) = stack[waiting];
                    break;
                }
            }
        }
    }

    /// [`FourTree::visit_ordered`] with a stack of its own.
    #[cold]
    #[inline(never)]
    fn visit_deeper(
        &self,
        start: u32,
        key: &impl Fn(&Vec3<f32x4>, &Vec3<f32x4>, f32) -> f32x4,
        most: f32,
        leaf: &mut impl FnMut(u32, f32, f32) -> f32,
    ) -> f32 {
        self.visit_ordered(start, key, most, leaf)
    }

    /// One ray of several from a node on, which goes its own way there.
    fn alone(
        &self,
        node: u32,
        slabs: &Slabs<f32x4>,
        most: f32,
        leaf: &mut impl FnMut(u32, f32, f32) -> f32,
    ) -> f32 {
        self.visit_ordered(node, &|low, high, most| slabs.enter(low, high, most), most, leaf)
    }
}
