//! The bounding volume hierarchy: nodes of four children held as lanes.
//!
//! A node holds the boxes of its four children, so one test in four lanes answers for all of them, and a leaf
//! costs no node of its own. Children come after their parents in the array: going through it backwards is a
//! refit. The tree knows a leaf by its *place* (node * 4 + lane), which the owner keeps for each collider.
//!
//! Four children: Dammertz et al., *Shallow Bounding Volume Hierarchies for Fast SIMD Ray Tracing* (2008).

use super::Aabb;
use crate::config::tuning::TREE_AREA_GROWTH;
use crate::lanes::{Lanes, Mask, Vec3, f32x4};
use crate::memory::buffers;
use crate::shape::{FourTree, boxes_meet};
use bytemuck::{Pod, Zeroable};

/// No place, no child; and a child with this bit is a leaf, and the rest is its collider.
pub(super) use crate::shape::{LEAF, NONE};

/// Place in a stack for a walk: three a level and one, in trees whose depth is logarithmic.
pub(crate) const STACK: usize = 256;

/// Four boxes and their contents; 128 bytes, two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub(crate) min: Vec3<f32x4>,
    pub(crate) max: Vec3<f32x4>,
    /// By lane: a node, a leaf (see [`LEAF`]) or [`NONE`], whose box is inert.
    child: [u32; 4],
    /// Place in the parent, or [`NONE`] for the root.
    parent: u32,
}

impl Node {
    fn new(parent: u32) -> Node {
        let mut node = Node { min: Vec3::zero(), max: Vec3::zero(), child: [NONE; 4], parent };
        for lane in 0..4 {
            node.set(lane, &Aabb::EMPTY);
        }
        node
    }

    #[inline]
    fn set(&mut self, lane: usize, bounds: &Aabb) {
        self.min.x.set_lane(lane, bounds.min.x);
        self.min.y.set_lane(lane, bounds.min.y);
        self.min.z.set_lane(lane, bounds.min.z);
        self.max.x.set_lane(lane, bounds.max.x);
        self.max.y.set_lane(lane, bounds.max.y);
        self.max.z.set_lane(lane, bounds.max.z);
    }

    #[inline]
    fn get(&self, lane: usize) -> Aabb {
        Aabb { min: self.min.lane(lane), max: self.max.lane(lane) }
    }

    /// The box around all four.
    #[inline]
    fn union(&self) -> Aabb {
        let low = |v: f32x4| {
            let [a, b, c, d] = v.to_array();
            Lanes::min(Lanes::min(a, b), Lanes::min(c, d))
        };
        let high = |v: f32x4| {
            let [a, b, c, d] = v.to_array();
            Lanes::max(Lanes::max(a, b), Lanes::max(c, d))
        };
        Aabb {
            min: glam::Vec3::new(low(self.min.x), low(self.min.y), low(self.min.z)),
            max: glam::Vec3::new(high(self.max.x), high(self.max.y), high(self.max.z)),
        }
    }

    /// The content of a lane: a node, a leaf (see [`LEAF`]) or [`NONE`].
    #[inline(always)]
    pub(super) fn child(&self, lane: usize) -> u32 {
        self.child[lane]
    }

    /// Which of the four boxes touch this one.
    #[inline(always)]
    pub(crate) fn overlaps(&self, min: &Vec3<f32x4>, max: &Vec3<f32x4>) -> u32 {
        boxes_meet((self.min, self.max), (*min, *max)).bits()
    }
}

/// A leaf to be: the middle of its box, and its collider.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(16))]
pub(super) struct Item {
    centre: [f32; 3],
    collider: u32,
}

/// The tree. Its boxes are exact unions of its leaves' after [`Tree::refit`], and contain them at any time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
    leaves: usize,
    /// Half the area of all inner boxes right after the last build [m²].
    built_area: f32,
    /// Leaves moved one by one since the area was last looked at.
    moved: usize,
    items: Vec<Item>,
    /// Ranges of items to be made a node of: start, end, place in the parent.
    tasks: Vec<(u32, u32, u32)>,
}

