//! Hulls, meshes and height fields as they are written, into recordings, by `to_bytes` and by serde: only
//! data that can't be computed again to the bit or takes long to compute.
//!
//! Everything read is checked as far as the engine relies on it: numbers finite, indices in range, trees that
//! hold each triangle once, in boxes around it, no deeper than their walks have stacks for.

use super::height_field::HeightField;
use super::hull::{ConvexHull, HullEdge};
use super::mesh::{TriangleMesh, VERTEX_BITS, VERTEX_MASK, has_area};
use super::surfaces::Surfaces;
use crate::error::{Error, finite, within};
use crate::limits::{self, MAX_COORDINATE};
use crate::shape::mesh::bvh::{DEPTH, IS_LEAF, MAX_TRIANGLES, MeshBvh, NO_CHILD, Node};
use glam::{Vec2, Vec3};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::sync::Arc;

/// The polyhedron. From the vertices alone the builder might make another.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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
#[serde(deny_unknown_fields)]
pub(crate) struct StoredMesh {
    vertices: Vec<Vec3>,
    /// Vertices in the order of first use are near each other: differences are a byte or two.
    corners: Vec<i32>,
    /// Six bits for each triangle.
    folds: Vec<u8>,
    nodes: Vec<StoredNode>,
    slack: f32,
    #[serde(default)]
    materials: Option<Surfaces>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct StoredNode {
    grid: [[f32; 3]; 2],
    boxes: [[[u8; 4]; 3]; 2],
    child: [u32; 4],
}

/// The heights, and the folds of edges, which take most of the time of building it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StoredField {
    columns: u32,
    rows: u32,
    cell: Vec2,
    heights: Vec<f32>,
    /// One byte a cell; none: they are found.
    #[serde(default)]
    folds: Vec<u8>,
    #[serde(default)]
    materials: Option<Surfaces>,
}

/// Materials of so many triangles or cells, checked.
fn restored(surfaces: Option<Surfaces>, count: usize) -> Result<Option<Box<Surfaces>>, Error> {
    let Some(Surfaces { mut parts, mut table }) = surfaces else { return Ok(None) };
    parts.shrink_to_fit();
    table.shrink_to_fit();
    Surfaces::new(count, parts, table).map(Some)
}

#[cfg(feature = "replay")]
impl StoredHull {
    /// Vertices and triangles.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.vertices.len(), 0)
    }
}

#[cfg(feature = "replay")]
impl StoredMesh {
    /// Vertices and triangles.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.vertices.len(), self.folds.len())
    }
}

#[cfg(feature = "replay")]
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
        vertices.iter().try_for_each(|v| limits::offset("stored hull", *v))?;
        for normal in &normals {
            within("normal of a stored hull", normal.length(), 0.999, 1.001, "of length one")?;
        }
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
        let follows = |face: u16, from: u16, to: u16| {
            let face = &faces[usize::from(face)];
            let next = face.iter().cycle().skip(1);
            face.iter().zip(next).any(|pair| pair == (&from, &to))
        };
        if !edges.iter().all(|&[a, b, f, g]| follows(f, a, b) && follows(g, b, a)) {
            return Err(bad("an edge of a stored hull is not between its faces"));
        }
        let edges =
            edges.into_iter().map(|[a, b, f, g]| HullEdge { vertices: [a, b], faces: [f, g] }).collect();
        let hull = ConvexHull::of_parts(vertices, faces, normals, edges, left_out);
        finite("volume of a stored hull", hull.moments.mass as f32)?;
        // The builder keeps to a millionth.
        let slack = 1e-3 * (hull.max - hull.min).max_element();
        let flat = hull.faces().zip(&hull.planes).all(|(face, (normal, offset))| {
            face.iter().all(|&v| normal.dot(hull.vertices[usize::from(v)]) >= offset - slack)
        });
        if flat { Ok(hull) } else { Err(bad("a vertex of a stored hull is not on its face")) }
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
            materials: self.surfaces.as_deref().cloned(),
        }
    }

    pub(crate) fn from_stored(stored: StoredMesh) -> Result<TriangleMesh, Error> {
        let StoredMesh { mut vertices, corners, folds, nodes, slack, materials } = stored;
        for v in &vertices {
            v.to_array().iter().try_for_each(|&x| limits::coordinate("stored mesh", x))?;
        }
        within("stored mesh", slack, 0.0, MAX_COORDINATE, "at least zero")?;
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
                if !known || vertex as u32 > VERTEX_MASK {
                    return Err(bad("a corner of a stored mesh has no vertex"));
                }
                *corner = vertex as u32 | u32::from(fold >> (2 * k) & 3) << VERTEX_BITS;
            }
            triangles.push(triangle);
        }
        // However it was made, it takes the same memory.
        vertices.shrink_to_fit();
        let nodes: Vec<Node> = nodes.iter().map(StoredNode::node).collect();
        let min = vertices.iter().fold(Vec3::INFINITY, |m, v| m.min(*v));
        let max = vertices.iter().fold(Vec3::NEG_INFINITY, |m, v| m.max(*v));
        let surfaces = restored(materials, triangles.len())?;
        let tree = MeshBvh { nodes, slack };
        let mesh = TriangleMesh { vertices, triangles, tree, min, max, surfaces };
        check_tree(&mesh)?;
        Ok(mesh)
    }
}

