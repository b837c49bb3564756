//! The narrow phase of a step: pairs in, contacts out.
//!
//! Three passes, and a fourth where ground has seams. *Place*: the relative pose of every pair that is not
//! known to be apart, eight at a time; a pair that hardly moved since its contact was found keeps it. *Bins*:
//! the others are binned by shape pair and go through their kernel in lanes. *Commit*, by one thread and in
//! the order of the pairs: contacts come and go. *Seams*: a shape that touches ground of several pieces is
//! judged against all of it ([`seams`](super::seams)).

use super::bins::{Bin, Bins};
use super::dispatch::run_bin;
use super::input::Input;
use super::pair_state::{PackedState, PairState};
use super::relative::{Relative, lanes_of, relative_poses};
use super::seams::Seams;
use crate::broad_phase::Pair;
use crate::config::ContinuousMode;
use crate::config::tuning::{FACE_SINK, ROUND_RECYCLE};
use crate::lanes::{Lanes, kernel, with_best};
use crate::memory::{Category, buffers};
use crate::narrow_phase::contacts::admit::ContactMemory;
use crate::narrow_phase::contacts::contact::{ContactRef, NO_CONTACT};
use crate::narrow_phase::contacts::found::{FoundContacts, Places, Wave};
use crate::narrow_phase::contacts::manifold::MAX_POINTS;
use crate::narrow_phase::contacts::store::{Contacts, SharedContacts};
use crate::threads::{Shared, Workers, per_block};
use std::ops::Range;

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    /// Of each pair.
    states: Vec<PackedState>,
    bins: Bins,
    found: FoundContacts,
    seams: Seams,
}

buffers! {
    Scratch {
        /// For so many pairs, in any bins.
        each_and_missing(pairs: usize) { states(pairs), bins(pairs) }
        bytes { found, seams }
    }
}

impl Scratch {
    #[cfg(debug_assertions)]
    pub(crate) fn spoil(&mut self) {
        use crate::memory::spoil;
        let Scratch { states, bins: Bins { order, blocks }, found: _, seams } = self;
        spoil(states);
        spoil(order);
        spoil(blocks);
        seams.spoil();
    }

    /// Bytes missing to work on so many pairs of meshes in one step.
    pub(crate) fn missing_to_find(&self, of_meshes: usize) -> usize {
        self.found.missing(of_meshes)
    }

    /// Whether the shapes of a continuous pair, given by its index, are surely apart all along the predicted
    /// path.
    pub(crate) fn is_clear(&self, pair: usize) -> bool {
        self.states.get(pair).is_some_and(|state| state.is(PairState::Far) || state.is(PairState::Clear))
    }
}

/// Counts of one step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct NarrowStats {
    pub(crate) recycled: u32,
    pub(crate) casts: u32,
    pub(crate) ghosts: u32,
    /// Points shed for lack of memory.
    pub(crate) shed: u32,
    /// A new contact touches.
    pub(crate) touching: bool,
}

/// Pairs a block, a multiple of the lanes: with fewer, claiming blocks costs time; with more, threads end at
/// different times.
const BLOCK: usize = per_block(128, 8);

