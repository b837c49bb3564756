//! Convex hulls: the data that the narrow phase, queries and mass properties read.

pub(crate) mod build;
mod form;
pub(crate) mod merge;

use super::mass::Moments;
use crate::error::{Error, each};
use crate::limits;
use crate::memory::{bytes_of, sum_bytes};
use build::Polyhedron;
use glam::Vec3;

/// A convex hull, shared by the shapes that use it.
///
/// Invariant, which the builder checks: a closed convex polyhedron. Every edge lies in two faces, every
/// vertex in at least three, V - E + F = 2, and no vertex is outside a plane by more than rounding.
#[derive(Clone, Debug)]
pub struct ConvexHull {
    /// Corners [m]: each one is a point that the caller gave, in the order of giving.
    pub(crate) vertices: Vec<Vec3>,
    /// Unit outward normal n and offset of each face: n·x = offset on the face [m].
    pub(crate) planes: Vec<(Vec3, f32)>,
    /// Face `i` has `face_vertices[face_start[i]..face_start[i + 1]]`: one entry more than there are faces.
    pub(crate) face_start: Vec<u16>,
    /// Vertices of the faces, counter-clockwise seen from outside, at least three a face.
    pub(crate) face_vertices: Vec<u16>,
    /// Every edge once, in the order of its vertices.
    pub(crate) edges: Vec<HullEdge>,
    /// The vertices again, eight at a time as x, y, z; filled up with the first vertex.
    pub(crate) vertex_chunks: Vec<[[f32; 8]; 3]>,
    /// The planes again, eight at a time as nx, ny, nz, offset; filled up with the first plane.
    pub(crate) normal_chunks: Vec<[[f32; 8]; 4]>,
    /// Corners of the box around it [m].
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
    /// Distance of the furthest vertex from the origin [m].
    pub(crate) radius: f32,
    /// Radius of the largest ball around the origin that the hull contains; zero if the origin is outside
    /// [m].
    pub(crate) inner_radius: f32,
    /// Centre of mass of the solid [m].
    pub(crate) centre: Vec3,
    /// How far the furthest given point is outside [m]; above the tolerance only if the vertices were too
    /// many.
    pub(crate) left_out: f32,
    /// Volume, centre and inertia at a density of one.
    pub(crate) moments: Moments,
}

/// An edge between two faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct HullEdge {
    /// In ascending order.
    pub(crate) vertices: [u16; 2],
    /// `faces[0]` has the edge from `vertices[0]` to `vertices[1]` counter-clockwise, `faces[1]` the other
    /// way round.
    pub(crate) faces: [u16; 2],
}

impl ConvexHull {
    /// The most vertices that a hull keeps. A contact costs time with every vertex, and a ball of 256
    /// vertices is round to 2 %.
    pub const MAX_VERTICES: usize = 256;

    /// The convex hull of a set of points [m], in any order and with duplicates.
    ///
    /// Points within about a millionth of the size of a face or an edge are not vertices: coplanar ones
    /// become one polygon. If more than [`Self::MAX_VERTICES`] would be left, the points that stand out
    /// furthest are kept, one after the other, and [`Self::left_out`] says how far the furthest of the others
    /// is outside.
    ///
    /// A triangle mesh on a dynamic body moves as the hull of its vertices.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    /// let wedge = ConvexHull::new(&corners)?;
    /// assert_eq!((wedge.vertices().len(), wedge.faces().len()), (4, 4));
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If a coordinate is not finite or beyond 1e6, if no side of the points' box is 1e-6 long, or if all
    /// points are equal, on a line or in a plane.
    pub fn new(points: &[Vec3]) -> Result<ConvexHull, Error> {
        each("point", points, |&point| limits::offset("hull point", point))?;
        let low = points.iter().fold(Vec3::INFINITY, |low, p| low.min(*p));
        let high = points.iter().fold(Vec3::NEG_INFINITY, |high, p| high.max(*p));
        let size = (high - low).max_element();
        if size > 0.0 {
            crate::error::within("hull size", size, limits::MIN_LENGTH, f32::MAX, "at least 1e-6 m")?;
        }
        Ok(Self::assemble(points, build::build(points, Self::MAX_VERTICES)?))
    }

