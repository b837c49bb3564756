//! A back end for bevy_picking (feature `picking`): pointers meet shapes by rays through the world.

use crate::convert::{ToBevy, ToEngine};
use crate::world::PhysicsWorld;
use backstop::{QueryFilter, Ray, RayHit};
use bevy_app::prelude::*;
use bevy_camera::Camera;
use bevy_ecs::prelude::*;
use bevy_picking::backend::prelude::*;

/// Tells bevy_picking which shapes are under pointers. Needs Bevy's `PickingPlugin`, or
/// `DefaultPickingPlugins`, which `DefaultPlugins` has, and [`BackstopPlugin`](crate::BackstopPlugin).
///
/// Hits are entities with a [`Shape`](crate::Shape), where they are after the last step; events of them go on
/// to their parents, so that observers of a body see those of its shapes. Depths are distances from the near
/// plane of the camera [m]; position and normal are where transforms are. A `Pickable` that is not hoverable
/// is passed over, and nothing behind one that blocks is reported; without `Pickable` a shape blocks.
#[derive(Clone, Copy, Debug, Default)]
pub struct BackstopPickingPlugin;

/// How pointers meet shapes.
#[derive(Resource, Clone, Copy, Debug)]
pub struct PhysicsPicking {
    /// Only cameras with [`PhysicsPickingCamera`], and shapes with `Pickable`. Default no.
    pub require_markers: bool,
    /// Whether sensors are met. Default no.
    pub sensors: bool,
    /// Length of rays [m]. Default 10 km.
    pub reach: f32,
}

impl Default for PhysicsPicking {
    fn default() -> Self {
        PhysicsPicking { require_markers: false, sensors: false, reach: 10_000.0 }
    }
}

/// A camera whose pointers meet shapes, where [`PhysicsPicking::require_markers`] asks for it.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct PhysicsPickingCamera;

impl Plugin for BackstopPickingPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<PhysicsPicking>();
        app.add_systems(PreUpdate, find_hits.in_set(PickingSystems::Backend));
    }
}

fn find_hits(
    physics: Option<Res<PhysicsWorld>>,
    settings: Res<PhysicsPicking>,
    rays: Res<RayMap>,
    cameras: Query<(&Camera, Has<PhysicsPickingCamera>)>,
    pickables: Query<&Pickable>,
    mut writer: MessageWriter<PointerHits>,
    mut met: Local<Vec<RayHit>>,
) {
    let Some(physics) = physics else { return };
    for (id, ray) in rays.iter() {
        let Ok((camera, marked)) = cameras.get(id.camera) else { continue };
        if settings.require_markers && !marked {
            continue;
        }
        let from = physics.to_world(ray.origin).to_engine();
        let ray = Ray::new(from, (*ray.direction).to_engine() * settings.reach);
        let filter = QueryFilter { sensors: settings.sensors, ..QueryFilter::default() };
        if physics.cast_ray_all(&ray, &filter, &mut met).is_err() {
            // A camera beyond the world sees nothing of it.
            continue;
        }
        let mut picks = Vec::new();
        for hit in &*met {
            let Some(entity) = physics.entity_of_shape(hit.shape) else { continue };
            let pickable = pickables.get(entity).ok();
            let is_passed_over = pickable.map_or(settings.require_markers, |pickable| !pickable.is_hoverable);
            if is_passed_over {
                continue;
            }
            let depth = (hit.point - from).length() as f32;
            let position = physics.to_local(hit.point.to_bevy());
            picks.push((entity, HitData::new(id.camera, depth, Some(position), Some(hit.normal.to_bevy()))));
            if pickable.is_none_or(|pickable| pickable.should_block_lower) {
                break;
            }
        }
        if !picks.is_empty() {
            writer.write(PointerHits::new(id.pointer, picks, camera.order as f32));
        }
    }
}
