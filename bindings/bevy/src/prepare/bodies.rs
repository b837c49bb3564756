//! Bodies: new ones with their shapes, and changes of those that are there.

use super::hierarchy::{Hierarchy, pose_by};
use super::shapes::describe;
use crate::components::body::*;
use crate::components::shape::ShapeParts;
use crate::convert::ToEngine;
use crate::messages::Problem;
use crate::world::{
    BODIES, BodyState, DrawnState, LocalPose, PhysicsWorld, Place, SHAPES, ShapeState, in_order,
};
use backstop::{BodyDesc, BodyHandle, Error, ShapeDesc, World};
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::prelude::{Changed, Entity, Has, Or, Query, ResMut};
use bevy_ecs::query::QueryData;
use bevy_transform::components::Transform;

/// All that is said of a body but its shapes.
#[derive(QueryData)]
pub(crate) struct BodyParts {
    kind: &'static RigidBody,
    mass: Option<&'static Mass>,
    gravity: Option<&'static GravityScale>,
    damping: Option<&'static Damping>,
    max_speeds: Option<&'static MaxSpeeds>,
    locks: Option<&'static LockedAxes>,
    continuous: Option<&'static Continuous>,
    solved_after: Option<&'static SolvedAfter>,
    never_sleeps: Has<NeverSleeps>,
    disabled: Has<BodyDisabled>,
}

/// A change of any of it but the kind.
type BodyChanged = Or<(
    Changed<Mass>,
    Changed<GravityScale>,
    Changed<Damping>,
    Changed<MaxSpeeds>,
    Changed<LockedAxes>,
    Changed<Continuous>,
    Changed<SolvedAfter>,
    Changed<NeverSleeps>,
    Changed<BodyDisabled>,
)>;

impl BodyPartsItem<'_, '_> {
    /// The description, at the origin.
    fn desc(&self, entity: Entity) -> BodyDesc {
        let mut desc = BodyDesc::new((*self.kind).into()).with_user_data(entity.to_bits());
        desc.mass = self.mass.map(|mass| mass.0);
        desc.gravity_scale = self.gravity.map_or(desc.gravity_scale, |scale| scale.0);
        if let Some(damping) = self.damping {
            (desc.linear_damping, desc.angular_damping) = (damping.linear, damping.angular);
        }
        if let Some(max) = self.max_speeds {
            (desc.max_linear_speed, desc.max_angular_speed) = (max.linear, max.angular);
        }
        if let Some(locks) = self.locks {
            (desc.lock_translation, desc.lock_rotation) = (locks.translation, locks.rotation);
        }
        desc.continuous = self.continuous.map_or(desc.continuous, |mode| mode.0);
        desc.solved_after = self.solved_after.map(|after| after.0);
        desc.can_sleep = !self.never_sleeps;
        desc
    }
}

/// What shapes that are new, or wait, would be: by their bodies.
type Found = EntityHashMap<Vec<(Entity, Place, ShapeDesc)>>;

/// Adds new bodies with their shapes, and new shapes to bodies that are there.
pub(crate) fn add_bodies_and_shapes(
    mut physics: ResMut<PhysicsWorld>,
    mut bodies: Query<(BodyParts, &Transform, &Velocity, &mut PhysicsPose)>,
    shapes: Query<ShapeParts>,
    hierarchy: Hierarchy,
) {
    let physics = &mut *physics;
    let mut found = Found::default();
    for shape in physics.candidates(SHAPES, physics.new_shapes.iter().copied()) {
        let Ok(parts) = shapes.get(shape) else { continue };
        if physics.shapes.contains_key(&shape) {
            continue;
        }
        let Some((body, place)) = hierarchy.place(shape) else {
            physics.wait(SHAPES, shape, Problem::NoBodyAbove);
            continue;
        };
        match describe(shape, &parts, &place) {
            Ok(desc) => found.entry(body).or_default().push((shape, place, desc)),
            Err(problem) => physics.wait(SHAPES, shape, problem),
        }
    }
    for body in physics.candidates(BODIES, physics.new_bodies.iter().copied()) {
        let Ok((parts, transform, velocity, mut pose)) = bodies.get_mut(body) else { continue };
        if physics.bodies.contains_key(&body) {
            continue;
        }
        *pose = pose_by(physics, hierarchy.above(body), transform);
        let mut own = found.remove(&body).unwrap_or_default();
        // A shape on the entity itself goes first, the others in the order in which they were spawned.
        own.sort_by_key(|(shape, ..)| *shape != body);
        add_body(physics, body, &parts, (*pose, *transform, *velocity), own);
    }
    for body in in_order(found.keys().copied()) {
        for (shape, place, desc) in found.remove(&body).unwrap_or_default() {
            add_shape(physics, body, shape, place, &desc);
        }
    }
}

