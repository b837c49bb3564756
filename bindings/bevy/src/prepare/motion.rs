//! Velocities, sleep, forces and transforms that somebody set.

use super::hierarchy::{Hierarchy, pose_by};
use crate::body::*;
use crate::character::Character;
use crate::convert::ToEngine;
use crate::plugin::StepLength;
use crate::world::{PhysicsWorld, in_order};
use backstop::{BodyKind, glam};
use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;

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

/// A body that is not the body of a character, which follows that, and whose transform changed.
type MovedBody = (Changed<Transform>, Without<Character>);

/// Transforms that somebody set: bodies are put there, kinematic ones move there within the step.
pub(crate) fn read_poses(
    mut physics: ResMut<PhysicsWorld>,
    dt: StepLength,
    mut bodies: Query<(Entity, &Transform, &RigidBody, &mut PhysicsPose), MovedBody>,
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
        if physics.kind(handle) != Ok(BodyKind::Kinematic) {
            continue;
        }
        if let Err(error) = physics.set_velocity(handle, glam::Vec3::ZERO, glam::Vec3::ZERO) {
            physics.refuse(body, error);
        }
        if let Some(state) = physics.bodies.get_mut(&body) {
            state.moved_in = physics.steps;
        }
        physics.moving.push(body);
    }
}
