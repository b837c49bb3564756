//! The kernels of bins: kernels that work on the pairs of a bin in lanes, and the path of the other pairs.

use super::bins::{Bin, TAPERED_BOX, TAPERED_CAPSULES};
use super::convex::collide_convex;
use super::input::{Approach, Input};
use super::pair_policy::{PairView, finish_convex, finish_mesh, margin_of};
use super::relative::{Relative, lanes_of, relative_pose, relative_poses};
use crate::broad_phase::Pair;
use crate::lanes::{Lanes, kernel, with_best};
use crate::narrow_phase::contacts::found::BlockOutput;
use crate::narrow_phase::contacts::store::SharedContacts;
use crate::narrow_phase::pairs::box_box::box_box;
use crate::narrow_phase::pairs::capsule_box::{capsule_box, tapered_capsule_box};
use crate::narrow_phase::pairs::capsule_capsule::{capsule_capsule, tapered_capsule_capsule};
use crate::narrow_phase::pairs::lanes_io::{ManifoldLanes, PairLanes};
use crate::narrow_phase::pairs::sphere_box::sphere_box;
use crate::narrow_phase::pairs::sphere_capsule::sphere_capsule;
use crate::narrow_phase::pairs::sphere_sphere::sphere_sphere;
use crate::shape::Kind;
use crate::threads::Shared;

type Kernel<L> = fn(&PairLanes<L>) -> ManifoldLanes<L>;

/// The lane kernel of a bin, if it has one.
fn kernel_of<L: Lanes>(bin: Bin) -> Option<Kernel<L>> {
    let kernels: [(u8, Kernel<L>); 8] = [
        (TAPERED_CAPSULES.0, tapered_capsule_capsule::<L>),
        (TAPERED_BOX.0, tapered_capsule_box::<L>),
        (Bin::pair(Kind::Sphere, Kind::Sphere), sphere_sphere::<L>),
        (Bin::pair(Kind::Sphere, Kind::Capsule), sphere_capsule::<L>),
        (Bin::pair(Kind::Sphere, Kind::Box), sphere_box::<L>),
        (Bin::pair(Kind::Capsule, Kind::Capsule), capsule_capsule::<L>),
        (Bin::pair(Kind::Capsule, Kind::Box), capsule_box::<L>),
        (Bin::pair(Kind::Box, Kind::Box), box_box::<L>),
    ];
    kernels.iter().find(|(of, _)| *of == bin.0).map(|(_, kernel)| *kernel)
}

kernel! {
    /// Up to eight pairs as lanes and one by one; past the end the last is repeated.
    fn load<'a, L: Lanes>(
        eight: &'a [Pair],
        approach: &'a [Approach; 8],
        input: &'a Input<'a>,
    ) -> (PairLanes<L>, [Relative; 8]) {
        let pair = |lane: usize| &eight[lane.min(eight.len() - 1)];
        let shape = |c: u32| input.summaries[c as usize].size;
        let placed = relative_poses::<L>(&|lane| *pair(lane), input.poses);
        let lanes = PairLanes::new(placed, |lane| {
            let p = pair(lane);
            (shape(p.a), shape(p.b), margin_of(input, &approach[lane]))
        });
        (lanes, lanes_of(&placed))
    }
}

/// Works through a block of pairs of one bin in lanes.
fn run_lanes<L: Lanes>(
    kernel: Kernel<L>,
    order: &[u32],
    input: &Input<'_>,
    pairs: &Shared<'_, Pair>,
    contacts: &SharedContacts<'_>,
    out: &mut BlockOutput<'_>,
) {
    for eight in order.chunks(8) {
        // SAFETY: the pairs of a block are its own.
        let at = |lane: usize| unsafe { *pairs.get(eight[lane.min(eight.len() - 1)] as usize) };
        let all: [Pair; 8] = std::array::from_fn(at);
        let approach: [Approach; 8] = std::array::from_fn(|lane| input.approach(&all[lane]));
        let (lanes, placed) = load::<L>(&all, &approach, input);
        let manifolds = kernel(&lanes);
        for (lane, &index) in eight.iter().enumerate() {
            let (pair, rel, approach) = (&all[lane], &placed[lane], &approach[lane]);
            let view = PairView { input, pair, index, rel, approach };
            finish_convex(&view, manifolds.lane(lane), contacts, out);
        }
    }
}

/// Works through a block of pairs of one bin.
pub(crate) fn run_bin(
    bin: Bin,
    order: &[u32],
    input: &Input<'_>,
    pairs: &Shared<'_, Pair>,
    contacts: &SharedContacts<'_>,
    out: &mut BlockOutput<'_>,
) {
    let in_lanes = with_best!(Wide => kernel_of::<Wide>(bin).map(|kernel| {
        run_lanes(kernel, order, input, pairs, contacts, out);
    }));
    if in_lanes.is_some() {
        return;
    }
    for &index in order {
        // SAFETY: the pairs of a block are its own.
        let pair = &unsafe { *pairs.get(index as usize) };
        let (a, b) = input.shapes(pair);
        let rel = &relative_pose(pair, input.poses);
        let approach = &input.approach(pair);
        let view = PairView { input, pair, index, rel, approach };
        if b.kind.is_ground() {
            finish_mesh(&view, contacts, out);
        } else {
            let raw = collide_convex(a, b, rel, margin_of(input, approach));
            finish_convex(&view, raw, contacts, out);
        }
    }
}