buffers! {
    Tree {
        // A walk keeps three tasks a level, and one.
        each(leaves: usize) { nodes(Self::nodes_for(leaves)), items(leaves), tasks(leaves.min(STACK)) }
    }
}

impl Tree {
    pub(super) fn leaves(&self) -> usize {
        self.leaves
    }

    #[inline(always)]
    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Adds leaves: one by one if they are few, in a new tree otherwise. `place` is told where each leaf is,
    /// old ones that moved included. Returns whether the tree was built anew.
    pub(crate) fn add(
        &mut self,
        colliders: &[u32],
        bounds: impl Fn(u32) -> Aabb,
        mut place: impl FnMut(u32, u32),
    ) -> bool {
        let sparse = self.nodes.len() > self.leaves + colliders.len() + 16;
        if colliders.len() * 8 > self.leaves || sparse {
            self.rebuild(colliders, bounds, place);
            return true;
        }
        for &collider in colliders {
            self.insert(collider, &bounds(collider), &mut place);
        }
        false
    }

    /// Builds the tree anew, of its leaves and more.
    pub(super) fn rebuild(
        &mut self,
        more: &[u32],
        bounds: impl Fn(u32) -> Aabb,
        mut place: impl FnMut(u32, u32),
    ) {
        let mut items = std::mem::take(&mut self.items);
        items.clear();
        let item = |collider| {
            let b = bounds(collider);
            Item { centre: (b.min + b.max).to_array(), collider }
        };
        self.for_each(|collider| items.push(item(collider)));
        items.extend(more.iter().map(|&collider| item(collider)));
        self.leaves = items.len();
        self.nodes.clear();
        self.tasks.clear();
        if !items.is_empty() {
            self.tasks.push((0, items.len() as u32, NONE));
        }
        while let Some((start, end, parent)) = self.tasks.pop() {
            let node = self.nodes.len() as u32;
            self.nodes.push(Node::new(parent));
            if parent != NONE {
                self.nodes[parent as usize / 4].child[parent as usize % 4] = node;
            }
            for (lane, (from, to)) in
                super::build::four_groups(&mut items, start, end).into_iter().enumerate()
            {
                let at = node * 4 + lane as u32;
                match to - from {
                    0 => {}
                    1 => {
                        let collider = items[from as usize].collider;
                        self.nodes[node as usize].set(lane, &bounds(collider));
                        self.nodes[node as usize].child[lane] = LEAF | collider;
                        place(collider, at);
                    }
                    _ => self.tasks.push((from, to, at)),
                }
            }
        }
        self.items = items;
        self.built_area = self.refit_all();
        self.moved = 0;
    }

    /// Puts a leaf where it enlarges the boxes on its way least.
    fn insert(&mut self, collider: u32, bounds: &Aabb, place: &mut impl FnMut(u32, u32)) {
        self.leaves += 1;
        let mut node = 0;
        loop {
            let at = &mut self.nodes[node];
            if let Some(lane) = at.child.iter().position(|&c| c == NONE) {
                at.child[lane] = LEAF | collider;
                at.set(lane, bounds);
                place(collider, (node * 4 + lane) as u32);
                return self.refit_up(node);
            }
            let mut best = (f32::INFINITY, 0);
            for lane in 0..4 {
                let old = at.get(lane);
                let cost = old.union(bounds).half_area() - old.half_area();
                // A box that holds it already wins; the first of equals.
                if cost < best.0 {
                    best = (cost, lane);
                }
            }
            let lane = best.1;
            let (child, old) = (at.child[lane], at.get(lane));
            if child & LEAF == 0 {
                node = child as usize;
                continue;
            }
            let parent = (node * 4 + lane) as u32;
            let new = self.nodes.len();
            self.nodes[node].child[lane] = new as u32;
            let mut both = Node::new(parent);
            both.child[0] = child;
            both.set(0, &old);
            self.nodes.push(both);
            place(child & !LEAF, new as u32 * 4);
            node = new;
        }
    }

