//! Hulls, meshes and height fields as they are written into recordings: what can't be found again to the bit,
//! and no more.
//!
//! Everything read is checked as far as the engine relies on it: indices in range, trees without a circle and
//! of a depth that their walks have stacks for.

use super::height_field::HeightField;
use super::hull::{ConvexHull, HullEdge};
use super::mesh::{MAX_COORDINATE, TriangleMesh, VERTEX_BITS, VERTEX_MASK};
use crate::error::{Error, finite, finite3, within};
use crate::shape::mesh::bvh::{DEPTH, IS_LEAF, MAX_TRIANGLES, MeshBvh, NO_CHILD, Node};
use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// The polyhedron. From the vertices alone the builder might make another.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StoredHull {
    vertices: Vec<Vec3>,
    faces: Vec<Vec<u16>>,
    normals: Vec<Vec3>,
    /// Vertices and faces.
    edges: Vec<[u16; 4]>,
    left_out: f32,
}

/// Vertices, triangles and the tree: in another tree the triangles would have another order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StoredMesh {
    vertices: Vec<Vec3>,
    /// Vertices in the order of first use are near each other: differences are a byte or two.
    corners: Vec<i32>,
    /// Six bits for each triangle.
    folds: Vec<u8>,
    nodes: Vec<StoredNode>,
    slack: f32,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct StoredNode {
    grid: [[f32; 3]; 2],
    boxes: [[[u8; 4]; 3]; 2],
    child: [u32; 4],
}

/// The heights; all else follows.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StoredField {
    columns: u32,
    rows: u32,
    cell: Vec2,
    heights: Vec<f32>,
}

impl StoredHull {
    /// Vertices and triangles.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.vertices.len(), 0)
    }
}

impl StoredMesh {
    /// Vertices and triangles.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.vertices.len(), self.folds.len())
    }
}

impl StoredField {
    /// Vertices and triangles.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.heights.len(), 2 * self.heights.len())
    }
}

fn bad(what: &str) -> Error {
    Error::Degenerate(what.into())
}

impl ConvexHull {
    pub(crate) fn stored(&self) -> StoredHull {
        StoredHull {
            vertices: self.vertices.clone(),
            faces: self.faces().map(<[u16]>::to_vec).collect(),
            normals: self.planes.iter().map(|plane| plane.0).collect(),
            edges: self
                .edges
                .iter()
                .map(|e| [e.vertices[0], e.vertices[1], e.faces[0], e.faces[1]])
                .collect(),
            left_out: self.left_out,
        }
    }

    pub(crate) fn from_stored(stored: StoredHull) -> Result<ConvexHull, Error> {
        let StoredHull { vertices, faces, normals, edges, left_out } = stored;
        vertices.iter().chain(&normals).try_for_each(|v| finite3("stored hull", *v).map(drop))?;
        finite("stored hull", left_out)?;
        let known =
            |face: &Vec<u16>| face.len() >= 3 && face.iter().all(|&v| usize::from(v) < vertices.len());
        let (count, corners) = (faces.len(), faces.iter().map(Vec::len).sum::<usize>());
        let closed = vertices.len() + count == edges.len() + 2 && corners == 2 * edges.len();
        let joined = |e: &[u16; 4]| {
            e[..2].iter().all(|&v| usize::from(v) < vertices.len())
                && e[2..].iter().all(|&f| usize::from(f) < count)
        };
        if !(4..=Self::MAX_VERTICES).contains(&vertices.len())
            || normals.len() != count
            || !closed
            || !faces.iter().all(known)
            || !edges.iter().all(joined)
        {
            return Err(bad("a stored hull is no polyhedron"));
        }
        let edges =
            edges.into_iter().map(|[a, b, f, g]| HullEdge { vertices: [a, b], faces: [f, g] }).collect();
        let hull = ConvexHull::of_parts(vertices, faces, normals, edges, left_out);
        finite("volume of a stored hull", hull.moments.mass as f32)?;
        Ok(hull)
    }
}

