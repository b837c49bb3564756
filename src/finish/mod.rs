//! Displacements -> poses; nothing may have crossed static geometry on the way; then the report.

mod ends;
mod free;
mod guard;
mod passing;
mod report;
mod settle;
mod trees;
mod turned;

use ends::Crossing;
pub(crate) use free::Clear;
use guard::{Counts, Guard, Held};
use passing::Movers;
pub use report::{StageTimes, StepReport};
use settle::{Settling, Tools};
use trees::Trees;
use turned::Turned;

use crate::body::{FreeTurn, Pose, carry_spin, exp_map};
use crate::broad_phase::{Pair, STACK};
use crate::config::Continuous;
use crate::config::tuning::TOUCH_DISTANCE;
use crate::constraint::Seat;
use crate::faults::is_sound;
use crate::forces::spins_freely;
use crate::lanes::{self, Record, Sym3};
use crate::limits::{MAX_LEFT_SPEED, MAX_POSITION};
use crate::memory::{Buffer, Made, bytes_of};
use crate::shape::Hot;
use crate::solver::closing;
use crate::threads::{Crew, Shared, per_block};
use crate::world::World;
use glam::{Quat, Vec3};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    stacks: Vec<Mutex<Vec<u32>>>,
    /// Of each dynamic body: it need not be looked at in there.
    pub(crate) clear: Vec<Clear>,
    /// Of each dynamic body, if there are fast ones: what is near its predicted path.
    beside: Vec<Beside>,
    /// Of strays.
    settling: settle::Scratch,
    /// Bodies of trees that were cut short, and the share of their ways that they went.
    cut: Mutex<Vec<(Seat, f32)>>,
}

impl Buffers {
    /// Calls `f` with each buffer and the place that it needs for so many bodies that can move, and that can be pushed; some
    /// of them may be joined, and some may go astray.
    pub(crate) fn each(
        &mut self,
        (movers, dynamic): (usize, usize),
        (joined, strays): (bool, bool),
        f: &mut dyn FnMut(&mut dyn Buffer, usize),
    ) {
        if joined && let Ok(cut) = self.cut.get_mut() {
            // By the static world, and by another body.
            f(cut, 2 * dynamic);
        }
        if strays {
            self.settling.each(f);
        }
        f(&mut self.clear, dynamic);
        f(&mut self.beside, dynamic);
        f(&mut stacks_of(&mut self.stacks), movers.div_ceil(BLOCK));
    }

    pub(crate) fn bytes(&self) -> (usize, usize) {
        let stacks =
            self.stacks.iter().filter_map(|s| s.lock().ok().map(|s| s.capacity() * 4)).sum::<usize>();
        let cut = self.cut.lock().map_or((0, 0), |cut| bytes_of(&cut));
        let own = self.stacks.capacity() * size_of::<Mutex<Vec<u32>>>();
        [bytes_of(&self.clear), bytes_of(&self.beside), self.settling.bytes(), cut]
            .into_iter()
            .fold((own, own + stacks), |s, b| (s.0 + b.0, s.1 + b.1))
    }

    /// What the guard of continuous bodies keeps goes.
    pub(crate) fn give_back(&mut self) {
        *self = Buffers::default();
    }

    /// There are no trees any more.
    pub(crate) fn part_trees(&mut self) {
        self.cut = Mutex::default();
    }

    /// Something static is where it was not before.
    pub(crate) fn statics_changed(&mut self) {
        self.clear.clear();
    }
}

/// Stacks for walks, each with all the place that it may need.
fn stacks_of(all: &mut Vec<Mutex<Vec<u32>>>) -> Made<'_, Mutex<Vec<u32>>> {
    Made { all, make: || Mutex::new(Vec::with_capacity(STACK)), holds: STACK * size_of::<u32>() }
}

/// What is near a body's predicted path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
enum Beside {
    #[default]
    Nothing,
    /// Static geometry, which the narrow phase saw the body miss.
    Missed,
    /// Static geometry that it may touch.
    Static,
}

