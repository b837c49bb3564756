//! How a moving shape turns, for the tests in lanes.

use crate::config::tuning::UNSEEN_ROTATION;
use crate::lanes::{Lanes, Vec3 as LaneVec3, f32x8};
use crate::shape::support::vertices;
use crate::shape::{Collider, Geometry};
use glam::Vec3;

/// A shape's rotation about its body's centre of mass, in its own frame.
pub(crate) struct Spin {
    /// Rotation vector over the step [rad]; zero if it moves no point by as much as the tolerance shows.
    pub(crate) vector: Vec3,
    /// Largest distance of a point from the axis [m], without the radius of round shapes, which turning does
    /// not move.
    pub(crate) reach: f32,
}

impl Spin {
    pub(crate) fn of(shape: &Collider, vector: Vec3, lever: Vec3, tolerance: f32) -> Spin {
        let angle = vector.length();
        if angle == 0.0 {
            return Spin { vector, reach: 0.0 };
        }
        let axis = vector / angle;
        let off = axis.cross(lever).length();
        let [x, y, z, _] = shape.size;
        let ends = |bottom: f32, top: f32| {
            let end = |y: f32| axis.cross(lever + Vec3::Y * y).length();
            (end(x) + top).max(end(-x) + bottom)
        };
        let reach = match &shape.geometry {
            Geometry::Sphere { .. } => off,
            Geometry::Capsule { .. } => ends(y - y.min(z), z - y.min(z)),
            Geometry::Cylinder { .. } => ends(y, z),
            Geometry::Box { .. } => {
                // Opposite corners are equally far from an axis through the middle.
                let corner = |x: f32, y: f32| axis.cross(Vec3::new(x, y, z)).length_squared();
                corner(x, y).max(corner(-x, y)).max(corner(x, -y)).max(corner(-x, -y)).sqrt() + off
            }
            Geometry::Hull(hull) => {
                let (axis, lever) = (LaneVec3::<f32x8>::splat(axis), LaneVec3::splat(lever));
                let most = hull.vertex_chunks.iter().fold(f32x8::zero(), |most, chunk| {
                    Lanes::max(most, axis.cross(vertices(chunk) + lever).length_squared())
                });
                most.to_array().into_iter().fold(0.0, f32::max).sqrt()
            }
            _ => shape.radius + off,
        };
        // Covers rounding.
        let reach = reach * (1.0 + 1e-5);
        // A chord is no longer than the arc, or than twice the radius. Turning about its own axis of symmetry
        // moves no surface of a round shape.
        let mut most = reach * angle.min(2.0);
        if shape.kind.is_round() {
            let tilt = vector.cross(Vec3::Y).length();
            most = most.min(off * angle.min(2.0) + tilt * shape.radius);
        }
        if most <= UNSEEN_ROTATION * tolerance {
            return Spin { vector: Vec3::ZERO, reach: 0.0 };
        }
        Spin { vector, reach }
    }
}
