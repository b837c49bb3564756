//! Characters: what their components say reaches the world before a step, and they walk after it.

use crate::components::body::{GravityScale, PhysicsPose};
use crate::components::character::*;
use crate::components::shape::ShapeFilter;
use crate::convert::{ToBevy, ToEngine};
use crate::messages::Problem;
use crate::plugin::StepLength;
use crate::prepare::{Hierarchy, pose_by};
use crate::world::{CHARACTERS, PhysicsWorld, WalkerState, in_order};
use backstop::{BodyKind, CharacterHandle, CharacterReport, Error, QueryFilter, glam};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_transform::components::Transform;

/// Adds new characters, takes over what changed about the others, and has their bodies follow them.
pub(crate) fn sync_characters(
    mut physics: ResMut<PhysicsWorld>,
    changed: Query<Entity, Changed<Character>>,
    mut characters: Query<(&Character, &Transform, &mut PhysicsPose)>,
    hierarchy: Hierarchy,
    dt: StepLength,
) {
    let physics = &mut *physics;
    for entity in physics.candidates(CHARACTERS, changed.iter()) {
        let Ok((character, transform, mut shown)) = characters.get_mut(entity) else { continue };
        if let Some(handle) = physics.character_of(entity) {
            if let Err(error) = change(physics, entity, handle, character) {
                physics.refuse(entity, error);
            }
            continue;
        }
        let pose = pose_by(physics, hierarchy.above(entity), transform);
        match add(physics, character, &pose) {
            Ok(handle) => {
                physics.waiting[CHARACTERS].remove(&entity);
                let state = WalkerState::new(handle, pose, *transform, character.shape.is_some());
                physics.walkers.insert(entity, state);
                *shown = pose;
            }
            Err(error) => physics.wait(CHARACTERS, entity, error),
        }
    }
    for entity in in_order(physics.walkers.keys().copied()) {
        let Ok((character, transform, mut shown)) = characters.get_mut(entity) else { continue };
        let done = match read_pose(physics, entity, (character, transform), &hierarchy) {
            Ok(placed) => follow(physics, entity, placed, dt.seconds()),
            Err(error) => Err(error.into()),
        };
        physics.heard_of(entity, 0, done);
        if let Some(state) = physics.walkers.get(&entity) {
            shown.set_if_neq(state.pose);
        }
    }
}

/// The engine's character, at a pose.
fn add(
    physics: &mut PhysicsWorld,
    character: &Character,
    pose: &PhysicsPose,
) -> Result<CharacterHandle, Error> {
    let mut made = backstop::Character::new(character.settings, pose.position.to_engine())?;
    reshape(&mut made, character, pose)?;
    physics.add_character(&made)
}

/// Gives a character what its component says, where it stands.
fn change(
    physics: &mut PhysicsWorld,
    entity: Entity,
    handle: CharacterHandle,
    character: &Character,
) -> Result<(), Error> {
    let Some(state) = physics.walkers.get(&entity) else { return Ok(()) };
    let pose = state.pose;
    let mut new = physics.character(handle)?;
    new.set_settings(character.settings)?;
    reshape(&mut new, character, &pose)?;
    physics.set_character(handle, &new)?;
    if let Some(state) = physics.walkers.get_mut(&entity) {
        state.shaped = character.shape.is_some();
    }
    Ok(())
}

/// Gives it its shape, turned; a capsule has no turn that counts.
fn reshape(new: &mut backstop::Character, character: &Character, pose: &PhysicsPose) -> Result<(), Error> {
    new.set_shape(character.shape.clone())?;
    let (_, upright) = new.capsule();
    let turned = character.shape.is_some().then(|| upright.conjugate() * pose.rotation.to_engine());
    new.set_rotation(turned.unwrap_or(glam::Quat::IDENTITY))
}

/// Puts a character where its transform says, if somebody else wrote that. Returns whether it was.
fn read_pose(
    physics: &mut PhysicsWorld,
    entity: Entity,
    (character, transform): (&Character, &Transform),
    hierarchy: &Hierarchy,
) -> Result<bool, Error> {
    let Some(state) = physics.walkers.get(&entity) else { return Ok(false) };
    let (handle, known, mut pose) = (state.handle, state.written, state.pose);
    let placed = transform.translation != known.translation;
    if !placed && transform.rotation == known.rotation {
        return Ok(false);
    }
    let written = pose_by(physics, hierarchy.above(entity), transform);
    pose.rotation = written.rotation;
    let mut new = physics.character(handle)?;
    if placed {
        pose.position = written.position;
        new.set_position(pose.position.to_engine())?;
    }
    if placed || character.shape.is_some() {
        reshape(&mut new, character, &pose)?;
        physics.set_character(handle, &new)?;
    }
    if let Some(state) = physics.walkers.get_mut(&entity) {
        state.previous =
            if placed { pose } else { PhysicsPose { rotation: pose.rotation, ..state.previous } };
        (state.pose, state.written) = (pose, *transform);
    }
    Ok(placed)
}

