//! The step, and after it: what the world did reaches the entities.

use crate::components::body::*;
use crate::components::character::Character;
use crate::convert::ToBevy;
use crate::hooks::{Called, CollisionHooks};
use crate::messages::*;
use crate::observers::{self, SensorEnd, SensorStart};
use crate::plugin::StepLength;
use crate::world::{CouplingState, JointState, PhysicsHooks, PhysicsWorld, in_order};
use backstop::ShapeHandle;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::system::{StaticSystemParam, SystemChangeTick, SystemParam, SystemParamItem};
use bevy_transform::components::Transform;

/// One step of the world, with the hooks of the app.
pub(crate) fn step<H: SystemParam + 'static>(
    mut physics: ResMut<PhysicsWorld>,
    dt: StepLength,
    boxed: Option<Res<PhysicsHooks>>,
    hooks: StaticSystemParam<H>,
) where
    for<'w, 's> SystemParamItem<'w, 's, H>: CollisionHooks,
{
    let physics = &mut *physics;
    let called = Called { hooks: &*hooks, boxed: boxed.as_deref(), shapes: &physics.shapes };
    let stepped = physics.world.step_with(dt.seconds(), &called).map(drop);
    if stepped.is_ok() {
        physics.steps += 1;
    }
    let error = stepped.err();
    if physics.refused != error {
        let problem = error.clone().map(Problem::Engine);
        physics.problems.extend(problem.map(|problem| PhysicsError { entity: None, problem }));
        physics.refused = error;
    }
}

/// Where a body is and how it moves, and its transform.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Motion {
    entity: Entity,
    pose: Option<&'static mut PhysicsPose>,
    velocity: Option<&'static mut Velocity>,
    transform: Option<&'static mut Transform>,
    is_below: Has<ChildOf>,
    walks: Has<Character>,
}

/// Poses, velocities and transforms of what moved.
pub(crate) fn write_motion(
    mut physics: ResMut<PhysicsWorld>,
    mut bodies: Query<Motion, With<RigidBody>>,
    mut before: Local<Vec<Entity>>,
    tick: SystemChangeTick,
) {
    let physics = &mut *physics;
    if std::mem::take(&mut physics.all_moved) {
        physics.take_over_all();
    } else {
        physics.take_over_moves(&mut before);
    }
    if physics.many_move() {
        let own = tick.this_run();
        physics.wrote.note(own);
        bodies.iter_mut().for_each(|mut part| {
            let of_transform = part.transform.as_ref().map(DetectChanges::last_changed);
            let of_velocity = part.velocity.as_ref().map(DetectChanges::last_changed);
            if of_transform == Some(own) || of_velocity == Some(own) {
                physics.wrote.look_at(part.entity);
            }
            show(physics, &mut part);
        });
    } else {
        for index in 0..physics.moving.len() {
            let Ok(mut part) = bodies.get_mut(physics.moving[index]) else { continue };
            show(physics, &mut part);
        }
    }
    // Where the origin moved, all transforms do: poses.rs writes them.
    physics.shown_last = physics.origin == physics.origin();
}

/// Writes where a body is and how it moves, if it moved; where a character is, that writes itself.
fn show(physics: &mut PhysicsWorld, part: &mut MotionItem) {
    let PhysicsWorld { bodies, drawn, walkers, list, wrote, .. } = physics;
    let Some(drawn) = drawn.get_mut(&part.entity).filter(|drawn| drawn.listed_in == *list) else { return };
    let Some(state) = bodies.get(&part.entity) else { return };
    if let Some(velocity) = &mut part.velocity {
        velocity.set_if_neq(state.velocity);
    }
    if part.walks && walkers.contains_key(&part.entity) {
        return;
    }
    if let Some(pose) = &mut part.pose {
        pose.set_if_neq(state.pose);
    }
    if let Some(transform) = part.transform.as_mut().filter(|_| !part.is_below)
        && drawn.show(transform, drawn.last)
    {
        wrote.look_at(part.entity);
    }
}

/// Who fell asleep and who woke.
pub(crate) fn write_sleep(
    mut physics: ResMut<PhysicsWorld>,
    mut sleep: Query<&mut Sleeping>,
    mut writers: Writers,
) {
    let PhysicsWorld { bodies, sleep_asked, fell_asleep, woke, .. } = &mut *physics;
    let mut show = |body: Entity| {
        if let (Some(state), Ok(mut shown)) = (bodies.get(&body), sleep.get_mut(body)) {
            shown.set_if_neq(Sleeping(state.asleep));
        }
    };
    sleep_asked.drain(..).for_each(&mut show);
    for body in fell_asleep.drain(..) {
        show(body);
        writers.slept.write(BodyFellAsleep { body });
    }
    for body in woke.drain(..) {
        show(body);
        writers.woke.write(BodyWoke { body });
    }
}

