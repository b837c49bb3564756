//! One step on one screen.

use crate::broad_phase::BroadStats;
use crate::config::FrictionModel;
use crate::config::tuning::{
    CAST_MOTION, CONTACT_MARGIN, JOINT_HOLD_TIME, MIN_THREADED_BODIES, RECYCLE_DISTANCE, STATIC_SLIP_SPEED,
    TOUCH_DISTANCE,
};
use crate::constraint::{
    FindInput, JointInput, JointRows, PrepareInput, PrepareScratch, Prepared, Restitution, Rows, StepLengths,
    evenness, find, lend, prepare,
};
use crate::error::Error;
use crate::events::{ContactHooks, NoHooks};
use crate::finish::{StageTimes, StepReport};
use crate::forces::Forces;
use crate::memory::{Category, MemoryReport, bytes_of};
use crate::narrow_phase::{Input, Scale, Scratch, collide};
use crate::record::probe;
use crate::statics::Statics;
use crate::threads::{Crew, Shared, with_crew};
use crate::world::{PartTimes, World};
use crate::{finish, movers, solver, time_of_impact};
use std::time::Instant;

/// Buffers that stages hand on to each other, kept from step to step.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    pub(crate) forces: Forces,
    pub(crate) broad: movers::Buffers,
    pub(crate) narrow: Scratch,
    pub(crate) restitution: Restitution,
    pub(crate) prepare: PrepareScratch,
    pub(crate) rows: Rows,
    pub(crate) joints: JointRows,
    pub(crate) statics: Statics,
    pub(crate) solver: solver::State,
    pub(crate) finish: finish::Buffers,
    pub(crate) impacts: time_of_impact::Buffers,
    /// Length of the step [s].
    pub(crate) dt: f32,
    /// Length of the last substep [s]: impulses are warm-started in proportion.
    pub(crate) last_h: f32,
    /// See `constraint::evenness`.
    pub(crate) evenness: f32,
}

impl Buffers {
    /// `continuous`: whether anything is. Discrete physics looks along the predicted motion too, but no further than a margin.
    pub(crate) fn report(&self, report: &mut MemoryReport, continuous: bool) {
        let motion = if continuous { Category::Continuous } else { Category::Scratch };
        report.add(motion, bytes_of(&self.forces.motion));
        report.add(Category::Continuous, self.impacts.bytes());
        report.add(Category::Scratch, self.forces.bytes());
        report.add(Category::Scratch, self.broad.bytes());
        report.add(Category::Scratch, self.narrow.bytes());
        report.add(Category::Scratch, self.restitution.bytes());
        report.add(Category::Scratch, self.prepare.bytes());
        report.add(Category::Joints, self.joints.bytes());
        report.add(Category::Scratch, self.statics.bytes());
        report.add(Category::Scratch, self.solver.bytes());
        report.add(Category::Scratch, self.finish.bytes());
    }
}

impl World {
    /// Moves the world on by `dt` seconds and says what that took.
    ///
    /// # Errors
    /// If `dt` is not in [`MIN_STEP`](crate::limits::MIN_STEP)..=[`MAX_STEP`](crate::limits::MAX_STEP), or a step panicked before.
    pub fn step(&mut self, dt: f32) -> Result<&StepReport, Error> {
        self.step_with(dt, &NoHooks)
    }

    /// The same with a word on contacts before they are solved.
    ///
    /// A hook that panics does so through this call, and leaves the step half done: from then on the world can't be stepped
    /// ([`Error::Poisoned`]) until [`World::restore`] brings it back to a whole state.
    ///
    /// # Errors
    /// If `dt` is not in [`MIN_STEP`](crate::limits::MIN_STEP)..=[`MAX_STEP`](crate::limits::MAX_STEP), or a step panicked before.
    pub fn step_with(&mut self, dt: f32, hooks: &dyn ContactHooks) -> Result<&StepReport, Error> {
        crate::limits::step(dt)?;
        if let Some(stage) = self.stage {
            return Err(Error::Poisoned { stage });
        }
        #[cfg(feature = "replay")]
        if self.tape.is_some() {
            self.step_taped(dt, hooks);
            return Ok(&self.report);
        }
        self.step_once(dt, hooks);
        Ok(&self.report)
    }

    pub(crate) fn step_once(&mut self, dt: f32, hooks: &dyn ContactHooks) {
        let threads = if self.bodies.movers() < MIN_THREADED_BODIES { 1 } else { self.settings.threads };
        let mut helpers = std::mem::take(&mut self.helpers);
        with_crew(threads, &mut helpers, |crew| self.run(&crew, dt, hooks));
        self.helpers = helpers;
    }

