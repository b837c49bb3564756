//! One step on one screen: the stages by name, in order.
//!
//! The inputs and outputs of each stage are in `world/step/inputs.rs`; clocks, hashes for recordings and the
//! name of the current stage in `world/step/stage.rs`.

use crate::config::tuning::MIN_THREADED_BODIES;
use crate::error::Error;
use crate::solver;
use crate::threads::{Workers, with_workers};
use crate::world::{ContactHooks, NoHooks, Part, Stage, StepCounts, StepReport, World};

/// # Steps
impl World {
    /// Moves the world on by `dt` seconds. Returns the report of the step.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// for _ in 0..60 {
    ///     let report = world.step(1.0 / 60.0)?;
    ///     assert_eq!(report.faulted, 0);
    /// }
    /// // It fell by 1.5 m and lies on the ground.
    /// assert!((world.position(body)?.y - 0.5).abs() < 0.01);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If `dt` is not in [`MIN_STEP`](crate::limits::MIN_STEP)..=[`MAX_STEP`](crate::limits::MAX_STEP), or a
    /// step panicked before.
    pub fn step(&mut self, dt: f32) -> Result<&StepReport, Error> {
        self.step_with(dt, &NoHooks)
    }

    /// Steps the world; `hooks` may veto or edit contacts before they are solved.
    ///
    /// A panic in a hook passes through this call, and leaves the step half done: from then on the world
    /// can't be stepped ([`Error::Poisoned`]) until [`World::restore`] brings it back to a valid state.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// /// Lets nothing collide: for a ghost.
    /// struct Ghost;
    /// impl ContactHooks for Ghost {
    ///     fn contact(&self, contact: &mut ContactHook<'_>) {
    ///         contact.veto();
    ///     }
    /// }
    /// let shape = world.shapes(body)?.next().expect("its cube");
    /// world.set_hooks(shape, true)?;
    /// for _ in 0..120 {
    ///     world.step_with(1.0 / 60.0, &Ghost)?;
    /// }
    /// assert!(world.position(body)?.y < -5.0);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If `dt` is not in [`MIN_STEP`](crate::limits::MIN_STEP)..=[`MAX_STEP`](crate::limits::MAX_STEP), or a
    /// step panicked before.
    pub fn step_with(&mut self, dt: f32, hooks: &dyn ContactHooks) -> Result<&StepReport, Error> {
        crate::limits::step(dt)?;
        if let Some(stage) = self.stage {
            return Err(Error::Poisoned { stage });
        }
        self.note_step_begins();
        let threads = if self.bodies.movers() < MIN_THREADED_BODIES { 1 } else { self.settings.threads };
        let mut helpers = std::mem::take(&mut self.helpers);
        with_workers(threads, &mut helpers, |workers| self.run(&workers, dt, hooks));
        self.helpers = helpers;
        self.note_step_ends(dt);
        Ok(&self.report)
    }

    /// Runs the stages.
    fn run(&mut self, workers: &Workers<'_>, dt: f32, hooks: &dyn ContactHooks) {
        let mut clock = self.begin_step(dt);
        let lengths = self.lengths(dt);
        let mut did = StepCounts::default();
        clock.stage(self, Stage::Broad, |world| {
            world.damp(dt);
            world.predict(workers, dt);
            world.find_pairs(workers, &mut did);
            if world.part(Part::Sleeping, World::wake_what_is_reached) {
                world.predict(workers, dt);
                world.find_pairs(workers, &mut did);
            }
        });
        clock.stage(self, Stage::Narrow, |world| did.narrow = world.find_contacts(workers, dt));
        clock.stage(self, Stage::Hooks, |world| world.part(Part::Hooks, |world| world.ask_hooks(hooks)));
        clock.stage(self, Stage::Prepare, |world| {
            world.estimate_loads(did.narrow.touching, lengths);
            world.reserve_impulses();
            did.prepared = world.prepare(workers, lengths);
            if did.shed() > 0 {
                world.buffers.prepare.crowd.shed();
            }
        });
        clock.stage(self, Stage::Solve, |world| {
            world.measure_rows(dt);
            let in_range = solver::solve(workers, world.solver_input(lengths));
            world.measure_solution();
            if !in_range {
                did.prepared = world.solve_without_faults(workers, lengths, did.prepared);
            }
            did.prepared.impacts = world.buffers.restitution.count;
            world.forget_forces();
            world.part(Part::Joints, |world| world.store_joints(dt));
            did.pushed = world.store_contacts(workers, lengths);
            world.part(Part::Events, World::record_contact_events);
        });
        let demand = clock.demand;
        clock.stage(self, Stage::Finish, |world| {
            did.held = world.move_bodies(workers, did.fast(), dt);
            did.met = world.meet_impacts(workers, dt);
            world.measure_step();
            world.thaw();
            world.part(Part::Joints, World::break_overloaded);
            world.damp(dt);
            // Not earlier: hooks may have made queries.
            world.update_queries();
            world.part(Part::Sensors, World::record_sensor_events);
            world.sort_events();
            world.part(Part::Sleeping, |world| world.rest(workers, dt));
            world.release(demand);
        });
        self.end_step(clock, &did, lengths);
    }
}
