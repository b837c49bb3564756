//! The resource: the engine's world, and which entity is what of it.

mod own_writes;
mod state;
mod table;

use crate::convert::{ToBevy, ToEngine};
use crate::messages::{PhysicsError, Problem};
use crate::{PhysicsPose, Velocity};
use backstop::{
    BodyHandle, CharacterHandle, ContactHooks, CouplingHandle, Error, JointHandle, MassProperties,
    ShapeHandle, Snapshot, World, glam,
};
use bevy_ecs::entity::{EntityHashMap, EntityHashSet};
use bevy_ecs::prelude::*;
use bevy_math::{DVec3, Quat, Vec3};
pub(crate) use own_writes::OwnWrites;
pub(crate) use state::{
    BodyState, CouplingState, DrawnState, JointState, LocalPose, Place, ShapeState, WalkerState,
};
use std::ops::{Deref, DerefMut};
pub(crate) use table::EntityTable;

/// The engine's [`World`], and the entities of its bodies, shapes and joints. It derefs to the world, so
/// that all of its methods can be called: queries, forces, settings, reports.
///
/// The user data of what the plugin adds are the bits of its entity. What is added to the world directly is
/// the caller's own, and appears in no message.
#[derive(Resource)]
pub struct PhysicsWorld {
    pub(crate) world: World,
    pub(crate) bodies: EntityTable<BodyState>,
    /// What frames read of the same bodies.
    pub(crate) drawn: EntityTable<DrawnState>,
    pub(crate) shapes: EntityTable<ShapeState>,
    pub(crate) joints: EntityHashMap<JointState>,
    pub(crate) couplings: EntityHashMap<CouplingState>,
    pub(crate) walkers: EntityTable<WalkerState>,
    /// What is to be made and is not yet, with the last reason that was reported.
    pub(crate) waiting: [EntityHashMap<String>; 5],
    /// Entities with a body or a shape that is new, or whose component itself changed, since the last step.
    pub(crate) new_bodies: Vec<Entity>,
    pub(crate) new_shapes: Vec<Entity>,
    /// Entities that lost a component which has a default.
    pub(crate) changed_bodies: Vec<Entity>,
    pub(crate) changed_shapes: Vec<Entity>,
    /// Shapes that were removed since the last step: with their entities and those of their bodies.
    pub(crate) departed: Vec<(ShapeHandle, [Entity; 2])>,
    /// Bodies whose poses of the last two steps differ; each once.
    pub(crate) moving: Vec<Entity>,
    /// Which list that is.
    pub(crate) list: u32,
    /// Whether the transforms of all of these that have no parent are those of the last step.
    pub(crate) shown_last: bool,
    /// Kinematic bodies that the last step moved to their transforms.
    pub(crate) following: EntityHashSet,
    /// Bodies that fell asleep in the last step or before it, and those that woke.
    pub(crate) fell_asleep: Vec<Entity>,
    pub(crate) woke: Vec<Entity>,
    /// What the plugin wrote since it last looked who else did.
    pub(crate) wrote: OwnWrites,
    /// Bodies whose transform somebody else wrote since the last step, and those whose velocity.
    pub(crate) moved: Vec<Entity>,
    pub(crate) pushed: Vec<Entity>,
    /// Bodies whose component asked for sleep or waking, which may have been refused.
    pub(crate) sleep_asked: Vec<Entity>,
    pub(crate) problems: Vec<PhysicsError>,
    /// Why the last step was refused, if it was.
    pub(crate) refused: Option<Error>,
    /// Whether poses are to be read from the world, whatever moved.
    pub(crate) all_moved: bool,
    /// The world's, when transforms were last written.
    pub(crate) origin: glam::DVec3,
    pub(crate) steps: u64,
}

/// Indices of `PhysicsWorld::waiting`.
pub(crate) const BODIES: usize = 0;
pub(crate) const SHAPES: usize = 1;
pub(crate) const JOINTS: usize = 2;
pub(crate) const COUPLINGS: usize = 3;
pub(crate) const CHARACTERS: usize = 4;

