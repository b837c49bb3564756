//! Before a step: what entities say reaches the world.

use crate::body::*;
use crate::convert::ToEngine;
use crate::joint::Joint;
use crate::messages::Problem;
use crate::shape::{ShapeChanged, ShapeParts, ShapePartsItem};
use crate::world::{
    BODIES, BodyState, JOINTS, JointState, PhysicsWorld, Place, SHAPES, ShapeState, in_order,
};
use backstop::{BodyDesc, Error, ShapeDesc};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::system::SystemParam;
use bevy_math::Vec3;
use bevy_transform::components::{GlobalTransform, Transform};
use std::collections::HashSet;

/// Transforms and parents.
#[derive(SystemParam)]
pub(crate) struct Hierarchy<'w, 's> {
    nodes: Query<'w, 's, (Option<&'static Transform>, Option<&'static ChildOf>, Has<RigidBody>)>,
}

impl Hierarchy<'_, '_> {
    /// The body of a shape, and where the shape is on it.
    fn place(&self, shape: Entity) -> Option<(Entity, Place)> {
        let (mut below, mut entity) = (Transform::IDENTITY, shape);
        loop {
            let (own, parent, is_body) = self.nodes.get(entity).ok()?;
            let own = own.copied().unwrap_or_default();
            if is_body {
                let all = Transform::from_scale(own.scale * self.scale_above(parent)) * below;
                let Transform { translation: position, rotation, scale } = all;
                return Some((entity, Place { position, rotation, scale }));
            }
            below = own * below;
            entity = parent?.parent();
        }
    }

    /// Product of the scales from a parent upwards.
    fn scale_above<'a>(&'a self, mut parent: Option<&'a ChildOf>) -> Vec3 {
        let mut scale = Vec3::ONE;
        while let Some((own, next, _)) = parent.and_then(|parent| self.nodes.get(parent.parent()).ok()) {
            scale *= own.map_or(Vec3::ONE, |own| own.scale);
            parent = next;
        }
        scale
    }

    /// What is above an entity, as one transform; none for a root.
    pub(crate) fn above(&self, entity: Entity) -> Option<GlobalTransform> {
        let mut parent = self.nodes.get(entity).ok()?.1?.parent();
        let mut above = GlobalTransform::IDENTITY;
        loop {
            let (own, next, _) = self.nodes.get(parent).ok()?;
            above = GlobalTransform::from(own.copied().unwrap_or_default()) * above;
            match next {
                Some(next) => parent = next.parent(),
                None => return Some(above),
            }
        }
    }
}

/// Where a body is by its transform, and that of its parents.
fn pose_by(physics: &PhysicsWorld, above: Option<GlobalTransform>, transform: &Transform) -> PhysicsPose {
    let global = above.map_or(*transform, |above| above.mul_transform(*transform).compute_transform());
    PhysicsPose { position: physics.to_world(global.translation), rotation: global.rotation }
}

/// All that is said of a body but its shapes.
#[derive(QueryData)]
pub(crate) struct BodyParts {
    kind: &'static RigidBody,
    mass: Option<&'static Mass>,
    gravity: Option<&'static GravityScale>,
    damping: Option<&'static Damping>,
    locks: Option<&'static LockedAxes>,
    continuous: Option<&'static ContinuousMode>,
    solved_after: Option<&'static SolvedAfter>,
    never_sleeps: Has<NeverSleeps>,
    disabled: Has<BodyDisabled>,
}

/// A change of any of it.
type BodyChanged = Or<(
    Changed<RigidBody>,
    Changed<Mass>,
    Changed<GravityScale>,
    Changed<Damping>,
    Changed<LockedAxes>,
    Changed<ContinuousMode>,
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
        if let Some(locks) = self.locks {
            (desc.lock_translation, desc.lock_rotation) = (locks.translation, locks.rotation);
        }
        desc.continuous = self.continuous.map_or(desc.continuous, |mode| mode.0);
        desc.solved_after = self.solved_after.map(|after| after.0);
        desc.can_sleep = !self.never_sleeps;
        desc
    }
}

