//! The world: it owns every store. Its methods are in a file per subject.
//!
//! - `content/`: bodies, shapes, joints and ragdolls; their mass and motion.
//! - `step/`: the inputs of each stage, and everything around the stages.
//! - `characters.rs`: characters that live in the world.
//! - `moves.rs`, `contacts.rs`: bodies that moved in a step, and contacts.
//! - `events.rs`, `hooks.rs`, `sleep.rs`, `report.rs`, `summary.rs`: events and reports of a step, hooks on
//!   it, and sleep.
//! - `state.rs`: the list of the state that outlives a step.
//! - `memory/`: memory that the world needs, holds, and may reserve.

// The documentation of `World` lists its methods in this order.
mod setup;

mod content;

mod step;

mod characters;

mod moves;

mod contacts;

mod events;

mod hooks;

mod sleep;

mod report;

mod summary;

mod memory;

mod revisions;

mod state;

pub(crate) use characters::{CHARACTER_WORDS, Characters, Resident};
pub use contacts::{BodyContact, ContactPoint};
pub(crate) use contacts::{Place, place_of, relative_now};
pub use content::Aabb;
pub(crate) use content::finite_position;
pub use hooks::{ContactHook, ContactHooks, NoHooks};
pub(crate) use memory::{Addition, Brings, Demand, Needs, Replacement};
pub use memory::{ContentForecast, Feature, FeatureCost, FeatureReport, Plan};
pub use moves::BodyMove;
pub(crate) use report::StepCounts;
pub use report::{StageTimes, StepReport};
pub(crate) use revisions::{Revisions, SharedPart};
pub(crate) use state::State;
#[cfg(feature = "observe")]
pub(crate) use step::StepMeter;
pub(crate) use step::{Buffers, Change, Part, PartTimes, Stage};
#[cfg(feature = "replay")]
pub(crate) use step::{Recorder, each_call};

use crate::body::{Bodies, Colliders};
use crate::broad_phase::{BroadPhase, Pair, QueryIndex};
use crate::config::Settings;
use crate::error::Error;
use crate::events::Events;
use crate::faults::Faults;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::joint::Joints;
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
/// 2. [`World::add_body`], [`World::add_shape`], [`World::add_joint`], [`World::add_coupling`],
///    [`World::add_character`] and [`Skeleton::add_to`](crate::Skeleton::add_to) fill it.
///    Each returns a handle, by which content is looked up, changed and removed.
/// 3. [`World::step`] moves it on, [`World::step_with`] with hooks on contacts. The [`StepReport`] has the
///    times and counts of the step.
/// 4. [`World::position`], [`World::rotation`] and others tell where bodies are, [`World::contact_begins`]
///    and others which shapes they touch; [`World::cast_ray`] and others answer queries.
/// 5. [`World::memory`] lists the bytes that the world holds, [`World::feature_report`] the parts of the
///    engine that its content needs.
/// 6. [`World::snapshot`] saves its state, and [`World::restore`] brings back the same bits.
///
/// Content changes between steps only. A handle becomes stale when its body, shape or joint is removed: a
/// stale handle is an [`Error`], never another body. A handle does not know its world, so that it stays valid
/// where a snapshot of the world is restored into another or in another process; in a world that has nothing
/// to do with its own it may name any body. A call that returns an error has changed nothing.
///
/// ```
/// use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World, glam::Vec3};
///
/// # fn main() -> Result<(), backstop::Error> {
/// let mut world = World::new(Settings::default())?;
/// world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::cuboid(10.0, 0.5, 10.0))))?;
/// let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
/// let ball = world.add_body(&BodyDesc::dynamic().with_position(Vec3::Y * 4.0).with_shape(ball))?;
/// for _ in 0..120 {
///     world.step(1.0 / 60.0)?;
/// }
/// // It lies on the floor, whose upper face is half a metre up.
/// assert!((world.position(ball)?.y - 1.0).abs() < 0.01);
/// # Ok(())
/// # }
/// ```
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
    #[cfg(feature = "observe")]
    pub(crate) meter: Option<Box<dyn StepMeter>>,
    /// Present while the world is recorded or replayed.
    #[cfg(feature = "replay")]
    pub(crate) recorder: Option<Box<dyn Recorder>>,
}

impl World {
    /// Whether it never had a body and never stepped, so that nothing depends on its past.
    #[cfg(feature = "replay")]
    pub(crate) fn is_new(&self) -> bool {
        self.bodies.slots.is_new() && self.characters.slots.is_empty() && self.buffers.dt == 0.0
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
                let keep = !self.settings.budget.is_none();
                if !keep {
                    self.bodies.rest.shrink_to_fit();
                }
                self.sleep.switch_off(keep);
            }
        }
    }
}
