//! Displacements in, poses out; nothing may have crossed static geometry in between.
//!
//! Threads move bodies block by block, each as far as the guard allows ([`moving`]). The rest is done
//! afterwards by one thread: bodies off their predicted path ([`settle`]), bodies that meet each other
//! ([`passing`]), and trees of joints of which a body was held ([`trees`]).

mod beside;
mod ends;
mod free;
mod guard;
mod moving;
mod passing;
mod settle;
mod trees;
mod turned;

use beside::{Beside, mark_beside};
pub(crate) use free::Clear;
pub(crate) use guard::Counts;
use guard::Guard;
pub(crate) use moving::is_in_range;
use moving::{FAR, Moving};
use passing::Movers;
use settle::{Tools, settle_off_path};
use trees::Trees;
use turned::BLOCK;

use crate::body::{Bodies, Colliders};
use crate::broad_phase::{BroadPhase, STACK};
use crate::config::tuning::STRAY_DISTANCE;
use crate::config::{ContinuousMode, Settings};
use crate::constraint::{JointRows, Restitution, Rows, TreeSlot};
use crate::forces::Forces;
use crate::joint::Joints;
use crate::lanes::Record;
use crate::memory::{Buffer, Made, bytes_of, sum_bytes};
use crate::narrow_phase::Scratch;
use crate::threads::{Shared, Workers};
use std::sync::{Mutex, PoisonError};

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    stacks: Vec<Mutex<Vec<u32>>>,
    /// For each dynamic body, a ball in which its path need not be checked.
    pub(crate) clear: Vec<Clear>,
    /// For each dynamic body, if any is fast: the static geometry near its predicted path.
    beside: Vec<Beside>,
    /// For bodies off their predicted path.
    settling: settle::Scratch,
    /// Bodies of trees whose paths were cut, and the share of them that they went.
    cut: Mutex<Vec<(TreeSlot, f32)>>,
}

/// The content for which the buffers are made.
pub(crate) struct Content {
    pub(crate) movers: usize,
    pub(crate) dynamic: usize,
    /// Whether some bodies may be joined.
    pub(crate) joined: bool,
}

// Not by `buffers!`: some are behind locks, and some exist only in some scenes.
impl Buffers {
    /// Calls `f` with each buffer and the capacity that it needs.
    pub(crate) fn each(&mut self, content: &Content, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        let Content { movers, dynamic, joined } = *content;
        if joined && let Ok(cut) = self.cut.get_mut() {
            // Cut by static geometry, and by another body.
            f(cut, 2 * dynamic);
        }
        f(&mut self.clear, dynamic);
        f(&mut self.beside, dynamic);
        f(&mut stacks_of(&mut self.stacks), movers.div_ceil(BLOCK));
    }

    /// Calls `f` with the buffers of bodies that are settled.
    pub(crate) fn each_to_settle(&mut self, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        self.settling.each(f);
    }

    pub(crate) fn bytes(&self) -> (usize, usize) {
        let stacks =
            self.stacks.iter().filter_map(|s| s.lock().ok().map(|s| s.capacity() * 4)).sum::<usize>();
        let cut = self.cut.lock().map_or((0, 0), |cut| bytes_of(&cut));
        let own = self.stacks.capacity() * size_of::<Mutex<Vec<u32>>>();
        let stacks = (own, own + stacks);
        sum_bytes([bytes_of(&self.clear), bytes_of(&self.beside), self.settling.bytes(), cut, stacks])
    }

    /// Releases the buffers of the guard of continuous bodies.
    pub(crate) fn release(&mut self) {
        *self = Buffers::default();
    }

    /// Releases the buffers of trees.
    pub(crate) fn part_trees(&mut self) {
        self.cut = Mutex::default();
    }

    /// Forgets empty balls: static geometry moved or was added.
    pub(crate) fn statics_changed(&mut self) {
        self.clear.clear();
    }
}

/// Stacks for tree traversals, each with its full capacity.
fn stacks_of(all: &mut Vec<Mutex<Vec<u32>>>) -> Made<'_, Mutex<Vec<u32>>> {
    Made { all, make: || Mutex::new(Vec::with_capacity(STACK)), holds: STACK * size_of::<u32>() }
}

/// Input of the end of a step, and the bodies that it moves.
pub(crate) struct Input<'a> {
    pub(crate) bodies: &'a mut Bodies,
    pub(crate) colliders: &'a Colliders,
    pub(crate) broad: &'a BroadPhase,
    pub(crate) joints: &'a Joints,
    pub(crate) forces: &'a Forces,
    pub(crate) narrow: &'a Scratch,
    pub(crate) impacts: &'a Restitution,
    /// Displacement [m] and rotation vector [rad] of each movable body.
    pub(crate) delta: &'a mut [Record],
    pub(crate) rows: &'a mut Rows,
    pub(crate) joint_rows: &'a mut JointRows,
    /// Pairs that hooks let pass through each other, sorted.
    pub(crate) vetoed: &'a [(u32, u32)],
    pub(crate) settings: &'a Settings,
    /// Whether any body is continuous, and whether any shape is a sensor.
    pub(crate) continuous: bool,
    pub(crate) senses: bool,
    /// Number of bodies that are faster than their boxes allow for; 0 if the list of pairs is incomplete.
    pub(crate) fast: u32,
    /// Length of the step [s].
    pub(crate) dt: f32,
}