/// Adds new bodies with their shapes, and new shapes to bodies that are there.
pub(crate) fn add_bodies_and_shapes(
    mut physics: ResMut<PhysicsWorld>,
    new_bodies: Query<Entity, Changed<RigidBody>>,
    new_shapes: Query<Entity, Changed<crate::Shape>>,
    bodies: Query<(BodyParts, &Transform, &Velocity)>,
    mut poses: Query<&mut PhysicsPose>,
    shapes: Query<ShapeParts>,
    hierarchy: Hierarchy,
) {
    let physics = &mut *physics;
    let mut found: Vec<(Entity, Entity, Place, ShapeDesc)> = Vec::new();
    for shape in physics.candidates(SHAPES, new_shapes.iter()) {
        if physics.shapes.contains_key(&shape) {
            continue;
        }
        let Ok(parts) = shapes.get(shape) else { continue };
        let Some((body, place)) = hierarchy.place(shape) else {
            physics.wait(SHAPES, shape, Problem::NoBodyAbove);
            continue;
        };
        match describe(shape, &parts, &place) {
            Ok(desc) => found.push((body, shape, place, desc)),
            Err(problem) => physics.wait(SHAPES, shape, problem),
        }
    }
    for body in physics.candidates(BODIES, new_bodies.iter()) {
        if physics.bodies.contains_key(&body) {
            continue;
        }
        let Ok((parts, transform, velocity)) = bodies.get(body) else { continue };
        // A shape on the entity itself goes first, the others in the order in which they were spawned.
        let mut own: Vec<_> = found.extract_if(.., |(of, ..)| *of == body).collect();
        own.sort_by_key(|(_, shape, ..)| *shape != body);
        let pose = pose_by(physics, hierarchy.above(body), transform);
        let desc = parts
            .desc(body)
            .at(pose.position.to_engine())
            .rotated(pose.rotation.to_engine())
            .moving(velocity.linear.to_engine(), velocity.angular.to_engine())
            .with_shapes(own.iter().map(|(.., desc)| desc.clone()));
        let handle = match physics.add_body(&desc) {
            Ok(handle) => handle,
            Err(error) => {
                physics.wait(BODIES, body, error);
                for (_, shape, ..) in own {
                    physics.waiting[SHAPES].entry(shape).or_default();
                }
                continue;
            }
        };
        physics.waiting[BODIES].remove(&body);
        let handles = physics.shapes_of(handle);
        for ((_, shape, place, _), handle) in own.into_iter().zip(handles) {
            physics.waiting[SHAPES].remove(&shape);
            physics.shapes.insert(shape, ShapeState { handle, body, place });
        }
        let state = BodyState {
            handle,
            previous: pose,
            pose,
            written: *transform,
            velocity: *velocity,
            asleep: false,
            mass: desc.mass,
            follows_shapes: false,
            moved_in: 0,
        };
        physics.bodies.insert(body, state);
        if let Ok(mut shown) = poses.get_mut(body) {
            *shown = pose;
        }
        if parts.disabled
            && let Err(error) = physics.set_enabled(handle, false)
        {
            physics.refuse(body, error);
        }
    }
    for (body, shape, place, desc) in found {
        let Some(handle) = physics.body(body) else {
            physics.waiting[SHAPES].entry(shape).or_default();
            continue;
        };
        match physics.add_shape(handle, &desc) {
            Ok(handle) => {
                physics.waiting[SHAPES].remove(&shape);
                physics.shapes.insert(shape, ShapeState { handle, body, place });
                physics.follow_shapes(body);
            }
            Err(error) => physics.wait(SHAPES, shape, error),
        }
    }
}

/// The description of a shape at its place.
fn describe(entity: Entity, parts: &ShapePartsItem, place: &Place) -> Result<ShapeDesc, Problem> {
    let refused = Problem::Scale { shape: parts.shape.0.kind_name(), scale: place.scale };
    let desc = parts
        .desc(entity, place.scale)
        .ok_or(refused)?
        .with_position(place.position.to_engine())
        .with_rotation(place.rotation.to_engine());
    desc.validate()?;
    Ok(desc)
}