/// Marks the dynamic bodies that are near something static on their predicted paths. None if nothing is fast: what is slow is
/// known to be clear of most already.
fn mark_beside(
    beside: &mut Vec<Beside>,
    fast: u32,
    (movers, dynamic): (usize, usize),
    (pairs, colliders): (&[Pair], &[Hot]),
    missed: impl Fn(usize, usize) -> bool,
) {
    beside.clear();
    if fast == 0 {
        return;
    }
    beside.resize(dynamic, Beside::Nothing);
    for (k, pair) in pairs.iter().enumerate() {
        let [a, b] = [pair.a, pair.b].map(|c| colliders[c as usize].body as usize);
        let body = a.min(b);
        if (a >= movers || b >= movers)
            && let Some(mark) = beside.get_mut(body)
        {
            *mark = (*mark).max(if missed(k, body) { Beside::Missed } else { Beside::Static });
        }
    }
}

/// A body in touch that turns by more than this in a step turns as a free one does [rad].
const WHIRLS: f32 = 0.5;

/// Bodies a block.
const BLOCK: usize = per_block(64, 1);
/// Moves the bodies to the end of the step. `fast`: how many outran their boxes; 0 if the list of pairs is not complete. Says
/// how many bodies the guard held.
pub(crate) fn finish(crew: &Crew<'_>, world: &mut World, fast: u32, dt: f32) -> Counts {
    // Read by the guard beside bodies that it moves.
    let slots = std::mem::take(&mut world.bodies.slot);
    let (held, mut stopped) = move_all(crew, world, &slots, fast, dt);
    world.bodies.slot = slots;
    if !stopped.is_empty() {
        world.note_stopped(&mut stopped);
    }
    held
}

