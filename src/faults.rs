//! Faults: bodies whose motion is no number, or beyond what can be followed.
//!
//! What a caller says is in range ([`crate::limits`]), but forces on light bodies, joints that contradict each other and what a
//! hook asks for can still make numbers that are none, and within a substep these are in everything that touches or is joined
//! to the body where they arose. So a step that finds any begins again without it: the body stands where it was, as if it
//! were static, and the rows of all others are made and solved anew. When the step ends it is at rest where it was at its
//! start, takes part in the next one, and [`World::stopped_bodies`] names it.

use crate::broad_phase::Pair;
use crate::constraint::Prepared;
use crate::handle::BodyHandle;
use crate::lanes::{Lanes, Mask, Record, f32x8};
use crate::limits::MAX_LEFT_SPEED as MOST;
use crate::memory::bytes_of;
use crate::threads::Crew;
use crate::world::World;

/// How often a step begins again. Each time at least one body stands still; what is left then is stopped where bodies are
/// moved.
const ATTEMPTS: usize = 4;

/// Bodies of the last step.
#[derive(Debug, Default)]
pub(crate) struct Faults {
    /// Those that were stopped, in the order of their handles.
    pub(crate) stopped: Vec<BodyHandle>,
    /// Slots of those that count as static until the step ends.
    frozen: Vec<u32>,
}

impl Faults {
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let (a, b) = (bytes_of(&self.stopped), bytes_of(&self.frozen));
        (a.0 + b.0, a.1 + b.1)
    }
}

/// Whether a velocity or a displacement is within a limit; what is no number is not. One comparison of eight lanes.
#[inline(always)]
pub(crate) fn is_within(r: f32x8, most: f32) -> bool {
    r.abs().le(f32x8::splat(most)).bits() == 0xff
}

/// The same of a record.
#[inline(always)]
pub(crate) fn is_sound(r: &Record, most: f32) -> bool {
    is_within(bytemuck::must_cast(*r), most)
}

impl World {
    /// Bodies that the last step stopped, because their new place or velocity was no number or out of range. Each is where it
    /// was before the step, at rest, and takes part in the next one. As many as [`StepReport::stopped`](crate::StepReport::stopped) says.
    pub fn stopped_bodies(&self) -> &[BodyHandle] {
        &self.faults.stopped
    }

    /// Begins a step without faults.
    pub(crate) fn forget_faults(&mut self) {
        self.faults.stopped.clear();
        self.faults.frozen.clear();
    }

    /// Predicts motions. Whose forces alone make them no numbers stands still from here on.
    pub(crate) fn predict(&mut self, crew: &Crew<'_>, dt: f32) {
        if crate::forces::predict(crew, self, dt) {
            self.freeze_pulled(crew, dt);
        }
    }

    #[cold]
    fn freeze_pulled(&mut self, crew: &Crew<'_>, dt: f32) {
        let forces = &self.buffers.forces;
        let pulled = |i: &usize| {
            let pull = forces.acceleration.get(*i).copied().unwrap_or_default();
            !crate::forces::is_sound(&forces.motion[*i], &pull, dt)
        };
        let slots = (0..self.bodies.dynamic()).filter(pulled).map(|i| self.bodies.slot[i]).collect();
        self.freeze(slots);
        crate::forces::predict(crew, self, dt);
    }

    /// Prepares and solves once more without those whose motion is no number. `prepared`: what came of it with them.
    #[cold]
    pub(crate) fn solve_without_faults(
        &mut self,
        crew: &Crew<'_>,
        dt: f32,
        mut prepared: Prepared,
    ) -> Prepared {
        for attempt in 1..=ATTEMPTS {
            let slots = self.culprits(attempt == ATTEMPTS);
            if slots.is_empty() {
                // They came back into the range by themselves.
                break;
            }
            // Velocities as they were when the step began; poses still are.
            self.bodies.velocity[..self.buffers.forces.start.len()]
                .copy_from_slice(&self.buffers.forces.start);
            self.freeze(slots);
            self.forget_impulses();
            crate::forces::predict(crew, self, dt);
            self.listen();
            prepared = self.prepare(crew, dt);
            if !self.solve(crew, dt) {
                break;
            }
        }
        prepared
    }

