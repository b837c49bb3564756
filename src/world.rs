//! The world: it owns every store; add, remove, change, look up.

mod budget;
mod buffers;
mod colliders;
mod events;
mod faults;
mod hooks;
mod joints;
mod mass;
mod model;
mod motion;
mod needs;
mod observers;
mod plan;
mod ragdolls;
mod report;
mod restoring;
mod revisions;
mod shapes;
mod sleep;
mod stage;
mod step_inputs;

pub(crate) use buffers::Buffers;
pub use hooks::{ContactHook, ContactHooks, MaybeSync, NoHooks};
pub(crate) use model::PartTimes;
pub use model::{Feature, Model, ModelPart};
pub(crate) use motion::finite_position;
pub(crate) use needs::{Demand, Needs};
pub(crate) use observers::Change;
#[cfg(feature = "replay")]
pub(crate) use observers::Recorder;
#[cfg(feature = "lab")]
pub(crate) use observers::StepMeter;
pub(crate) use plan::ContentForecast;
pub(crate) use report::StepCounts;
pub use report::{StageTimes, StepReport};
pub(crate) use restoring::{Brings, Replacement};
pub(crate) use revisions::{Revisions, SharedPart};
pub(crate) use stage::{Part, Stage};

use mass::{columns_of, mass_of, movable};

use crate::body::{Bodies, BodyDesc, BodyDetails, BodyKind, Colliders, Mass, NewBody, Pose, Traits};
use crate::broad_phase::{BroadPhase, Pair, QueryIndex};
use crate::config::RowGroup;
use crate::config::{Continuous, Settings};
use crate::error::Error;
use crate::events::Events;
use crate::faults::Faults;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::joint::Joints;
use crate::lanes::Record;
use crate::limits;
use crate::memory::{Amounts, Buffer, Category, MemoryReport, in_arc};
use crate::narrow_phase::Contacts;
use crate::shape::{Geometry, Kind};
use crate::sleep::Sleep;
use crate::threads::Helpers;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Bodies that move, collide and rest.
///
/// Everything is changed between steps, by handles that go stale when what they name is removed: a stale handle is an
/// [`Error`], never another body. A refused call changes nothing.
#[derive(Debug, Default)]
pub struct World {
    pub(crate) settings: Settings,
    pub(crate) bodies: Bodies,
    pub(crate) colliders: Colliders,
    pub(crate) broad: BroadPhase,
    /// Where what moves is now, for queries.
    pub(crate) now: QueryIndex,
    pub(crate) joints: Joints,
    pub(crate) contacts: Contacts,
    pub(crate) buffers: Buffers,
    pub(crate) report: StepReport,
    pub(crate) needs: Needs,
    /// What the last step needed, and how long that took.
    pub(crate) last_demand: Demand,
    pub(crate) spent: PartTimes,
    pub(crate) origin: DVec3,
    assets: Assets,
    peaks: MemoryReport,
    removed: Vec<Pair>,
    pub(crate) sleep: Sleep,
    pub(crate) events: Events,
    /// Of what snapshots share.
    pub(crate) revisions: Revisions,
    /// Bodies that the last step had to stop.
    pub(crate) faults: Faults,
    /// The stage of the step that is under way; after a step, that in which it panicked.
    pub(crate) stage: Option<&'static str>,
    pub(crate) helpers: Helpers,
    /// While the accuracy of steps is measured.
    #[cfg(feature = "lab")]
    pub(crate) meter: Option<Box<dyn StepMeter>>,
    /// While it is recorded or replayed.
    #[cfg(feature = "replay")]
    pub(crate) recorder: Option<Box<dyn Recorder>>,
}

/// Shared geometry, counted once however many shapes use it.
#[derive(Debug, Default)]
struct Assets {
    /// Address, uses, what it is, bytes.
    list: Vec<(usize, u32, Kind, (usize, usize))>,
}

