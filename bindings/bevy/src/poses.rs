//! Transforms: the pose after the last step while steps run; between the last two, or ahead of the last, when
//! a frame is drawn.

use crate::components::body::{Extrapolation, NoInterpolation, PhysicsPose, RigidBody, Velocity};
use crate::components::character::Character;
use crate::convert::ToBevy;
use crate::plugin::StepLength;
use crate::world::{DrawnState, LocalPose, PhysicsWorld, in_order};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::system::{SystemChangeTick, SystemParam};
use bevy_math::{DVec3, Quat, Vec3, Vec3A};
use bevy_time::{Fixed, Time};
use bevy_transform::components::{GlobalTransform, Transform};

/// Which moment transforms show.
#[derive(Clone, Copy, PartialEq)]
enum Moment {
    /// The last step.
    Last,
    /// A share of a step after it, whose length is given [s]: drawn that share of the way from the step
    /// before to the last one, or where the velocity leads from the last one in that share of a step.
    After { share: f32, dt: f32 },
}

/// The transform of a body, and how it is drawn.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Drawn {
    entity: Entity,
    transform: &'static mut Transform,
    sudden: Has<NoInterpolation>,
    ahead: Has<Extrapolation>,
    is_below: Has<ChildOf>,
    walks: Has<Character>,
}

/// What the plugin writes the transform of.
type Shown = Or<(With<RigidBody>, With<Character>)>;