/// Callbacks on contacts of shapes with [`ContactHooked`](crate::ContactHooked). Their user data are the bits
/// of the shapes' entities.
#[derive(Resource)]
pub struct PhysicsHooks(pub Box<dyn ContactHooks + Send>);

/// Each entity once, in the order in which they were spawned as far as their indices are new.
pub(crate) fn in_order(entities: impl IntoIterator<Item = Entity>) -> Vec<Entity> {
    let mut all: Vec<Entity> = entities.into_iter().collect();
    all.sort_unstable_by_key(|entity| (entity.index_u32(), entity.to_bits()));
    all.dedup();
    all
}

impl Deref for PhysicsWorld {
    type Target = World;
    fn deref(&self) -> &World {
        &self.world
    }
}

impl DerefMut for PhysicsWorld {
    fn deref_mut(&mut self) -> &mut World {
        &mut self.world
    }
}

impl PhysicsWorld {
    pub(crate) fn new(world: World) -> Self {
        PhysicsWorld {
            world,
            bodies: EntityTable::default(),
            drawn: EntityTable::default(),
            shapes: EntityTable::default(),
            joints: EntityHashMap::default(),
            couplings: EntityHashMap::default(),
            walkers: EntityTable::default(),
            waiting: Default::default(),
            new_bodies: Vec::new(),
            new_shapes: Vec::new(),
            changed_bodies: Vec::new(),
            changed_shapes: Vec::new(),
            departed: Vec::new(),
            moving: Vec::new(),
            list: 1,
            shown_last: false,
            following: EntityHashSet::default(),
            fell_asleep: Vec::new(),
            woke: Vec::new(),
            wrote: OwnWrites::default(),
            moved: Vec::new(),
            pushed: Vec::new(),
            sleep_asked: Vec::new(),
            problems: Vec::new(),
            refused: None,
            all_moved: false,
            origin: glam::DVec3::ZERO,
            steps: 0,
        }
    }

    /// The body of an entity, if it is in the world: it is from the first step after it was spawned.
    pub fn body(&self, entity: Entity) -> Option<BodyHandle> {
        self.bodies.get(&entity).map(|body| body.handle)
    }

    /// The shape of an entity, if it is in the world.
    pub fn shape(&self, entity: Entity) -> Option<ShapeHandle> {
        self.shapes.get(&entity).map(|shape| shape.handle)
    }

    /// The joint of an entity, if it is in the world: one that broke is not.
    pub fn joint(&self, entity: Entity) -> Option<JointHandle> {
        self.joints.get(&entity).map(|joint| joint.handle).filter(|joint| self.world.contains_joint(*joint))
    }

    /// The coupling of an entity, if it is in the world: one that broke is not.
    pub fn coupling_of(&self, entity: Entity) -> Option<CouplingHandle> {
        let known = self.couplings.get(&entity).map(|coupling| coupling.handle);
        known.filter(|coupling| self.world.contains_coupling(*coupling))
    }

    /// The character of an entity, if it is in the world.
    pub fn character_of(&self, entity: Entity) -> Option<CharacterHandle> {
        self.walkers.get(&entity).map(|walker| walker.handle)
    }

    /// The entity of a body; none if the handle is stale or the body is not of the plugin.
    pub fn entity_of(&self, body: BodyHandle) -> Option<Entity> {
        let entity = Entity::try_from_bits(self.world.user_data(body).ok()?)?;
        (self.body(entity) == Some(body)).then_some(entity)
    }

    /// The entity of a shape; none if the handle is stale or the shape is not of the plugin.
    pub fn entity_of_shape(&self, shape: ShapeHandle) -> Option<Entity> {
        let entity = Entity::try_from_bits(self.world.shape_user_data(shape).ok()?)?;
        (self.shape(entity) == Some(shape)).then_some(entity)
    }

    /// The entity of a character; none if the handle is stale or the character is not of the plugin.
    pub fn entity_of_character(&self, character: CharacterHandle) -> Option<Entity> {
        self.walkers.iter().find(|(_, state)| state.handle == character).map(|(entity, _)| *entity)
    }

    /// The entity of a joint; none if the handle is stale or the joint is not of the plugin.
    pub fn entity_of_joint(&self, joint: JointHandle) -> Option<Entity> {
        let entity = Entity::try_from_bits(self.world.joint_user_data(joint).ok()?)?;
        (self.joint(entity) == Some(joint)).then_some(entity)
    }