    /// The stages by name, in order, timed.
    fn run(&mut self, crew: &Crew<'_>, dt: f32, hooks: &dyn ContactHooks) {
        self.stage = Some("broad");
        let start = Instant::now();
        let mut times = StageTimes::default();
        let demand = self.demand();
        self.spent = PartTimes::default();
        self.make_place_for_step();
        self.keep_rest();
        self.events.start();
        self.buffers.dt = dt;

        self.forget_faults();
        self.predict(crew, dt);
        let mut broad = movers::pairs(crew, self);
        let watch = Watch::start(self.settings.sleeping);
        let woke = self.wake_what_is_reached();
        self.spent.sleeping = watch.stop();
        if woke {
            self.predict(crew, dt);
            broad = sum(broad, movers::pairs(crew, self));
        }
        probe!(self, Forces);
        probe!(self, Broad);
        let mut clock = lap(start, &mut times.broad);

        self.stage = Some("narrow");
        let narrow = self.narrow(crew, dt);
        probe!(self, Narrow);
        let watch = Watch::start(self.needs.hooks > 0);
        self.ask_hooks(hooks);
        self.spent.hooks = watch.stop();
        clock = lap(clock, &mut times.narrow);

        self.stage = Some("prepare");
        self.buffers.statics.pending |= narrow.touching;
        self.estimate_loads(dt);
        self.listen();
        let mut prepared = self.prepare(crew, dt);
        if broad.0.shed + narrow.shed + prepared.shed > 0 {
            self.buffers.prepare.crowd.shed();
        }
        probe!(self, Prepare);
        clock = lap(clock, &mut times.prepare);

        self.stage = Some("solve");
        let lengths = self.lengths(dt);
        if !self.solve(crew, dt) {
            prepared = self.solve_without_faults(crew, dt, prepared);
        }
        prepared.impacts = self.buffers.restitution.count;
        let free = self.settings.budget.is_none();
        self.bodies.forget_forces(free);
        let watch = Watch::start(self.joints.count > 0);
        self.store_joints(dt);
        self.spent.joints += watch.stop();
        let stored = {
            if self.settings.friction_model == FrictionModel::Point {
                // Each point adds its share.
                self.forget_friction();
            }
            let contacts = Shared::new(&mut self.contacts.all);
            solver::store(crew, &mut self.buffers.rows, dt, lengths, &contacts)
        };
        self.buffers.statics.pending |= stored.unknown_load;
        if self.settings.friction_model == FrictionModel::Point {
            self.bear_apart(dt, lengths.now());
        }
        let watch = Watch::start(self.needs.events > 0);
        self.hear_contacts();
        self.spent.events = watch.stop();
        probe!(self, Solve);
        clock = lap(clock, &mut times.solve);

        self.stage = Some("finish");
        // Where pairs were shed, to have none says nothing.
        let fast = if broad.0.shed > 0 { 0 } else { broad.0.fast };
        let held = finish::finish(crew, self, fast, dt);
        let impacts = time_of_impact::meet_impacts(crew, self, dt);
        #[cfg(feature = "lab")]
        self.read_accuracy();
        self.thaw();
        // Not before: hooks may have asked where things are.
        self.now.step(free);
        let watch = Watch::start(self.needs.sensors > 0);
        self.hear_sensors();
        self.spent.sensors = watch.stop();
        self.grant_events();
        self.events.finish(self.settings.event_capacity as usize);
        let watch = Watch::start(self.settings.sleeping);
        self.rest(crew, dt);
        self.spent.sleeping += watch.stop();
        self.give_back(demand);
        let end = lap(clock, &mut times.finish);
        times.step = (end - start).as_secs_f32() * 1e6;
        self.buffers.evenness = evenness(self.buffers.evenness, lengths);
        self.buffers.last_h = lengths.now();
        self.report = StepReport::new(self, times, broad, narrow, prepared, stored.pushed, (held, impacts));
        (self.sleep.woke, self.sleep.slept) = (0, 0);
        self.note_peaks();
        self.stage = None;
    }

    /// Solves the rows; says whether all velocities stayed in range.
    pub(crate) fn solve(&mut self, crew: &Crew<'_>, dt: f32) -> bool {
        #[cfg(feature = "lab")]
        let mut meter = self.start_measuring(dt);
        #[cfg(feature = "lab")]
        let witness = meter.as_deref_mut().map(|meter| meter as &mut dyn solver::Witness);
        #[cfg(not(feature = "lab"))]
        let witness = None;
        let buffers = &mut self.buffers;
        let rows = (&mut buffers.rows, &mut buffers.joints);
        let state = (&mut buffers.solver, &buffers.prepare.crowd, witness);
        let impulses = self.events.impulses.as_mut_slice();
        let impacts = (&mut buffers.restitution, impulses, self.colliders.all.as_slice());
        let (bodies, forces) = (&mut self.bodies, &mut buffers.forces);
        let sound = solver::solve(crew, &self.settings, dt, bodies, forces, rows, impacts, state);
        #[cfg(feature = "lab")]
        self.stop_measuring(meter);
        sound
    }