/// Takes over what changed about shapes that are there, and where they are on their bodies.
pub(crate) fn change_shapes(
    mut physics: ResMut<PhysicsWorld>,
    changed: Query<Entity, ShapeChanged>,
    moved: Query<Entity, (With<crate::Shape>, With<RigidBody>, Changed<Transform>)>,
    below: Query<Entity, (With<crate::Shape>, Without<RigidBody>)>,
    shapes: Query<ShapeParts>,
    hierarchy: Hierarchy,
) {
    let physics = &mut *physics;
    // What is below a body may have been moved by anything in between.
    for shape in moved.iter().chain(&below) {
        let Some(state) = physics.shapes.get(&shape) else { continue };
        let place = hierarchy.place(shape);
        if place == Some((state.body, state.place)) {
            continue;
        }
        match place {
            Some((body, _)) if body == state.body => physics.changed_shapes.push(shape),
            _ => {
                physics.remove_shape_of(shape);
                physics.waiting[SHAPES].insert(shape, String::new());
            }
        }
    }
    let lost = std::mem::take(&mut physics.changed_shapes);
    for shape in changed.iter().chain(lost) {
        let Some(state) = physics.shapes.get(&shape) else { continue };
        let (handle, body, scale) = (state.handle, state.body, state.place.scale);
        let (Ok(parts), Some((_, place))) = (shapes.get(shape), hierarchy.place(shape)) else { continue };
        let result = describe(shape, &parts, &place).and_then(|desc| {
            let reshaped = parts.shape.is_changed() || place.scale != scale;
            Ok(update_shape(physics, handle, &desc, reshaped)?)
        });
        match result {
            Ok(()) => {
                physics.follow_shapes(body);
                if let Some(state) = physics.shapes.get_mut(&shape) {
                    state.place = place;
                }
            }
            Err(problem) => physics.refuse(shape, problem),
        }
    }
}

/// Sets what differs from a description.
fn update_shape(
    world: &mut backstop::World,
    shape: backstop::ShapeHandle,
    desc: &ShapeDesc,
    reshaped: bool,
) -> Result<(), Error> {
    if reshaped {
        world.set_geometry(shape, desc.geometry.clone())?;
    }
    if world.shape_pose(shape)? != (desc.position, desc.rotation) {
        world.set_shape_pose(shape, desc.position, desc.rotation)?;
    }
    if world.material(shape)? != desc.material {
        world.set_material(shape, desc.material)?;
    }
    if world.filter(shape)? != desc.filter {
        world.set_filter(shape, desc.filter)?;
    }
    if world.density(shape)? != desc.density {
        world.set_density(shape, desc.density)?;
    }
    if world.is_sensor(shape)? != desc.sensor {
        world.set_sensor(shape, desc.sensor)?;
    }
    if (world.listens_to_events(shape)?, world.listens_to_hooks(shape)?) != (desc.events, desc.hooks) {
        world.set_listening(shape, desc.events, desc.hooks)?;
    }
    Ok(())
}

/// Takes over what changed about bodies that are there.
pub(crate) fn change_bodies(
    mut physics: ResMut<PhysicsWorld>,
    changed: Query<Entity, BodyChanged>,
    bodies: Query<BodyParts>,
) {
    let physics = &mut *physics;
    let lost = std::mem::take(&mut physics.changed_bodies);
    for body in changed.iter().chain(lost) {
        let (Some(handle), Ok(parts)) = (physics.body(body), bodies.get(body)) else { continue };
        let desc = parts.desc(body);
        if let Err(error) = update_body(physics, handle, &desc, !parts.disabled) {
            physics.refuse(body, error);
            continue;
        }
        let Some(state) = physics.bodies.get_mut(&body).filter(|state| state.mass != desc.mass) else {
            continue;
        };
        state.follows_shapes = desc.mass.is_none();
        state.mass = desc.mass;
        match desc.mass.map_or(Ok(()), |mass| physics.set_mass(handle, mass)) {
            Ok(()) => physics.follow_shapes(body),
            Err(error) => physics.refuse(body, error),
        }
    }
}

/// Sets what differs from a description.
fn update_body(
    world: &mut backstop::World,
    body: backstop::BodyHandle,
    desc: &BodyDesc,
    enabled: bool,
) -> Result<(), Error> {
    world.set_kind(body, desc.kind)?;
    if world.gravity_scale(body)? != desc.gravity_scale {
        world.set_gravity_scale(body, desc.gravity_scale)?;
    }
    if world.damping(body)? != (desc.linear_damping, desc.angular_damping) {
        world.set_damping(body, desc.linear_damping, desc.angular_damping)?;
    }
    if world.locks(body)? != (desc.lock_translation, desc.lock_rotation) {
        world.set_locks(body, desc.lock_translation, desc.lock_rotation)?;
    }
    if world.continuous(body)? != desc.continuous {
        world.set_continuous(body, desc.continuous)?;
    }
    if world.solved_after(body)? != desc.solved_after {
        world.solve_body_after(body, desc.solved_after)?;
    }
    if world.can_sleep(body)? != desc.can_sleep {
        world.set_can_sleep(body, desc.can_sleep)?;
    }
    if world.is_enabled(body)? != enabled {
        world.set_enabled(body, enabled)?;
    }
    Ok(())
}