    /// Slots of bodies to be frozen: of those whose motion is no number the ones that joints or forces act on, if there are any,
    /// because contacts alone only spread what those begin. `all`: whatever acts on them.
    fn culprits(&self, all: bool) -> Vec<u32> {
        let bodies = &self.bodies;
        let unsound = |i: &usize| {
            !is_sound(&bodies.velocity[*i], MOST) || !is_sound(&self.buffers.solver.delta[*i], f32::MAX)
        };
        let driven = |slot: &u32| {
            let force = bodies.force.get(bodies.slots.dense(*slot) as usize);
            self.joints.has_any(*slot) || force.is_some_and(|force| *force != Record::default())
        };
        let unsound: Vec<u32> = (0..bodies.dynamic()).filter(unsound).map(|i| bodies.slot[i]).collect();
        let some: Vec<u32> = unsound.iter().copied().filter(driven).collect();
        if all || some.is_empty() { unsound } else { some }
    }

    /// Has bodies stand where they are until the step ends: they go where sleepers are, which are static to all stages.
    fn freeze(&mut self, slots: Vec<u32>) {
        let World { bodies, colliders, joints, faults, .. } = self;
        for slot in slots {
            let index = bodies.send_to_sleep(bodies.slots.dense(slot), |own, index| {
                own.as_slice().iter().for_each(|&c| colliders.follow(c, index));
            }) as usize;
            bodies.velocity[index] = Record::default();
            bodies.colliders[index].as_slice().iter().for_each(|&c| colliders.place(c, &bodies.pose[index]));
            if let Some(force) = bodies.force.get_mut(index) {
                *force = Record::default();
            }
            faults.frozen.push(slot);
            faults.stopped.push(BodyHandle { slot, generation: bodies.slots.generation(slot) });
        }
        joints.changed |= joints.count > 0;
    }

    /// Ends the step for those that stood still.
    pub(crate) fn thaw(&mut self) {
        if self.faults.stopped.is_empty() {
            return;
        }
        self.faults.stopped.sort_unstable();
        let World { bodies, colliders, joints, faults, broad, .. } = self;
        for &slot in &faults.frozen {
            let index = bodies.wake(bodies.slots.dense(slot), |own, index| {
                own.as_slice().iter().for_each(|&c| colliders.follow(c, index));
            }) as usize;
            // Pairs with others that stood still were not looked for.
            bodies.colliders[index].as_slice().iter().for_each(|&c| broad.look_again(c));
        }
        joints.changed |= joints.count > 0 && !faults.frozen.is_empty();
        faults.frozen.clear();
        // What they made of impulses before they were found, or of those of others.
        self.forget_impulses();
    }

    /// Bodies by index that were put back where they are moved.
    #[cold]
    pub(crate) fn note_stopped(&mut self, indices: &mut [u32]) {
        indices.sort_unstable();
        let handles: Vec<BodyHandle> = indices.iter().map(|&i| self.handle_of(i as usize)).collect();
        self.faults.stopped.extend(handles);
    }

    /// Where impulses are no numbers, or are of a body that stands still, nothing is warm-started with them.
    pub(crate) fn forget_impulses(&mut self) {
        let frozen: Vec<u32> = self.faults.frozen.iter().map(|&slot| self.bodies.slots.dense(slot)).collect();
        let hot = &self.colliders.hot;
        let stands = |pair: &Pair| [pair.a, pair.b].iter().any(|&c| frozen.contains(&hot[c as usize].body));
        for pair in &self.broad.pairs {
            let (mut slot, stands) = (pair.contact, !frozen.is_empty() && stands(pair));
            while let Some(contact) = self.contacts.all.get_mut(slot as usize) {
                if stands || !contact.has_sound_loads() {
                    contact.forget_loads();
                }
                slot = contact.next;
            }
        }
        self.joints.forget_unsound();
    }
}
