//! Triangles and colours that stand for a shape in a viewer. Hulls and meshes are read back from theirs.

use super::super::assets;
use backstop::Geometry;
use backstop::debug;
use glam::Vec3;

/// Half side of the square that stands for an infinite plane [m].
const PLANE: f32 = 100.0;

/// Vertices and triangles, counter-clockwise from outside; none for a height field.
pub(super) fn triangles(geometry: &Geometry) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    match geometry {
        Geometry::Mesh(mesh) => assets::mesh_triangles(mesh),
        Geometry::Plane => {
            let corner = |(x, z): (f32, f32)| Vec3::new(x * PLANE, 0.0, z * PLANE);
            let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(corner);
            (corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
        }
        _ => debug::convex(geometry),
    }
}

/// Colour (linear red, green, blue) of a shape; static shapes are grey.
pub(super) fn colour(geometry: &Geometry, moves: bool) -> [f32; 3] {
    match geometry {
        _ if !moves => [0.45, 0.47, 0.5],
        Geometry::Sphere { .. } => [0.8, 0.18, 0.1],
        Geometry::Capsule { .. } => [0.85, 0.45, 0.05],
        Geometry::Box { .. } => [0.1, 0.35, 0.75],
        Geometry::Cylinder { .. } => [0.15, 0.55, 0.2],
        _ => [0.5, 0.2, 0.65],
    }
}