    /// A point of the world where transforms are: relative to [`World::origin`].
    pub fn to_local(&self, point: DVec3) -> Vec3 {
        (point.to_engine() - self.world.origin()).as_vec3().to_bevy()
    }

    /// The point of the world that a transform's translation means.
    pub fn to_world(&self, point: Vec3) -> DVec3 {
        (self.world.origin() + point.to_engine().as_dvec3()).to_bevy()
    }

    /// Moves a body to a pose at once, without interpolation. For a kinematic body, which a change of its
    /// `Transform` moves within a step, this is the way to put it elsewhere. A character is put
    /// elsewhere by its `Transform`.
    ///
    /// # Errors
    /// [`Error::StaleBody`] if the entity is no body of the world; as [`World::set_pose`].
    pub fn teleport(&mut self, entity: Entity, position: DVec3, rotation: Quat) -> Result<(), Error> {
        let body = self.body(entity).ok_or(Error::StaleBody)?;
        self.world.set_pose(body, position.to_engine(), rotation.to_engine())?;
        let pose = self.pose_of(body)?;
        self.following.remove(&entity);
        if let Some(state) = self.bodies.get_mut(&entity) {
            state.moved_in = self.steps;
        }
        self.put_at(entity, pose);
        self.mark_moving(entity);
        Ok(())
    }

    /// Restores a snapshot, and takes its poses over to the transforms in the next step. The entities of
    /// bodies, shapes and joints have to be those that were there when it was taken; joints that broke since
    /// hold again.
    ///
    /// # Errors
    /// As [`World::restore`].
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Error> {
        self.world.restore(snapshot)?;
        self.all_moved = true;
        for state in self.walkers.values_mut() {
            let Ok(character) = self.world.character(state.handle) else { continue };
            let (_, upright) = character.capsule();
            state.pose.position = character.position().to_bevy();
            if state.shaped {
                state.pose.rotation = (upright * character.rotation()).to_bevy();
                state.turned_back = true;
            }
        }
        Ok(())
    }

    /// The shapes of a body of the plugin, in its order.
    pub(crate) fn shapes_of(&self, body: BodyHandle) -> Vec<ShapeHandle> {
        self.world.shapes(body).into_iter().flatten().collect()
    }

    /// Pose of a body's origin.
    pub(crate) fn pose_of(&self, body: BodyHandle) -> Result<PhysicsPose, Error> {
        Ok(PhysicsPose {
            position: self.world.position(body)?.to_bevy(),
            rotation: self.world.rotation(body)?.to_bevy(),
        })
    }

    /// Notes where a body is, without a way from where it was.
    pub(crate) fn put_at(&mut self, body: Entity, pose: PhysicsPose) {
        if let (Some(state), Some(drawn)) = (self.bodies.get_mut(&body), self.drawn.get_mut(&body)) {
            state.pose = pose;
            drawn.last = LocalPose::of(&pose, self.origin);
            drawn.previous = drawn.last;
        }
    }

    /// Takes over poses and velocities of the bodies that a step moved, and has them be written. Those that
    /// have just come to rest are written once more.
    pub(crate) fn take_over_moves(&mut self, before: &mut Vec<Entity>) {
        std::mem::swap(&mut self.moving, before);
        self.moving.clear();
        let (now, old) = (self.steps, self.list);
        self.list = old.wrapping_add(1);
        let mut stayed = 0;
        let PhysicsWorld { world, bodies, drawn, moving, list, fell_asleep, woke, origin, .. } = self;
        world.body_moves().for_each(|moved| {
            let Some(body) = Entity::try_from_bits(moved.user_data) else { return };
            let (Some(state), Some(drawn)) = (bodies.get_mut(&body), drawn.get_mut(&body)) else { return };
            if state.handle != moved.body {
                return;
            }
            stayed += usize::from(drawn.listed_in == old);
            drawn.listed_in = *list;
            moving.push(body);
            state.pose =
                PhysicsPose { position: moved.position.to_bevy(), rotation: moved.rotation.to_bevy() };
            (drawn.previous, drawn.last) = (drawn.last, LocalPose::of(&state.pose, *origin));
            state.velocity = Velocity {
                linear: moved.linear_velocity.to_bevy(),
                angular: moved.angular_velocity.to_bevy(),
            };
            state.moved_in = now;
            if state.asleep != moved.fell_asleep {
                state.asleep = moved.fell_asleep;
                if state.asleep { fell_asleep.push(body) } else { woke.push(body) }
            }
        });
        if stayed < before.len() {
            let rests = |body: &Entity| self.bodies.get(body).is_some_and(|state| state.moved_in + 1 == now);
            let resting = in_order(before.iter().copied().filter(rests));
            resting.into_iter().for_each(|body| self.take_over_rest(body, now - 1));
        }
        before.clear();
    }