/// Finds the contacts of all pairs, and leaves to their rows the memory that these will need. The rows of the
/// last step are no longer needed: under a budget new contacts use their memory for a while.
pub(crate) fn collide(
    workers: &Workers<'_>,
    input: &Input<'_>,
    pairs: &mut [Pair],
    contacts: &mut Contacts,
    scratch: &mut Scratch,
    mut memory: ContactMemory<'_>,
) -> NarrowStats {
    let allowances = &mut *memory.allowances;
    // The broad phase takes in pairs only if there is memory for this.
    allowances.within(Category::Scratch, |allowance| allowance.fit(&mut scratch.states, pairs.len()));
    contacts.keep_rooms(!allowances.is_endless());
    place(workers, input, pairs, contacts, scratch);
    let Scratch { states, bins, found, seams } = scratch;
    allowances.within(Category::Scratch, |allowance| bins.sort(states, allowance));
    let mut stats = NarrowStats {
        recycled: states.iter().filter(|state| state.is(PairState::Kept)).count() as u32,
        ..NarrowStats::default()
    };
    found.touching = false;
    found.plan(bins, pairs, allowances);
    found.swap_own(&mut memory);
    let (mut first, end) = (0, bins.blocks.len());
    loop {
        let last = found.wave(&mut bins.blocks, first, pairs, input, &mut memory);
        let mut wave = Wave { bins, blocks: first..last, states };
        run_blocks(workers, input, &mut wave, pairs, contacts, found.places(&mut memory.space.slab));
        stats.shed += found.commit(&mut wave, pairs, contacts, input, &mut memory);
        first = bins.repeat(first..last, states);
        if first == end {
            break;
        }
    }
    found.swap_own(&mut memory);
    stats.shed += found.finish(pairs, contacts, input, &mut memory);
    stats.shed += seams.judge(workers, input, pairs, states, contacts, &mut memory);
    stats.touching = found.touching;
    for block in &bins.blocks {
        stats.casts += block.casts;
        stats.ghosts += block.ghosts;
    }
    stats
}

/// Works on the pairs of some blocks.
fn run_blocks(
    workers: &Workers<'_>,
    input: &Input<'_>,
    wave: &mut Wave<'_>,
    pairs: &mut [Pair],
    contacts: &mut Contacts,
    places: Places<'_>,
) {
    let all = contacts.share();
    let state = Shared::new(wave.states);
    let Bins { order, blocks } = &mut *wave.bins;
    let blocks = &mut blocks[wave.blocks.clone()];
    let (count, blocks) = (blocks.len(), Shared::new(blocks));
    let (order, pairs) = (&*order, Shared::new(pairs));
    workers.run(count, &|block| {
        // SAFETY: this is the only one that runs the block.
        let block = unsafe { blocks.get(block) };
        let (bin, order) = (block.bin, &order[block.start as usize..block.end as usize]);
        // SAFETY: this is the only one that runs the block.
        let mut out = unsafe { places.of(block, &state, &pairs) };
        run_bin(bin, order, input, &pairs, &all, &mut out);
    });
}

/// Decides which pairs keep their contacts, and the bins of the others.
///
/// Relative poses are not stored: most pairs don't need them again, and computing them anew costs less than
/// storing them.
fn place(
    workers: &Workers<'_>,
    input: &Input<'_>,
    pairs: &mut [Pair],
    contacts: &mut Contacts,
    scratch: &mut Scratch,
) {
    scratch.states.clear();
    scratch.states.resize(pairs.len(), PairState::Far.into());
    let states = Shared::new(&mut scratch.states);
    let (all, count, pairs) = (contacts.share(), pairs.len(), Shared::new(pairs));
    workers.run(count.div_ceil(BLOCK), &|block| {
        let of = block * BLOCK..((block + 1) * BLOCK).min(count);
        with_best!(Wide => place_block::<Wide>(of, input, &pairs, &states, &all));
    });
}

kernel! {
    /// See [`place`]; for a block of pairs.
    fn place_block<'a, L: Lanes>(
        of: Range<usize>,
        input: &'a Input<'a>,
        pairs: &'a Shared<'a, Pair>,
        states: &'a Shared<'a, PackedState>,
        all: &'a SharedContacts<'a>,
    ) {
        // Pairs that are known to be apart have the right state already.
        let (mut looked, mut count) = ([0; BLOCK], 0);
        for i in of {
            // SAFETY: no other block has the pair.
            let pair = unsafe { pairs.get(i) };
            if !input.is_known_apart(pair) {
                pair.apart = 0;
                looked[count] = i;
                count += 1;
            }
        }
        for lanes in looked[..count].chunks(8) {
            // SAFETY: as above.
            let mut eight = [unsafe { *pairs.get(lanes[0]) }; 8];
            for (pair, &i) in eight.iter_mut().zip(lanes) {
                // SAFETY: as above.
                *pair = unsafe { *pairs.get(i) };
            }
            let placed = lanes_of(&relative_poses::<L>(&|lane| eight[lane], input.poses));
            for ((&i, pair), now) in lanes.iter().zip(&mut eight).zip(placed) {
                // SAFETY: as above; and so with the pair's state and contacts.
                unsafe {
                    *states.get(i) = state_of(input, pair, &now, all);
                    pairs.get(i).apart = pair.apart;
                }
            }
        }
    }
}

