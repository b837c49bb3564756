//! Velocities, sleep, forces and transforms that somebody set.

use super::hierarchy::{Hierarchy, pose_by};
use crate::components::body::*;
use crate::components::character::Character;
use crate::convert::ToEngine;
use crate::plugin::StepLength;
use crate::world::{PhysicsWorld, in_order};
use backstop::{BodyKind, glam};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_transform::components::Transform;

/// Where a body is and how it moves, and when that was written.
#[derive(QueryData)]
pub(crate) struct Written {
    entity: Entity,
    transform: Option<Ref<'static, Transform>>,
    velocity: Option<Ref<'static, Velocity>>,
}

/// Finds bodies whose transform or velocity somebody else wrote, in one pass over all of them.
pub(crate) fn find_written(mut physics: ResMut<PhysicsWorld>, all: Query<Written, With<RigidBody>>) {
    let PhysicsWorld { bodies, moved, pushed, .. } = &mut *physics;
    moved.clear();
    pushed.clear();
    for part in &all {
        let transform = part.transform.filter(|transform| transform.is_changed());
        let velocity = part.velocity.filter(|velocity| velocity.is_changed());
        if transform.is_none() && velocity.is_none() {
            continue;
        }
        let Some(state) = bodies.get(&part.entity) else { continue };
        if transform.is_some_and(|transform| *transform != state.written) {
            moved.push(part.entity);
        }
        if velocity.is_some_and(|velocity| *velocity != state.velocity) {
            pushed.push(part.entity);
        }
    }
}

/// Velocities, forces and sleep that somebody set.
pub(crate) fn read_motion(
    mut physics: ResMut<PhysicsWorld>,
    velocities: Query<&Velocity>,
    sleep: Query<(Entity, &Sleeping), Changed<Sleeping>>,
    forces: Query<(Entity, &ConstantForce)>,
) {
    let physics = &mut *physics;
    for index in 0..physics.pushed.len() {
        let body = physics.pushed[index];
        let (Ok(velocity), Some(state)) = (velocities.get(body), physics.bodies.get_mut(&body)) else {
            continue;
        };
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
        physics.following.remove(&body);
    }
    for (body, sleeping) in &sleep {
        let Some(state) = physics.bodies.get(&body).filter(|state| state.asleep != sleeping.0) else {
            continue;
        };
        let handle = state.handle;
        physics.sleep_asked.push(body);
        let done = if sleeping.0 { physics.sleep(handle) } else { physics.wake(handle) };
        if let Err(error) = done {
            physics.refuse(body, error);
        }
    }
    for (body, force) in &forces {
        let Some(handle) = physics.body(body) else { continue };
        if let Err(error) =
            physics.add_force_and_torque(handle, force.force.to_engine(), force.torque.to_engine())
        {
            physics.refuse(body, error);
        }
    }
}

/// Transforms that somebody set: bodies are put there, kinematic ones move there within the step. The body of
/// a character follows that.
pub(crate) fn read_poses(
    mut physics: ResMut<PhysicsWorld>,
    dt: StepLength,
    mut bodies: Query<(&Transform, &RigidBody, &mut PhysicsPose), Without<Character>>,
    hierarchy: Hierarchy,
) {
    let (physics, dt) = (&mut *physics, dt.seconds());
    let mut stops = std::mem::take(&mut physics.following);
    for index in 0..physics.moved.len() {
        let body = physics.moved[index];
        let (Ok((transform, kind, mut shown)), Some(state)) =
            (bodies.get_mut(body), physics.bodies.get_mut(&body))
        else {
            continue;
        };
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
        if physics.kind(handle) != Ok(BodyKind::Kinematic) {
            continue;
        }
        if let Err(error) = physics.set_velocity(handle, glam::Vec3::ZERO, glam::Vec3::ZERO) {
            physics.refuse(body, error);
        }
        if let Some(state) = physics.bodies.get_mut(&body) {
            state.moved_in = physics.steps;
        }
        physics.mark_moving(body);
    }
}
