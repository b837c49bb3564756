//! The world bounds of a collider.

use super::Aabb;
use crate::math::Quat;
use crate::shape::{Collider, Kind};
use glam::{DVec3, Vec3};

// Rounding: of a rotated point.
/// Share of a shape's size by which its bounds are widened: rotating a point loses a few units of 2^-24.
const ROUNDING: f32 = 8.0 / (1 << 24) as f32;

/// World bounds of a collider on a body at a pose (`position`: its centre of mass, in the world).
///
/// Exact for every shape but for rounding, which goes outwards; at 1e7 m from the origin that is 1 m, the
/// distance between two numbers there. A plane's are infinite, but end at its surface if that is level with
/// an axis.
pub(crate) fn aabb_of(collider: &Collider, position: DVec3, rotation: Quat) -> Aabb {
    let turned = rotation * collider.rotation;
    let offset = rotation * collider.position;
    let (min, max) = collider.geometry.turned_bounds(turned);
    let reach = Vec3::splat(offset.length());
    let size = if collider.kind == Kind::Plane { reach } else { min.abs().max(max.abs()).max(reach) };
    let slack = (size * ROUNDING).as_dvec3();
    let origin = position + offset.as_dvec3();
    Aabb { min: round_down(origin + min.as_dvec3() - slack), max: round_up(origin + max.as_dvec3() + slack) }
}

fn round_down(v: DVec3) -> Vec3 {
    v.as_vec3().map_with(v, |near, exact| beside(near, -i32::from(f64::from(near) > exact)))
}

fn round_up(v: DVec3) -> Vec3 {
    v.as_vec3().map_with(v, |near, exact| beside(near, i32::from(f64::from(near) < exact)))
}

/// The number so many places further up, without a branch: which way a number was rounded is anyone's guess.
/// It steps from one zero to the other, but a number that is rounded to zero keeps its sign and steps away
/// from it.
fn beside(near: f32, steps: i32) -> f32 {
    let in_order = |bits: i32| bits ^ ((bits >> 31) as u32 >> 1) as i32;
    f32::from_bits(in_order(in_order(near.to_bits() as i32) + steps) as u32)
}

trait MapWith {
    fn map_with(self, other: DVec3, f: impl Fn(f32, f64) -> f32) -> Self;
}

impl MapWith for Vec3 {
    fn map_with(self, other: DVec3, f: impl Fn(f32, f64) -> f32) -> Vec3 {
        Vec3::new(f(self.x, other.x), f(self.y, other.y), f(self.z, other.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{ConvexHull, Geometry};
    use glam::{EulerRot, dvec3, vec3};
    use std::sync::Arc;

    fn collider(geometry: Geometry) -> Collider {
        let (position, rotation) = (vec3(0.3, -0.2, 0.1), Quat::from_rotation_z(0.4));
        Collider { position, rotation, ..Collider::new(geometry) }
    }

    /// The furthest point of a shape along a direction of its own frame, by definition.
    fn support(c: &Collider, d: DVec3) -> f64 {
        let s = c.size.map(f64::from);
        let side = (d.x * d.x + d.z * d.z).sqrt();
        match c.kind {
            Kind::Sphere => s[0] * d.length(),
            Kind::Capsule => (d.y * s[0] + s[2] * d.length()).max(-d.y * s[0] + s[1] * d.length()),
            Kind::Hull => match &c.geometry {
                Geometry::Hull(h) => {
                    h.vertices.iter().map(|v| v.as_dvec3().dot(d)).fold(f64::NEG_INFINITY, f64::max)
                }
                _ => f64::NAN,
            },
            Kind::Box => d.x.abs() * s[0] + d.y.abs() * s[1] + d.z.abs() * s[2],
            _ => (d.y * s[0] + s[2] * side).max(-d.y * s[0] + s[1] * side),
        }
    }

    #[test]
    fn bounds_hold_the_shape_and_are_tight_near_and_far() {
        let corner = |i: usize| {
            let i = i as f32;
            vec3((i * 0.77) % 1.7 - 1.0, (i * 1.9) % 1.3 - 0.4, (i * 0.31) % 2.0)
        };
        let points: Vec<Vec3> = (0..20).map(corner).collect();
        let hull = ConvexHull::new(&points).unwrap();
        let shapes = [
            collider(Geometry::Sphere { radius: 0.7 }),
            collider(Geometry::Capsule { half_height: 1.2, radius_bottom: 0.5, radius_top: 0.2 }),
            collider(Geometry::cuboid(0.5, 1.0, 2.0)),
            collider(Geometry::Cylinder { half_height: 0.8, radius_bottom: 0.6, radius_top: 0.0 }),
            collider(Geometry::Hull(Arc::new(hull))),
        ];
        for (at, tight) in [(dvec3(1.0, 2.0, 3.0), 5e-6), (dvec3(1e7 + 0.3, -1e7, 12_345.678), 1.01)] {
            for i in 0..200 {
                let i = i as f32;
                let rotation = glam::Quat::from_euler(EulerRot::XYZ, i * 0.7, i * 1.3, i * 0.2).into();
                for c in &shapes {
                    let bounds = aabb_of(c, at, rotation);
                    let (body, local) = (rotation.as_dquat().normalize(), c.rotation.as_dquat().normalize());
                    let origin = at + body * c.position.as_dvec3();
                    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                        let high = origin.dot(axis) + support(c, (body * local).inverse() * axis);
                        let low = origin.dot(axis) - support(c, (body * local).inverse() * -axis);
                        let (min, max) = (bounds.min.as_dvec3().dot(axis), bounds.max.as_dvec3().dot(axis));
                        assert!(min <= low && low - min < tight, "{:?} {min} {low}", c.kind);
                        assert!(max >= high && max - high < tight, "{:?} {max} {high}", c.kind);
                    }
                }
            }
        }
    }

    #[test]
    fn a_level_plane_ends_at_its_surface_and_a_tilted_one_nowhere() {
        let mut plane = collider(Geometry::Plane);
        (plane.position, plane.rotation) = (Vec3::ZERO, Quat::IDENTITY);
        let level = aabb_of(&plane, dvec3(5.0, 2.0, 0.0), Quat::IDENTITY);
        assert_eq!(level.max, vec3(f32::INFINITY, 2.0, f32::INFINITY));
        assert_eq!(level.min, Vec3::NEG_INFINITY);
        let tilted = aabb_of(&plane, dvec3(5.0, 2.0, 0.0), Quat::from_rotation_x(0.1));
        assert_eq!((tilted.min, tilted.max), (Vec3::NEG_INFINITY, Vec3::INFINITY));
    }
}