/// Velocities, forces and sleep that somebody set.
pub(crate) fn read_motion(
    mut physics: ResMut<PhysicsWorld>,
    velocities: Query<(Entity, &Velocity), Changed<Velocity>>,
    sleep: Query<(Entity, &Sleeping), Changed<Sleeping>>,
    forces: Query<(Entity, &ConstantForce)>,
) {
    let physics = &mut *physics;
    for (body, velocity) in &velocities {
        let Some(state) = physics.bodies.get_mut(&body) else { continue };
        let (handle, known) = (state.handle, state.velocity);
        state.velocity = *velocity;
        if velocity.linear != known.linear
            && let Err(error) = physics.set_linear_velocity(handle, velocity.linear.to_engine())
        {
            physics.refuse(body, error);
        }
        if velocity.angular != known.angular
            && let Err(error) = physics.set_angular_velocity(handle, velocity.angular.to_engine())
        {
            physics.refuse(body, error);
        }
        if *velocity != known {
            physics.following.remove(&body);
        }
    }
    for (body, sleeping) in &sleep {
        let Some(state) = physics.bodies.get(&body).filter(|state| state.asleep != sleeping.0) else {
            continue;
        };
        let handle = state.handle;
        let done = if sleeping.0 { physics.send_to_sleep(handle) } else { physics.wake(handle) };
        if let Err(error) = done {
            physics.refuse(body, error);
        }
    }
    for (body, force) in &forces {
        let Some(handle) = physics.body(body) else { continue };
        if let Err(error) = physics.add_force(handle, force.force.to_engine(), force.torque.to_engine()) {
            physics.refuse(body, error);
        }
    }
}

/// Transforms that somebody set: bodies are put there, kinematic ones move there within the step.
pub(crate) fn read_poses(
    mut physics: ResMut<PhysicsWorld>,
    dt: crate::plugin::StepLength,
    mut bodies: Query<(Entity, &Transform, &RigidBody, &mut PhysicsPose), Changed<Transform>>,
    hierarchy: Hierarchy,
) {
    let (physics, dt) = (&mut *physics, dt.seconds());
    let mut stops = std::mem::take(&mut physics.following);
    for (body, transform, kind, mut shown) in &mut bodies {
        let Some(state) = physics.bodies.get_mut(&body) else { continue };
        let written = std::mem::replace(&mut state.written, *transform);
        let (moved, turned) =
            (written.translation != transform.translation, written.rotation != transform.rotation);
        if !moved && !turned {
            continue;
        }
        let (handle, known) = (state.handle, state.pose);
        let above = hierarchy.above(body);
        let mut pose = pose_by(physics, above, transform);
        if above.is_none() {
            // What was not set may lie between two steps.
            pose.position = if moved { pose.position } else { known.position };
            pose.rotation = if turned { pose.rotation } else { known.rotation };
        }
        let (position, rotation) = (pose.position.to_engine(), pose.rotation.to_engine());
        if *kind == RigidBody::Kinematic {
            stops.remove(&body);
            match physics.move_kinematic(handle, position, rotation, dt) {
                Ok(()) => drop(physics.following.insert(body)),
                Err(error) => physics.refuse(body, error),
            }
            continue;
        }
        if let Err(error) = physics.set_pose(handle, position, rotation) {
            physics.refuse(body, error);
            continue;
        }
        *shown = pose;
        if let Some(state) = physics.bodies.get_mut(&body) {
            (state.previous, state.pose) = (pose, pose);
        }
    }
    // Those that have arrived stay there.
    for body in in_order(stops) {
        let Some(handle) = physics.body(body) else { continue };
        let stopped = physics.set_velocity(handle, Vec3::ZERO.to_engine(), Vec3::ZERO.to_engine());
        if let Err(error) = stopped {
            physics.refuse(body, error);
        }
        physics.moving.push(body);
    }
}