impl Assets {
    fn key(geometry: &Geometry) -> Option<(usize, Kind, (usize, usize))> {
        // Its own bytes are told with itself; it lies in an `Arc`.
        fn entry<T>(
            shared: &Arc<T>,
            kind: Kind,
            (live, reserved): (usize, usize),
        ) -> (usize, Kind, (usize, usize)) {
            let counts = in_arc::<T>() - size_of::<T>();
            (Arc::as_ptr(shared) as usize, kind, (live + counts, reserved + counts))
        }
        Some(match geometry {
            Geometry::Hull(hull) => entry(hull, Kind::Hull, hull.bytes()),
            Geometry::Mesh(mesh) => entry(mesh, Kind::Mesh, mesh.bytes()),
            Geometry::HeightField(field) => entry(field, Kind::HeightField, field.bytes()),
            _ => return None,
        })
    }

    fn add(&mut self, geometry: &Geometry) {
        if let Some((key, kind, bytes)) = Self::key(geometry) {
            match self.list.binary_search_by_key(&key, |e| e.0) {
                Ok(i) => self.list[i].1 += 1,
                Err(i) => self.list.insert(i, (key, 1, kind, bytes)),
            }
        }
    }

    fn remove(&mut self, geometry: &Geometry) {
        if let Some((key, ..)) = Self::key(geometry)
            && let Ok(i) = self.list.binary_search_by_key(&key, |e| e.0)
        {
            self.list[i].1 -= 1;
            if self.list[i].1 == 0 {
                self.list.remove(i);
            }
        }
    }

    fn category(kind: Kind) -> Category {
        if kind == Kind::Hull { Category::Shapes } else { Category::Meshes }
    }