    /// The corners [m].
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// The faces, each as indices of vertices, counter-clockwise seen from outside.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u16]> {
        self.face_start.windows(2).map(|w| &self.face_vertices[usize::from(w[0])..usize::from(w[1])])
    }

    /// How far the furthest given point is outside [m]: within rounding, unless the vertices were too many.
    pub fn left_out(&self) -> f32 {
        self.left_out
    }

    /// Bytes (in use, reserved), itself included.
    pub fn bytes(&self) -> (usize, usize) {
        let own = size_of::<Self>();
        sum_bytes([
            (own, own),
            bytes_of(&self.vertices),
            bytes_of(&self.planes),
            bytes_of(&self.face_start),
            bytes_of(&self.face_vertices),
            bytes_of(&self.edges),
            bytes_of(&self.vertex_chunks),
            bytes_of(&self.normal_chunks),
        ])
    }

    /// Everything that follows from the polyhedron's vertices, faces and edges.
    fn assemble(points: &[Vec3], polyhedron: Polyhedron) -> ConvexHull {
        let Polyhedron { vertices, faces, normals, edges, left_out } = polyhedron;
        let vertices: Vec<Vec3> = vertices.iter().map(|&i| points[i as usize]).collect();
        let normals = normals.iter().map(|n| n.as_vec3()).collect();
        Self::of_parts(vertices, faces, normals, edges, left_out as f32)
    }

    pub(super) fn of_parts(
        mut vertices: Vec<Vec3>,
        faces: Vec<Vec<u16>>,
        normals: Vec<Vec3>,
        mut edges: Vec<HullEdge>,
        left_out: f32,
    ) -> ConvexHull {
        let planes: Vec<(Vec3, f32)> = normals
            .into_iter()
            .map(|n| {
                // The offset belongs to the rounded normal, so that rounding leaves no vertex outside.
                let offset = vertices.iter().map(|v| n.as_dvec3().dot(v.as_dvec3())).fold(f64::MIN, f64::max);
                (n, offset as f32)
            })
            .collect();
        let mut face_start = vec![0];
        let mut face_vertices = Vec::new();
        for face in &faces {
            face_vertices.extend_from_slice(face);
            face_start.push(face_vertices.len() as u16);
        }
        // However it was made, it takes the same memory: a replay keeps to the same budget.
        vertices.shrink_to_fit();
        edges.shrink_to_fit();
        face_start.shrink_to_fit();
        face_vertices.shrink_to_fit();
        let xyz = |v: Vec3| v.to_array();
        let plane = |(n, offset): (Vec3, f32)| [n.x, n.y, n.z, offset];
        let moments = Moments::of_polyhedron(&vertices, &faces);
        ConvexHull {
            vertex_chunks: chunks(&vertices, xyz),
            normal_chunks: chunks(&planes, plane),
            min: vertices.iter().copied().reduce(Vec3::min).unwrap_or_default(),
            max: vertices.iter().copied().reduce(Vec3::max).unwrap_or_default(),
            radius: vertices.iter().map(|v| v.as_dvec3().length()).fold(0.0, f64::max) as f32,
            inner_radius: planes.iter().map(|p| p.1).fold(f32::MAX, f32::min).max(0.0),
            centre: moments.centre.as_vec3(),
            left_out,
            moments,
            vertices,
            planes,
            face_start,
            face_vertices,
            edges,
        }
    }
}

/// Eight items at a time, component by component, filled up with the first.
fn chunks<T: Copy, const N: usize>(items: &[T], components: impl Fn(T) -> [f32; N]) -> Vec<[[f32; 8]; N]> {
    items
        .chunks(8)
        .map(|eight| {
            let mut chunk = [[0.0; 8]; N];
            for lane in 0..8 {
                let item = components(*eight.get(lane).unwrap_or(&items[0]));
                for (row, value) in chunk.iter_mut().zip(item) {
                    row[lane] = value;
                }
            }
            chunk
        })
        .collect()
}

#[cfg(test)]
mod tests;
