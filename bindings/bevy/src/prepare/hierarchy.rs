//! Where entities are below one another.

use crate::components::body::{PhysicsPose, RigidBody};
use crate::components::shape::ShapeOffset;
use crate::world::{PhysicsWorld, Place};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_math::Vec3;
use bevy_transform::components::{GlobalTransform, Transform};

/// Transforms and parents.
#[derive(SystemParam)]
pub(crate) struct Hierarchy<'w, 's> {
    nodes: Query<'w, 's, (Option<&'static Transform>, Option<&'static ChildOf>, Has<RigidBody>)>,
    offsets: Query<'w, 's, &'static ShapeOffset>,
}

impl Hierarchy<'_, '_> {
    /// The body of a shape, and where the shape is on it.
    pub(crate) fn place(&self, shape: Entity) -> Option<(Entity, Place)> {
        let offset = self.offsets.get(shape).copied().unwrap_or_default();
        let below = Transform::from_translation(offset.position).with_rotation(offset.rotation);
        let (mut below, mut entity) = (below, shape);
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
pub(crate) fn pose_by(
    physics: &PhysicsWorld,
    above: Option<GlobalTransform>,
    transform: &Transform,
) -> PhysicsPose {
    let global = above.map_or(*transform, |above| above.mul_transform(*transform).compute_transform());
    PhysicsPose { position: physics.to_world(global.translation), rotation: global.rotation }
}
