//! Bodies that a step had to stop, and a step that restarts without them.

use crate::constraint::{Prepared, StepLengths};
use crate::faults::{ATTEMPTS, culprits, pulled};
use crate::forces::predict;
use crate::handle::BodyHandle;
use crate::solver;
use crate::threads::Workers;
use crate::world::World;

/// # Faults
impl World {
    /// Bodies that the last step stopped, because their new position or velocity was not finite or out of
    /// range. Each is where it was before the step, or where the impact was that left it none, at rest, and
    /// takes part in the next one.
    /// [`StepReport::faulted`](crate::StepReport::stopped) is their number.
    pub fn faulted_bodies(&self) -> &[BodyHandle] {
        &self.faults.stopped
    }

    /// Predicts motions. Bodies whose forces alone make these non-finite stand still for the step.
    pub(crate) fn predict(&mut self, workers: &Workers<'_>, dt: f32) {
        if self.predict_all(workers, dt) {
            let slots = pulled(&self.bodies, &self.buffers.forces, dt);
            self.freeze(&slots);
            self.predict_all(workers, dt);
        }
    }

    fn predict_all(&mut self, workers: &Workers<'_>, dt: f32) -> bool {
        predict(workers, &mut self.bodies, self.settings.gravity, &mut self.buffers.forces, dt)
    }

    /// Prepares and solves once more without the bodies whose motion is not finite. `prepared`: counts of the
    /// attempt with them.
    #[cold]
    pub(crate) fn solve_without_faults(
        &mut self,
        workers: &Workers<'_>,
        lengths: StepLengths,
        mut prepared: Prepared,
    ) -> Prepared {
        for attempt in 1..=ATTEMPTS {
            let delta = &self.buffers.solver.delta;
            let slots = culprits(&self.bodies, delta, &self.joints, attempt == ATTEMPTS);
            if slots.is_empty() {
                // They returned into range by themselves.
                break;
            }
            // Restore the velocities of the start of the step; poses have not changed.
            self.bodies.velocity[..self.buffers.forces.start.len()]
                .copy_from_slice(&self.buffers.forces.start);
            self.freeze(&slots);
            self.forget_impulses();
            self.predict_all(workers, lengths.dt());
            self.reserve_impulses();
            prepared = self.prepare(workers, lengths);
            self.measure_rows(lengths.dt());
            let in_range = solver::solve(workers, self.solver_input(lengths));
            self.measure_solution();
            if in_range {
                break;
            }
        }
        prepared
    }

    fn freeze(&mut self, slots: &[u32]) {
        self.faults.freeze(slots, &mut self.bodies, &mut self.colliders, &mut self.joints);
    }

    /// Ends the step for the bodies that stood still.
    pub(crate) fn thaw(&mut self) {
        let World { bodies, colliders, joints, faults, broad, .. } = self;
        if faults.thaw(bodies, colliders, joints, |collider| broad.look_again(collider)) {
            // Impulses that these bodies got or passed on before they were found.
            self.forget_impulses();
        }
    }

    /// Impulses that are not finite, or act on a body that stands still, are not used for warm starting.
    pub(crate) fn forget_impulses(&mut self) {
        let frozen = self.faults.frozen(&self.bodies);
        let summaries = &self.colliders.summaries;
        let stands = |c: u32| frozen.contains(&summaries[c as usize].body);
        self.contacts.for_each_of(&self.broad.pairs, |pair, contact| {
            let stands = !frozen.is_empty() && (stands(pair.a) || stands(pair.b));
            if stands || !contact.as_ref().has_sound_loads() {
                contact.forget_loads();
            }
        });
        self.joints.forget_unsound();
    }
}
