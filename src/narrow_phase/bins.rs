//! Pairs binned by shape pair, and worked through in lanes.

use super::ahead::{
    NO_GAP, fly_mesh, halfway, hit_mesh, keep_reached, look_ahead, look_ahead_mesh, look_along, look_beside,
    motion_of, right_way_out, strikes, touches_mesh, would_push,
};
use super::box_box::box_box;
use super::capsule_box::{capsule_box, tapered_capsule_box};
use super::capsule_capsule::{capsule_capsule, tapered_capsule_capsule};
use super::cast::tolerance;
use super::cast_mesh::Cast;
use super::collide::{Approach, Input, Same, lanes_of, relative_pose, relative_poses};
use super::contact::{Contact, NONE};
use super::convex::collide_convex;
use super::found::Out;
use super::gates::{enter_mesh, gate, straight};
use super::lanes_io::{ManifoldLanes, PairLanes};
use super::mesh::collide_mesh;
use super::mesh_reach::{Reach, extent_of};
use super::sphere_box::sphere_box;
use super::sphere_capsule::sphere_capsule;
use super::sphere_sphere::sphere_sphere;
use super::{RawManifold, Relative};
use crate::broad_phase::Pair;
use crate::config::{Continuous, Start};
use crate::lanes::f32x8;
use crate::memory::{Buffer, Room, bytes_of};
use crate::shape::{Collider, Hot, Kind};
use crate::threads::{Shared, per_block};
use std::cell::LazyCell;

/// A shape pair, as a small number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bin(pub(crate) u8);

const KINDS: u8 = 8;
/// Tapered capsules have kernels, and so bins, of their own.
const TAPERED_CAPSULES: Bin = Bin(KINDS * KINDS);
const TAPERED_BOX: Bin = Bin(KINDS * KINDS + 1);
/// From here on the bins of meshes, then those of height fields, by the kind of the other shape. They have no kernel in
/// lanes, so a block may have several of them: in a scene of few bodies there are not as many blocks as kinds.
const MESHES: Bin = Bin(KINDS * KINDS + 2);
/// One bin a pair of kinds, the tapered ones, and those of meshes.
const COUNT: usize = MESHES.0 as usize + 2 * KINDS as usize;
/// Pairs a block of one bin: a multiple of eight.
pub(super) const BLOCK: u32 = per_block(64, 8) as u32;