/// Bodies and characters, and anything that they may be below.
type Transforms<'w, 's> = ParamSet<'w, 's, (Query<'w, 's, Drawn, Shown>, Query<'w, 's, &'static Transform>)>;

/// What writes transforms.
#[derive(SystemParam)]
pub(crate) struct Poses<'w, 's> {
    physics: ResMut<'w, PhysicsWorld>,
    transforms: Transforms<'w, 's>,
    parents: Query<'w, 's, &'static ChildOf>,
    below: Query<'w, 's, Entity, (Shown, With<ChildOf>)>,
    all_ahead: Option<Res<'w, AllAhead>>,
    tick: SystemChangeTick,
}

/// All bodies and characters are drawn ahead of the last step.
#[derive(Resource)]
pub(crate) struct AllAhead;

impl Poses<'_, '_> {
    /// Writes where bodies are at a moment: those that moved, and those below a parent, which may have moved.
    /// What somebody else wrote stays.
    fn write(&mut self, moment: Moment) {
        let physics = &mut *self.physics;
        follow_origin(physics);
        let ahead = self.all_ahead.is_some();
        let mut drawn = self.transforms.p0();
        if !(physics.shown_last && moment == Moment::Last) {
            if physics.many_move() {
                let own = self.tick.this_run();
                physics.wrote.note(own);
                drawn.iter_mut().for_each(|mut part| {
                    if part.transform.last_changed() == own {
                        physics.wrote.look_at(part.entity);
                    }
                    write_root(physics, &mut part, moment, ahead);
                });
            } else {
                for index in 0..physics.moving.len() {
                    let Ok(mut part) = drawn.get_mut(physics.moving[index]) else { continue };
                    write_root(physics, &mut part, moment, ahead);
                }
            }
            physics.shown_last = moment == Moment::Last;
        }
        for index in 0..physics.walkers.len() {
            let Some(mut part) = physics.walkers.key(index).and_then(|entity| drawn.get_mut(entity).ok())
            else {
                continue;
            };
            if !part.is_below {
                write_character(physics, &mut part, None, moment, ahead);
            }
        }
        if !self.below.is_empty() {
            self.write_below(moment, ahead);
        }
    }

    /// Writes the transforms of those below a parent, parents first: they may be bodies themselves.
    fn write_below(&mut self, moment: Moment, ahead: bool) {
        let physics = &mut *self.physics;
        let mut below: Vec<(usize, Entity)> =
            self.below.iter().map(|body| (self.parents.iter_ancestors(body).count(), body)).collect();
        below.sort_unstable_by_key(|(depth, body)| (*depth, body.index_u32()));
        for (_, body) in below {
            let mut above = GlobalTransform::IDENTITY;
            let others = self.transforms.p1();
            for ancestor in self.parents.iter_ancestors(body) {
                let own = others.get(ancestor).copied().unwrap_or_default();
                above = GlobalTransform::from(own) * above;
            }
            let mut drawn = self.transforms.p0();
            let Ok(mut part) = drawn.get_mut(body) else { continue };
            if part.walks && physics.walkers.contains_key(&body) {
                write_character(physics, &mut part, Some(above), moment, ahead);
            } else {
                write_body(physics, &mut part, Some(above), moment, ahead);
            }
        }
    }
}

/// Writes a body that has no parent and is no character, if it moves.
#[inline]
fn write_root(physics: &mut PhysicsWorld, part: &mut DrawnItem, moment: Moment, ahead: bool) {
    if !(part.is_below || part.walks && physics.walkers.contains_key(&part.entity)) {
        write_body(physics, part, None, moment, ahead);
    }
}

#[inline]
fn write_body(
    physics: &mut PhysicsWorld,
    part: &mut DrawnItem,
    above: Option<GlobalTransform>,
    moment: Moment,
    ahead: bool,
) {
    let PhysicsWorld { world, bodies, drawn, list, origin, wrote, .. } = physics;
    let Some(state) = drawn.get_mut(&part.entity) else { return };
    if above.is_none() && state.listed_in != *list {
        return;
    }
    let pose = match moment {
        Moment::Last => state.last,
        _ if part.sudden => state.last,
        Moment::After { share, dt } if ahead || part.ahead => {
            let Some(body) = bodies.get(&part.entity) else { return };
            let arm = world.centre_of_mass(body.handle).map(|centre| centre.to_bevy() - body.pose.position);
            let pose = moved_on(&body.pose, &body.velocity, arm.unwrap_or_default(), share * dt);
            LocalPose::of(&pose, *origin)
        }
        Moment::After { share, .. } => between(&state.previous, &state.last, share),
    };
    let pose = above.map_or(pose, |above| below(&above, pose));
    if state.show(&mut part.transform, pose) {
        wrote.look_at(part.entity);
    }
}

impl DrawnState {
    /// Writes a pose to the transform of the body, unless somebody else wrote another one. Returns whether
    /// somebody else changed the transform in any way since it was last written.
    #[inline(always)]
    pub(crate) fn show(&mut self, transform: &mut Mut<Transform>, pose: LocalPose) -> bool {
        let is_foreign = transform.last_changed() != self.shown_at;
        if is_foreign && LocalPose::of_transform(transform) != self.written {
            return true;
        }
        if pose != self.written {
            self.written = pose;
            (transform.translation, transform.rotation) = (pose.position.into(), pose.rotation);
            self.shown_at = transform.last_changed();
        }
        is_foreign
    }
}

/// Writes the translation of a character, and its rotation only after a snapshot: games turn characters in
/// any frame, and they are to go on moving evenly.
fn write_character(
    physics: &mut PhysicsWorld,
    part: &mut DrawnItem,
    above: Option<GlobalTransform>,
    moment: Moment,
    ahead: bool,
) {
    let origin = physics.origin;
    let Some(state) = physics.walkers.get_mut(&part.entity) else { return };
    let last = LocalPose::of(&state.pose, origin);
    let pose = match moment {
        Moment::After { share, .. } if !part.sudden => {
            let previous = LocalPose::of(&state.previous, origin);
            let mut pose = between(&previous, &last, share);
            if ahead || part.ahead {
                pose.position = last.position + (pose.position - previous.position);
            }
            pose
        }
        _ => last,
    };
    let pose = above.map_or(pose, |above| below(&above, pose));
    let (translation, rotation) = (Vec3::from(pose.position), pose.rotation);
    let mut new = *part.transform;
    if new.translation == state.written.translation {
        (new.translation, state.written.translation) = (translation, translation);
    }
    if state.turned_back {
        (new.rotation, state.written.rotation) = (rotation, rotation);
    }
    part.transform.set_if_neq(new);
    state.turned_back = false;
}

/// Where the world's origin moved, all transforms do.
fn follow_origin(physics: &mut PhysicsWorld) {
    let new = physics.world.origin();
    if physics.origin == new {
        return;
    }
    let shift = Vec3A::from((physics.origin - new).as_vec3().to_bevy());
    physics.origin = new;
    for body in in_order(physics.bodies.keys().copied()) {
        if let (Some(state), Some(drawn)) = (physics.bodies.get(&body), physics.drawn.get_mut(&body)) {
            let last = LocalPose::of(&state.pose, new);
            if drawn.previous == drawn.last {
                drawn.previous = last;
            } else {
                drawn.previous.position += shift;
            }
            drawn.last = last;
        }
        physics.mark_moving(body);
    }
}

/// A pose as it is seen from what is above.
fn below(above: &GlobalTransform, pose: LocalPose) -> LocalPose {
    let position = above.affine().inverse().transform_point3a(pose.position);
    LocalPose { position, rotation: above.rotation().inverse() * pose.rotation }
}

/// Cosine of half of an angle of 16 degrees. For less than that between two steps a chord, which takes a
/// third of the time, is within 1e-4 rad of the arc.
const NEAR: f32 = 0.99;

/// The pose at a fraction of the way from one to another, which is exact at its ends.
#[inline]
fn between(from: &LocalPose, to: &LocalPose, fraction: f32) -> LocalPose {
    if fraction >= 1.0 || from == to {
        return *to;
    }
    if fraction <= 0.0 {
        return *from;
    }
    let (start, end) = (from.rotation, to.rotation);
    let is_near = start.dot(end).abs() > NEAR;
    let rotation = if is_near { start.lerp(end, fraction) } else { start.slerp(end, fraction) };
    LocalPose { position: from.position.lerp(to.position, fraction), rotation }
}

/// The pose after some time, if nothing changes the velocity [s]. `arm` is from the origin of the body to its
/// centre of mass, whose velocity it is.
fn moved_on(pose: &PhysicsPose, velocity: &Velocity, arm: DVec3, time: f32) -> PhysicsPose {
    let turn = Quat::from_scaled_axis(velocity.angular * time);
    let arm_after = turn.as_dquat() * arm;
    PhysicsPose {
        position: pose.position + (velocity.linear * time).as_dvec3() + (arm - arm_after),
        rotation: (turn * pose.rotation).normalize(),
    }
}

/// Before and after a step: where bodies are.
pub(crate) fn show_last(mut poses: Poses) {
    poses.write(Moment::Last);
}

/// When a frame is drawn: where bodies are between the last two steps, or after the last one.
pub(crate) fn interpolate(mut poses: Poses, time: Res<Time<Fixed>>, step: StepLength) {
    poses.write(Moment::After { share: time.overstep_fraction(), dt: step.seconds() });
}
