//! The ground under a character, and how the character stays on it.

use super::planes::Planes;
use super::report::Ground;
use super::shape::Shape;
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::query::ShapeHit;
use crate::world::World;
use glam::{DVec3, Vec3};

/// Looks for ground down to `reach` [m] and lowers the character onto it. If there is none, `at` is
/// unchanged. It stands on an edge if the ground beyond is no more than `step` [m] lower.
pub(super) fn settle(
    shape: &Shape<'_>,
    at: &mut DVec3,
    reach: f64,
    step: f64,
) -> Result<Option<Ground>, Error> {
    let down = shape.up * -reach;
    let Some(hit) = shape.cast(*at, down)? else { return Ok(None) };
    let lowered = *at + down * f64::from(hit.fraction);
    let ground = |body, shape_handle, point, normal| -> Result<Option<Ground>, Error> {
        let velocity = velocity_at(shape.world, body, point)?;
        Ok(Some(Ground { body, shape: shape_handle, point, normal, velocity }))
    };
    if shape.is_floor(hit.normal) {
        *at = lowered;
        return ground(hit.body, hit.shape, hit.point, hit.normal);
    }
    // At the edge of a step, or between ground and wall, the ground below the middle counts.
    let left = reach * (1.0 - f64::from(hit.fraction));
    if let Some(floor) = shape.floor_below(lowered, left + step + shape.tiny)? {
        *at = lowered;
        // If it does not hang on an edge, it stands beside the shape that it touched first.
        return if shape.up.dot(shape.feet(lowered) - floor.point) < 10.0 * shape.tiny {
            ground(floor.body, floor.shape, floor.point, floor.normal)
        } else {
            ground(hit.body, hit.shape, hit.point, floor.normal)
        };
    }
    if is_wedged(shape, lowered, &hit)? {
        *at = lowered;
        return ground(hit.body, hit.shape, hit.point, shape.up.as_vec3());
    }
    Ok(None)
}

/// Whether surfaces that are too steep one by one hold the character together, like the two sides of a
/// gutter.
fn is_wedged(shape: &Shape<'_>, at: DVec3, first: &ShapeHit) -> Result<bool, Error> {
    let mut planes = Planes::default();
    planes.add(first.normal.as_dvec3().normalize());
    for _ in 0..3 {
        let path = planes.clip(-shape.up * shape.radius);
        if path.length() < 1e-3 * shape.radius {
            return Ok(true);
        }
        let Some(hit) = shape.cast(at, path)? else { return Ok(false) };
        if path.length() * f64::from(hit.fraction) > shape.tiny {
            return Ok(false);
        }
        planes.add(hit.normal.as_dvec3().normalize());
    }
    Ok(false)
}

/// Velocity of a point of a body [m/s].
pub(super) fn velocity_at(world: &World, body: BodyHandle, point: DVec3) -> Result<Vec3, Error> {
    let arm = (point - world.centre_of_mass(body)?).as_vec3();
    Ok(world.linear_velocity(body)? + world.angular_velocity(body)?.cross(arm))
}