    /// Takes over pose, velocity and sleep of a body that the last step did not move.
    fn take_over_rest(&mut self, body: Entity, step: u64) {
        let Some(handle) = self.body(body) else { return };
        let Ok(pose) = self.pose_of(handle) else { return };
        let asleep = self.world.is_sleeping(handle).unwrap_or_default();
        let velocity = Velocity {
            linear: self.world.linear_velocity(handle).unwrap_or_default().to_bevy(),
            angular: self.world.angular_velocity(handle).unwrap_or_default().to_bevy(),
        };
        let (Some(state), Some(drawn)) = (self.bodies.get_mut(&body), self.drawn.get_mut(&body)) else {
            return;
        };
        (drawn.previous, drawn.last) = (drawn.last, LocalPose::of(&pose, self.origin));
        (state.pose, state.velocity, state.moved_in) = (pose, velocity, step);
        if state.asleep != asleep {
            state.asleep = asleep;
            if asleep { self.fell_asleep.push(body) } else { self.woke.push(body) }
        }
        self.mark_moving(body);
    }

    /// Takes over all bodies after a restore, which moves those that sleep, too.
    pub(crate) fn take_over_all(&mut self) {
        self.moving.clear();
        self.list = self.list.wrapping_add(1);
        for body in in_order(self.bodies.keys().copied()) {
            self.take_over_rest(body, self.steps);
            if let Some(drawn) = self.drawn.get_mut(&body) {
                drawn.previous = drawn.last;
            }
        }
    }

    /// Whether to go through all bodies, side by side in memory, costs less than to look up each that moves.
    pub(crate) fn many_move(&self) -> bool {
        4 * self.moving.len() > self.bodies.len()
    }

    /// Has the transform of a body be written until it rests.
    pub(crate) fn mark_moving(&mut self, body: Entity) {
        let Some(state) = self.drawn.get_mut(&body) else { return };
        self.shown_last = false;
        if state.listed_in != self.list {
            state.listed_in = self.list;
            self.moving.push(body);
        }
    }

    /// Notes that something was refused, to be reported and logged.
    pub(crate) fn refuse(&mut self, entity: Entity, problem: impl Into<Problem>) {
        self.problems.push(PhysicsError { entity: Some(entity), problem: problem.into() });
    }

    /// Has something wait, and reports why unless it waits for that already.
    pub(crate) fn wait(&mut self, list: usize, entity: Entity, problem: impl Into<Problem>) {
        let problem = problem.into();
        let reason = problem.to_string();
        if self.waiting[list].get(&entity) != Some(&reason) {
            self.waiting[list].insert(entity, reason);
            self.refuse(entity, problem);
        }
    }

    /// What waits, in the order in which it was spawned, with others that are new.
    pub(crate) fn candidates(&self, list: usize, new: impl Iterator<Item = Entity>) -> Vec<Entity> {
        in_order(self.waiting[list].keys().copied().chain(new))
    }

