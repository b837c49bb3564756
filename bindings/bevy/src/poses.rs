//! Transforms: the pose after the last step while steps run, and between the last two when a frame is drawn.

use crate::body::{NoInterpolation, PhysicsPose, RigidBody};
use crate::character::Character;
use crate::convert::{ToBevy, ToEngine};
use crate::world::{PhysicsWorld, in_order};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_math::{Quat, Vec3};
use bevy_time::{Fixed, Time};
use bevy_transform::components::{GlobalTransform, Transform};

/// What the plugin writes the transform of.
type Shown = Or<(With<RigidBody>, With<Character>)>;

/// What writes transforms.
#[derive(SystemParam)]
pub(crate) struct Poses<'w, 's> {
    physics: ResMut<'w, PhysicsWorld>,
    transforms: Query<'w, 's, &'static mut Transform>,
    parents: Query<'w, 's, &'static ChildOf>,
    below: Query<'w, 's, Entity, (Shown, With<ChildOf>)>,
    sudden: Query<'w, 's, (), With<NoInterpolation>>,
}

impl Poses<'_, '_> {
    /// Writes where bodies are at a fraction of the way from the step before to the last one: those that
    /// moved, and those below a parent, which may have moved. What somebody else wrote stays.
    fn write(&mut self, fraction: f32) {
        self.follow_origin();
        let none_below = self.below.is_empty();
        for index in 0..self.physics.moving.len() {
            let body = self.physics.moving[index];
            if none_below || !self.below.contains(body) {
                self.write_one(body, None, fraction);
            }
        }
        if none_below {
            return;
        }
        // Parents first: they may be bodies themselves.
        let mut below: Vec<(usize, Entity)> =
            self.below.iter().map(|body| (self.parents.iter_ancestors(body).count(), body)).collect();
        below.sort_unstable_by_key(|(depth, body)| (*depth, body.index_u32()));
        for (_, body) in below {
            let mut above = GlobalTransform::IDENTITY;
            for ancestor in self.parents.iter_ancestors(body) {
                let own = self.transforms.get(ancestor).copied().unwrap_or_default();
                above = GlobalTransform::from(own) * above;
            }
            self.write_one(body, Some(above), fraction);
        }
    }

    fn write_one(&mut self, body: Entity, above: Option<GlobalTransform>, fraction: f32) {
        let fraction = if fraction < 1.0 && self.sudden.contains(body) { 1.0 } else { fraction };
        if !self.physics.walkers.is_empty() && self.physics.walkers.contains_key(&body) {
            return self.write_character(body, above, fraction);
        }
        let physics = &mut *self.physics;
        let origin = physics.origin;
        let (Some(state), Ok(mut transform)) = (physics.bodies.get_mut(&body), self.transforms.get_mut(body))
        else {
            return;
        };
        if *transform != state.written {
            return;
        }
        let pose = between(&state.previous, &state.pose, fraction);
        let place = (pose.position.to_engine() - origin).as_vec3().to_bevy();
        let (translation, rotation) = below(above, place, pose.rotation);
        state.written = Transform { translation, rotation, ..*transform };
        transform.set_if_neq(state.written);
    }

    /// Writes the translation of a character, and its rotation only after a snapshot: games turn characters
    /// in any frame, and they are to go on moving evenly.
    fn write_character(&mut self, entity: Entity, above: Option<GlobalTransform>, fraction: f32) {
        let physics = &mut *self.physics;
        let (Some(state), Ok(mut transform)) =
            (physics.walkers.get(&entity), self.transforms.get_mut(entity))
        else {
            return;
        };
        let (mut written, turned_back) = (state.written, state.turned_back);
        let pose = between(&state.previous, &state.pose, fraction);
        let (translation, rotation) = below(above, physics.to_local(pose.position), pose.rotation);
        let mut new = *transform;
        if new.translation == written.translation {
            (new.translation, written.translation) = (translation, translation);
        }
        if turned_back {
            (new.rotation, written.rotation) = (rotation, rotation);
        }
        transform.set_if_neq(new);
        if let Some(state) = physics.walkers.get_mut(&entity) {
            (state.written, state.turned_back) = (written, false);
        }
    }

    /// Where the world's origin moved, all transforms do.
    fn follow_origin(&mut self) {
        let physics = &mut *self.physics;
        if physics.origin != physics.origin() {
            physics.origin = physics.origin();
            let all = in_order(physics.bodies.keys().chain(physics.walkers.keys()).copied());
            physics.moving = all;
        }
    }
}

/// A place and a rotation as they are seen from what is above.
fn below(above: Option<GlobalTransform>, translation: Vec3, rotation: Quat) -> (Vec3, Quat) {
    let Some(above) = above else { return (translation, rotation) };
    (above.affine().inverse().transform_point3(translation), above.rotation().inverse() * rotation)
}

/// The pose at a fraction of the way from one to another, which is exact at its ends.
fn between(from: &PhysicsPose, to: &PhysicsPose, fraction: f32) -> PhysicsPose {
    if fraction >= 1.0 || from == to {
        return *to;
    }
    if fraction <= 0.0 {
        return *from;
    }
    PhysicsPose {
        position: from.position.lerp(to.position, f64::from(fraction)),
        rotation: from.rotation.slerp(to.rotation, fraction),
    }
}

/// Before and after a step: where bodies are.
pub(crate) fn show_last(mut poses: Poses) {
    poses.write(1.0);
}

/// When a frame is drawn: where bodies are between the last two steps.
pub(crate) fn interpolate(mut poses: Poses, time: Res<Time<Fixed>>) {
    poses.write(time.overstep_fraction());
}