/// Moves the bodies to the end of the step. Returns how many the guard held, and which were stopped because
/// their motion was not finite or left the range of the world.
pub(crate) fn finish(
    workers: &Workers<'_>,
    mut input: Input<'_>,
    buffers: &mut Buffers,
) -> (Counts, Vec<u32>) {
    // The guard reads these while it moves other bodies.
    let slots = std::mem::take(&mut input.bodies.slot);
    let mode = if input.continuous { input.settings.stage_modes().finish } else { ContinuousMode::Discrete };
    let guard = Guard {
        broad: input.broad,
        colliders: &input.colliders.all,
        summaries: &input.colliders.summaries,
        poses: &input.colliders.poses,
        mode,
        cuts: input.settings.guard && mode != ContinuousMode::Discrete,
        senses: input.senses,
        vetoed: input.vetoed,
        joints: input.joints,
        slots: &slots,
    };
    let mut moved = move_all(workers, &guard, &mut input, buffers);
    reach_targets(input.bodies, input.dt);
    mend_all(&guard, &mut input, buffers, &mut moved);
    input.bodies.slot = slots;
    (moved.held, moved.stopped)
}

/// Puts kinematic bodies exactly where they are to be after a step of `dt` seconds: integrated, their
/// velocities lead there but for rounding.
pub(crate) fn reach_targets(bodies: &mut Bodies, dt: f32) {
    let kinematic = bodies.dynamic()..bodies.movers();
    let Bodies { rare, slots, velocity, details, pose, .. } = bodies;
    for (slot, target) in rare.targets.iter() {
        let index = slots.dense(slot) as usize;
        // One that does not move is there.
        if target.dt == dt && kinematic.contains(&index) && velocity[index] != Record::default() {
            pose[index] = details[index].pose_at(target.position, target.rotation);
        }
    }
}

/// The result of moving all bodies.
struct Moved {
    held: Counts,
    /// Bodies that were put back to where they were, at rest.
    stopped: Vec<u32>,
    /// Whether some are off their predicted path: these stay where they were until they are settled.
    any_off_path: bool,
}

/// Moves each body independently, in blocks.
fn move_all(workers: &Workers<'_>, guard: &Guard<'_>, input: &mut Input<'_>, buffers: &mut Buffers) -> Moved {
    let Input { bodies, colliders, broad, forces, narrow, impacts, delta, joint_rows, .. } = input;
    let (movers, dynamic, measures) = (bodies.movers(), bodies.dynamic(), input.settings.measures());
    let blocks = movers.div_ceil(BLOCK);
    let Buffers { stacks, clear, beside, cut, .. } = buffers;
    if input.continuous {
        stacks_of(stacks).reserve_total(blocks);
    }
    clear.resize(if input.continuous { dynamic } else { 0 }, Clear::default());
    let summaries = &colliders.summaries;
    mark_beside(beside, input.fast, movers, dynamic, &broad.pairs, summaries, |pair, body| {
        narrow.is_clear(pair) && guard.is_around(bodies.colliders[body].as_slice(), measures.touch)
    });
    let Bodies { mass, traits, colliders, velocity, pose, uneven, .. } = &mut **bodies;
    let moving = Moving {
        guard,
        velocity: Shared::new(velocity),
        pose: Shared::new(pose),
        delta: Shared::new(delta),
        clear: Shared::new(clear),
        mass,
        traits,
        colliders,
        forces,
        impacts,
        tree_slots: &joint_rows.tree_slots,
        beside,
        stacks,
        cut,
        least: STRAY_DISTANCE * measures.unit,
        uneven: *uneven > 0,
        movers,
        dynamic,
        dt: input.dt,
        cuts: Default::default(),
        lifts: Default::default(),
        any_off_path: Default::default(),
        stopped: Default::default(),
    };
    workers.run(blocks, &|block| moving.move_block(block));
    let held = Counts { cut: moving.cuts.into_inner(), lifted: moving.lifts.into_inner(), settled: 0 };
    let stopped = moving.stopped.into_inner().unwrap_or_else(PoisonError::into_inner);
    Moved { held, stopped, any_off_path: moving.any_off_path.into_inner() }
}

/// The part for one thread, if the guard is on: bodies off their predicted path, bodies that would pass
/// through each other, trees of joints whose paths were cut, and bodies that a kinematic one overran.
fn mend_all(guard: &Guard<'_>, input: &mut Input<'_>, buffers: &mut Buffers, moved: &mut Moved) {
    let Buffers { stacks, settling, cut, .. } = buffers;
    let Some(Ok(mut stack)) = stacks.first().map(|stack| stack.lock()) else { return };
    let Input { bodies, broad, forces, impacts, delta, rows, joint_rows, settings, dt, .. } = input;
    let (movers, dynamic) = (bodies.movers(), bodies.dynamic());
    if moved.any_off_path {
        let may_grow = settings.budget.is_none();
        let mut tools = Tools { stack: &mut stack, scratch: settling, may_grow };
        settle_off_path(guard, &mut tools, bodies, delta, &forces.acceleration, settings, moved);
    }
    let Ok(cut) = cut.get_mut() else { return };
    if guard.cuts {
        let tree_slots = &joint_rows.tree_slots;
        let mut movers = Movers { bodies, delta, impacts, tree_slots, cut, stack: &mut stack };
        moved.held.cut += guard.hold_movers(&broad.pairs, &mut movers);
    }
    if !cut.is_empty() {
        let slop = settings.measures().slop;
        Trees { bodies, delta, rows, joints: joint_rows, slop }.mend(guard, cut, &mut stack);
        cut.clear();
    }
    if movers > dynamic && guard.cuts {
        moved.held.cut += guard.hold_kinematic(&broad.pairs, bodies, &mut stack, *dt);
    }
}
