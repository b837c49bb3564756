//! Inputs and outputs of each stage of a step in the world, and the bookkeeping around it.

use super::stage::Part;
use crate::body::{Bodies, Colliders};
use crate::broad_phase::PairMemory;
use crate::config::tuning::{CAST_MOTION, JOINT_HOLD_TIME, RECYCLE_DISTANCE};
use crate::config::{ContinuousMethod, FrictionModel, Measures, Settings};
use crate::constraint::{
    Beside, PrepareInput, Prepared, StepLengths, WIDEST_JOINT_BATCH, find, lend, prepare, row_cost,
};
use crate::finish::Counts;
use crate::forces::{Forces, cap, damp};
use crate::memory::{Allowances, Category};
use crate::narrow_phase::{ContactMemory, Input, NarrowStats, Scale, collide};
use crate::solver::SolverInput;
use crate::statics::Structure;
use crate::threads::Workers;
use crate::time_of_impact::{Impacts, Solved, meet_impacts, meets_impacts};
use crate::world::{Buffers, StepCounts, World};
use crate::{finish, movers, solver};
use glam::Vec3;

impl World {
    /// Finds the pairs of the step, or once more after some bodies woke.
    pub(crate) fn find_pairs(&mut self, workers: &Workers<'_>, did: &mut StepCounts) {
        let mut allowances = self.allowances();
        let Buffers { broad: buffers, forces, narrow, rows, .. } = &mut self.buffers;
        let input = movers::Input {
            bodies: &self.bodies,
            joints: &self.joints,
            motion: &forces.motion,
            mode: self.settings.stage_modes().broad,
            unit: self.settings.length_unit,
            senses_static: self.needs.senses_static > 0,
        };
        movers::place(workers, &input, &mut self.colliders, &mut self.broad, buffers, &mut allowances);
        // The rows of the last step are obsolete, and without pairs there are none to make.
        let contacts = self.contacts.live();
        let mut give = |bytes: usize| rows.give_up(bytes, contacts);
        let missing = |pairs: usize| narrow.missing(pairs);
        let mut memory = PairMemory { allowances: &mut allowances, give_up: &mut give };
        let colliders = &self.colliders.all;
        let stats = movers::find(workers, &input, colliders, &mut self.broad, buffers, &missing, &mut memory);
        did.add_broad(stats);
        did.ghosts += self.forget_pairs_that_ended();
    }

    /// Records the ends of pairs, and removes their contacts. Returns how many of these had pushed in the
    /// last step.
    fn forget_pairs_that_ended(&mut self) -> u32 {
        // Before the list leaves its place, where its bytes are counted.
        if !self.buffers.broad.removed.is_empty() {
            self.refresh_event_allowance();
        }
        let mut removed = std::mem::take(&mut self.buffers.broad.removed);
        let mut ghosts = 0;
        for pair in &removed {
            self.part_pair(pair);
            ghosts += self.contacts.count_pushed(pair.contact);
            self.contacts.remove_chain(pair.contact);
        }
        removed.clear();
        self.buffers.broad.removed = removed;
        ghosts
    }

    /// Finds the contacts of the step.
    pub(crate) fn find_contacts(&mut self, workers: &Workers<'_>, dt: f32) -> NarrowStats {
        let Measures { unit, touch, margin, .. } = self.settings.measures();
        let mut allowances = self.allowances();
        let (joints, slots) = (&self.joints, &self.bodies.slot);
        let Buffers { forces, narrow, rows, prepare, statics, .. } = &mut self.buffers;
        let scale = scale(&self.colliders, &self.bodies, forces, &self.settings, dt);
        let input = Input {
            colliders: &self.colliders.all,
            summaries: &self.colliders.summaries,
            poses: &self.colliders.poses,
            swings: &self.colliders.swings,
            odometers: &self.colliders.odometers,
            motion: &forces.motion,
            fall: self.settings.gravity * (0.5 * dt * dt),
            dynamic: self.bodies.dynamic(),
            margin,
            touch_distance: touch,
            unit,
            fast: CAST_MOTION * unit,
            recycle: if self.settings.recycling { RECYCLE_DISTANCE * unit } else { -1.0 },
            mode: self.settings.stage_modes().narrow,
            start: self.settings.start(),
            scale,
            has_joints: &|body| joints.has_any(slots[body as usize]),
        };
        let (friction, model) = (self.needs.friction > 0, self.settings.friction_model);
        let beside = self.needs.beside();
        let mut lists = statics.lists();
        if beside.rolling {
            lists.0 += size_of::<Vec3>();
            lists.1 += self.contacts.rolling_bytes().1;
        }
        let mut space = lend(rows, prepare, row_cost(friction, model, beside), lists);
        let (pairs, contacts) = (&mut self.broad.pairs, &mut self.contacts);
        let memory = ContactMemory { allowances: &mut allowances, space: &mut space };
        let stats = collide(workers, &input, pairs, contacts, narrow, memory);
        rows.take_back(space.slab);
        stats
    }