    /// Removes the body of an entity. Its shapes and joints wait for another.
    pub(crate) fn remove_body_of(&mut self, entity: Entity) {
        self.waiting[BODIES].remove(&entity);
        let Some(BodyState { handle, .. }) = self.bodies.remove(&entity) else { return };
        self.drawn.remove(&entity);
        self.following.remove(&entity);
        for shape in self.shapes_of(handle) {
            let Some(shape) = self.entity_of_shape(shape) else { continue };
            self.forget_shape(shape);
            self.waiting[SHAPES].insert(shape, String::new());
        }
        let joints: Vec<Entity> = self
            .world
            .joints_of(handle)
            .into_iter()
            .flatten()
            .filter_map(|joint| self.entity_of_joint(joint))
            .collect();
        for joint in joints {
            self.joints.remove(&joint);
            self.waiting[JOINTS].insert(joint, String::new());
        }
        // It is stale only if the caller removed it.
        let _ = self.world.remove_body(handle);
    }

    /// Removes the shape of an entity. A body that loses its last one keeps the mass that it had.
    pub(crate) fn remove_shape_of(&mut self, entity: Entity) {
        self.waiting[SHAPES].remove(&entity);
        let Some(ShapeState { handle, body, .. }) = self.forget_shape(entity) else { return };
        if self.world.remove_shape(handle) != Err(Error::NoMass) {
            self.follow_shapes(body);
            return;
        }
        let Some(state) = self.bodies.get_mut(&body) else { return };
        state.follows_shapes = true;
        let kept =
            self.world.mass_properties(state.handle).and_then(|mass| self.world.set_mass(state.handle, mass));
        if let Err(error) = kept.and_then(|()| self.world.remove_shape(handle)) {
            self.refuse(entity, error);
        }
    }

    fn forget_shape(&mut self, entity: Entity) -> Option<ShapeState> {
        let state = self.shapes.remove(&entity)?;
        self.departed.push((state.handle, [entity, state.body]));
        Some(state)
    }

    /// Removes the coupling of an entity.
    pub(crate) fn remove_coupling_of(&mut self, entity: Entity) {
        self.waiting[COUPLINGS].remove(&entity);
        if let Some(coupling) = self.couplings.remove(&entity) {
            // It is stale if it broke or one of its joints is gone.
            let _ = self.world.remove_coupling(coupling.handle);
        }
    }

    /// Removes the character of an entity.
    pub(crate) fn remove_character_of(&mut self, entity: Entity) {
        self.waiting[CHARACTERS].remove(&entity);
        if let Some(walker) = self.walkers.remove(&entity) {
            // It is stale only if the caller removed it.
            let _ = self.world.remove_character(walker.handle);
        }
    }

    /// Reports why a character was refused something before the step (0) or after it (1), once until that is
    /// over.
    pub(crate) fn heard_of(&mut self, entity: Entity, when: usize, done: Result<(), Problem>) {
        let problem = done.err();
        let reason = problem.as_ref().map(Problem::to_string);
        let Some(state) = self.walkers.get_mut(&entity) else { return };
        if state.problems[when] != reason {
            state.problems[when] = reason;
            self.problems.extend(problem.map(|problem| PhysicsError { entity: Some(entity), problem }));
        }
    }

    /// Removes the joint of an entity.
    pub(crate) fn remove_joint_of(&mut self, entity: Entity) {
        self.waiting[JOINTS].remove(&entity);
        if let Some(joint) = self.joints.remove(&entity) {
            // It is stale if it broke in the last step or the caller removed it.
            let _ = self.world.remove_joint(joint.handle);
        }
    }

    /// Gives a body the mass of its shapes, if it lost that of its own; the engine knows no way back from a
    /// given mass.
    pub(crate) fn follow_shapes(&mut self, entity: Entity) {
        let Some(body) = self.bodies.get(&entity).filter(|body| body.follows_shapes) else { return };
        let handle = body.handle;
        let part = |shape: ShapeHandle| -> Result<MassProperties, Error> {
            let (position, rotation) = self.world.shape_pose(shape)?;
            let own = MassProperties::of(self.world.geometry(shape)?, self.world.density(shape)?);
            Ok(own.transformed(position, rotation))
        };
        let parts: Vec<MassProperties> =
            self.shapes_of(handle).into_iter().filter_map(|shape| part(shape).ok()).collect();
        let mass = MassProperties::combine(&parts);
        if mass.mass > 0.0
            && let Err(error) = self.world.set_mass(handle, mass)
        {
            self.refuse(entity, error);
        }
    }
}