    /// Takes the leaf out; its lane is free for another.
    pub(super) fn remove(&mut self, place: u32) {
        let (node, lane) = (place as usize / 4, place as usize % 4);
        self.nodes[node].child[lane] = NONE;
        self.nodes[node].set(lane, &Aabb::EMPTY);
        self.leaves -= 1;
        self.refit_up(node);
    }

    /// Gives leaves new boxes, then makes the boxes above fit. Returns whether the tree got so bad by it that
    /// it should be built anew.
    pub(super) fn refit(&mut self, moved: impl Iterator<Item = (u32, Aabb)> + Clone) -> bool {
        let mut count = 0;
        for (place, bounds) in moved.clone() {
            self.nodes[place as usize / 4].set(place as usize % 4, &bounds);
            count += 1;
        }
        self.moved += count;
        // A way up costs about six nodes; going through all of them costs less per node.
        let all = count * 6 > self.nodes.len();
        if !all {
            for (place, _) in moved {
                self.refit_up(place as usize / 4);
            }
        }
        if all || self.moved > self.leaves {
            self.moved = 0;
            return self.refit_all() > self.built_area * TREE_AREA_GROWTH;
        }
        false
    }

    /// Makes the boxes above a node fit, up to the first that doesn't change.
    fn refit_up(&mut self, mut node: usize) {
        loop {
            let parent = self.nodes[node].parent;
            if parent == NONE {
                return;
            }
            let union = self.nodes[node].union();
            let (up, lane) = (parent as usize / 4, parent as usize % 4);
            if self.nodes[up].get(lane) == union {
                return;
            }
            self.nodes[up].set(lane, &union);
            node = up;
        }
    }

    /// Makes all boxes fit; returns half their area.
    fn refit_all(&mut self) -> f32 {
        let mut area = 0.0;
        for node in (1..self.nodes.len()).rev() {
            let union = self.nodes[node].union();
            let parent = self.nodes[node].parent as usize;
            self.nodes[parent / 4].set(parent % 4, &union);
            area += union.half_area().max(0.0);
        }
        area
    }

    /// Calls `f` with every leaf's collider, in the array's order.
    pub(super) fn for_each(&self, mut f: impl FnMut(u32)) {
        for node in &self.nodes {
            for child in node.child {
                if child & LEAF != 0 && child != NONE {
                    f(child & !LEAF);
                }
            }
        }
    }

    /// Calls `f` with the collider of every leaf that passes `test`; `test` says which of a node's four boxes
    /// do.
    ///
    /// Writing all four children out and counting only those that pass, without a branch, took 2.5 times as
    /// long: each node then waits for the one before, where a guess lets the processor run ahead
    /// (`timing.rs`, 4096 walks).
    #[inline(always)]
    pub(crate) fn visit(&self, stack: &mut Vec<u32>, test: impl Fn(&Node) -> u32, mut f: impl FnMut(u32)) {
        if self.leaves == 0 {
            return;
        }
        stack.clear();
        let mut next = 0;
        loop {
            let node = &self.nodes[next as usize];
            let mut bits = test(node);
            while bits != 0 {
                let child = node.child[bits.trailing_zeros() as usize];
                bits &= bits - 1;
                if child & LEAF == 0 {
                    stack.push(child);
                } else if child != NONE {
                    f(child & !LEAF);
                }
            }
            match stack.pop() {
                Some(node) => next = node,
                None => return,
            }
        }
    }

    /// [`Tree::visit`] with all leaves whose boxes touch this one.
    #[inline(always)]
    pub(crate) fn visit_box(&self, stack: &mut Vec<u32>, bounds: &Aabb, f: impl FnMut(u32)) {
        let (min, max) = (Vec3::splat(bounds.min), Vec3::splat(bounds.max));
        self.visit(stack, |node| node.overlaps(&min, &max), f);
    }