/// How many bodies the guard held, and which were stopped.
fn move_all(crew: &Crew<'_>, world: &mut World, slots: &[u32], fast: u32, dt: f32) -> (Counts, Vec<u32>) {
    let (movers, dynamic) = (world.bodies.movers(), world.bodies.dynamic());
    let blocks = movers.div_ceil(BLOCK);
    let (cuts, lifts) = (AtomicU32::new(0), AtomicU32::new(0));
    let stopped = Mutex::new(Vec::new());
    let continuous = world.is_continuous();
    let Buffers { stacks, clear, beside, settling, cut } = &mut world.buffers.finish;
    if continuous {
        stacks_of(stacks).widen(blocks);
    }
    let mode = if continuous { world.settings.stage_modes().finish } else { Continuous::Discrete };
    let guard = Guard {
        broad: &world.broad,
        colliders: &world.colliders.all,
        hot: &world.colliders.hot,
        poses: &world.colliders.poses,
        mode,
        cuts: world.settings.guard && mode != Continuous::Discrete,
        senses: world.needs.sensors > 0,
        vetoed: &world.events.vetoed,
        joints: &world.joints,
        slots,
    };
    clear.resize(if continuous { dynamic } else { 0 }, Clear::default());
    let (bodies, narrow) = (&world.bodies, &world.buffers.narrow);
    let (hot, real) = (&world.colliders.hot, TOUCH_DISTANCE * world.settings.length_unit);
    mark_beside(beside, fast, (movers, dynamic), (&world.broad.pairs, hot), |pair, body| {
        narrow.is_clear(pair) && guard.is_around(bodies.colliders[body].as_slice(), real)
    });
    let beside = &*beside;
    let bodies = &mut world.bodies;
    let delta = Shared::new(&mut world.buffers.solver.delta);
    let (start, impacts) = (&world.buffers.forces.start, &world.buffers.restitution);
    let uneven = bodies.uneven > 0;
    let (mass, traits, colliders) = (&bodies.mass, &bodies.traits, &bodies.colliders);
    let velocity = Shared::new(&mut bodies.velocity);
    let pose = Shared::new(&mut bodies.pose);
    let stacks = &*stacks;
    let clear = Shared::new(clear);
    let (seats, shared) = (&world.buffers.joints.seats, &*cut);
    let inverse_inertia = &world.buffers.forces.inverse_inertia;
    let unit = world.settings.length_unit;
    let off = Off { motion: &world.buffers.forces.motion, start, hot, least: STRAYS * unit, dt };
    let strays = AtomicBool::new(false);
    let note = |seat: Option<Seat>, share: f32| {
        if let (Some(seat), Ok(mut cut)) = (seat, shared.lock()) {
            // Lifted off something, it may have gone further than it wanted, or where it wanted nowhere.
            cut.push((seat, if share < 1.0 { share.max(0.0) } else { 1.0 }));
        }
    };
    let stop = |i: usize, pose: &mut Pose, velocity: &mut Record, whence: Pose| {
        stop_body(pose, velocity, whence, i < dynamic);
        stopped.lock().unwrap_or_else(PoisonError::into_inner).push(i as u32);
    };
    let turns_freely =
        |i: usize| uneven && i < dynamic && spins_freely(&mass[i], &traits[i], start[i].angular, dt);
    crew.run(blocks, &|block| {
        // Without the guard there are none, and nothing is pushed.
        let mut none = Vec::new();
        let mut own = stacks.get(block).and_then(|stack| stack.lock().ok());
        let stack = own.as_deref_mut().unwrap_or(&mut none);
        let (first, end) = (block * BLOCK, ((block + 1) * BLOCK).min(movers));
        let turned = Turned::of((first..end).filter(|&i| turns_freely(i)).filter_map(|i| {
            // SAFETY: each body is in one block.
            let (pose, d) = unsafe { (pose.get(i), delta.get(i)) };
            let (rotation, spin, inertia) = (pose.rotation, start[i].angular, mass[i].inertia);
            (d.pad0 == 0.0).then_some((i - first, FreeTurn { rotation, spin, inertia, time: dt }))
        }));
        for i in first..end {
            // SAFETY: each body is in one block.
            let (pose, velocity, d) = unsafe { (pose.get(i), velocity.get(i), delta.get(i)) };
            let whence = *pose;
            if !is_sound(d, FAR) || !is_sound(velocity, MAX_LEFT_SPEED) {
                *d = Record::default();
                stop(i, pose, velocity, whence);
                continue;
            }
            // Bodies of trees that keep their energy turned with their angular momentum, substep by substep.
            let (touched, carried) = (d.pad0 != 0.0, d.pad1 != 0.0);
            let seat = seats.of(i);
            let before = seat.map(|_| whence);
            let own = colliders.get(i).map_or(&[][..], |own| own.as_slice());
            // Its axis wanders, which no look ahead knew of.
            let mut precesses = false;
            if !touched && turns_freely(i) {
                (pose.rotation, velocity.angular) = turned.of_place(i - first);
                precesses = beside.get(i).is_some_and(|beside| *beside != Beside::Nothing)
                    && off.turned(i, whence.rotation, pose.rotation, own)
                    && !guard.is_free(stack, own, whence.position, d.linear, off.reach(own));
            } else if let Some((rotation, time)) = impacts.turned(i) {
                // It bounced, and its spin is that of the moment.
                let inertia = mass[i].inertia;
                let turn = FreeTurn { rotation, spin: velocity.angular, inertia, time: dt - time };
                (pose.rotation, velocity.angular) = turn.one();
            } else {
                let mut turned = (exp_map(d.angular) * pose.rotation).normalize();
                if uneven
                    && i < dynamic
                    && !carried
                    && spins_freely(&mass[i], &traits[i], velocity.angular, dt)
                {
                    let inertia = mass[i].inertia;
                    if d.angular.length_squared() > WHIRLS * WHIRLS
                        && guard.is_elastic(colliders[i].as_slice())
                    {
                        // About an axis that stands still a rod that spins about its own would hardly tilt, and sink into
                        // what lifts its end. Its spin keeps its energy, as seen from the body.
                        let turn =
                            FreeTurn { rotation: pose.rotation, spin: d.angular / dt, inertia, time: dt };
                        turned = turn.one().0;
                        let (own, spin) = FreeTurn { spin: velocity.angular, ..turn }.one();
                        velocity.angular = turned * (own.conjugate() * spin);
                    } else {
                        velocity.angular = carry_spin(pose.rotation, turned, velocity.angular, inertia);
                    }
                }
                pose.rotation = turned;
            }
            let mut moved = d.linear;
            // What met nothing went along the path that the broad phase and the narrow phase looked along.
            let alone =
                !touched && !precesses && beside.get(i).is_some_and(|beside| *beside != Beside::Static);
            if i < dynamic && !alone && guard.wants(&traits[i], own) {
                let from = pose.position;
                // What bounced meets what it was thrown at with its speed, in the next step. What is joined goes nowhere alone.
                let bounced = impacts.bounced(i);
                let led = bounced || guard.is_elastic(own) || guard.joints.has_any(slots[i]);
                // SAFETY: each body is in one block.
                let clear = unsafe { clear.get(i) };
                let mut is_stray = !led && (precesses || touched && off.strays(i, d, own));
                if !is_stray && (guard.cuts || !led) && !guard.is_clear(stack, own, clear, from, moved) {
                    let mut kept = *velocity;
                    match guard.hold(stack, own, from, &mut moved, &mut kept) {
                        Some((Held::Cut, _)) if !led => is_stray = true,
                        Some((held, _)) if guard.cuts => {
                            let count = if held == Held::Cut { &cuts } else { &lifts };
                            count.fetch_add(1, Ordering::Relaxed);
                            note(seat, moved.length() / d.linear.length());
                            if !bounced {
                                *velocity = kept;
                            }
                        }
                        _ => moved = d.linear,
                    }
                }
                if is_stray {
                    // Stays where it was until it is settled.
                    d.pad0 = STRAY;
                    strays.store(true, Ordering::Relaxed);
                    continue;
                }
            }
            pose.position += moved.as_dvec3();
            if let Some(before) = before
                && guard.cuts
                && guard.wants(&traits[i], own)
                && let Some(crossing) = guard.crossing(stack, own, &before, pose)
            {
                cuts.fetch_add(1, Ordering::Relaxed);
                stop_end(velocity, &crossing, mass[i].inverse, &inverse_inertia[i]);
                note(seat, crossing.share);
            }
            if !is_in_range(pose) || !is_sound(velocity, MAX_LEFT_SPEED) {
                // What it turned or was lifted by was no number, however sound it began, or it is out of the world.
                stop(i, pose, velocity, whence);
            }
        }
    });
    let mut held = Counts { cut: cuts.into_inner(), lifted: lifts.into_inner(), settled: 0 };
    let mut stopped = stopped.into_inner().unwrap_or_else(PoisonError::into_inner);
    // From here on one thread goes through what is left, if there is a guard at all.
    let Some(Ok(mut stack)) = stacks.first().map(|stack| stack.lock()) else { return (held, stopped) };
    if strays.into_inner() {
        let may_grow = world.settings.budget.is_none();
        let mut tools = Tools { stack: &mut stack, scratch: settling, may_grow };
        let delta = &world.buffers.solver.delta;
        for i in (0..dynamic).filter(|&i| delta[i].pad0 == STRAY) {
            let stray = Settling {
                own: bodies.colliders[i].as_slice(),
                traits: &bodies.traits[i],
                pull: world.buffers.forces.acceleration.get(i).map_or(Vec3::ZERO, |pull| pull.linear),
                slop: world.settings.slop * unit,
                least: (STRAYS * unit)
                    .min(0.5 * guard.inner(bodies.colliders[i].as_slice()))
                    .max(2.0 * world.settings.slop * unit),
            };
            let (pose, velocity) = (&mut bodies.pose[i], &mut bodies.velocity[i]);
            let whence = *pose;
            let settled = stray.settle(&guard, &mut tools, pose, delta[i].linear, velocity);
            held.cut += u32::from(settled.cut);
            held.settled += u32::from(settled.moved);
            if !is_in_range(pose) || !is_sound(velocity, MAX_LEFT_SPEED) {
                stop_body(pose, velocity, whence, true);
                stopped.push(i as u32);
            }
        }
    }
    let Ok(cut) = cut.get_mut() else { return (held, stopped) };
    if guard.cuts {
        let delta = &mut world.buffers.solver.delta;
        let mut movers = Movers { bodies, delta, impacts, seats, cut, stack: &mut stack };
        held.cut += guard.hold_movers(&world.broad.pairs, &mut movers);
    }
    if !cut.is_empty() {
        let closing = closing(&world.settings);
        let delta = &mut world.buffers.solver.delta;
        let (rows, joints) = (&mut world.buffers.rows, &mut world.buffers.joints);
        Trees { bodies, delta, rows, joints, closing }.mend(&guard, cut, &mut stack);
        cut.clear();
    }
    if movers > dynamic && guard.cuts {
        held.cut += guard.hold_kinematic(&world.broad.pairs, bodies, &mut stack, dt);
    }
    (held, stopped)
}

