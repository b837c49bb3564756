//! Construction of the engine's shapes for scenes, in one place.

use backstop::Error;
use backstop::{ConvexHull, TriangleMesh};
use glam::Vec3;
use std::sync::Arc;

pub(super) fn mesh(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Arc<TriangleMesh>, Error> {
    TriangleMesh::new(vertices.to_vec(), triangles.to_vec()).map(Arc::new)
}

pub(super) fn hull(points: &[Vec3]) -> Result<Arc<ConvexHull>, Error> {
    ConvexHull::new(points).map(Arc::new)
}

/// Vertices and triangles of a mesh.
pub(super) fn mesh_triangles(mesh: &TriangleMesh) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut welded = crate::weld::Welded::default();
    (0..mesh.triangle_count() as u32)
        .filter_map(|i| mesh.corners(i))
        .for_each(|corners| welded.triangle(corners));
    (welded.vertices, welded.triangles)
}