    pub(crate) fn lengths(&self, dt: f32) -> StepLengths {
        let now = dt / self.settings.substeps as f32;
        let Buffers { last_h, evenness, .. } = self.buffers;
        StepLengths::new(last_h, now, dt, evenness, self.settings.warm_starting)
    }

    /// Of all contacts of the step.
    fn forget_friction(&mut self) {
        let dynamic = self.bodies.dynamic();
        for pair in self.broad.pairs.iter().filter(|pair| !pair.is_idle(&self.colliders.hot, dynamic)) {
            let mut slot = pair.contact;
            while let Some(contact) = self.contacts.all.get_mut(slot as usize) {
                contact.friction = glam::Vec3::ZERO;
                slot = contact.next;
            }
        }
    }

    /// Lets contacts whose points were solved apart bear what these did.
    fn bear_apart(&mut self, dt: f32, h: f32) {
        let dynamic = self.bodies.dynamic();
        for pair in self.broad.pairs.iter().filter(|pair| !pair.is_idle(&self.colliders.hot, dynamic)) {
            let mut slot = pair.contact;
            while let Some(contact) = self.contacts.all.get_mut(slot as usize) {
                self.buffers.statics.pending |= contact.bear(dt, h);
                slot = contact.next;
            }
        }
    }

    /// What joints bore, and which of them broke.
    fn store_joints(&mut self, dt: f32) {
        self.joints.broken.clear();
        if self.joints.count == 0 {
            return;
        }
        let hold = (dt / JOINT_HOLD_TIME).min(1.0);
        self.buffers.joints.store(&mut self.joints, &self.bodies, self.settings.substeps as f32 / dt, hold);
        // Rows may end as no numbers though the velocities that they acted on were brought back.
        self.joints.forget_unsound();
        if self.joints.any_breakable() {
            self.break_joints();
        }
    }

    fn narrow(&mut self, crew: &Crew<'_>, dt: f32) -> crate::narrow_phase::NarrowStats {
        let unit = self.settings.length_unit;
        let mut rooms = self.rooms();
        let (joints, slots) = (&self.joints, &self.bodies.slot);
        let gain = dt * self.settings.substeps as f32;
        let Buffers { forces, narrow, rows, prepare, statics, .. } = &mut self.buffers;
        let input = Input {
            colliders: &self.colliders.all,
            hot: &self.colliders.hot,
            poses: &self.colliders.poses,
            motion: &forces.motion,
            fall: self.settings.gravity * (0.5 * dt * dt),
            dynamic: self.bodies.dynamic(),
            margin: CONTACT_MARGIN * unit,
            real: TOUCH_DISTANCE * unit,
            unit,
            fast: CAST_MOTION * unit,
            recycle: if self.settings.recycling { RECYCLE_DISTANCE * unit } else { -1.0 },
            mode: self.settings.stage_modes().narrow,
            start: self.settings.start(),
            scale: Scale {
                hot: &self.colliders.hot,
                motion: &forces.motion,
                mass: &self.bodies.mass,
                dynamic: self.bodies.dynamic(),
                gain,
                unit,
            },
            has_joints: &|body| joints.has_any(slots[body as usize]),
        };
        let how = (self.needs.friction > 0, self.settings.friction_model == FrictionModel::Point);
        let mut space = lend(rows, prepare, how, statics.lists());
        let (pairs, contacts) = (&mut self.broad.pairs, &mut self.contacts);
        let stats = collide(crew, &input, pairs, contacts, narrow, (&mut rooms, &mut space));
        rows.take_back(space.slab);
        stats
    }

