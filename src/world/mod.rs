//! The world: it owns every store. Its methods are in a file per subject.
//!
//! - `content/`: bodies, shapes, joints and ragdolls; their mass and motion.
//! - `step/`: the inputs of each stage, and everything around the stages.
//! - `characters.rs`: characters that live in the world.
//! - `events.rs`, `hooks.rs`, `sleep.rs`, `report.rs`: events and reports of a step, hooks on it, and sleep.
//! - `memory/`: memory that the world needs, holds, and may reserve.

mod characters;
mod contacts;
mod content;
mod events;
mod hooks;
mod memory;
mod report;
mod revisions;
mod sleep;
mod step;

pub(crate) use characters::{CHARACTER_WORDS, Characters, Resident};
pub use contacts::{BodyContact, ContactPoint};
pub(crate) use contacts::{Place, place_of, relative_now};
pub use content::Aabb;
pub(crate) use content::finite_position;
pub use hooks::{ContactHook, ContactHooks, NoHooks};
pub(crate) use memory::{Brings, ContentForecast, Demand, Needs, PartTimes, Replacement};
pub use memory::{Feature, Model, ModelPart};
pub(crate) use report::StepCounts;
pub use report::{StageTimes, StepReport};
pub(crate) use revisions::{Revisions, SharedPart};
#[cfg(feature = "replay")]
pub(crate) use step::Recorder;
#[cfg(feature = "lab")]
pub(crate) use step::StepMeter;
pub(crate) use step::{Buffers, Change, Part, Stage};

use crate::body::{Bodies, Colliders};
use crate::broad_phase::{BroadPhase, Pair, QueryIndex};
use crate::config::Settings;
use crate::error::Error;
use crate::events::Events;
use crate::faults::Faults;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::joint::Joints;
use crate::limits;
use crate::memory::{Buffer, MemoryReport};
use crate::narrow_phase::Contacts;
use crate::sleep::Sleep;
use crate::threads::Helpers;
use glam::DVec3;
use memory::Assets;

/// Bodies that move, collide and come to rest.
///
/// In the order of use:
///
/// 1. [`World::new`] makes an empty world from [`Settings`]; [`World::set_settings`] and
///    [`World::set_origin`] change it later.
/// 2. [`World::add_body`], [`World::add_shape`], [`World::add_joint`] and
///    [`Skeleton::add_to`](crate::Skeleton::add_to) fill it.
///    Each returns a handle, by which content is looked up, changed and removed.
/// 3. [`World::step`] moves it on, [`World::step_with`] with hooks on contacts. The [`StepReport`] has the
///    times and counts of the step.
/// 4. [`World::position`], [`World::rotation`] and others tell where bodies are, [`World::contact_begins`]
///    and others what they touch; [`World::cast_ray`] and others answer queries.
/// 5. [`World::memory`] lists what the world holds, [`World::model`] which parts of the engine its content
///    needs.
/// 6. [`World::snapshot`] saves its state, and [`World::restore`] brings back the same bits.
///
/// Content changes between steps only. A handle becomes stale when its body, shape or joint is removed: a
/// stale handle is an [`Error`], never another body. A call that returns an error has changed nothing.
#[derive(Debug, Default)]
pub struct World {
    pub(crate) settings: Settings,
    pub(crate) bodies: Bodies,
    pub(crate) colliders: Colliders,
    pub(crate) broad: BroadPhase,
    /// Current positions of movable colliders, for queries.
    pub(crate) now: QueryIndex,
    pub(crate) joints: Joints,
    pub(crate) characters: Characters,
    pub(crate) contacts: Contacts,
    pub(crate) buffers: Buffers,
    pub(crate) report: StepReport,
    pub(crate) needs: Needs,
    /// The parts of the engine that the last step needed, and their times.
    pub(crate) last_demand: Demand,
    pub(crate) spent: PartTimes,
    pub(crate) origin: DVec3,
    assets: Assets,
    peaks: MemoryReport,
    removed: Vec<Pair>,
    pub(crate) sleep: Sleep,
    pub(crate) events: Events,
    /// Change counters of the data that snapshots share.
    pub(crate) revisions: Revisions,
    /// Bodies that the last step had to stop.
    pub(crate) faults: Faults,
    /// The current stage of a step; between steps, the stage in which the last one panicked.
    pub(crate) stage: Option<&'static str>,
    pub(crate) helpers: Helpers,
    /// Present while the accuracy of steps is measured.
    #[cfg(feature = "lab")]
    pub(crate) meter: Option<Box<dyn StepMeter>>,
    /// Present while the world is recorded or replayed.
    #[cfg(feature = "replay")]
    pub(crate) recorder: Option<Box<dyn Recorder>>,
}