    /// Estimates loads of contacts that are not known. `touching`: some contact is new.
    pub(crate) fn estimate_loads(&mut self, touching: bool, lengths: StepLengths) {
        let mut allowances = self.allowances();
        let Buffers { statics, forces, .. } = &mut self.buffers;
        statics.pending |= touching;
        let mut structure = Structure {
            bodies: &self.bodies,
            colliders: &self.colliders,
            pairs: &self.broad.pairs,
            contacts: &mut self.contacts,
            acceleration: &forces.acceleration,
        };
        statics.estimate(&mut structure, &self.settings, lengths, &mut allowances);
    }

    /// Makes the rows of the step.
    pub(crate) fn prepare(&mut self, workers: &Workers<'_>, lengths: StepLengths) -> Prepared {
        let mut allowances = self.allowances();
        let lost = self.part(Part::Restitution, |world| world.find_impacts(lengths, &mut allowances));
        self.part(Part::Joints, |world| world.arrange_joints(workers, lengths));
        let prepared = self.prepare_contacts(workers, lengths, &mut allowances);
        self.part(Part::Joints, |world| world.fill_joints(workers, lengths));
        Prepared { shed: prepared.shed + lost, ..prepared }
    }

    /// Finds the points that may bounce. Returns the number beyond the allowance.
    fn find_impacts(&mut self, lengths: StepLengths, allowances: &mut Allowances) -> u32 {
        let mut impacts = std::mem::take(&mut self.buffers.restitution);
        let lost = if self.needs.restitution == 0 {
            impacts.clear();
            0
        } else {
            let input = self.prepare_input(lengths, 0);
            allowances.within(Category::Scratch, |allowance| find(&input, &mut impacts, allowance))
        };
        self.buffers.restitution = impacts;
        lost
    }

    /// Arranges joints in trees and batches, if they changed, and fills the trees.
    fn arrange_joints(&mut self, workers: &Workers<'_>, lengths: StepLengths) {
        let mut rows = std::mem::take(&mut self.buffers.joints);
        if self.joints.changed {
            let (joints, bodies) = (&mut self.joints, &self.bodies);
            let held = rows.arranged_bytes() + joints.promised(WIDEST_JOINT_BATCH);
            self.revisions.moving += u64::from(joints.is_stale());
            joints.compact();
            let (order, in_trees) = (self.settings.order, self.settings.joint_trees);
            rows.arrange(joints, bodies, order, in_trees);
            let left = held.saturating_sub(rows.arranged_bytes());
            joints.note_resting(left, WIDEST_JOINT_BATCH, bodies);
        }
        if self.joints.count > 0 || !rows.tree_slots.is_empty() {
            let mut inertia = std::mem::take(&mut self.buffers.forces.inverse_inertia);
            rows.fill_trees(workers, &self.prepare_input(lengths, 0), &mut inertia);
            self.buffers.forces.inverse_inertia = inertia;
        }
        self.buffers.joints = rows;
    }

    fn prepare_contacts(
        &mut self,
        workers: &Workers<'_>,
        lengths: StepLengths,
        allowances: &mut Allowances,
    ) -> Prepared {
        let ahead = self.room_ahead(allowances);
        if self.needs.rolling > 0 {
            allowances.within(Category::Manifolds, |allowance| self.contacts.fit_rolling(allowance));
        }
        let mut rows = std::mem::take(&mut self.buffers.rows);
        let mut scratch = std::mem::take(&mut self.buffers.prepare);
        let prepared =
            prepare(workers, &self.prepare_input(lengths, ahead), &mut rows, &mut scratch, allowances);
        (self.buffers.rows, self.buffers.prepare) = (rows, scratch);
        prepared
    }