impl Bin {
    pub(crate) fn of(a: &Hot, b: &Hot) -> Bin {
        let tapered = |c: &Hot| c.kind == Kind::Capsule && c.size[1] != c.size[2];
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

/// Pairs of one bin that are worked through in one go, what place their finds have, and what was counted.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Block {
    pub(crate) bin: Bin,
    /// Range in the order.
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// Where its new contacts begin, and how many there is place for.
    pub(crate) fresh: u32,
    pub(crate) place: u32,
    /// How many of those may be, and are, of two bodies that can be pushed, and of others.
    pub(crate) quota: [u32; 2],
    pub(crate) used: [u32; 2],
    /// Which of the blocks of mesh pairs it is.
    pub(crate) mesh: u32,
    /// Pairs that lost their contacts.
    pub(crate) emptied: u32,
    pub(crate) casts: u32,
    pub(crate) ghosts: u32,
    /// Points that there was no place for.
    pub(crate) shed: u32,
}

/// Pairs in the order of their bins.
#[derive(Debug, Default)]
pub(crate) struct Bins {
    /// Pair indices, bin after bin.
    pub(crate) order: Vec<u32>,
    pub(crate) blocks: Vec<Block>,
}

impl Bins {
    /// Counting sort of the pairs by bin; those with `skip` or a higher number are left out.
    pub(crate) fn sort(&mut self, bin_of: &[u8], skip: u8, room: &mut Room) {
        let mut starts = [0u32; COUNT + 1];
        for &bin in bin_of.iter().filter(|&&bin| bin < skip) {
            starts[bin as usize + 1] += 1;
        }
        for bin in 0..COUNT {
            starts[bin + 1] += starts[bin];
        }
        let total = starts[COUNT];
        // Pairs are only taken in if there is room for all of them here, which must not go to anything else.
        let place = if room.is_endless() { total as usize } else { bin_of.len() };
        room.fit(&mut self.order, place);
        room.fit(&mut self.blocks, Self::most_blocks(place));
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

    /// Bytes that buffers lack for so many pairs.
    pub(crate) fn each(&mut self, pairs: usize, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        f(&mut self.order, pairs);
        f(&mut self.blocks, Self::most_blocks(pairs));
    }

    /// Bytes that it lacks for so many.
    pub(crate) fn missing(&self, pairs: usize) -> usize {
        self.order.missing(pairs) + self.blocks.missing(Self::most_blocks(pairs))
    }

    /// Each bin may end with one that is not full.
    fn most_blocks(pairs: usize) -> usize {
        pairs / BLOCK as usize + COUNT.min(pairs)
    }

    pub(crate) fn bytes(&self) -> (usize, usize) {
        let (a, b) = (bytes_of(&self.order), bytes_of(&self.blocks));
        (a.0 + b.0, a.1 + b.1)
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
    contacts: &Shared<'_, Contact>,
    out: &mut Out<'_>,
) {
    let margin_of = |approach: &Approach| {
        let most = approach.most();
        input.margin + if approach.is_continuous() { most } else { most.min(input.margin) }
    };
    if let Some(kernel) = kernel_of(bin) {
        for eight in order.chunks(8) {
            let pair = |lane: usize| eight[lane.min(eight.len() - 1)] as usize;
            let shape = |c: u32| input.hot[c as usize].size;
            let approach: [Approach; 8] = std::array::from_fn(|lane| input.approach(&pairs[pair(lane)]));
            let placed = relative_poses::<f32x8>(&|lane| pairs[pair(lane)], input.poses);
            let lanes = PairLanes::new(placed, |lane| {
                let p = &pairs[pair(lane)];
                (shape(p.a), shape(p.b), margin_of(&approach[lane]))
            });
            let (manifolds, placed) = (kernel(&lanes), lanes_of(&placed));
            for (lane, &index) in eight.iter().enumerate() {
                let raw = manifolds.lane(lane);
                finish_convex(input, pairs, index, raw, (&placed[lane], &approach[lane]), contacts, out);
            }
        }
        return;
    }
    for &index in order {
        let pair = &pairs[index as usize];
        let (a, b) = (&input.colliders[pair.a as usize], &input.colliders[pair.b as usize]);
        let rel = &relative_pose(pair, input.poses);
        let approach = input.approach(pair);
        if b.kind == Kind::Mesh || b.kind == Kind::HeightField {
            finish_mesh(input, pair, index, (a, b), (rel, &approach), contacts, out);
        } else {
            let raw = collide_convex(a, b, rel, margin_of(&approach));
            finish_convex(input, pairs, index, raw, (rel, &approach), contacts, out);
        }
    }
}

/// A gap that a push should have closed counts as a ghost above this many margins.
pub(crate) const GHOST_GAP: f32 = 0.5;

/// Whether the contact moves much faster than the bodies: on a round shape that is large against the other, which rocks
/// on it. The rows of a step act at one place. At the place of its start they would add energy to the rocking in every
/// step; at that of its middle they take a little away.
fn wanders(input: &Input<'_>, pair: &Pair) -> bool {
    let (a, b) = (&input.colliders[pair.a as usize], &input.colliders[pair.b as usize]);
    let large = |round: &Collider, other: &Collider| {
        let round_kind = matches!(round.kind, Kind::Sphere | Kind::Capsule | Kind::Cylinder);
        round_kind && round.radius > 2.0 * other.radius
    };
    large(a, b) || large(b, a)
}

fn finish_convex(
    input: &Input<'_>,
    pairs: &[Pair],
    index: u32,
    raw: RawManifold,
    (rel, approach): (&Relative, &Approach),
    contacts: &Shared<'_, Contact>,
    out: &mut Out<'_>,
) {
    let pair = &pairs[index as usize];
    let nearest = raw.points().iter().fold(f32::INFINITY, |s, p| s.min(p.separation));
    let (mut raw, mut fraction, mut missed) = (raw, 0.0, false);
    if approach.is_continuous() && nearest > 0.0 && raw.count > 0 && input.start != Start::Speculative {
        let fast = nearest > input.real && approach.most() > input.fast;
        let volume = approach.mode == Continuous::Volume;
        let strays = nearest <= input.margin && input.strays(pair);
        // A plane lies between the two. If the motion can't close the gap across it, they don't touch.
        let closing = -(input.poses[pair.a as usize].rotation * raw.normal).dot(approach.way);
        if fast && !volume && !strays && closing + approach.spin < nearest {
            (raw.count, missed) = (0, true);
        } else if fast || would_push(input, &motion_of(input, pair), &raw) {
            // Apart, and a plane at the start of the step would be a guess: look where they really touch.
            let hit = if input.start == Start::Gated {
                gate(input, pair, &raw)
            } else {
                out.count_casts(1);
                look_ahead(input, pair)
            };
            // On a miss there is nothing in reach on this path; the larger volume keeps what it passes.
            let found = hit.or_else(|| if volume { look_beside(input, pair) } else { None });
            if found.is_some() || !strays {
                (raw, fraction) = found.unwrap_or_default();
            }
            missed = raw.count == 0;
        }
    } else if nearest < 0.0
        && let Some(out) = right_way_out(input, pair, rel, &raw)
    {
        raw = out;
    }
    if raw.count > 0
        && input.slides_far(pair, approach)
        && let Some(later) = look_along(input, pair, (&raw, fraction))
    {
        (raw, fraction) = later;
    }
    if fraction == 0.0 && (1..3).contains(&raw.count) && wanders(input, pair) {
        let middle = halfway(input, pair, input.margin);
        // Unless it would push where nothing is touched.
        if middle.count > 0 && (nearest <= 0.0 || !would_push(input, &motion_of(input, pair), &middle)) {
            (raw, fraction) = (middle, 0.5);
        }
    }
    if pair.contact == NONE {
        if raw.count > 0 {
            out.add(input, pair, index, raw, fraction);
        } else if missed {
            out.clear(index);
        }
        return;
    }
    // SAFETY: the contact is this pair's, and this block has the pair.
    let contact = unsafe { contacts.get(pair.contact as usize) };
    if contact.pushed && nearest > GHOST_GAP * input.margin {
        out.count_ghost();
    }
    if raw.count == 0 {
        out.empty(index);
    } else {
        let frame = input.poses[pair.a as usize].rotation;
        contact.renew(&raw, (*rel, frame), Same::of(input, pair));
        contact.fraction = fraction;
    }
}

fn finish_mesh(
    input: &Input<'_>,
    pair: &Pair,
    index: u32,
    (a, b): (&Collider, &Collider),
    (rel, approach): (&Relative, &Approach),
    contacts: &Shared<'_, Contact>,
    out: &mut Out<'_>,
) {
    let most = approach.most();
    // Within half the ball that fits into it a body can't get past a triangle, and planes at the start will do. What
    // rolls moves and turns alike, and its planes are near: its way and its turn may each be as far as that ball.
    let continuous = approach.is_continuous();
    let looks = continuous && input.start != Start::Speculative;
    let gated = input.start == Start::Gated;
    let rolls = pair.contact != NONE
        && approach.mode == Continuous::Segment
        && approach.length.max(approach.spin) < a.inner_radius;
    let fast = looks && !rolls && most > input.fast.max(0.5 * a.inner_radius);
    // Where the body is, and what it may turn into: what it may reach further away is found by the cast.
    let reach = match (fast, continuous) {
        (true, _) => approach.spin.min(a.radius),
        (false, true) => most,
        (false, false) => most.min(input.margin),
    };
    let margin = input.margin + reach;
    let Some(mesh) = out.mesh.as_deref_mut() else {
        // No buffers were granted, and the contacts of the last step are out of date.
        out.count_shed(1);
        if pair.contact != NONE {
            out.empty(index);
        }
        return;
    };
    let (start, mut casts, mut nearest) = (mesh.count(), 0, f32::INFINITY);
    // What rests on the mesh may not need it.
    let (shapes, motion) = ((a, b), LazyCell::new(|| motion_of(input, pair)));
    // Without a contact it is likely to be in flight.
    mesh.mesh.nearby.forget();
    let flight = if fast && !gated && pair.contact == NONE {
        fly_mesh(input, shapes, (rel, &motion), &mut mesh.mesh)
    } else {
        Cast::Near
    };
    let mut ahead = match flight {
        Cast::First(touch) => Some(touch),
        _ => None,
    };
    if let Cast::Near = flight {
        if fast {
            // The path will be asked for too.
            let way = motion.a.rotation.conjugate() * motion.displacement;
            mesh.mesh.nearby.expect(extent_of(a, rel, margin, way));
        }
        mesh.raw.clear();
        // Of what is fast, manifolds without a near point would be dropped.
        let all = Reach::new(margin).within(if fast { input.margin } else { margin });
        // What is slow reaches what it goes to; if it strikes something, it may go anywhere.
        let aims = !fast && approach.mode == Continuous::Segment && approach.length > input.margin;
        let way = input.poses[pair.a as usize].rotation.conjugate() * -approach.way;
        let reach = if aims { Reach { way, ..Reach::new(input.margin + approach.spin) } } else { all };
        collide_mesh(a, b, rel, reach, &mut mesh.mesh, &mut mesh.raw);
        if aims && strikes(&motion, input.margin, &mesh.raw) {
            mesh.raw.clear();
            collide_mesh(a, b, rel, all, &mut mesh.mesh, &mut mesh.raw);
        } else if aims && mesh.raw.iter().any(|m| m.points().iter().all(|p| p.separation > input.margin)) {
            keep_reached(&motion, input.margin, &mut mesh.raw);
        }
        nearest = mesh.raw.iter().flat_map(|m| m.points()).fold(f32::INFINITY, |s, p| s.min(p.separation));
        // What rests on the mesh sinks by what gravity adds in the step, and must not strike the ground that it is on.
        let resting = if nearest <= input.real { input.margin } else { input.real };
        if fast {
            // Manifolds without a near point are guesses; what is really hit comes from the cast.
            mesh.raw.retain(|m| m.points().iter().any(|p| p.separation <= resting));
        }
        // Close, but apart by more than shows: planes count only if anything is touched at all.
        let apart = nearest > tolerance(a, b, input.unit).max(NO_GAP * input.real);
        let near = |m: &RawManifold| m.points().iter().any(|p| p.separation <= input.margin);
        let guess = |m: &RawManifold| would_push(input, &motion, m) && !(near(m) && input.strays(pair));
        if looks && apart && mesh.raw.iter().any(guess) {
            casts += 1;
            let touches = if gated {
                approach.spin > input.margin || enter_mesh(input, shapes, (rel, &motion), 0.0).is_some()
            } else {
                touches_mesh(input.unit, shapes, (rel, &motion), &mut mesh.mesh)
            };
            if !touches {
                mesh.raw.retain(|m| !guess(m));
            }
        }
        (0..mesh.raw.len()).for_each(|i| mesh.add(mesh.raw[i], 0.0));
        if fast {
            ahead = if gated {
                enter_mesh(input, shapes, (rel, &motion), resting)
            } else {
                look_ahead_mesh(input, shapes, (rel, &motion), resting, &mut mesh.mesh)
            };
        }
    }
    casts += u32::from(fast);
    if let Some(touch) = ahead {
        casts += 1;
        if gated {
            hit_mesh(input, pair, shapes, &straight(&motion), touch, mesh);
        } else {
            hit_mesh(input, pair, shapes, &motion, touch, mesh);
        }
    }
    let found = mesh.end(index, start);
    out.count_casts(if gated { 0 } else { casts });
    if let Cast::Free = flight {
        out.clear(index);
    }
    if pair.contact != NONE {
        // SAFETY: the contact is this pair's, and this block has the pair.
        let contact = unsafe { contacts.get(pair.contact as usize) };
        if contact.pushed && nearest > GHOST_GAP * input.margin {
            out.count_ghost();
        }
    }
    if !found && pair.contact != NONE {
        out.empty(index);
    }
}
