//! Triangle meshes.

use crate::error::Error;
use glam::Vec3;

/// A static triangle mesh, shared by the shapes that use it.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// Stand-in until the real one is merged.
    ///
    /// # Errors
    /// Without triangles, or if an index is out of range.
    pub fn new(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Self, Error> {
        if triangles.is_empty() || triangles.iter().flatten().any(|&i| i as usize >= vertices.len()) {
            return Err(Error::Degenerate("a mesh needs triangles with valid indices".into()));
        }
        Ok(TriangleMesh { vertices: vertices.to_vec(), triangles: triangles.to_vec() })
    }
    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }
    pub(crate) fn triangle(&self, i: u32) -> [Vec3; 3] {
        self.triangles[i as usize].map(|v| self.vertices[v as usize])
    }
}
impl TriangleMesh {
    pub(crate) fn bytes(&self) -> (usize, usize) {
        (0, 0)
    }
}