    /// Calls `leaf(collider, most)` for the leaves whose key is at most `most`, about the smallest first; it
    /// returns the new `most`. See [`FourTree::visit_ordered`].
    pub(super) fn visit_keys(
        &self,
        key: &impl Fn(&Vec3<f32x4>, &Vec3<f32x4>, f32) -> f32x4,
        most: f32,
        leaf: &mut impl FnMut(u32, f32) -> f32,
    ) -> f32 {
        if self.leaves == 0 {
            return most;
        }
        self.visit_ordered(0, key, most, &mut |collider, _, most| leaf(collider, most))
    }

    /// Place for the nodes of a tree of so many leaves. A node has two children or more after a build, and
    /// each leaf that is added later may bring one; beyond that the tree is sparse and built anew.
    fn nodes_for(leaves: usize) -> usize {
        if leaves == 0 { 0 } else { leaves + leaves / 4 + 16 }
    }

    /// How many nodes there are.
    pub(super) fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Writes which nodes and leaves hang on which: the order in which leaves are found comes from that.
    pub(super) fn save(&self, out: &mut Vec<u32>) {
        out.extend([self.built_area.to_bits(), self.moved as u32]);
        self.nodes.iter().for_each(|node| out.extend_from_slice(&node.child));
    }

    /// Restores the output of [`Tree::save`]. `place` is told where each leaf is.
    pub(super) fn restore(
        &mut self,
        words: &[u32],
        bounds: impl Fn(u32) -> Aabb,
        mut place: impl FnMut(u32, u32),
    ) {
        self.built_area = f32::from_bits(words[0]);
        self.moved = words[1] as usize;
        self.leaves = 0;
        self.nodes.clear();
        self.nodes.extend(words[Self::HEAD..].as_chunks::<4>().0.iter().map(|_| Node::new(NONE)));
        for (n, child) in words[Self::HEAD..].as_chunks::<4>().0.iter().enumerate() {
            self.nodes[n].child = *child;
            for (lane, &child) in child.iter().enumerate().filter(|(_, child)| **child != NONE) {
                let at = (n * 4 + lane) as u32;
                if child & LEAF == 0 {
                    self.nodes[child as usize].parent = at;
                } else {
                    self.leaves += 1;
                    self.nodes[n].set(lane, &bounds(child & !LEAF));
                    place(child & !LEAF, at);
                }
            }
        }
        // The boxes above are exact unions: they need not be kept.
        self.refit_all();
    }

    /// Words that [`Tree::save`] writes before the nodes.
    pub(super) const HEAD: usize = 2;

    /// Whether words are of a tree; calls `leaf` with each collider in it.
    pub(super) fn check(words: &[u32], mut leaf: impl FnMut(u32) -> bool) -> bool {
        let nodes = words[Self::HEAD..].as_chunks::<4>().0;
        // Each node but the first hangs on one before it.
        let mut hung = vec![false; nodes.len()];
        let mut fits = !f32::from_bits(words[0]).is_nan();
        for (n, child) in nodes.iter().enumerate() {
            fits &= n == 0 || hung[n];
            for &child in child.iter().filter(|&&child| child != NONE) {
                fits &= if child & LEAF != 0 {
                    leaf(child & !LEAF)
                } else {
                    let below = child as usize;
                    below > n && below < nodes.len() && !std::mem::replace(&mut hung[below], true)
                };
            }
        }
        fits
    }
}

impl Item {
    /// The centre in lanes; the last lane means nothing.
    #[inline]
    pub(super) fn lanes(self) -> f32x4 {
        bytemuck::must_cast(self)
    }
    #[inline]
    pub(super) fn centre(&self) -> glam::Vec3 {
        self.centre.into()
    }
    pub(super) fn collider(&self) -> u32 {
        self.collider
    }
}

#[cfg(test)]
mod tests;
