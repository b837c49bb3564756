//! Velocities, sleep, forces and transforms that somebody set.

use super::hierarchy::{Hierarchy, pose_by};
use crate::components::body::*;
use crate::components::character::Character;
use crate::components::shape::Shape;
use crate::convert::ToEngine;
use crate::plugin::StepLength;
use crate::world::{LocalPose, PhysicsWorld, in_order};
use backstop::{BodyKind, glam};
use bevy_ecs::change_detection::{ContiguousRef, Tick};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemChangeTick;
use bevy_transform::components::Transform;

/// When transforms and velocities of bodies were written, and what is there.
type Written = (Entity, Option<Ref<'static, Transform>>, Option<Ref<'static, Velocity>>);

/// Finds bodies whose transform or velocity somebody else wrote, in one pass over the ticks of all of them.
pub(crate) fn find_written(
    mut physics: ResMut<PhysicsWorld>,
    all: Query<Written, With<RigidBody>>,
    tick: SystemChangeTick,
) {
    let PhysicsWorld { bodies, drawn, moved, pushed, wrote, .. } = &mut *physics;
    moved.clear();
    pushed.clear();
    let foreign = |entity: Entity, changed: Tick| {
        changed.is_newer_than(tick.last_run(), tick.this_run()) && wrote.may_be_foreign(entity, changed)
    };
    // Both components are in tables.
    for (entities, transforms, velocities) in all.contiguous_iter().into_iter().flatten() {
        if let Some(transforms) = transforms {
            let ticks = transforms.changed_ticks_slice();
            for (row, (&entity, &changed)) in entities.iter().zip(ticks).enumerate() {
                if !foreign(entity, changed) {
                    continue;
                }
                let (Some(state), Some(drawn)) = (bodies.get(&entity), drawn.get(&entity)) else { continue };
                let transform = &transforms[row];
                if LocalPose::of_transform(transform) != drawn.written || transform.scale != state.scale {
                    moved.push(entity);
                }
            }
        }
        if let Some(velocities) = velocities {
            let ticks = velocities.changed_ticks_slice();
            for (row, (&entity, &changed)) in entities.iter().zip(ticks).enumerate() {
                if foreign(entity, changed)
                    && bodies.get(&entity).is_some_and(|state| velocities[row] != state.velocity)
                {
                    pushed.push(entity);
                }
            }
        }
    }
    wrote.clear();
}

/// Calls `each` with the entities of which a component changed since the system ran before. Tables in which
/// none did cost nothing, if the component has a summary tick.
fn each_changed<C: Component>(all: &Query<(Entity, Ref<C>)>, mut each: impl FnMut(Entity)) {
    for (entities, components) in all.contiguous_iter().into_iter().flatten() {
        let (_, ticks) = ContiguousRef::split(components);
        if ticks.summary_tick_is_changed() == Some(false) {
            continue;
        }
        for (&entity, changed) in entities.iter().zip(ticks.changed()) {
            if changed.is_newer_than(ticks.last_run(), ticks.this_run()) {
                each(entity);
            }
        }
    }
}

/// Finds bodies and shapes that are new, or whose component itself changed.
pub(crate) fn find_changed(
    mut physics: ResMut<PhysicsWorld>,
    bodies: Query<(Entity, Ref<RigidBody>)>,
    shapes: Query<(Entity, Ref<Shape>)>,
) {
    let PhysicsWorld { new_bodies, new_shapes, .. } = &mut *physics;
    new_bodies.clear();
    new_shapes.clear();
    each_changed(&bodies, |body| new_bodies.push(body));
    each_changed(&shapes, |shape| new_shapes.push(shape));
}

/// Velocities, forces and sleep that somebody set.
pub(crate) fn read_motion(
    mut physics: ResMut<PhysicsWorld>,
    velocities: Query<&Velocity>,
    sleep: Query<(Entity, Ref<Sleeping>)>,
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
    each_changed(&sleep, |body| {
        let (Ok((_, sleeping)), Some(state)) = (sleep.get(body), physics.bodies.get(&body)) else { return };
        if state.asleep == sleeping.0 {
            return;
        }
        let handle = state.handle;
        physics.sleep_asked.push(body);
        let done = if sleeping.0 { physics.sleep(handle) } else { physics.wake(handle) };
        if let Err(error) = done {
            physics.refuse(body, error);
        }
    });
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
        let (Ok((transform, kind, mut shown)), Some(state), Some(drawn)) =
            (bodies.get_mut(body), physics.bodies.get_mut(&body), physics.drawn.get_mut(&body))
        else {
            continue;
        };
        state.scale = transform.scale;
        let new = LocalPose::of_transform(transform);
        let written = std::mem::replace(&mut drawn.written, new);
        let (moved, turned) = (written.position != new.position, written.rotation != new.rotation);
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
        physics.put_at(body, pose);
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