    /// The category of each, and its bytes.
    fn bytes(&self) -> impl Iterator<Item = (Category, (usize, usize))> + '_ {
        self.list.iter().map(|&(_, _, kind, bytes)| (Self::category(kind), bytes))
    }

    /// Reserved bytes of all of a kind.
    fn bytes_of(&self, kind: Kind) -> usize {
        self.list.iter().filter(|one| one.2 == kind).map(|one| one.3.1).sum()
    }

    /// Bytes that geometries would add, each counted once, and how many of them are new.
    fn cost<'a>(&self, geometries: impl Iterator<Item = &'a Geometry>) -> (Amounts, usize) {
        let is_new = |key: usize| self.list.binary_search_by_key(&key, |e| e.0).is_err();
        let mut new: Vec<_> = geometries.filter_map(Self::key).filter(|(key, ..)| is_new(*key)).collect();
        new.sort_unstable();
        new.dedup();
        let mut bytes = Amounts::default();
        new.iter().for_each(|&(_, kind, (_, reserved))| bytes.add(Self::category(kind), reserved));
        (bytes, new.len())
    }
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
    /// If a setting is out of range, or the budget in them does not allow what they switch on, sleeping or a method that meets
    /// impacts at their times, for the bodies that are there. A budget alone is never refused.
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

    /// Adds a body.
    ///
    /// # Errors
    /// If its description is out of range, a dynamic body has no mass or a shape that only a static one may have, or
    /// the budget does not allow it.
    pub fn add_body(&mut self, desc: &BodyDesc) -> Result<BodyHandle, Error> {
        let (centre, mass) = self.check(desc)?;
        self.reserve(std::slice::from_ref(desc))?;
        self.note(Change::AddBody(desc));
        Ok(self.insert(desc, centre, mass))
    }

    /// Adds many bodies: all of them, or none.
    ///
    /// # Errors
    /// As for [`World::add_body`].
    pub fn add_bodies(&mut self, descs: &[BodyDesc]) -> Result<Vec<BodyHandle>, Error> {
        let masses = descs.iter().map(|d| self.check(d)).collect::<Result<Vec<_>, _>>()?;
        self.reserve(descs)?;
        self.note(Change::AddBodies(descs));
        self.bodies.reserve(descs.len());
        let shapes = descs.iter().map(|d| d.shapes.len()).sum();
        self.colliders.slots.reserve(shapes);
        self.colliders.reserve(shapes);
        Ok(descs.iter().zip(masses).map(|(desc, (details, mass))| self.insert(desc, details, mass)).collect())
    }

    /// Removes a body with its shapes.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn remove_body(&mut self, body: BodyHandle) -> Result<(), Error> {
        let index = self.index(body)?;
        self.note(Change::RemoveBody(body));
        let index = self.disturb(index);
        self.revise(index);
        self.remove_joints_of(body);
        let colliders = self.bodies.take_colliders(index);
        for &collider in colliders.as_slice() {
            self.drop_collider(collider);
        }
        let shapes = &mut self.colliders;
        self.bodies.remove(index as u32, |colliders, index| {
            colliders.as_slice().iter().for_each(|&c| shapes.follow(c, index));
        });
        Ok(())
    }

    /// Removes many bodies: all of them, or none.
    ///
    /// # Errors
    /// If a handle is stale.
    pub fn remove_bodies(&mut self, bodies: &[BodyHandle]) -> Result<(), Error> {
        bodies.iter().try_for_each(|&body| self.index(body).map(drop))?;
        // One that is named twice is gone the second time.
        for &body in bodies {
            if self.contains(body) {
                self.remove_body(body)?;
            }
        }
        Ok(())
    }

    /// Takes a body out of the world or puts it back, with its shapes and joints: one that is disabled does not move, touches
    /// nothing, and is seen by no query; its joints hold nothing. It keeps its handles, its pose and its velocities, and may
    /// be changed all the while.
    ///
    /// # Errors
    /// If the handle is stale, or the budget does not allow it to take part again: others may have come meanwhile.
    pub fn set_enabled(&mut self, body: BodyHandle, enabled: bool) -> Result<(), Error> {
        let index = self.index(body)?;
        if self.bodies.traits[index].disabled != enabled {
            return Ok(());
        }
        if enabled {
            self.reserve_for_enabled(index)?;
        }
        self.note(Change::SetEnabled(body, enabled));
        let index = self.disturb(index);
        self.revise(index);
        if !enabled {
            for place in 0..self.bodies.colliders[index].as_slice().len() {
                let collider = self.bodies.colliders[index].as_slice()[place];
                self.leave_broad(collider);
            }
        }
        let World { bodies, colliders, .. } = self;
        let index = bodies.set_enabled(index as u32, enabled, |own, index| {
            own.as_slice().iter().for_each(|&c| colliders.follow(c, index));
        });
        if enabled {
            for place in 0..self.bodies.colliders[index as usize].as_slice().len() {
                let collider = self.bodies.colliders[index as usize].as_slice()[place];
                self.colliders.place(collider, &self.bodies.pose[index as usize]);
                self.enter_broad(collider);
            }
        }
        self.joints.changed = true;
        Ok(())
    }

    /// Whether a body takes part in the world; see [`World::set_enabled`].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn is_enabled(&self, body: BodyHandle) -> Result<bool, Error> {
        Ok(!self.bodies.traits[self.index(body)?].disabled)
    }

    /// How many bodies there are.
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// All bodies: dynamic ones first, then kinematic, then dynamic ones that are asleep and
    /// those that are disabled, then static.
    pub fn bodies(&self) -> impl Iterator<Item = BodyHandle> + '_ {
        (0..self.bodies.len()).map(|index| self.handle_of(index))
    }

    /// Whether the handle still names a body.
    pub fn contains(&self, body: BodyHandle) -> bool {
        self.index(body).is_ok()
    }

    /// What moves a body.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn kind(&self, body: BodyHandle) -> Result<BodyKind, Error> {
        Ok(self.bodies.kind[self.index(body)?])
    }

    /// The caller's number of a body.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn user_data(&self, body: BodyHandle) -> Result<u64, Error> {
        Ok(self.bodies.details[self.index(body)?].user_data)
    }

    /// Sets the factor on gravity.
    ///
    /// # Errors
    /// If the handle is stale or the number is beyond 1e6.
    pub fn set_gravity_scale(&mut self, body: BodyHandle, scale: f32) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::acceleration("gravity scale", Vec3::splat(scale))?;
        self.note(Change::SetGravityScale(body, scale));
        let index = self.wake_body(index);
        self.revise(index);
        self.bodies.traits[index].gravity_scale = scale;
        Ok(())
    }

    /// Sets how a body is kept from passing through others. Two bodies collide by the greater of their modes, save
    /// that what is static has none.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_continuous(&mut self, body: BodyHandle, mode: Continuous) -> Result<(), Error> {
        let index = self.index(body)?;
        self.note(Change::SetContinuous(body, mode));
        self.revise(index);
        self.bodies.set_continuous(index, mode);
        let mode = self.bodies.mode(index);
        for &c in self.bodies.colliders[index].as_slice() {
            self.colliders.summaries[c as usize].mode = mode;
        }
        Ok(())
    }

    /// Has the rows of a body solved right after those of a group, or in their own places again; see [`BodyDesc::raised`].
    ///
    /// # Errors
    /// If the handle is stale or the budget does not allow it.
    pub fn raise_body(&mut self, body: BodyHandle, above: Option<RowGroup>) -> Result<(), Error> {
        let index = self.index(body)?;
        self.reserve_for_raised(above.is_some())?;
        self.note(Change::RaiseBody(body, above));
        self.revise(index);
        self.bodies.raise(index, above);
        self.joints.changed = true;
        Ok(())
    }

    /// What the last step did.
    pub fn report(&self) -> &StepReport {
        &self.report
    }

    /// A number that differs if any pose or velocity differs in a bit. Bodies count in the order of their handles.
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
        hash
    }

    /// Kinetic energy of all dynamic bodies plus their potential energy in the world's gravity, relative to the
    /// world's zero [J].
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

    /// Whether it never had a body and never stepped: no handle was given out, and nothing depends on what was.
    #[cfg(feature = "replay")]
    pub(crate) fn is_new(&self) -> bool {
        self.bodies.slots.is_new() && self.buffers.dt == 0.0
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

    /// Checks a description and computes what the body's columns need.
    fn check(&self, desc: &BodyDesc) -> Result<(BodyDetails, Mass), Error> {
        desc.validate()?;
        let total = desc.mass.unwrap_or_else(|| mass_of(&desc.shapes));
        if desc.kind == BodyKind::Dynamic && desc.mass.is_none() && total.mass <= 0.0 {
            return Err(Error::NoMass);
        }
        if desc.kind == BodyKind::Dynamic {
            movable(&total)?;
        }
        Ok(columns_of(&total, desc.kind, desc.user_data, desc.mass.is_none()))
    }

    fn insert(&mut self, desc: &BodyDesc, details: BodyDetails, mass: Mass) -> BodyHandle {
        let rotation = desc.rotation.normalize();
        let locks = Traits::lock_bits(desc.lock_translation, desc.lock_rotation);
        let moves = desc.kind != BodyKind::Static;
        let new = NewBody {
            kind: desc.kind,
            pose: Pose {
                position: desc.position + (rotation * details.centre).as_dvec3(),
                rotation: (rotation * details.axes).normalize(),
            },
            velocity: Record {
                linear: if moves { desc.linear_velocity } else { Vec3::ZERO },
                angular: if moves { desc.angular_velocity } else { Vec3::ZERO },
                ..Record::default()
            },
            mass,
            traits: Traits {
                gravity_scale: desc.gravity_scale,
                continuous: desc.continuous,
                locks,
                raised: desc.raised,
                sleepless: !desc.can_sleep,
                disabled: false,
            },
            details,
        };
        let shapes = &mut self.colliders;
        let (slot, generation) = self.bodies.insert(new, |colliders, index| {
            colliders.as_slice().iter().for_each(|&c| shapes.follow(c, index));
        });
        let index = self.bodies.slots.get(slot, generation).unwrap_or(0) as usize;
        self.revise(index);
        for shape in &desc.shapes {
            self.new_collider(index, shape);
        }
        BodyHandle { slot, generation }
    }

    /// Something about a body changed that snapshots share.
    fn revise(&mut self, index: usize) {
        self.revisions.moving += 1;
        self.revisions.fixed += u64::from(self.bodies.kind[index] == BodyKind::Static);
    }

    /// Makes the column that tells how long bodies have been at rest, if they may sleep.
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