/// The treatment of a pair. Distances found on the way are stored in it.
///
/// # Safety
/// No other thread may access the contacts of this pair.
#[inline(always)]
unsafe fn state_of(
    input: &Input<'_>,
    pair: &mut Pair,
    now: &Relative,
    all: &SharedContacts<'_>,
) -> PackedState {
    let idle = pair.is_idle(input.summaries, input.dynamic);
    let state = if idle && pair.contact != NO_CONTACT {
        PairState::Kept
    } else if idle {
        PairState::Far
    // SAFETY: by the contract.
    } else if unsafe { recycle(input, pair, now, all) } {
        PairState::Kept
    } else if far(input, pair, now) || input.is_sensor(pair) {
        PairState::Far
    } else {
        let kind = |c: u32| &input.summaries[c as usize];
        PairState::Binned(Bin::of(kind(pair.a), kind(pair.b)))
    };
    let ground = state != PairState::Far && !idle && input.is_static(pair);
    PackedState::from(state).of_ground(ground)
}

/// Whether the balls around two shapes without a contact are too far apart for one.
fn far(input: &Input<'_>, pair: &mut Pair, now: &Relative) -> bool {
    if pair.contact != NO_CONTACT {
        return false;
    }
    let (a, b) = (&input.summaries[pair.a as usize], &input.summaries[pair.b as usize]);
    let (reach, approach) = (a.radius + b.radius, input.approach(pair));
    // Beyond the reach of all kernels.
    let most = reach + input.margin + approach.reach(input.margin);
    let squared = now.position.length_squared();
    if squared > most * most {
        input.note_apart(pair, squared.sqrt() - reach);
        return true;
    }
    // Fast pairs that are apart get points only at a touch, and balls that pass each other don't touch.
    // Rotation moves their centres by no more than their levers.
    if approach.mode != ContinuousMode::Segment || approach.max_closing() <= input.fast || !reach.is_finite()
    {
        return false;
    }
    let turn = |c: u32| input.motion_of(c).turn_angle.min(2.0);
    let near = reach + input.margin + a.lever * turn(pair.a) + b.lever * turn(pair.b);
    let pose = |c: u32| &input.poses[c as usize];
    let apart = (pose(pair.b).position - pose(pair.a).position).as_vec3();
    let way = approach.displacement;
    let along = (-apart.dot(way) / way.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    (apart + way * along).length_squared() > near * near
}

/// Whether the pair keeps its contacts; moves their points with the bodies if so.
///
/// # Safety
/// No other thread may access the contacts of this pair.
unsafe fn recycle(input: &Input<'_>, pair: &Pair, now: &Relative, all: &SharedContacts<'_>) -> bool {
    if pair.contact == NO_CONTACT || input.recycle < 0.0 {
        return false;
    }
    // SAFETY: by the contract.
    let first = unsafe { all.at(pair.contact) };
    let first = first.as_ref();
    if first.count == 0 || first.fraction > 0.0 {
        return false;
    }
    let reach = input.summaries[pair.a as usize].radius.min(input.summaries[pair.b as usize].radius);
    // On a round surface the normal turns as the point of contact moves on.
    let is_round = first.count < 3 && (rolls(input, pair.a) || rolls(input, pair.b));
    let limit = input.recycle.min(0.05 * reach) * if is_round { ROUND_RECYCLE } else { 1.0 };
    if pair.fast && !(first.bears() > 0.0 && is_slow(input, pair, limit)) {
        return false;
    }
    let moved = moved_past(first, &(now.position - first.found_at.position), limit);
    // |sin(angle / 2)| of the turn since then, by the quaternion's vector part.
    let d = now.rotation * first.found_at.rotation.conjugate();
    let turned = 4.0 * (d.x * d.x + d.y * d.y + d.z * d.z);
    if moved > limit * limit
        || turned * reach * reach > limit * limit
            && (is_round || swings_past(input, pair, first, d.xyz() * 2.0, limit))
    {
        return false;
    }
    // SAFETY: by the contract.
    if first.bears() == 0.0 && unsafe { may_cross(input, pair, now, all) } {
        return false;
    }
    let mut slot = pair.contact;
    while slot != NO_CONTACT {
        // SAFETY: by the contract.
        let mut contact = unsafe { all.at(slot) };
        contact.follow(now, input.poses[pair.a as usize].rotation);
        slot = contact.next;
    }
    true
}

/// Whether the shapes of a pair may get past the planes between them within the step. Such planes must not be
/// kept until they are crossed. A pair that bears a load is not apart, whichever way its separations are
/// rounded.
///
/// # Safety
/// No other thread may access the contacts of this pair.
unsafe fn may_cross(input: &Input<'_>, pair: &Pair, now: &Relative, all: &SharedContacts<'_>) -> bool {
    let approach = input.approach(pair);
    let mut nearest = f32::INFINITY;
    let mut slot = pair.contact;
    while slot != NO_CONTACT {
        // SAFETY: by the contract.
        let contact = unsafe { all.at(slot) };
        let contact = contact.as_ref();
        if contact.bears() > 0.0 {
            return false;
        }
        nearest = nearest.min(contact.nearest(now));
        slot = contact.next;
    }
    nearest > 0.0 && approach.is_continuous() && approach.max_closing() > nearest
}

/// Whether a turn of `b` against `a` moves points of both shapes by more than `limit` [m]. A plank that turns
/// about its long axis moves its points by far less than its length says; in a heap of planks manifolds would
/// change too often for anything to come to rest. `turn`: small, in the frame of `a` [rad].
#[cold]
fn swings_past(
    input: &Input<'_>,
    pair: &Pair,
    contact: ContactRef<'_>,
    turn: glam::Vec3,
    limit: f32,
) -> bool {
    let swing = |c: u32, turn: glam::Vec3| input.colliders[c as usize].swing(turn);
    let on_b = contact.found_at.rotation.conjugate() * turn;
    swing(pair.a, turn).min(swing(pair.b, on_b)) > limit
}

/// Whether two bodies that bear each other move by no more than `limit`, apart from gravity [m].
fn is_slow(input: &Input<'_>, pair: &Pair, limit: f32) -> bool {
    let approach = input.approach(pair);
    let [a, b] = [pair.a, pair.b].map(|c| input.is_pushed(c));
    let falls = f32::from(u8::from(b)) - f32::from(u8::from(a));
    (approach.displacement - input.fall * falls).length() + approach.swing <= limit
}

/// Square of how far `b` moved past `a` since their contact was found [m²]. Sinking along the normal, within
/// a few times the limit, keeps the arms: a stack that lands on itself keeps its contacts, and with them the
/// place to return to.
fn moved_past(contact: ContactRef<'_>, moved: &glam::Vec3, limit: f32) -> f32 {
    let along = contact.normal.dot(*moved);
    let sinks =
        contact.count as usize == MAX_POINTS && contact.next == NO_CONTACT && along.abs() < FACE_SINK * limit;
    if sinks { (*moved - contact.normal * along).length_squared() } else { moved.length_squared() }
}

/// Whether a shape is round somewhere.
fn rolls(input: &Input<'_>, collider: u32) -> bool {
    input.summaries[collider as usize].kind.is_round()
}
