//! Bins of pairs with the same two shapes, and blocks of them.

use super::pair_state::{PackedState, PairState, pairs_that};
use crate::memory::{Allowance, buffers};
use crate::shape::{ColliderSummary, Kind};
use crate::threads::per_block;

/// A shape pair, as a small number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bin(pub(crate) u8);

const KINDS: u8 = Kind::COUNT;
/// Tapered capsules have kernels, and so bins, of their own.
pub(super) const TAPERED_CAPSULES: Bin = Bin(KINDS * KINDS);
pub(super) const TAPERED_BOX: Bin = Bin(KINDS * KINDS + 1);
/// The bins of meshes begin here, then those of height fields, by the kind of the other shape. They have no
/// kernel in lanes, so a block may contain several of them: in a scene of few bodies there are fewer blocks
/// than kinds.
const MESHES: Bin = Bin(KINDS * KINDS + 2);
/// One bin for each pair of kinds, the tapered ones, and those of meshes.
pub(super) const BINS: u8 = MESHES.0 + 2 * KINDS;
const COUNT: usize = BINS as usize;
/// Pairs a block of one bin, a multiple of eight.
pub(super) const BLOCK: u32 = per_block(64, 8) as u32;

impl Bin {
    pub(crate) fn of(a: &ColliderSummary, b: &ColliderSummary) -> Bin {
        let tapered = |c: &ColliderSummary| c.kind == Kind::Capsule && c.size[1] != c.size[2];
        match (a.kind, b.kind) {
            (Kind::Capsule, Kind::Capsule) if tapered(a) || tapered(b) => TAPERED_CAPSULES,
            (Kind::Capsule, Kind::Box) if tapered(a) => TAPERED_BOX,
            (a, Kind::Mesh) => Bin(MESHES.0 + a as u8),
            (a, Kind::HeightField) => Bin(MESHES.0 + KINDS + a as u8),
            (a, b) => Bin(Bin::pair(a, b)),
        }
    }

    /// Whether its pairs are of a mesh or height field.
    pub(crate) fn is_mesh(self) -> bool {
        self.0 >= MESHES.0
    }

    pub(super) const fn pair(a: Kind, b: Kind) -> u8 {
        a as u8 * KINDS + b as u8
    }
}

/// Pairs of one bin that one thread works through, the range of its new contacts, and its counts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Block {
    pub(crate) bin: Bin,
    /// Some contact gets a manifold that it has no place for.
    pub(crate) grown: bool,
    /// Pairs that have to be looked at again because there is no place for their manifold.
    pub(crate) crowded: u8,
    /// Range in the order.
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// Start and capacity of its new contacts and of those that grow, and how many it found.
    pub(crate) fresh: u32,
    pub(crate) place: u32,
    pub(crate) found: u32,
    /// Its index among the blocks of mesh pairs.
    pub(crate) mesh: u32,
    /// Pairs that lost their contacts.
    pub(crate) emptied: u32,
    pub(crate) casts: u32,
    pub(crate) ghosts: u32,
    /// Points shed for lack of memory.
    pub(crate) shed: u32,
}

impl Block {
    /// The range of its results among the places of all blocks.
    pub(crate) fn found(&self) -> std::ops::Range<usize> {
        self.fresh as usize..(self.fresh + self.found) as usize
    }

    /// Those of so many of its contacts that may get more points than they have.
    pub(crate) fn growing(&self, contacts: u32) -> u32 {
        const SPHERE: u8 = Kind::Sphere as u8;
        let kinds = [self.bin.0 / KINDS, self.bin.0 % KINDS];
        if self.bin.0 < TAPERED_CAPSULES.0 && kinds.contains(&SPHERE) { 0 } else { contacts }
    }
}

/// Pairs in the order of their bins.
#[derive(Debug, Default)]
pub(crate) struct Bins {
    /// Pair indices, bin after bin.
    pub(crate) order: Vec<u32>,
    pub(crate) blocks: Vec<Block>,
}

buffers! { Bins { each_and_missing(pairs: usize) { order(pairs), blocks(Self::most_blocks(pairs)) } } }

impl Bins {
    /// Sorts the pairs by bin (counting sort); those without a bin are left out.
    pub(crate) fn sort(&mut self, states: &[PackedState], allowance: &mut Allowance) {
        let mut starts = [0u32; COUNT + 1];
        let bin_of = |pair: u32| states[pair as usize].bin().unwrap_or_default();
        let binned = || pairs_that(states, |state| state.bin().is_some());
        for pair in binned() {
            starts[usize::from(bin_of(pair).0) + 1] += 1;
        }
        for bin in 0..COUNT {
            starts[bin + 1] += starts[bin];
        }
        let total = starts[COUNT];
        // The broad phase takes in pairs only if there is memory for all of them here, so it must not be used
        // for anything else.
        let place = if allowance.is_endless() { total as usize } else { states.len() };
        allowance.fit(&mut self.order, place);
        allowance.fit(&mut self.blocks, Self::most_blocks(place));
        self.order.clear();
        self.order.resize(total as usize, 0);
        self.blocks.clear();
        for bin in 0..=MESHES.0 as usize {
            let last = if bin == MESHES.0 as usize { total } else { starts[bin + 1] };
            for start in (starts[bin]..last).step_by(BLOCK as usize) {
                let end = last.min(start + BLOCK);
                self.blocks.push(Block { bin: Bin(bin as u8), start, end, ..Block::default() });
            }
        }
        for pair in binned() {
            let at = &mut starts[usize::from(bin_of(pair).0)];
            self.order[*at as usize] = pair;
            *at += 1;
        }
    }

    /// Keeps only the pairs that have to be examined again in some blocks that ran. Returns the first such
    /// block, or the end.
    pub(crate) fn repeat(&mut self, ran: std::ops::Range<usize>, states: &mut [PackedState]) -> usize {
        let mut is_crowded = |pair: u32| {
            let state = &mut states[pair as usize];
            let crowded = state.is(PairState::Crowded);
            if crowded {
                state.set(PairState::Kept);
            }
            crowded
        };
        let Bins { order, blocks } = self;
        let mut first = ran.end;
        for (index, block) in ran.clone().zip(&mut blocks[ran]) {
            let own = &mut order[block.start as usize..block.end as usize];
            // In their order, for the first in place of the others.
            let mut crowded = 0;
            for i in 0..own.len() {
                if block.crowded > 0 && is_crowded(own[i]) {
                    own.swap(crowded, i);
                    crowded += 1;
                }
            }
            if crowded > 0 {
                first = first.min(index);
            }
            block.end = block.start + crowded as u32;
            (block.place, block.found, block.grown) = (crowded as u32, 0, false);
            (block.crowded, block.emptied, block.shed) = (0, 0, 0);
        }
        first
    }

    /// Each bin may end with a block that is not full.
    fn most_blocks(pairs: usize) -> usize {
        pairs / BLOCK as usize + COUNT.min(pairs)
    }
}