/// The events of the step, with entities.
pub(crate) fn write_messages(
    mut physics: ResMut<PhysicsWorld>,
    mut writers: Writers,
    mut commands: Commands,
) {
    let physics = &mut *physics;
    let named = |shape: ShapeHandle| -> Option<[Entity; 2]> {
        if let Some(entity) = physics.entity_of_shape(shape) {
            return Some([entity, physics.shapes.get(&entity)?.body]);
        }
        physics.departed.iter().find(|(gone, _)| *gone == shape).map(|(_, entities)| *entities)
    };
    let both = |shapes: [ShapeHandle; 2]| -> Option<[[Entity; 2]; 2]> {
        let [[a, of_a], [b, of_b]] = [named(shapes[0])?, named(shapes[1])?];
        Some([[a, b], [of_a, of_b]])
    };
    let contact = |event: &backstop::ContactEvent| {
        let [shapes, bodies] = both(event.shapes)?;
        let point = physics.to_local(event.point.to_bevy());
        let (normal, approach_speed, impulse) = (event.normal.to_bevy(), event.approach_speed, event.impulse);
        Some(Contact { shapes, bodies, point, normal, approach_speed, impulse })
    };
    let crossing = |event: &backstop::SensorEvent| {
        let [[sensor, visitor], [_, body]] = both([event.sensor, event.visitor])?;
        Some(Crossing { sensor, visitor, body, fraction: event.fraction })
    };
    let ended = |event: &backstop::ContactEnd| {
        let [shapes, bodies] = both(event.shapes)?;
        Some(ContactEnded { shapes, bodies })
    };
    let asks = |shapes: [ShapeHandle; 2]| shapes.map(|shape| physics.has_events(shape).unwrap_or(false));
    for event in physics.contact_begins() {
        let Some(contact) = contact(event) else { continue };
        writers.began.write(ContactBegan(contact));
        observers::start(&mut commands, contact, asks(event.shapes));
    }
    writers.hits.write_batch(physics.contact_hits().iter().filter_map(contact).map(ContactHit));
    for event in physics.contact_ends() {
        let Some(ended) = ended(event) else { continue };
        writers.ended.write(ended);
        observers::end(&mut commands, ended, asks(event.shapes));
    }
    for crossing in physics.sensor_begins().iter().filter_map(crossing) {
        writers.entered.write(SensorEntered(crossing));
        commands.trigger(SensorStart { entity: crossing.sensor, crossing });
    }
    for (event, crossing) in physics.sensor_ends().iter().filter_map(|end| Some((end, crossing(end)?))) {
        writers.left.write(SensorLeft(crossing));
        if physics.entity_of_shape(event.sensor).is_some() {
            commands.trigger(SensorEnd { entity: crossing.sensor, crossing });
        }
    }
    write_joints(physics, &mut writers);
    physics.departed.clear();
    for error in physics.problems.drain(..) {
        match error.entity {
            Some(entity) => log::warn!("{entity}: {}", error.problem),
            None => log::error!("the step is refused: {}", error.problem),
        }
        writers.errors.write(error);
    }
}

/// What became of joints and couplings.
fn write_joints(physics: &PhysicsWorld, writers: &mut Writers) {
    for event in physics.strained_joints() {
        let Some(joint) = physics.entity_of_joint(event.joint) else { continue };
        let (force, torque) = (event.force.to_bevy(), event.torque.to_bevy());
        writers.strained.write(JointStrained { joint, force, torque });
    }
    let broken = physics.broken_joints();
    if !broken.is_empty() {
        // Their handles are stale: nothing else knows whose they were.
        let broke = |(joint, state): (&Entity, &JointState)| broken.contains(&state.handle).then_some(*joint);
        for joint in in_order(physics.joints.iter().filter_map(broke)) {
            writers.broke.write(JointBroke { joint });
        }
    }
    let broken = physics.broken_couplings();
    if !broken.is_empty() {
        let broke =
            |(entity, state): (&Entity, &CouplingState)| broken.contains(&state.handle).then_some(*entity);
        for coupling in in_order(physics.couplings.iter().filter_map(broke)) {
            writers.decoupled.write(CouplingBroke { coupling });
        }
    }
}
