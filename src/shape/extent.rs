//! How far a shape reaches from its own origin, and how far it surely fills space around it.

use super::Geometry;
use glam::Vec3;

impl Geometry {
    /// Largest distance of a point of the shape from its own origin [m]; infinite for a plane.
    pub fn radius(&self) -> f32 {
        match *self {
            Geometry::Sphere { radius } => radius,
            Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                half_height + radius_bottom.max(radius_top)
            }
            Geometry::Box { half_extents } => half_extents.length(),
            Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                let wide = radius_bottom.max(radius_top);
                (half_height * half_height + wide * wide).sqrt()
            }
            Geometry::Hull(ref hull) => hull.radius,
            Geometry::Mesh(ref mesh) => furthest(mesh.aabb()),
            Geometry::HeightField(ref field) => furthest(field.aabb()),
            Geometry::Plane => f32::INFINITY,
        }
    }

    /// Radius of the largest ball around the shape's own origin that it contains [m]; zero if it doesn't
    /// contain its origin, and for planes, meshes and height fields.
    pub fn inner_radius(&self) -> f32 {
        match *self {
            Geometry::Sphere { radius } => radius,
            // The mean radius, unless one ball is all there is of it.
            Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                (0.5 * (radius_bottom + radius_top)).max(radius_bottom.max(radius_top) - half_height)
            }
            Geometry::Box { half_extents } => half_extents.min_element(),
            Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                // Distance of the slanted side: the mean radius times the cosine of the slope.
                let (mean, slope) = (0.5 * (radius_bottom + radius_top), radius_top - radius_bottom);
                let height = 2.0 * half_height;
                half_height.min(mean * height / (height * height + slope * slope).sqrt())
            }
            Geometry::Hull(ref hull) => hull.inner_radius,
            Geometry::Plane | Geometry::Mesh(_) | Geometry::HeightField(_) => 0.0,
        }
    }

    /// Whether a point in its frame lies inside; never in planes, meshes and height fields.
    pub(crate) fn holds(&self, point: Vec3) -> bool {
        // Inside a round shape by the radius at a height.
        let within = |h: f32, bottom: f32, top: f32| {
            let radius = bottom + (top - bottom) * (0.5 + 0.5 * point.y / h);
            point.y.abs() < h && point.x.hypot(point.z) < radius
        };
        match *self {
            Geometry::Sphere { radius } => point.length() < radius,
            // Cones from ball to ball have all of that; of the balls themselves what is beyond may be left
            // out.
            Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                within(half_height, radius_bottom, radius_top)
            }
            Geometry::Box { half_extents } => point.abs().cmplt(half_extents).all(),
            Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                within(half_height, radius_bottom, radius_top)
            }
            Geometry::Hull(ref hull) => hull.planes.iter().all(|(n, offset)| n.dot(point) < *offset),
            Geometry::Plane | Geometry::Mesh(_) | Geometry::HeightField(_) => false,
        }
    }
}

/// Distance of the furthest corner of a box from the origin.
fn furthest((min, max): (Vec3, Vec3)) -> f32 {
    min.abs().max(max.abs()).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::ConvexHull;
    use glam::Vec3;
    use std::sync::Arc;

    /// Smallest and largest distance of the surface from the origin, over a section through the y axis.
    fn surface(points: impl Iterator<Item = (f32, f32)>) -> (f32, f32) {
        points.map(|(x, y)| x.hypot(y)).fold((f32::MAX, 0.0), |(a, b), d| (a.min(d), b.max(d)))
    }

    #[test]
    fn radii_of_a_frustum_are_those_of_its_surface() {
        for (h, a, b) in [(1.0_f32, 0.5_f32, 0.5_f32), (0.3, 1.0, 0.2), (2.0, 0.0, 1.0), (0.2, 3.0, 0.0)] {
            let frustum = Geometry::Cylinder { half_height: h, radius_bottom: a, radius_top: b };
            let points = (0..=2000).flat_map(|i| {
                let t = i as f32 / 2000.0;
                [(a * t, -h), (b * t, h), (a + (b - a) * t, h * (2.0 * t - 1.0))]
            });
            let (near, far) = surface(points);
            assert!(
                (frustum.inner_radius() - near).abs() < 1e-3 && frustum.inner_radius() <= near * 1.000_001
            );
            assert!((frustum.radius() - far).abs() < 1e-6);
        }
    }

    #[test]
    fn radii_of_a_capsule_follow_from_its_support() {
        for (h, a, b) in [(1.0_f32, 0.5_f32, 0.5_f32), (0.3, 1.0, 0.2), (0.5, 0.4, 0.7), (0.0, 2.0, 2.0)] {
            let capsule = Geometry::Capsule { half_height: h, radius_bottom: a, radius_top: b };
            // A convex shape around the origin contains the ball of its least support, and reaches its
            // greatest.
            let support = (0..=2000).map(|i| i as f32 / 1000.0 - 1.0).map(|y| (h * y + b).max(-h * y + a));
            let (near, far) = support.fold((f32::MAX, 0.0_f32), |(n, f), s| (n.min(s), f.max(s)));
            assert!((capsule.inner_radius() - near).abs() < 1e-3 && capsule.inner_radius() <= near + 1e-6);
            assert!((capsule.radius() - far).abs() < 1e-6);
        }
    }

    #[test]
    fn a_hull_has_the_radii_of_its_box_and_no_ball_around_an_origin_outside() {
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
        let hull = |offset: f32| {
            let points: Vec<Vec3> =
                (0..8).map(|i| corner(i) * Vec3::new(1.0, 2.0, 3.0) + Vec3::X * offset).collect();
            Geometry::Hull(Arc::new(ConvexHull::new(&points).unwrap()))
        };
        let cuboid = Geometry::cuboid(1.0, 2.0, 3.0);
        assert_eq!((hull(0.0).radius(), hull(0.0).inner_radius()), (cuboid.radius(), cuboid.inner_radius()));
        assert_eq!(hull(0.25).inner_radius(), 0.75);
        assert_eq!(hull(5.0).inner_radius(), 0.0);
    }
}
