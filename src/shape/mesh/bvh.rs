//! The tree of a triangle mesh: four children a node, their bounds as lanes of bytes.
//!
//! A node is one cache line. It has a grid of its own, 256 steps along each axis of its box, and its
//! children's boxes are rounded outwards to that grid (Mahovsky and Wyvill, *Memory-Conserving Bounding
//! Volume Hierarchies*, 2006). One call answers for four children. Triangles lie in the order of the leaves,
//! so a leaf is a first triangle and a count.

use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, f32x4};
use crate::shape::four_tree::{self, FourTree};
use crate::shape::slabs::{boxes_meet, path_hits_boxes};
use glam::Vec3;

/// Most triangles of a leaf. Eight are tested in one go of `f32x8` lanes; with fewer the tree takes more
/// bytes than it saves (4 a leaf: 7 bytes of tree a triangle, 8: 3.6).
pub(crate) const LEAF: usize = 8;
/// Bins of the surface area heuristic.
const BINS: usize = 12;
/// Levels that follow the heuristic; below them ranges are halved, which bounds the depth and thereby the
/// stack.
const FREE_LEVELS: u32 = 8;
/// Most levels: 8 + 13.
#[cfg(feature = "serde")]
pub(crate) const DEPTH: u32 = FREE_LEVELS + 13;
/// Most nodes that wait: three for each of them.
const STACK: usize = 64;

/// Four children.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Coordinates of the grid's step 0 and the size of a step [m].
    pub(crate) origin: [f32; 3],
    pub(crate) step: [f32; 3],
    /// Steps along x, y and z, per child.
    pub(crate) low: [[u8; 4]; 3],
    pub(crate) high: [[u8; 4]; 3],
    pub(crate) child: [u32; 4],
}

/// Set in a child that is a leaf: then 28 bits of first triangle and 3 of count - 1 follow. Else: a node's
/// index.
pub(crate) const IS_LEAF: u32 = four_tree::LEAF;
/// No child: a leaf that would end beyond the most triangles.
pub(crate) const NO_CHILD: u32 = four_tree::NONE;
/// Leaves can name as many triangles.
pub(crate) const MAX_TRIANGLES: usize = 1 << 28;

impl Node {
    const EMPTY: Node = Node {
        origin: [0.0; 3],
        step: [0.0; 3],
        low: [[255; 4]; 3],
        high: [[0; 4]; 3],
        child: [NO_CHILD; 4],
    };

    #[inline(always)]
    fn bounds(&self) -> (LaneVec3<f32x4>, LaneVec3<f32x4>) {
        let axis = |k: usize, q: &[[u8; 4]; 3]| {
            let [a, b, c, d] = q[k];
            let steps = f32x4::new([f32::from(a), f32::from(b), f32::from(c), f32::from(d)]);
            f32x4::splat(self.origin[k]) + steps * f32x4::splat(self.step[k])
        };
        let all = |q| LaneVec3::new(axis(0, q), axis(1, q), axis(2, q));
        (all(&self.low), all(&self.high))
    }
    /// The box of one child.
    #[cfg(feature = "serde")]
    pub(crate) fn child_box(&self, lane: usize) -> (Vec3, Vec3) {
        let at = |q: &[[u8; 4]; 3]| {
            Vec3::new(self.at(0, q[0][lane]), self.at(1, q[1][lane]), self.at(2, q[2][lane]))
        };
        (at(&self.low), at(&self.high))
    }
    fn at(&self, axis: usize, steps: u8) -> f32 {
        self.origin[axis] + f32::from(steps) * self.step[axis]
    }
}

/// An item of the tree: the bounds of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
    pub(crate) triangle: u32,
}

impl Item {
    fn key(&self, axis: usize) -> f32 {
        self.min[axis] + self.max[axis]
    }
}

/// See the module. Bounds in the mesh's frame.
#[derive(Clone, Debug)]
pub(crate) struct MeshBvh {
    pub(crate) nodes: Vec<Node>,
    /// Covers the rounding of a path's cross products [m].
    pub(crate) slack: f32,
}

impl MeshBvh {
    /// Builds the tree and sorts the items into the order of its leaves.
    pub(crate) fn build(items: &mut [Item]) -> MeshBvh {
        let (min, max) = union(items);
        let slack = 1e-6 * min.abs().max(max.abs()).max_element();
        let mut tree = MeshBvh { nodes: Vec::new(), slack };
        tree.split(items, 0, 0);
        tree.nodes.shrink_to_fit();
        tree
    }

    pub(crate) fn bytes(&self) -> (usize, usize) {
        crate::memory::bytes_of(&self.nodes)
    }