    pub(crate) fn prepare(&mut self, crew: &Crew<'_>, dt: f32) -> Prepared {
        let unit = self.settings.length_unit;
        let forces = &self.buffers.forces;
        let mut lost = 0;
        let mut rooms = self.rooms();
        let watch = Watch::start(self.needs.restitution > 0);
        if self.needs.restitution > 0 {
            let input = FindInput {
                bodies: &self.bodies,
                colliders: &self.colliders.all,
                poses: &self.colliders.poses,
                pairs: &self.broad.pairs,
                contacts: &self.contacts.all,
                joints: &self.joints,
                motion: &forces.motion,
                acceleration: &forces.acceleration,
                tweaks: &self.events.tweaks,
                threshold: self.settings.restitution_threshold * unit,
                real: TOUCH_DISTANCE * unit,
                dt,
            };
            let impacts = &mut self.buffers.restitution;
            lost = rooms.within(Category::Scratch, |room| find(&input, impacts, room));
        } else {
            self.buffers.restitution.clear();
        }
        self.spent.restitution = watch.stop();
        let watch = Watch::start(self.joints.count > 0);
        let h = dt / self.settings.substeps as f32;
        let lengths = self.lengths(dt);
        let warm = lengths.ratio();
        if self.joints.changed {
            self.revisions.moving += u64::from(self.joints.is_stale());
            self.joints.compact();
            let (order, in_trees) = (self.settings.order, self.settings.joint_trees);
            self.buffers.joints.arrange(&self.joints, &self.bodies, order, in_trees);
        }
        if self.joints.count > 0 || !self.buffers.joints.seats.is_empty() {
            let Buffers { joints, forces, .. } = &mut self.buffers;
            let input = JointInput {
                bodies: &self.bodies,
                inverse_inertia: &[],
                acceleration: &forces.acceleration,
                joints: &self.joints,
                pairs: &self.broad.pairs,
                hot: &self.colliders.hot,
                seated: &[],
                order: self.settings.order,
                warm,
                h,
                unit: self.settings.length_unit,
            };
            joints.fill_trees(crew, &input, &mut forces.inverse_inertia);
        }
        self.spent.joints = watch.stop();
        let ahead = self.room_ahead(&rooms);
        let forces = &self.buffers.forces;
        let input = PrepareInput {
            bodies: &self.bodies,
            colliders: &self.colliders.all,
            hot: &self.colliders.hot,
            poses: &self.colliders.poses,
            contacts: &self.contacts.all,
            pairs: &self.broad.pairs,
            motion: &forces.motion,
            inverse_inertia: &forces.inverse_inertia,
            real: TOUCH_DISTANCE * unit,
            near: 2.0 * CONTACT_MARGIN * unit,
            ahead,
            lengths,
            stick: STATIC_SLIP_SPEED * unit,
            slop: self.settings.slop * unit,
            order: self.settings.order,
            seats: &self.buffers.joints.seats,
            tweaks: &self.events.tweaks,
            per_point: self.settings.friction_model == FrictionModel::Point,
            friction: self.needs.friction > 0,
            scale: Scale {
                hot: &self.colliders.hot,
                motion: &forces.motion,
                mass: &self.bodies.mass,
                dynamic: self.bodies.dynamic(),
                gain: dt * self.settings.substeps as f32,
                unit,
            },
        };
        let prepared = prepare(crew, &input, &mut self.buffers.rows, &mut self.buffers.prepare, &mut rooms);
        if self.joints.count > 0 {
            let joints = &self.joints;
            let joined = |body: usize| joints.of_body(self.bodies.slot[body]).next().is_some();
            self.buffers.prepare.crowd.leave_out(joined);
            let watch = Watch::start(true);
            let input = JointInput {
                bodies: &self.bodies,
                inverse_inertia: &self.buffers.forces.inverse_inertia,
                acceleration: &self.buffers.forces.acceleration,
                joints: &self.joints,
                pairs: &self.broad.pairs,
                hot: &self.colliders.hot,
                seated: &self.buffers.rows.seated,
                order: self.settings.order,
                warm,
                h,
                unit: self.settings.length_unit,
            };
            self.buffers.joints.fill(crew, &input);
            self.spent.joints += watch.stop();
        }
        Prepared { shed: prepared.shed + lost, ..prepared }
    }
}

/// What two looks for pairs did in all.
fn sum((one, ghosts): (BroadStats, u32), (two, more): (BroadStats, u32)) -> (BroadStats, u32) {
    let stats = BroadStats {
        moved: one.moved + two.moved,
        added: one.added + two.added,
        removed: one.removed + two.removed,
        built: one.built + two.built,
        ..two
    };
    (stats, ghosts + more)
}

/// The time of a part that is needed; of one that isn't nothing is measured.
struct Watch(Option<Instant>);

impl Watch {
    fn start(needed: bool) -> Watch {
        Watch(needed.then(Instant::now))
    }
    /// [us]
    fn stop(self) -> f32 {
        self.0.map_or(0.0, |start| start.elapsed().as_secs_f32() * 1e6)
    }
}

/// Adds the time since `start` to a stage [us] and returns now.
fn lap(start: Instant, stage: &mut f32) -> Instant {
    let now = Instant::now();
    *stage = (now - start).as_secs_f32() * 1e6;
    now
}
