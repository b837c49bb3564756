//! Quickhull.

use super::hull::HullEdge;
use crate::error::Error;
use glam::{DVec3, Vec3};

/// A closed convex polyhedron, as the builder hands it over.
pub(super) struct Polyhedron {
    /// Which of the points are vertices, ascending.
    pub(super) vertices: Vec<u32>,
    /// Indices into `vertices`, counter-clockwise from outside.
    pub(super) faces: Vec<Vec<u16>>,
    /// Unit outward normals of the faces.
    pub(super) normals: Vec<DVec3>,
    pub(super) edges: Vec<HullEdge>,
    /// How far the furthest point is outside [m].
    pub(super) left_out: f64,
}

pub(super) fn build(_points: &[Vec3], _most: usize) -> Result<Polyhedron, Error> {
    Err(Error::Degenerate("not built yet".into()))
}