    /// Makes a node of a range that starts at item `first` of all.
    fn split(&mut self, items: &mut [Item], first: usize, level: u32) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        let mut ranges = [(0, items.len()), (0, 0), (0, 0), (0, 0)];
        let mut count = 1;
        while count < 4 {
            // The largest is halved first: that fills the leaves and bounds the depth.
            let Some(largest) = (0..count).max_by_key(|&i| (ranges[i].1 - ranges[i].0, 4 - i)) else { break };
            let (from, to) = ranges[largest];
            if to - from <= LEAF {
                break;
            }
            let middle = from + partition(&mut items[from..to], level < FREE_LEVELS);
            ranges.copy_within(largest + 1..count, largest + 2);
            ranges[largest] = (from, middle);
            ranges[largest + 1] = (middle, to);
            count += 1;
        }

        let (min, max) = union(items);
        let mut node = Node::EMPTY;
        for axis in 0..3 {
            node.origin[axis] = min[axis];
            node.step[axis] = step_of(min[axis], max[axis]);
        }
        for (i, &(from, to)) in ranges[..count].iter().enumerate() {
            let (min, max) = union(&items[from..to]);
            for axis in 0..3 {
                let steps = |x: f32| {
                    if node.step[axis] > 0.0 { (x - node.origin[axis]) / node.step[axis] } else { 0.0 }
                };
                let mut low = steps(min[axis]).floor().clamp(0.0, 255.0) as u8;
                while low > 0 && node.at(axis, low) > min[axis] {
                    low -= 1;
                }
                let mut high = steps(max[axis]).ceil().clamp(0.0, 255.0) as u8;
                while high < 255 && node.at(axis, high) < max[axis] {
                    high += 1;
                }
                (node.low[axis][i], node.high[axis][i]) = (low, high);
            }
            node.child[i] = if to - from <= LEAF {
                IS_LEAF | ((first + from) as u32) << 3 | (to - from - 1) as u32
            } else {
                self.split(&mut items[from..to], first + from, level + 1)
            };
        }
        self.nodes[index] = node;
        index as u32
    }

    /// Calls `leaf(first, count)` for the leaves whose boxes meet a box until one answers yes; says whether
    /// one did.
    #[inline]
    pub(crate) fn any_in_box(&self, min: Vec3, max: Vec3, mut leaf: impl FnMut(u32, u32) -> bool) -> bool {
        let around = (LaneVec3::<f32x4>::splat(min), LaneVec3::splat(max));
        let mut stack = [0u32; STACK];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let Some(node) = self.nodes.get(stack[waiting] as usize) else { continue };
            let mut bits = boxes_meet(node.bounds(), around).bits();
            while bits != 0 {
                let child = node.child[bits.trailing_zeros() as usize];
                bits &= bits - 1;
                if child == NO_CHILD {
                    // Where a grid has no extent, even the wrong way round is met.
                } else if child & IS_LEAF != 0 {
                    if leaf((child & !IS_LEAF) >> 3, (child & 7) + 1) {
                        return true;
                    }
                } else if waiting < STACK {
                    stack[waiting] = child;
                    waiting += 1;
                }
            }
        }
        false
    }

    /// A margin that covers the rounding of coordinates as large as those of the boxes [m].
    pub(crate) fn slack(&self) -> f32 {
        self.slack
    }
}

/// The first triangle of a leaf, and how many there are.
#[inline(always)]
pub(crate) fn triangles(leaf: u32) -> (u32, u32) {
    (leaf >> 3, (leaf & 7) + 1)
}

impl FourTree for MeshBvh {
    #[inline(always)]
    fn sides(&self, node: u32) -> [f32x4; 6] {
        let (low, high) = self.nodes[node as usize].bounds();
        [low.x, low.y, low.z, high.x, high.y, high.z]
    }
    #[inline(always)]
    fn child(&self, node: u32, lane: usize) -> u32 {
        self.nodes[node as usize].child[lane]
    }
}

/// A straight path that a box of half extents `inflate` is swept along, prepared to be tested against many
/// boxes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Path {
    from: Vec3,
    middle: Vec3,
    half: Vec3,
    inflate: Vec3,
    /// One over each component of the whole displacement; 0 where that is 0.
    inverse: Vec3,
}

impl Path {
    /// `slack` [m] covers the rounding of coordinates as large as the boxes'.
    pub(crate) fn new(from: Vec3, to: Vec3, inflate: Vec3, slack: f32) -> Path {
        let slack = slack + 1e-6 * from.abs().max(to.abs()).max_element();
        let d = to - from;
        let invert = |x: f32| if x.abs() > 1e-30 { 1.0 / x } else { 0.0 };
        Path {
            from,
            middle: (from + to) * 0.5,
            half: d * 0.5,
            inflate: inflate + Vec3::splat(slack),
            inverse: Vec3::new(invert(d.x), invert(d.y), invert(d.z)),
        }
    }