/// Adds a body with its shapes; if it is refused they all wait.
fn add_body(
    physics: &mut PhysicsWorld,
    body: Entity,
    parts: &BodyPartsItem,
    (pose, written, velocity): (PhysicsPose, Transform, Velocity),
    shapes: Vec<(Entity, Place, ShapeDesc)>,
) {
    let desc = parts
        .desc(body)
        .with_position(pose.position.to_engine())
        .with_rotation(pose.rotation.to_engine())
        .with_velocity(velocity.linear.to_engine(), velocity.angular.to_engine())
        .with_shapes(shapes.iter().map(|(.., desc)| desc.clone()));
    let handle = match physics.add_body(&desc) {
        Ok(handle) => handle,
        Err(error) => {
            physics.wait(BODIES, body, error);
            for (shape, ..) in shapes {
                physics.waiting[SHAPES].entry(shape).or_default();
            }
            return;
        }
    };
    physics.waiting[BODIES].remove(&body);
    for ((shape, place, _), handle) in shapes.into_iter().zip(physics.shapes_of(handle)) {
        physics.waiting[SHAPES].remove(&shape);
        physics.shapes.insert(shape, ShapeState { handle, body, place });
    }
    let state = BodyState {
        handle,
        pose,
        velocity,
        scale: written.scale,
        asleep: false,
        mass: desc.mass.map(Box::new),
        follows_shapes: false,
        moved_in: 0,
    };
    physics.bodies.insert(body, state);
    let pose = LocalPose::of(&pose, physics.origin);
    physics.drawn.insert(body, DrawnState::at_rest(pose, &written));
    if parts.disabled
        && let Err(error) = physics.set_enabled(handle, false)
    {
        physics.refuse(body, error);
    }
}

/// Adds a shape to a body, or has it wait for one that waits itself.
fn add_shape(physics: &mut PhysicsWorld, body: Entity, shape: Entity, place: Place, desc: &ShapeDesc) {
    let Some(handle) = physics.body(body) else {
        physics.waiting[SHAPES].entry(shape).or_default();
        return;
    };
    match physics.add_shape(handle, desc) {
        Ok(handle) => {
            physics.waiting[SHAPES].remove(&shape);
            physics.shapes.insert(shape, ShapeState { handle, body, place });
            physics.follow_shapes(body);
        }
        Err(error) => physics.wait(SHAPES, shape, error),
    }
}

/// Takes over what changed about bodies that are there.
pub(crate) fn change_bodies(
    mut physics: ResMut<PhysicsWorld>,
    changed: Query<Entity, BodyChanged>,
    bodies: Query<BodyParts>,
) {
    let physics = &mut *physics;
    let lost = std::mem::take(&mut physics.changed_bodies);
    let kinds = std::mem::take(&mut physics.new_bodies);
    for body in kinds.iter().copied().chain(&changed).chain(lost) {
        let (Some(handle), Ok(parts)) = (physics.body(body), bodies.get(body)) else { continue };
        let desc = parts.desc(body);
        if let Err(error) = update_body(physics, handle, &desc, !parts.disabled) {
            physics.refuse(body, error);
            continue;
        }
        let Some(state) =
            physics.bodies.get_mut(&body).filter(|state| state.mass.as_deref() != desc.mass.as_ref())
        else {
            continue;
        };
        state.follows_shapes = desc.mass.is_none();
        state.mass = desc.mass.map(Box::new);
        match desc.mass.map_or(Ok(()), |mass| physics.set_mass(handle, mass)) {
            Ok(()) => physics.follow_shapes(body),
            Err(error) => physics.refuse(body, error),
        }
    }
    physics.new_bodies = kinds;
}

/// Sets what differs from a description.
fn update_body(world: &mut World, body: BodyHandle, desc: &BodyDesc, enabled: bool) -> Result<(), Error> {
    world.set_kind(body, desc.kind)?;
    if world.gravity_scale(body)? != desc.gravity_scale {
        world.set_gravity_scale(body, desc.gravity_scale)?;
    }
    if world.damping(body)? != (desc.linear_damping, desc.angular_damping) {
        world.set_damping(body, desc.linear_damping, desc.angular_damping)?;
    }
    if world.max_speeds(body)? != [desc.max_linear_speed, desc.max_angular_speed] {
        world.set_max_speeds(body, desc.max_linear_speed, desc.max_angular_speed)?;
    }
    if world.locked_axes(body)? != (desc.lock_translation, desc.lock_rotation) {
        world.set_locked_axes(body, desc.lock_translation, desc.lock_rotation)?;
    }
    if world.continuous(body)? != desc.continuous {
        world.set_continuous(body, desc.continuous)?;
    }
    if world.body_solved_after(body)? != desc.solved_after {
        world.set_body_solved_after(body, desc.solved_after)?;
    }
    if world.can_sleep(body)? != desc.can_sleep {
        world.set_can_sleep(body, desc.can_sleep)?;
    }
    if world.is_enabled(body)? != enabled {
        world.set_enabled(body, enabled)?;
    }
    Ok(())
}