/// What tells strays from others.
struct Off<'a> {
    motion: &'a [Record],
    start: &'a [Record],
    hot: &'a [Hot],
    /// Who ends less far off strays not [m].
    least: f32,
    dt: f32,
}

impl Off<'_> {
    /// Whether any point of a body ended far from where it was predicted to be, with the pull of the step and without.
    fn strays(&self, i: usize, went: &Record, own: &[u32]) -> bool {
        let reach = self.reach(own);
        let is_far = |linear: Vec3, angular: Vec3| {
            let swing = reach * (went.angular - angular).length().min(2.0);
            (went.linear - linear).length() + swing > self.least
        };
        let (meant, start) = (&self.motion[i], &self.start[i]);
        is_far(meant.linear, meant.angular) && is_far(start.linear * self.dt, start.angular * self.dt)
    }

    /// Whether a body that turned as a free one is turned otherwise than predicted, by so much that a point of it is far off.
    fn turned(&self, i: usize, before: Quat, after: Quat, own: &[u32]) -> bool {
        let meant = exp_map(self.motion[i].angular) * before;
        // The chord of the angle between them.
        let chord = 2.0 * (1.0 - meant.dot(after).powi(2)).max(0.0).sqrt();
        self.reach(own) * chord > self.least
    }

    /// How far any point of a body is from its centre, at most [m].
    fn reach(&self, own: &[u32]) -> f32 {
        own.iter().fold(0.0, |reach, &c| {
            let hot = &self.hot[c as usize];
            reach.max(hot.lever + hot.radius)
        })
    }
}