/// Adds new joints and takes over what changed about those that are there.
pub(crate) fn sync_joints(
    mut physics: ResMut<PhysicsWorld>,
    joints: Query<&Joint>,
    changed: Query<Entity, Changed<Joint>>,
) {
    let physics = &mut *physics;
    for entity in physics.candidates(JOINTS, changed.iter()) {
        let Ok(joint) = joints.get(entity) else { continue };
        if let Some(state) = physics.joints.get(&entity) {
            if state.bodies == joint.bodies && physics.contains_joint(state.handle) {
                if let Err(error) = update_joint(physics, entity, joint) {
                    physics.refuse(entity, error);
                }
                continue;
            }
            physics.remove_joint_of(entity);
        }
        match add_joint(physics, entity, joint) {
            Ok(state) => {
                physics.waiting[JOINTS].remove(&entity);
                physics.joints.insert(entity, state);
            }
            Err(problem) => physics.wait(JOINTS, entity, problem),
        }
    }
}

/// The description of a joint with its bodies and frames.
fn describe_joint(
    physics: &PhysicsWorld,
    entity: Entity,
    joint: &Joint,
) -> Result<backstop::JointDesc, Problem> {
    let [a, b] = joint.bodies;
    let handle = |body: Entity| physics.body(body).ok_or(Problem::NoBody(body));
    let mut desc = joint.desc.clone().with_user_data(entity.to_bits());
    desc.bodies = [handle(a)?, handle(b)?];
    if let Some((point, rotation)) = joint.anchor {
        let point = physics.to_world(point).to_engine();
        desc.frames = physics.frames_at(desc.bodies, point, rotation.to_engine())?;
    }
    Ok(desc)
}

fn add_joint(physics: &mut PhysicsWorld, entity: Entity, joint: &Joint) -> Result<JointState, Problem> {
    let desc = describe_joint(physics, entity, joint)?;
    let handle = physics.add_joint(&desc)?;
    Ok(JointState { handle, bodies: joint.bodies, desc, anchor: joint.anchor })
}

/// Sets what differs from what was last set.
fn update_joint(physics: &mut PhysicsWorld, entity: Entity, joint: &Joint) -> Result<(), Problem> {
    let mut desc = describe_joint(physics, entity, joint)?;
    let Some(JointState { handle, desc: old, anchor, .. }) = physics.joints.remove(&entity) else {
        return Ok(());
    };
    if joint.anchor.is_some() && joint.anchor == anchor {
        // The bodies have moved since; the frames are where they were put.
        desc.frames = old.frames;
    }
    let set = set_joint(physics, handle, &old, &desc);
    let desc = if set.is_ok() { desc } else { old };
    physics.joints.insert(entity, JointState { handle, bodies: joint.bodies, desc, anchor: joint.anchor });
    Ok(set?)
}

fn set_joint(
    world: &mut backstop::World,
    joint: backstop::JointHandle,
    old: &backstop::JointDesc,
    new: &backstop::JointDesc,
) -> Result<(), Error> {
    new.validate()?;
    if new.frames != old.frames {
        world.set_joint_frames(joint, new.frames)?;
    }
    if new.limits != old.limits {
        world.set_joint_limits(joint, &new.limits)?;
    }
    let axes = |desc: &backstop::JointDesc| -> Vec<_> {
        desc.drives.iter().map(|drive| (drive.motion, drive.axis)).collect()
    };
    let of = axes(new);
    if of == axes(old) && of.iter().collect::<HashSet<_>>().len() == of.len() {
        // A target that changes in every step is to cost no more than that.
        for (drive, _) in new.drives.iter().zip(&old.drives).filter(|(drive, old)| drive != old) {
            world.set_joint_drive(joint, *drive)?;
        }
    } else {
        world.set_joint_drives(joint, &new.drives)?;
    }
    if new.collide != old.collide {
        world.set_joint_collide(joint, new.collide)?;
    }
    if (new.break_force, new.break_torque) != (old.break_force, old.break_torque) {
        world.set_joint_strength(joint, new.break_force, new.break_torque)?;
    }
    if (new.force_threshold, new.torque_threshold) != (old.force_threshold, old.torque_threshold) {
        world.set_joint_thresholds(joint, new.force_threshold, new.torque_threshold)?;
    }
    if new.solved_after != old.solved_after {
        world.solve_joint_after(joint, new.solved_after)?;
    }
    Ok(())
}