    /// Which boxes the path meets, and where it enters them at the earliest, as a fraction.
    ///
    /// Whether: by separating axes. Where: by slabs, only for those that it meets.
    #[inline(always)]
    pub(crate) fn meets<L: Lanes>(&self, low: LaneVec3<L>, high: LaneVec3<L>) -> (L::Mask, L) {
        let half = L::splat(0.5);
        let inflate = LaneVec3::splat(self.inflate);
        let extent = (high - low) * half + inflate;
        let offset = LaneVec3::splat(self.middle) - (low + high) * half;
        let meets = path_hits_boxes(LaneVec3::splat(self.half), offset, extent);
        let (low, high) =
            (low - inflate - LaneVec3::splat(self.from), high + inflate - LaneVec3::splat(self.from));
        let along = |low: L, high: L, inverse: f32| {
            let inverse = L::splat(inverse);
            (low * inverse).min(high * inverse)
        };
        let entry = along(low.x, high.x, self.inverse.x).max(L::zero());
        let entry = along(low.y, high.y, self.inverse.y).max(entry);
        let entry = along(low.z, high.z, self.inverse.z).max(entry);
        (meets, entry)
    }

    /// Where the path enters boxes, by their low and high corners, as a fraction; infinite where it misses.
    #[inline(always)]
    pub(crate) fn enter<L: Lanes>(&self, [low, high]: [&LaneVec3<L>; 2]) -> L {
        let (meets, entry) = self.meets::<L>(*low, *high);
        L::select(meets, entry, L::splat(f32::INFINITY))
    }

    /// The entry of one box, if the path meets it.
    #[inline(always)]
    pub(crate) fn meets_one(&self, low: Vec3, high: Vec3) -> Option<f32> {
        let (meets, entry) = self.meets::<f32>(LaneVec3::splat(low), LaneVec3::splat(high));
        meets.then_some(entry)
    }
}

/// The step of a grid of 256 lines from `min` to at least `max` [m], both finite and in this order.
///
/// Let `e` be the next number above the rounded extent, so `e` is at least the exact one, and `s` the next
/// above the rounded `e / 255`. Then `255 s >= e`, and rounding is monotone: `min + 255 s`, rounded, is at
/// least `max`. That holds for denormal extents too, where no factor would make a step larger.
fn step_of(min: f32, max: f32) -> f32 {
    let extent = max - min;
    if !extent.is_finite() {
        return (max / 255.0 - min / 255.0).next_up();
    }
    let step = extent / 255.0;
    if min + 255.0 * step >= max {
        return step;
    }
    // Where a thousandth counts it is more than the least that is enough.
    (step * 1.001).max((extent.next_up() / 255.0).next_up())
}

fn union(items: &[Item]) -> (Vec3, Vec3) {
    items.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), i| (min.min(i.min), max.max(i.max)))
}

/// Sorts a range in two and returns the length of the first part, neither being empty.
fn partition(items: &mut [Item], heuristic: bool) -> usize {
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for item in items.iter() {
        let centre = item.min + item.max;
        (min, max) = (min.min(centre), max.max(centre));
    }
    let size = max - min;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    if heuristic && items.len() > 4 * LEAF && size[axis] > 0.0 {
        let scale = BINS as f32 / size[axis];
        let bin = |item: &Item| (((item.key(axis) - min[axis]) * scale) as usize).min(BINS - 1);
        if let Some(last) = cheapest(items, bin) {
            let mut middle = 0;
            for i in 0..items.len() {
                if bin(&items[i]) <= last {
                    items.swap(i, middle);
                    middle += 1;
                }
            }
            if middle > 0 && middle < items.len() {
                return middle;
            }
        }
    }
    // Halves in which only the last leaf may be short.
    let middle = (items.len().div_ceil(LEAF) / 2 * LEAF).clamp(1, items.len() - 1);
    items.select_nth_unstable_by(middle, |a, b| {
        a.key(axis).total_cmp(&b.key(axis)).then(a.triangle.cmp(&b.triangle))
    });
    middle
}

/// The last bin of the first part where the sum of surface times count is least (MacDonald and Booth, 1990;
/// binned: Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies*, 2007).
fn cheapest(items: &[Item], bin: impl Fn(&Item) -> usize) -> Option<usize> {
    let mut bins = [(Vec3::INFINITY, Vec3::NEG_INFINITY, 0usize); BINS];
    for item in items {
        let b = &mut bins[bin(item)];
        *b = (b.0.min(item.min), b.1.max(item.max), b.2 + 1);
    }
    // Counts in leaves: a part of nine triangles costs two.
    let cost = |b: &(Vec3, Vec3, usize)| {
        let d = b.1 - b.0;
        (d.x * d.y + d.y * d.z + d.z * d.x) * b.2.div_ceil(LEAF) as f32
    };
    let join = |a: &(Vec3, Vec3, usize), b: &(Vec3, Vec3, usize)| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2);
    let mut above = bins;
    for i in (0..BINS - 1).rev() {
        above[i] = join(&bins[i], &above[i + 1]);
    }
    let mut below = bins[0];
    let mut best = None;
    for i in 0..BINS - 1 {
        if i > 0 {
            below = join(&below, &bins[i]);
        }
        if below.2 > 0 && above[i + 1].2 > 0 {
            let cost = cost(&below) + cost(&above[i + 1]);
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, i));
            }
        }
    }
    best.map(|(_, i)| i)
}

#[cfg(test)]
mod tests;