/// Marks a stray, where others have whether they were touched.
const STRAY: f32 = -1.0;
/// Who ends further from where it was predicted to be strays [length units].
const STRAYS: f32 = 0.0025;

/// Puts a body back to where it was, at rest. The velocity of a kinematic one is the caller's.
#[cold]
fn stop_body(pose: &mut Pose, velocity: &mut Record, whence: Pose, is_dynamic: bool) {
    *pose = whence;
    if is_dynamic {
        *velocity = Record::default();
    }
}

/// Whether a body is where a caller could put it; beyond, boxes and distances would be no numbers soon.
#[inline(always)]
fn is_in_range(pose: &Pose) -> bool {
    pose.is_finite() && pose.position.abs().max_element() <= MAX_POSITION
}

/// Displacements beyond are out of the world, whatever the body was [m], [rad].
const FAR: f32 = 4.0 * MAX_POSITION as f32;

/// Takes away the speed with which an end of a body goes into something.
fn stop_end(velocity: &mut Record, crossing: &Crossing, inverse_mass: f32, inverse_inertia: &Sym3<f32>) {
    let Crossing { arm, normal, .. } = *crossing;
    let speed = normal.dot(velocity.linear + velocity.angular.cross(arm));
    let lever = arm.cross(normal);
    let turned = inverse_inertia.mul(lanes::Vec3::new(lever.x, lever.y, lever.z)).lane(0);
    let mobility = inverse_mass + lever.dot(turned);
    if speed < 0.0 && mobility > 0.0 {
        let impulse = -speed / mobility;
        velocity.linear += normal * (impulse * inverse_mass);
        velocity.angular += turned * impulse;
    }
}