/// Has the body of a character, if it has one, be where the character is after the step.
fn follow(physics: &mut PhysicsWorld, entity: Entity, placed: bool, dt: f32) -> Result<(), Problem> {
    let (Some(state), Some(body)) = (physics.walkers.get(&entity), physics.body(entity)) else {
        return Ok(());
    };
    if physics.kind(body)? != BodyKind::Kinematic {
        return Err(Problem::NotKinematic);
    }
    let pose = state.pose;
    let (position, rotation) = (pose.position.to_engine(), pose.rotation.to_engine());
    if placed {
        physics.set_pose(body, position, rotation)?;
        return Ok(physics.set_velocity(body, glam::Vec3::ZERO, glam::Vec3::ZERO)?);
    }
    let rests = physics.pose_of(body)? == pose
        && physics.linear_velocity(body)? == glam::Vec3::ZERO
        && physics.angular_velocity(body)? == glam::Vec3::ZERO;
    if !rests {
        physics.move_kinematic(body, position, rotation, dt)?;
    }
    Ok(())
}

/// What a walk reads and writes.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct WalkParts {
    character: &'static Character,
    input: &'static mut CharacterInput,
    state: &'static mut CharacterState,
    pose: &'static mut PhysicsPose,
    gravity: Option<&'static GravityScale>,
    filter: Option<&'static ShapeFilter>,
}

/// After the step: all characters walk, in the order in which they were spawned, and push what they run into.
pub(crate) fn walk(mut physics: ResMut<PhysicsWorld>, mut characters: Query<WalkParts>, dt: StepLength) {
    let physics = &mut *physics;
    if physics.refused.is_some() {
        return;
    }
    for entity in in_order(physics.walkers.keys().copied()) {
        let Ok(mut parts) = characters.get_mut(entity) else { continue };
        let done = walk_one(physics, entity, &mut parts, dt.seconds());
        physics.heard_of(entity, 1, done.map_err(Problem::from));
    }
}

fn walk_one(
    physics: &mut PhysicsWorld,
    entity: Entity,
    parts: &mut WalkPartsItem,
    dt: f32,
) -> Result<(), Error> {
    let Some(handle) = physics.character_of(entity) else { return Ok(()) };
    let velocity = wished(physics, parts, dt);
    if parts.input.jump != 0.0 {
        parts.input.jump = 0.0;
    }
    let filter = QueryFilter {
        filter: parts.filter.map(|filter| filter.0),
        exclude_body: physics.body(entity),
        ..QueryFilter::new()
    };
    let report = physics.walk_character(handle, &filter, velocity, dt)?;
    report.push(physics)?;
    let position = physics.character(handle)?.position().to_bevy();
    write(physics, &report, &mut parts.state);
    if let Some(state) = physics.walkers.get_mut(&entity) {
        state.previous = state.pose;
        state.pose.position = position;
        parts.pose.set_if_neq(state.pose);
    }
    Ok(())
}

/// The velocity of the next walk: the wish across, with gravity and jumps along `up`.
fn wished(physics: &PhysicsWorld, parts: &WalkPartsItem, dt: f32) -> glam::Vec3 {
    let wish = parts.input.velocity.to_engine();
    let scale = parts.gravity.map_or(1.0, |gravity| gravity.0);
    if scale == 0.0 {
        return wish;
    }
    let up = parts.character.settings.up;
    let across = |velocity: glam::Vec3| velocity - up * up.dot(velocity);
    let now = parts.state.velocity.to_engine();
    let wish = across(wish);
    if parts.state.grounded() && parts.input.jump > 0.0 {
        return wish + up * parts.input.jump;
    }
    let rise = up.dot(now) + up.dot(physics.settings().gravity) * scale * dt;
    if parts.state.grounded() {
        return wish + up * rise;
    }
    let missing = wish - across(now);
    let (most, length) = (parts.character.air_acceleration.max(0.0) * dt, missing.length());
    let step = if length > most { missing * (most / length) } else { missing };
    across(now) + step + up * rise
}

/// What came of it, with entities.
fn write(physics: &PhysicsWorld, report: &CharacterReport, state: &mut CharacterState) {
    state.velocity = report.velocity.to_bevy();
    state.ground = report.ground.map(|ground| CharacterGround {
        body: physics.entity_of(ground.body),
        shape: physics.entity_of_shape(ground.shape),
        point: physics.to_local(ground.point.to_bevy()),
        normal: ground.normal.to_bevy(),
        velocity: ground.velocity.to_bevy(),
    });
    state.touched.clear();
    state.touched.extend(report.hits().map(|hit| CharacterTouch {
        body: physics.entity_of(hit.body),
        shape: physics.entity_of_shape(hit.shape),
        point: physics.to_local(hit.point.to_bevy()),
        normal: hit.normal.to_bevy(),
        impulse: hit.impulse.to_bevy(),
    }));
    (state.moved, state.carried) = (report.moved.to_bevy(), report.carried.to_bevy());
    state.pushed_out = report.pushed_out.to_bevy();
    (state.turned, state.stepped, state.overlap) = (report.turned, report.stepped, report.overlap);
}
