//! The area that a shape shows to a wave or a wind.

use crate::debug::convex;
use crate::shape::Geometry;
use glam::Vec3;
use std::f32::consts::PI;

/// Area of the parallel projection of a convex shape along a unit direction of its own frame [m²]; zero for
/// planes, meshes and height fields.
///
/// That of round shapes whose ends differ is the projection of the triangles that show them.
pub(super) fn silhouette(geometry: &Geometry, along: Vec3) -> f32 {
    // The part of a shape about the y axis that is seen from the side.
    let aside = (1.0 - along.y * along.y).max(0.0).sqrt();
    match *geometry {
        Geometry::Sphere { radius } => PI * radius * radius,
        Geometry::Box { half_extents: h } => {
            4.0 * along.abs().dot(Vec3::new(h.y * h.z, h.z * h.x, h.x * h.y))
        }
        Geometry::Capsule { half_height, radius_bottom: r, radius_top } if r == radius_top => {
            PI * r * r + 4.0 * r * half_height * aside
        }
        Geometry::Cylinder { half_height, radius_bottom: r, radius_top } if r == radius_top => {
            PI * r * r * along.y.abs() + 4.0 * r * half_height * aside
        }
        _ => {
            // Each line of sight through a convex surface meets two of its triangles.
            let (vertices, triangles) = convex(geometry);
            let shown = triangles.iter().map(|corners| {
                let [a, b, c] = corners.map(|corner| vertices[corner as usize]);
                0.25 * (b - a).cross(c - a).dot(along).abs()
            });
            shown.sum()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::ConvexHull;

    /// Expected: shadows of a cube of side 2 along an axis and along its diagonal, which is a regular hexagon
    /// of area sqrt(3) s²; of a cylinder from the side and from above.
    #[test]
    fn shapes_cast_the_shadows_of_the_textbook() {
        let near = |geometry: &Geometry, along: Vec3, area: f32| {
            let found = silhouette(geometry, along.normalize());
            assert!((found - area).abs() < 1e-3 * area, "{geometry:?}: {found}, not {area}");
        };
        let corners = [-1.0, 1.0].map(|x| [-1.0, 1.0].map(|y| [-1.0, 1.0].map(|z| Vec3::new(x, y, z))));
        let hull = ConvexHull::new(corners.as_flattened().as_flattened()).unwrap();
        for cube in [Geometry::cuboid(1.0, 1.0, 1.0), Geometry::hull(hull)] {
            near(&cube, Vec3::X, 4.0);
            near(&cube, Vec3::ONE, 4.0 * 3.0_f32.sqrt());
        }
        near(&Geometry::sphere(0.5), Vec3::ONE, PI / 4.0);
        near(&Geometry::cylinder(2.0, 0.5), Vec3::X, 4.0);
        near(&Geometry::cylinder(2.0, 0.5), Vec3::Y, PI / 4.0);
        near(&Geometry::capsule(1.0, 0.5), Vec3::Z, PI / 4.0 + 2.0);
        assert_eq!(silhouette(&Geometry::Plane, Vec3::Y), 0.0);
    }
}