/// Every node but the first is the child of one before it, no deeper than walks go; each triangle is in one
/// leaf, has an area, and lies in all boxes that lead to it.
fn check_tree(mesh: &TriangleMesh) -> Result<(), Error> {
    let nodes = &mesh.tree.nodes;
    let mut depth = vec![0; nodes.len()];
    *depth.first_mut().ok_or_else(|| bad("a stored mesh has no tree"))? = 1;
    let mut held = vec![false; mesh.triangles.len()];
    for (i, node) in nodes.iter().enumerate() {
        let finite = node.origin.iter().chain(&node.step).all(|x| x.is_finite());
        if !finite || depth[i] == 0 || depth[i] > DEPTH {
            return Err(bad("the tree of a stored mesh is none"));
        }
        for &child in node.child.iter().filter(|&&c| c != NO_CHILD) {
            if child & IS_LEAF != 0 {
                let leaf = held.get_mut(leaf_of(child));
                let leaf = leaf.ok_or_else(|| bad("a leaf of a stored mesh has no triangles"))?;
                if leaf.iter_mut().any(|held| std::mem::replace(held, true)) {
                    return Err(bad("a triangle of a stored mesh is in two leaves"));
                }
            } else if child as usize <= i || depth.get(child as usize) != Some(&0) {
                return Err(bad("the tree of a stored mesh goes in circles"));
            } else {
                depth[child as usize] = depth[i] + 1;
            }
        }
    }
    if held.contains(&false) {
        return Err(bad("a triangle of a stored mesh is in no leaf"));
    }
    check_boxes(mesh)
}

fn leaf_of(child: u32) -> std::ops::Range<usize> {
    let first = ((child & !IS_LEAF) >> 3) as usize;
    first..first + (child & 7) as usize + 1
}

/// From the last node to the first, so that a child is known before its parent.
fn check_boxes(mesh: &TriangleMesh) -> Result<(), Error> {
    let nodes = &mesh.tree.nodes;
    let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let mut around = vec![none; nodes.len()];
    for (i, node) in nodes.iter().enumerate().rev() {
        for (lane, &child) in node.child.iter().enumerate().filter(|(_, c)| **c != NO_CHILD) {
            let (mut low, mut high) = none;
            if child & IS_LEAF == 0 {
                (low, high) = around[child as usize];
            } else {
                for triangle in leaf_of(child) {
                    let [a, b, c] = mesh.triangle(triangle as u32);
                    if !has_area([a, b, c]) {
                        return Err(bad("a triangle of a stored mesh has no area"));
                    }
                    (low, high) = (low.min(a.min(b).min(c)), high.max(a.max(b).max(c)));
                }
            }
            let (from, to) = node.child_box(lane);
            if !(from.cmple(low).all() && high.cmple(to).all()) {
                return Err(bad("a box in the tree of a stored mesh is too small"));
            }
            around[i] = (around[i].0.min(low), around[i].1.max(high));
        }
    }
    Ok(())
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
            folds: self.folds.clone(),
            materials: self.surfaces.as_deref().cloned(),
        }
    }

    pub(crate) fn from_stored(stored: StoredField) -> Result<HeightField, Error> {
        let StoredField { columns, rows, cell, heights, folds, materials } = stored;
        let mut field = HeightField::with_folds(columns as usize, rows as usize, cell, heights, folds)?;
        field.surfaces = restored(materials, field.triangle_count() / 2)?;
        Ok(field)
    }
}

macro_rules! by_what_is_stored {
    ($($shape:ident $stored:ident),*) => { $(
        impl Serialize for $shape {
            fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                self.stored().serialize(to)
            }
        }

        impl<'de> Deserialize<'de> for $shape {
            fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                $shape::from_stored($stored::deserialize(from)?).map_err(D::Error::custom)
            }
        }
    )* };
}

by_what_is_stored! { ConvexHull StoredHull, TriangleMesh StoredMesh, HeightField StoredField }

/// The value in an `Arc`, without serde's feature `rc`.
pub(super) mod shared {
    use super::*;

    pub(in crate::shape) fn serialize<T: Serialize, S: Serializer>(
        shared: &Arc<T>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        T::serialize(shared, to)
    }

    pub(in crate::shape) fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Arc<T>, D::Error> {
        T::deserialize(from).map(Arc::new)
    }
}