    /// The input of rows. `ahead`: bytes that those of contacts by continuous collision may take.
    pub(crate) fn prepare_input(&self, lengths: StepLengths, ahead: usize) -> PrepareInput<'_> {
        let (forces, beside) = (&self.buffers.forces, self.needs.beside());
        let tweaked = self.events.tweaks.iter().any(|tweak| tweak.surface != Vec3::ZERO);
        PrepareInput {
            bodies: &self.bodies,
            colliders: &self.colliders,
            contacts: &self.contacts,
            pairs: &self.broad.pairs,
            forces,
            measures: self.settings.measures(),
            ahead,
            lengths,
            order: self.settings.order,
            tree_slots: &self.buffers.joints.tree_slots,
            tweaks: &self.events.tweaks,
            per_point: self.settings.friction_model == FrictionModel::Point,
            friction: self.needs.friction > 0,
            beside: Beside { surfaces: beside.surfaces || tweaked, ..beside },
            joints: &self.joints,
            marks: &[],
            scale: scale(&self.colliders, &self.bodies, forces, &self.settings, lengths.dt()),
        }
    }

    fn fill_joints(&mut self, workers: &Workers<'_>, lengths: StepLengths) {
        if self.joints.count == 0 {
            return;
        }
        let (joints, slots) = (&self.joints, &self.bodies.slot);
        let crowd = &mut self.buffers.prepare.crowd;
        crowd.leave_out(|body: usize| joints.of_body(slots[body]).next().is_some());
        let mut batches = std::mem::take(&mut self.buffers.joints);
        batches.fill(workers, &self.prepare_input(lengths, 0), &self.buffers.rows.tree_contacts);
        self.buffers.joints = batches;
    }

    /// The rows of the step for the solver, and the bodies that they act on.
    pub(crate) fn solver_input(&mut self, lengths: StepLengths) -> SolverInput<'_> {
        #[cfg(feature = "observe")]
        let witness = self.meter.as_deref_mut().map(|meter| meter.witness());
        #[cfg(not(feature = "observe"))]
        let witness = None;
        let buffers = &mut self.buffers;
        SolverInput {
            settings: &self.settings,
            lengths,
            bodies: &mut self.bodies,
            colliders: &self.colliders.all,
            forces: &mut buffers.forces,
            rows: &mut buffers.rows,
            joints: &mut buffers.joints,
            restitution: &mut buffers.restitution,
            impulses: self.events.impulses.as_mut_slice(),
            crowd: &mut buffers.prepare.crowd,
            state: &mut buffers.solver,
            witness,
        }
    }

    /// Takes away half of the velocity that damped bodies lose in a step, and holds bodies to their greatest
    /// speeds.
    pub(crate) fn damp(&mut self, dt: f32) {
        if self.bodies.rare.damping.len() > 0 {
            damp(&mut self.bodies, dt);
        }
        if self.bodies.rare.caps.len() > 0 {
            cap(&mut self.bodies);
        }
    }

    /// Clears forces, which last for one step.
    pub(crate) fn forget_forces(&mut self) {
        self.bodies.forget_forces(self.settings.budget.is_none());
    }

    /// Makes queries use the new poses.
    pub(crate) fn update_queries(&mut self) {
        self.now.step(self.settings.budget.is_none());
    }

    /// Lengths of the substeps of a step, and of those of the step before.
    pub(crate) fn lengths(&self, dt: f32) -> StepLengths {
        let now = dt / self.settings.substeps as f32;
        let Buffers { last_h, evenness, .. } = self.buffers;
        StepLengths::new(last_h, now, dt, evenness, self.settings.warm_starting)
    }

    /// Stores the loads of joints.
    pub(crate) fn store_joints(&mut self, dt: f32) {
        if self.joints.count == 0 {
            return;
        }
        let hold = (dt / JOINT_HOLD_TIME).min(1.0);
        self.buffers.joints.store(&mut self.joints, &self.bodies, self.settings.substeps as f32 / dt, hold);
        // Rows may be left non-finite even though the velocities that they acted on were brought back into
        // range.
        self.joints.forget_unsound();
    }

    /// Breaks joints and couplings that were overloaded in the step, and lists those that were strained. A
    /// break wakes bodies, which changes their indices: so it comes after all stages that read predictions by
    /// them ([`Forces::is_of`]).
    pub(crate) fn break_overloaded(&mut self) {
        self.joints.broken.clear();
        self.joints.strained.clear();
        self.joints.couplings.broken.clear();
        if self.joints.breakable > 0 {
            self.break_joints();
        }
        if self.joints.couplings.count > 0 {
            self.break_couplings();
        }
        if self.joints.reporting > 0 {
            self.list_strained_joints();
        }
    }

    /// Stores the loads of contacts. Returns how many pushed before they touched.
    pub(crate) fn store_contacts(&mut self, workers: &Workers<'_>, lengths: StepLengths) -> u32 {
        let (dynamic, summaries) = (self.bodies.dynamic(), &self.colliders.summaries);
        let solved = self.broad.pairs.iter().filter(|pair| !pair.is_idle(summaries, dynamic));
        let per_point = self.settings.friction_model == FrictionModel::Point;
        let Buffers { rows, statics, .. } = &mut self.buffers;
        if per_point {
            // Each point adds its share.
            self.contacts.for_each_of(solved.clone(), |_, contact| contact.friction = glam::Vec3::ZERO);
        }
        let stored = {
            let contacts = self.contacts.share();
            solver::store(workers, rows, lengths, &contacts)
        };
        statics.pending |= stored.unknown_load;
        if per_point {
            // The load of a contact whose points were solved separately is that of its points.
            self.contacts.for_each_of(solved, |_, contact| {
                statics.pending |= contact.bear(lengths.dt(), lengths.now());
            });
        }
        stored.pushed
    }

    /// Moves bodies to the end of the step. `fast`: number of bodies that are faster than their boxes allow
    /// for, or 0 if that is not known.
    pub(crate) fn move_bodies(&mut self, workers: &Workers<'_>, fast: u32, dt: f32) -> Counts {
        let continuous = self.is_continuous();
        let buffers = &mut self.buffers;
        let input = finish::Input {
            bodies: &mut self.bodies,
            colliders: &self.colliders,
            broad: &self.broad,
            joints: &self.joints,
            forces: &buffers.forces,
            narrow: &buffers.narrow,
            impacts: &buffers.restitution,
            delta: &mut buffers.solver.delta,
            rows: &mut buffers.rows,
            joint_rows: &mut buffers.joints,
            vetoed: &self.events.vetoed,
            settings: &self.settings,
            continuous,
            senses: self.needs.sensors > 0,
            fast,
            dt,
        };
        let (held, mut stopped) = finish::finish(workers, input, &mut buffers.finish);
        if !stopped.is_empty() {
            self.faults.note_stopped(&self.bodies, &mut stopped);
        }
        held
    }

    /// Solves impacts one by one, if the method asks for that.
    pub(crate) fn meet_impacts(&mut self, workers: &Workers<'_>, dt: f32) -> Impacts {
        // Without these methods nothing below is compiled.
        if !ContinuousMethod::COMPARED || !meets_impacts(&self.settings) {
            return Impacts::default();
        }
        let allowance = self.allowance(Category::Continuous);
        let buffers = &mut self.buffers;
        let mut solved = Solved {
            bodies: &mut self.bodies,
            colliders: &self.colliders,
            broad: &self.broad,
            joints: &self.joints,
            forces: &buffers.forces,
            delta: &buffers.solver.delta,
            vetoed: &self.events.vetoed,
            settings: &self.settings,
            dt,
        };
        let (impacts, mut stopped) = meet_impacts(workers, &mut solved, &mut buffers.impacts, allowance);
        if !stopped.is_empty() {
            self.faults.note_stopped(&self.bodies, &mut stopped);
        }
        finish::reach_targets(&mut self.bodies, dt);
        impacts
    }
}

/// Weights of contacts, by which they are chosen if there is not enough memory for all.
fn scale<'a>(
    colliders: &'a Colliders,
    bodies: &'a Bodies,
    forces: &'a Forces,
    settings: &Settings,
    dt: f32,
) -> Scale<'a> {
    Scale {
        summaries: &colliders.summaries,
        motion: &forces.motion,
        mass: &bodies.mass,
        dynamic: bodies.dynamic(),
        gain: dt * settings.substeps as f32,
        unit: settings.length_unit,
    }
}
