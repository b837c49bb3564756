//! Faults: bodies whose motion is not finite, or out of range.
//!
//! The caller's input is in range ([`crate::limits`]), but forces on light bodies, joints that contradict
//! each other and changes by hooks can still lead to non-finite numbers, and within a substep these spread to
//! everything that touches or is joined to the body where they arose. So a step that finds any starts again
//! without it: the body stands still, as if it were static, and the rows of all others are made and solved
//! anew. When the step ends it is at rest where it was at its start, takes part in the next one, and
//! [`World::faulted_bodies`](crate::World::faulted_bodies) lists it.

use crate::body::{Bodies, Colliders};
use crate::forces::Forces;
use crate::handle::BodyHandle;
use crate::joint::Joints;
use crate::lanes::Record;
use crate::limits::MAX_LEFT_SPEED;
use crate::memory::buffers;

/// Maximum number of restarts of a step. Each time at least one more body stands still; bodies that are still
/// at fault after the last are stopped where bodies are moved.
pub(crate) const ATTEMPTS: usize = 4;

/// Bodies at fault in the last step.
#[derive(Debug, Default)]
pub(crate) struct Faults {
    /// Stopped bodies, in the order of their handles.
    pub(crate) stopped: Vec<BodyHandle>,
    /// Slots of the bodies that count as static until the step ends.
    frozen: Vec<u32>,
}

buffers! { Faults { bytes { stopped, frozen } } }

impl Faults {
    /// Begins a step without faults.
    pub(crate) fn forget(&mut self) {
        self.stopped.clear();
        self.frozen.clear();
    }

    /// Freezes bodies until the step ends: they join the range of sleeping ones, which are static to all
    /// stages.
    pub(crate) fn freeze(
        &mut self,
        slots: &[u32],
        bodies: &mut Bodies,
        colliders: &mut Colliders,
        joints: &mut Joints,
    ) {
        for &slot in slots {
            let dense = bodies.slots.dense(slot);
            let index = bodies.sleep(dense, colliders);
            if let Some(force) = bodies.force.get_mut(index) {
                *force = Record::default();
            }
            self.frozen.push(slot);
            self.stopped.push(BodyHandle { slot, generation: bodies.slots.generation(slot) });
        }
        joints.changed |= joints.count > 0;
    }

    /// Ends the step for frozen bodies: calls `look_again` with each of their colliders, because pairs with
    /// other frozen ones were not searched for. Returns whether any body was stopped.
    pub(crate) fn thaw(
        &mut self,
        bodies: &mut Bodies,
        colliders: &mut Colliders,
        joints: &mut Joints,
        mut look_again: impl FnMut(u32),
    ) -> bool {
        if self.stopped.is_empty() {
            return false;
        }
        self.stopped.sort_unstable();
        for &slot in &self.frozen {
            let dense = bodies.slots.dense(slot);
            let index = bodies.wake(dense, colliders) as usize;
            bodies.colliders[index].as_slice().iter().for_each(|&c| look_again(c));
        }
        joints.changed |= joints.count > 0 && !self.frozen.is_empty();
        self.frozen.clear();
        true
    }

    /// Indices of bodies that were stopped while bodies were moved.
    #[cold]
    pub(crate) fn note_stopped(&mut self, bodies: &Bodies, indices: &mut [u32]) {
        indices.sort_unstable();
        self.stopped.extend(indices.iter().map(|&i| bodies.handle(i as usize)));
    }

    /// Indices of the frozen bodies.
    pub(crate) fn frozen(&self, bodies: &Bodies) -> Vec<u32> {
        self.frozen.iter().map(|&slot| bodies.slots.dense(slot)).collect()
    }
}

/// Slots of dynamic bodies whose forces alone make their motions non-finite in a step of `dt` seconds.
#[cold]
pub(crate) fn pulled(bodies: &Bodies, forces: &Forces, dt: f32) -> Vec<u32> {
    let pulled = |i: &usize| {
        let pull = forces.acceleration.get(*i).copied().unwrap_or_default();
        !crate::forces::is_sound(&forces.motion[*i], &pull, dt)
    };
    (0..bodies.dynamic()).filter(pulled).map(|i| bodies.slot[i]).collect()
}

/// Slots of bodies to be frozen: those whose velocity or displacement (`delta`) is not finite. If joints or
/// forces act on some of them, only these are frozen, because contacts alone only spread the fault. `all`:
/// regardless of what acts on them.
pub(crate) fn culprits(bodies: &Bodies, delta: &[Record], joints: &Joints, all: bool) -> Vec<u32> {
    let unsound =
        |i: &usize| !bodies.velocity[*i].is_within(MAX_LEFT_SPEED) || !delta[*i].is_within(f32::MAX);
    let driven = |slot: &u32| {
        let force = bodies.force.get(bodies.slots.dense(*slot) as usize);
        joints.has_any(*slot) || force.is_some_and(|force| *force != Record::default())
    };
    let unsound: Vec<u32> = (0..bodies.dynamic()).filter(unsound).map(|i| bodies.slot[i]).collect();
    let some: Vec<u32> = unsound.iter().copied().filter(driven).collect();
    if all || some.is_empty() { unsound } else { some }
}