impl TriangleMesh {
    pub(crate) fn stored(&self) -> StoredMesh {
        let mut last = 0;
        let corners = self.triangles.iter().flatten().map(|&corner| {
            let vertex = (corner & VERTEX_MASK) as i32;
            vertex - std::mem::replace(&mut last, vertex)
        });
        StoredMesh {
            corners: corners.collect(),
            vertices: self.vertices.clone(),
            folds: (0..self.triangles.len() as u32).map(|i| self.edges(i).0).collect(),
            nodes: self.tree.nodes.iter().map(StoredNode::new).collect(),
            slack: self.tree.slack,
        }
    }

    pub(crate) fn from_stored(stored: StoredMesh) -> Result<TriangleMesh, Error> {
        let StoredMesh { vertices, corners, folds, nodes, slack } = stored;
        for v in &vertices {
            finite3("stored mesh", *v)?;
            within("stored mesh", v.abs().max_element(), 0.0, MAX_COORDINATE, "within 1e7")?;
        }
        finite("stored mesh", slack)?;
        if folds.is_empty() || folds.len() > MAX_TRIANGLES || corners.len() != 3 * folds.len() {
            return Err(bad("a stored mesh has no triangles, or not three corners for each"));
        }
        let mut vertex = 0i32;
        let mut triangles = Vec::with_capacity(folds.len());
        for (three, fold) in corners.chunks_exact(3).zip(&folds) {
            let mut triangle = [0; 3];
            for (k, (corner, step)) in triangle.iter_mut().zip(three).enumerate() {
                vertex = vertex.wrapping_add(*step);
                let known = usize::try_from(vertex).is_ok_and(|v| v < vertices.len());
                if !known {
                    return Err(bad("a corner of a stored mesh has no vertex"));
                }
                *corner = vertex as u32 | u32::from(fold >> (2 * k) & 3) << VERTEX_BITS;
            }
            triangles.push(triangle);
        }
        let nodes: Vec<Node> = nodes.iter().map(StoredNode::node).collect();
        check_tree(&nodes, triangles.len())?;
        let min = vertices.iter().fold(Vec3::INFINITY, |m, v| m.min(*v));
        let max = vertices.iter().fold(Vec3::NEG_INFINITY, |m, v| m.max(*v));
        Ok(TriangleMesh { vertices, triangles, tree: MeshBvh { nodes, slack }, min, max })
    }
}

/// Every node but the first is the child of one before it, no deeper than walks go, and leaves have
/// triangles.
fn check_tree(nodes: &[Node], triangles: usize) -> Result<(), Error> {
    let mut depth = vec![0; nodes.len()];
    if let Some(first) = depth.first_mut() {
        *first = 1;
    }
    for (i, node) in nodes.iter().enumerate() {
        let finite = node.origin.iter().chain(&node.step).all(|x| x.is_finite());
        if !finite || depth[i] == 0 || depth[i] > DEPTH {
            return Err(bad("the tree of a stored mesh is none"));
        }
        for &child in node.child.iter().filter(|&&c| c != NO_CHILD) {
            if child & IS_LEAF != 0 {
                let (first, count) = ((child & !IS_LEAF) >> 3, (child & 7) + 1);
                if (first + count) as usize > triangles {
                    return Err(bad("a leaf of a stored mesh has no triangles"));
                }
            } else if child as usize <= i || depth.get(child as usize) != Some(&0) {
                return Err(bad("the tree of a stored mesh goes in circles"));
            } else {
                depth[child as usize] = depth[i] + 1;
            }
        }
    }
    if nodes.is_empty() { Err(bad("a stored mesh has no tree")) } else { Ok(()) }
}

impl StoredNode {
    fn new(node: &Node) -> StoredNode {
        StoredNode { grid: [node.origin, node.step], boxes: [node.low, node.high], child: node.child }
    }
    fn node(&self) -> Node {
        let ([origin, step], [low, high]) = (self.grid, self.boxes);
        Node { origin, step, low, high, child: self.child }
    }
}

impl HeightField {
    pub(crate) fn stored(&self) -> StoredField {
        StoredField {
            columns: self.columns as u32,
            rows: self.rows as u32,
            cell: self.cell,
            heights: self.heights.clone(),
        }
    }

    pub(crate) fn from_stored(stored: StoredField) -> Result<HeightField, Error> {
        HeightField::new(stored.columns as usize, stored.rows as usize, stored.cell, stored.heights)
    }
}
