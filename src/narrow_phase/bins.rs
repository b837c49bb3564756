//! Bins of pairs with the same two shapes, and the kernels that work through them in lanes.

use super::collide::{Approach, Input, lanes_of, relative_pose, relative_poses};
use super::convex::collide_convex;
use super::pair_policy::{PairState, finish_convex, finish_mesh, margin_of};
use crate::broad_phase::Pair;
use crate::lanes::f32x8;
use crate::memory::{Allowance, buffers};
use crate::narrow_phase::contacts::found::BlockOutput;
use crate::narrow_phase::contacts::store::SharedContacts;
use crate::narrow_phase::pairs::box_box::box_box;
use crate::narrow_phase::pairs::capsule_box::{capsule_box, tapered_capsule_box};
use crate::narrow_phase::pairs::capsule_capsule::{capsule_capsule, tapered_capsule_capsule};
use crate::narrow_phase::pairs::lanes_io::{ManifoldLanes, PairLanes};
use crate::narrow_phase::pairs::sphere_box::sphere_box;
use crate::narrow_phase::pairs::sphere_capsule::sphere_capsule;
use crate::narrow_phase::pairs::sphere_sphere::sphere_sphere;
use crate::shape::{ColliderSummary, Kind};
use crate::threads::per_block;

/// A shape pair, as a small number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bin(pub(crate) u8);

const KINDS: u8 = 8;
/// Tapered capsules have kernels, and so bins, of their own.
const TAPERED_CAPSULES: Bin = Bin(KINDS * KINDS);
const TAPERED_BOX: Bin = Bin(KINDS * KINDS + 1);
/// The bins of meshes begin here, then those of height fields, by the kind of the other shape. They have no
/// kernel in lanes, so a block may contain several of them: in a scene of few bodies there are fewer blocks
/// than kinds.
const MESHES: Bin = Bin(KINDS * KINDS + 2);
/// One bin for each pair of kinds, the tapered ones, and those of meshes.
const COUNT: usize = MESHES.0 as usize + 2 * KINDS as usize;
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

    const fn pair(a: Kind, b: Kind) -> u8 {
        a as u8 * KINDS + b as u8
    }
}

/// Pairs of one bin that one thread works through, the range of its new contacts, and its counts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Block {
    pub(crate) bin: Bin,
    /// Contacts that get a manifold that they have no place for, and pairs that have to be looked at again
    /// because there is no place for that manifold.
    pub(crate) grown: u8,
    pub(crate) crowded: u8,
    /// The most of the former.
    pub(crate) growth: u8,
    /// Range in the order.
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// Start and capacity of its new contacts and of those that grow.
    pub(crate) fresh: u32,
    pub(crate) place: u32,
    /// Most and present number of new contacts between two bodies that can be pushed, and of others.
    pub(crate) quota: [u32; 2],
    pub(crate) used: [u32; 2],
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
    /// Manifolds in its part of the new contacts.
    pub(crate) fn found(&self) -> usize {
        (self.used[0] + self.used[1]) as usize + usize::from(self.grown)
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
    /// Sorts the pairs by bin (counting sort); those with `skip` or a higher number are left out.
    pub(crate) fn sort(&mut self, bin_of: &[u8], skip: u8, allowance: &mut Allowance) {
        let mut starts = [0u32; COUNT + 1];
        for &bin in bin_of.iter().filter(|&&bin| bin < skip) {
            starts[bin as usize + 1] += 1;
        }
        for bin in 0..COUNT {
            starts[bin + 1] += starts[bin];
        }
        let total = starts[COUNT];
        // The broad phase takes in pairs only if there is memory for all of them here, so it must not be used
        // for anything else.
        let place = if allowance.is_endless() { total as usize } else { bin_of.len() };
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
        for (pair, &bin) in bin_of.iter().enumerate().filter(|&(_, &bin)| bin < skip) {
            let at = &mut starts[bin as usize];
            self.order[*at as usize] = pair as u32;
            *at += 1;
        }
    }

    /// Leaves only what has to be looked at again in some blocks that ran. Returns the first such block, or
    /// the end.
    pub(crate) fn repeat(&mut self, ran: std::ops::Range<usize>, is_crowded: &dyn Fn(u32) -> bool) -> usize {
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
            (block.place, block.quota, block.used) = (crowded as u32, [0; 2], [0; 2]);
            block.growth = crowded as u8;
            (block.grown, block.crowded, block.emptied, block.shed) = (0, 0, 0, 0);
        }
        first
    }

    /// Each bin may end with a block that is not full.
    fn most_blocks(pairs: usize) -> usize {
        pairs / BLOCK as usize + COUNT.min(pairs)
    }
}

