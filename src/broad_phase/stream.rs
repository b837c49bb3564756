//! Rays through the trees together.

use super::BroadPhase;
use super::bvh::{Node, Tree};
use super::query_tree::{QueryTree, Sorts};
use crate::lanes::f32x4;
use crate::shape::{FourTree, Stream, Walk};

impl FourTree for Tree {
    #[inline(always)]
    fn sides(&self, node: u32) -> [f32x4; 6] {
        let Node { min, max, .. } = &self.nodes()[node as usize];
        [min.x, min.y, min.z, max.x, max.y, max.z]
    }
    #[inline(always)]
    fn child(&self, node: u32, lane: usize) -> u32 {
        self.nodes()[node as usize].child(lane)
    }
}

impl BroadPhase {
    /// Calls `leaf(collider, rays, stream)` with every collider and the rays that meet its box before their
    /// `most`, which it may lower; about the nearest first after colliders without bounds.
    pub(crate) fn together(
        &self,
        current: &QueryTree,
        sorts: Sorts,
        stream: &mut Stream,
        walk: &mut Walk,
        rays: u64,
        mut leaf: impl FnMut(u32, u64, &mut Stream),
    ) {
        self.endless(current, sorts, |c| leaf(c, rays, stream));
        if sorts.statics && self.statics.leaves() > 0 {
            walk.through(&self.statics, stream, rays, &mut leaf);
        }
        if (sorts.movers || !current.late.is_empty()) && current.tree.leaves() > 0 {
            walk.through(&current.tree, stream, rays, &mut leaf);
        }
    }
}
