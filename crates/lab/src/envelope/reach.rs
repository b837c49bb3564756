//! Extents of bodies, for measures that are independent of an engine.

use backstop::BodyDesc;
use backstop::Geometry;
use glam::{Quat, Vec3};

/// How far a body reaches from its origin along a direction of unit length [m]; zero for shapes without an
/// extent of their own.
pub(super) fn reach(body: &BodyDesc, rotation: Quat, direction: Vec3) -> f64 {
    let own = rotation.inverse() * direction;
    let of = |shape: &backstop::ShapeDesc| {
        let along = shape.rotation.inverse() * own;
        f64::from(shape.position.dot(own) + extent(&shape.geometry, along))
    };
    body.shapes.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
}

/// The support function of a shape in its own axes.
fn extent(geometry: &Geometry, along: Vec3) -> f32 {
    let ring = |radius: f32| radius * along.x.hypot(along.z);
    match geometry {
        Geometry::Sphere { radius } => *radius,
        Geometry::Box { half_extents } => half_extents.dot(along.abs()),
        Geometry::Capsule { half_height, radius_bottom, radius_top } => {
            (radius_top + half_height * along.y).max(radius_bottom - half_height * along.y)
        }
        Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
            (ring(*radius_top) + half_height * along.y).max(ring(*radius_bottom) - half_height * along.y)
        }
        Geometry::Hull(hull) => {
            hull.vertices().iter().map(|v| v.dot(along)).fold(f32::NEG_INFINITY, f32::max)
        }
        // Nowhere, of planes, meshes and height fields.
        _ => geometry.furthest(along.as_dvec3()).map_or(0.0, |point| point.dot(along.as_dvec3()) as f32),
    }
}