type Kernel = fn(&PairLanes<f32x8>) -> ManifoldLanes<f32x8>;

/// The lane kernel of a bin, if it has one.
fn kernel_of(bin: Bin) -> Option<Kernel> {
    const SPHERES: u8 = Bin::pair(Kind::Sphere, Kind::Sphere);
    const SPHERE_CAPSULE: u8 = Bin::pair(Kind::Sphere, Kind::Capsule);
    const SPHERE_BOX: u8 = Bin::pair(Kind::Sphere, Kind::Box);
    const CAPSULES: u8 = Bin::pair(Kind::Capsule, Kind::Capsule);
    const CAPSULE_BOX: u8 = Bin::pair(Kind::Capsule, Kind::Box);
    const BOXES: u8 = Bin::pair(Kind::Box, Kind::Box);
    const TAPERED: u8 = TAPERED_CAPSULES.0;
    const TAPERED_ON_BOX: u8 = TAPERED_BOX.0;
    match bin.0 {
        TAPERED => Some(tapered_capsule_capsule::<f32x8>),
        TAPERED_ON_BOX => Some(tapered_capsule_box::<f32x8>),
        SPHERES => Some(sphere_sphere::<f32x8>),
        SPHERE_CAPSULE => Some(sphere_capsule::<f32x8>),
        SPHERE_BOX => Some(sphere_box::<f32x8>),
        CAPSULES => Some(capsule_capsule::<f32x8>),
        CAPSULE_BOX => Some(capsule_box::<f32x8>),
        BOXES => Some(box_box::<f32x8>),
        _ => None,
    }
}

/// Works through a block of pairs of one bin.
pub(crate) fn run_bin(
    bin: Bin,
    order: &[u32],
    input: &Input<'_>,
    pairs: &[Pair],
    contacts: &SharedContacts<'_>,
    out: &mut BlockOutput<'_>,
) {
    if let Some(kernel) = kernel_of(bin) {
        for eight in order.chunks(8) {
            let pair = |lane: usize| eight[lane.min(eight.len() - 1)] as usize;
            let shape = |c: u32| input.summaries[c as usize].size;
            let approach: [Approach; 8] = std::array::from_fn(|lane| input.approach(&pairs[pair(lane)]));
            let placed = relative_poses::<f32x8>(&|lane| pairs[pair(lane)], input.poses);
            let lanes = PairLanes::new(placed, |lane| {
                let p = &pairs[pair(lane)];
                (shape(p.a), shape(p.b), margin_of(input, &approach[lane]))
            });
            let (manifolds, placed) = (kernel(&lanes), lanes_of(&placed));
            for (lane, &index) in eight.iter().enumerate() {
                let (pair, rel, approach) = (&pairs[index as usize], &placed[lane], &approach[lane]);
                let state = PairState { input, pair, index, rel, approach };
                finish_convex(&state, manifolds.lane(lane), contacts, out);
            }
        }
        return;
    }
    for &index in order {
        let pair = &pairs[index as usize];
        let (a, b) = (&input.colliders[pair.a as usize], &input.colliders[pair.b as usize]);
        let rel = &relative_pose(pair, input.poses);
        let approach = &input.approach(pair);
        let state = PairState { input, pair, index, rel, approach };
        if b.kind == Kind::Mesh || b.kind == Kind::HeightField {
            finish_mesh(&state, contacts, out);
        } else {
            let raw = collide_convex(a, b, rel, margin_of(input, approach));
            finish_convex(&state, raw, contacts, out);
        }
    }
}
