//! Up to 64 rays on their way through one tree.
//!
//! All rays that reach a node go through it together: its boxes are read and unpacked once, each ray tests
//! four of them at a time as it does alone, and no ray waits for another as the nodes of one ray do. A bit
//! for each ray and child says whether the ray enters it. Where few are left they continue alone, so
//! diverging rays lose little.
//!
//! Lists of rays at the nodes of a wide tree: Tsakok, *Faster Incoherent Rays: Multi-BVH Ray Stream Tracing*
//! (2009); as bits: Fuetterling et al., *Efficient Ray Tracing Kernels for Modern CPU Architectures* (JCGT
//! 2015); alone where rays part: Benthin et al., *Combining Single and Packet-Ray Tracing for Arbitrary Ray
//! Distributions* (2012).

use super::four_tree::{FourTree, LEAF, NONE};
use super::slabs::Slabs;
use crate::lanes::{Lanes, Mask, f32x4, ones};

/// Most rays of a stream: a bit each.
pub(crate) const RAYS: usize = 64;
/// Levels that rays go through together; further down each goes alone.
const LEVELS: usize = 12;
/// Up to so many rays go on alone.
const FEW: u32 = 2;

/// The rays of a stream, and up to which fraction each still matters.
#[derive(Debug)]
pub(crate) struct Stream {
    slabs: [Slabs<f32x4>; RAYS],
    pub(crate) most: [f32; RAYS],
    /// Where each ray enters the box of the leaf at hand.
    pub(crate) entry: [f32; RAYS],
}

impl Stream {
    pub(crate) fn new() -> Stream {
        Stream { slabs: [Slabs::default(); RAYS], most: [0.0; RAYS], entry: [0.0; RAYS] }
    }
    pub(crate) fn put(&mut self, ray: usize, slabs: Slabs<f32x4>, most: f32) {
        (self.slabs[ray], self.most[ray]) = (slabs, most);
    }
}

/// An entry of the stack: a child of a node, with the rays that entered its box.
#[derive(Clone, Copy, Debug, Default)]
struct Waiting {
    rays: u64,
    child: u32,
    level: u8,
    lane: u8,
}

/// Where the rays enter the boxes of the nodes that they are in, by level, ray and lane.
#[derive(Debug)]
pub(crate) struct Walk {
    entries: [[[f32; 4]; RAYS]; LEVELS],
}

impl Walk {
    pub(crate) fn new() -> Walk {
        Walk { entries: [[[0.0; 4]; RAYS]; LEVELS] }
    }

    /// Calls `leaf(leaf, rays, stream)` with every leaf and the rays that enter its box before their `most`,
    /// which it may lower; about the nearest first. Not to be called for a tree without a node.
    #[inline(always)]
    pub(crate) fn through<T: FourTree>(
        &mut self,
        tree: &T,
        stream: &mut Stream,
        rays: u64,
        leaf: &mut impl FnMut(u32, u64, &mut Stream),
    ) {
        let mut stack = [Waiting::default(); 3 * LEVELS + 1];
        stack[0].rays = rays;
        let mut waiting = 1;
        // The root has no box: its entry is at the start.
        let mut root = true;
        while waiting > 0 {
            waiting -= 1;
            let Waiting { mut rays, child, level, lane } = stack[waiting];
            if !root {
                let page = &self.entries[level as usize - 1];
                let mut left = 0;
                for ray in ones(rays) {
                    let entry = page[ray][lane as usize % 4];
                    stream.entry[ray] = entry;
                    left |= u64::from(entry <= stream.most[ray]) << ray;
                }
                rays = left;
                if rays == 0 {
                    continue;
                }
            }
            root = false;
            if child & LEAF != 0 {
                leaf(child & !LEAF, rays, stream);
                continue;
            }
            if rays.count_ones() <= FEW || level as usize == LEVELS {
                for ray in ones(rays) {
                    let (slabs, most) = (stream.slabs[ray], stream.most[ray]);
                    tree.alone(child, &slabs, most, &mut |at, entry, _| {
                        stream.entry[ray] = entry;
                        leaf(at, 1 << ray, stream);
                        stream.most[ray]
                    });
                }
                continue;
            }
            let sides = tree.sides(child);
            let page = &mut self.entries[level as usize];
            let mut into = [0u64; 4];
            let mut first = f32x4::splat(f32::INFINITY);
            for ray in ones(rays) {
                let entry = stream.slabs[ray].enter_sides(&sides, stream.most[ray]);
                page[ray] = entry.to_array();
                first = Lanes::min(first, entry);
                spread(&mut into, Lanes::lt(entry, f32x4::splat(f32::INFINITY)).bits(), ray);
            }
            let (first, base) = (first.to_array(), waiting);
            for lane in 0..4 {
                let next = tree.child(child, lane);
                if into[lane] == 0 || next == NONE {
                    continue;
                }
                // The nearest on top.
                let mut at = waiting;
                while at > base && first[stack[at - 1].lane as usize % 4] < first[lane] {
                    stack[at] = stack[at - 1];
                    at -= 1;
                }
                stack[at] = Waiting { rays: into[lane], child: next, level: level + 1, lane: lane as u8 };
                waiting += 1;
            }
        }
    }
}

/// Notes a ray in the lanes whose bits are set.
#[inline(always)]
pub(super) fn spread(into: &mut [u64; 4], lanes: u32, ray: usize) {
    for (lane, into) in into.iter_mut().enumerate() {
        *into |= u64::from(lanes >> lane & 1) << ray;
    }
}