impl World {
    /// An empty world.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn new(settings: Settings) -> Result<World, Error> {
        settings.validate()?;
        Ok(World { settings, ..World::default() })
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Replaces the settings; the next step uses them.
    ///
    /// # Errors
    /// If a setting is out of range, or their budget does not allow what they switch on (sleeping, or a
    /// continuous method that meets impacts at their times) for the bodies of the world. A budget alone is
    /// never refused.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        settings.validate()?;
        self.reserve_for_settings(&settings)?;
        self.note(Change::SetSettings(&settings));
        if settings.gravity != self.settings.gravity || !settings.sleeping {
            self.wake_all();
        }
        self.joints.changed |=
            settings.order != self.settings.order || settings.joint_trees != self.settings.joint_trees;
        self.settings = settings;
        Ok(())
    }

    /// The point that single-precision positions are relative to [m]. Zero unless set.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Moves the point that single-precision positions are relative to. Bodies stay where they are.
    ///
    /// # Errors
    /// If it is beyond [`limits::MAX_POSITION`].
    pub fn set_origin(&mut self, origin: DVec3) -> Result<(), Error> {
        limits::position(origin)?;
        self.note(Change::SetOrigin(origin));
        self.origin = origin;
        Ok(())
    }

    /// Times and counts of the last step.
    pub fn report(&self) -> &StepReport {
        &self.report
    }

    /// Hash of all poses and velocities, bit by bit, in the order of the bodies' handles, and of the world's
    /// characters.
    pub fn hash(&self) -> u64 {
        let mut order: Vec<(u32, usize)> =
            self.bodies.slot.iter().enumerate().map(|(i, &s)| (s, i)).collect();
        order.sort_unstable();
        let mut hash = 0xCBF2_9CE4_8422_2325u64;
        let mut add = |bits: u64| hash = (hash ^ bits).wrapping_mul(0x100_0000_01B3).rotate_left(5);
        for (_, index) in order {
            let (pose, v) = (&self.bodies.pose[index], &self.bodies.velocity[index]);
            pose.position.to_array().iter().for_each(|x| add(x.to_bits()));
            pose.rotation.to_array().iter().for_each(|x| add(x.to_bits().into()));
            v.linear.to_array().iter().chain(&v.angular.to_array()).for_each(|x| add(x.to_bits().into()));
        }
        for (handle, resident) in self.characters.iter() {
            add(handle.to_bits());
            resident.words.iter().for_each(|&word| add(word.into()));
        }
        hash
    }

    /// Kinetic energy of all dynamic bodies plus their potential energy in the world's gravity, relative to
    /// the world's zero [J].
    pub fn energy(&self) -> f64 {
        self.bodies
            .all_dynamic()
            .map(|i| {
                let (mass, pose, v) = (&self.bodies.mass[i], &self.bodies.pose[i], &self.bodies.velocity[i]);
                let m = f64::from(self.bodies.details[i].mass);
                let local = pose.rotation.conjugate() * v.angular;
                let spin = 0.5 * f64::from(local.dot(mass.inertia * local));
                let linear = 0.5 * m * v.linear.as_dvec3().length_squared();
                let pull = f64::from(self.bodies.traits[i].gravity_scale) * self.settings.gravity.as_dvec3();
                linear + spin - m * pull.dot(pose.position)
            })
            .sum()
    }

    /// Whether it never had a body or character and never stepped, so that nothing depends on its past.
    #[cfg(feature = "replay")]
    pub(crate) fn is_new(&self) -> bool {
        self.bodies.slots.is_new() && self.characters.seats.is_empty() && self.buffers.dt == 0.0
    }

    pub(crate) fn index(&self, body: BodyHandle) -> Result<usize, Error> {
        self.bodies.slots.get(body.slot, body.generation).map(|i| i as usize).ok_or(Error::StaleBody)
    }

    pub(crate) fn collider(&self, shape: ShapeHandle) -> Result<u32, Error> {
        // A collider's slot is its index: it never moves.
        self.colliders.slots.get(shape.slot, shape.generation).ok_or(Error::StaleShape)
    }

    pub(crate) fn handle_of(&self, index: usize) -> BodyHandle {
        self.bodies.handle(index)
    }

    pub(crate) fn shape_handle(&self, collider: u32) -> ShapeHandle {
        self.colliders.handle(collider)
    }

    /// Creates or removes the column with the time for which bodies have been at rest, as sleeping is on or
    /// off.
    pub(crate) fn keep_rest(&mut self) {
        let wanted = if self.settings.sleeping { self.bodies.len() } else { 0 };
        self.bodies.rests = self.settings.sleeping;
        if self.bodies.rest.len() != wanted {
            self.bodies.rest.clear();
            self.bodies.rest.reserve_total(wanted);
            self.bodies.rest.resize(wanted, 0.0);
            if wanted == 0 {
                self.bodies.rest.shrink_to_fit();
                self.sleep = Sleep::default();
            }
        }
    }
}
