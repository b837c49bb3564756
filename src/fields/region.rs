//! The bodies that a field reaches.

use crate::body::BodyKind;
use crate::error::Error;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::math::Quat;
use crate::query::QueryFilter;
use crate::shape::{Filter, Geometry};
use crate::world::{Aabb, World};
use glam::{DVec3, Vec3};

/// A shape of a dynamic body that is awake, with its pose.
pub(super) struct Reached<'a> {
    pub(super) body: BodyHandle,
    pub(super) geometry: &'a Geometry,
    pub(super) position: DVec3,
    pub(super) rotation: Quat,
}

/// Shapes of dynamic bodies that are awake, in order; those whose boxes meet a region, if there is one.
pub(super) fn shapes<'a>(
    world: &'a World,
    region: Option<&Aabb>,
    filter: Option<Filter>,
) -> Result<Vec<Reached<'a>>, Error> {
    let mut found: Vec<(BodyHandle, ShapeHandle)> = Vec::new();
    if let Some(region) = region {
        let filter = QueryFilter { filter, ..QueryFilter::only_dynamic() };
        let mut met = Vec::new();
        world.overlap_aabb(region, &filter, &mut met)?;
        found.extend(met.iter().map(|met| (met.body, met.shape)));
    } else {
        for body in bodies(world) {
            for shape in world.shapes(body)? {
                let allowed = match filter {
                    Some(filter) => filter.allows(&world.filter(shape)?),
                    None => true,
                };
                if allowed && !world.is_sensor(shape)? {
                    found.push((body, shape));
                }
            }
        }
    }
    found.sort_unstable();
    let mut reached = Vec::with_capacity(found.len());
    for (body, shape) in found {
        if !world.is_sleeping(body)? {
            let (position, rotation) = world.shape_world_pose(shape)?;
            let geometry = world.geometry(shape)?;
            reached.push(Reached { body, geometry, position, rotation: rotation.into() });
        }
    }
    Ok(reached)
}

/// Dynamic bodies that are awake.
pub(super) fn bodies(world: &World) -> impl Iterator<Item = BodyHandle> + '_ {
    world.bodies().filter(|&body| {
        world.kind(body) == Ok(BodyKind::Dynamic)
            && world.is_sleeping(body) == Ok(false)
            && world.is_enabled(body) == Ok(true)
    })
}

/// Adds forces at points, and torques.
pub(super) fn apply(world: &mut World, pushes: &[(BodyHandle, Vec3, DVec3, Vec3)]) -> Result<usize, Error> {
    let (mut count, mut last) = (0, None);
    for &(body, force, at, torque) in pushes {
        world.add_force_at(body, force, at)?;
        world.add_torque(body, torque)?;
        count += usize::from(last != Some(body));
        last = Some(body);
    }
    Ok(count)
}
