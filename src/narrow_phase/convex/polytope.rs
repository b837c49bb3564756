//! Polytopes: the view of a box, a hull or a triangle for the separating-axis test, the clipper and the round
//! shapes.
//!
//! A hull is borrowed; the others are built on the stack, which costs less than to look them up.

#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "a NaN must go the way of a zero")]

use crate::lanes::{Lanes, Vec3 as LaneVec3, f32x8};
use crate::math::Quat;
use crate::shape::{Collider, ConvexHull, Geometry, HullEdge};
use glam::{Mat3, Vec3};

/// A pose as a matrix: `b` in the frame of `a`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub(crate) axes: Mat3,
    pub(crate) position: Vec3,
}

impl Pose {
    pub(crate) const IDENTITY: Pose = Pose { axes: Mat3::IDENTITY, position: Vec3::ZERO };

    pub(crate) fn new(position: Vec3, rotation: Quat) -> Pose {
        Pose { axes: rotation.matrix(), position }
    }
    #[inline(always)]
    pub(crate) fn point(&self, p: Vec3) -> Vec3 {
        self.axes.x_axis * p.x + self.axes.y_axis * p.y + self.axes.z_axis * p.z + self.position
    }
    #[inline(always)]
    pub(crate) fn direction(&self, d: Vec3) -> Vec3 {
        self.axes.x_axis * d.x + self.axes.y_axis * d.y + self.axes.z_axis * d.z
    }
    /// A direction of `a` in the frame of `b`.
    #[inline(always)]
    pub(crate) fn back(&self, d: Vec3) -> Vec3 {
        Vec3::new(self.axes.x_axis.dot(d), self.axes.y_axis.dot(d), self.axes.z_axis.dot(d))
    }
    /// `a` in the frame of `b`.
    #[inline(always)]
    pub(crate) fn inverse(&self) -> Pose {
        Pose { axes: self.axes.transpose(), position: -self.back(self.position) }
    }
}

/// A convex polytope in its own frame [m]. The arrays are those of [`ConvexHull`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polytope<'a> {
    pub(crate) vertices: &'a [Vec3],
    /// Eight vertices at a time, filled up with the first.
    pub(crate) vertex_chunks: &'a [[[f32; 8]; 3]],
    /// Unit outward normal and offset.
    pub(crate) planes: &'a [(Vec3, f32)],
    /// Eight planes at a time, filled up with the first. These are the faces that may be an axis: of a
    /// triangle only the front.
    pub(crate) normal_chunks: &'a [[[f32; 8]; 4]],
    pub(crate) face_start: &'a [u16],
    pub(crate) face_vertices: &'a [u16],
    pub(crate) edges: &'a [HullEdge],
    /// Corners of a box around it.
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

impl<'a> Polytope<'a> {
    pub(crate) fn face(&self, face: usize) -> &'a [u16] {
        &self.face_vertices[usize::from(self.face_start[face])..usize::from(self.face_start[face + 1])]
    }

    /// The vertex furthest along `direction`, the first of several.
    pub(crate) fn support(&self, direction: Vec3) -> (usize, f32) {
        let mut best = (0, f32::MIN);
        for (i, v) in self.vertices.iter().enumerate() {
            let along = v.dot(direction);
            if along > best.1 {
                best = (i, along);
            }
        }
        best
    }

    /// The face whose normal is furthest along `direction`; the first of its lane among equals. A
    /// triangle answers with its front.
    pub(crate) fn face_towards(&self, direction: Vec3) -> usize {
        let d = LaneVec3::<f32x8>::splat(direction);
        let (mut most, mut chunk) = (f32x8::splat(f32::MIN), f32x8::zero());
        for (k, [nx, ny, nz, _]) in self.normal_chunks.iter().enumerate() {
            let along = LaneVec3::new(f32x8::new(*nx), f32x8::new(*ny), f32x8::new(*nz)).dot(d);
            let better = along.gt(most);
            most = Lanes::select(better, along, most);
            chunk = Lanes::select(better, f32x8::splat(k as f32), chunk);
        }
        let (mut best, mut face) = (f32::MIN, 0);
        for (i, (&along, &chunk)) in most.to_array().iter().zip(&chunk.to_array()).enumerate() {
            if along > best {
                (best, face) = (along, 8 * chunk as usize + i);
            }
        }
        // The filling repeats the first plane, and the filling's lane can come first.
        if face < self.planes.len() { face } else { 0 }
    }
}

/// Storage of a polytope's arrays.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "lives on the stack where it is used, one or two at a time")]
pub(crate) enum Solid<'a> {
    Box(Brick),
    Hull(&'a ConvexHull),
    Triangle(Triangle),
}

impl<'a> Solid<'a> {
    /// The shape's polytope; `None` if it has none.
    #[inline]
    pub(crate) fn of(shape: &'a Collider) -> Option<Solid<'a>> {
        Some(match &shape.geometry {
            Geometry::Box { half_extents } => Solid::Box(Brick::new(*half_extents)),
            Geometry::Hull(hull) => Solid::Hull(hull),
            _ => return None,
        })
    }

    #[inline]
    pub(crate) fn view(&self) -> Polytope<'_> {
        match self {
            Solid::Box(b) => Polytope {
                vertices: &b.vertices,
                vertex_chunks: &b.vertex_chunks,
                planes: &b.planes,
                normal_chunks: &b.normal_chunks,
                face_start: &BOX_START,
                face_vertices: &BOX_FACES,
                edges: &BOX_EDGES,
                min: b.vertices[0],
                max: b.vertices[7],
            },
            Solid::Hull(h) => Polytope {
                vertices: &h.vertices,
                vertex_chunks: &h.vertex_chunks,
                planes: &h.planes,
                normal_chunks: &h.normal_chunks,
                face_start: &h.face_start,
                face_vertices: &h.face_vertices,
                edges: &h.edges,
                min: h.min,
                max: h.max,
            },
            Solid::Triangle(t) => Polytope {
                vertices: &t.vertices,
                vertex_chunks: &t.vertex_chunks,
                planes: &t.planes,
                normal_chunks: &t.normal_chunks,
                face_start: &[0, 3, 6],
                face_vertices: &[0, 1, 2, 0, 2, 1],
                edges: &TRIANGLE_EDGES,
                min: t.vertices[0].min(t.vertices[1]).min(t.vertices[2]),
                max: t.vertices[0].max(t.vertices[1]).max(t.vertices[2]),
            },
        }
    }
}

/// A box. Vertex `i` is at plus in x, y, z where bit 0, 1, 2 of `i` is set; faces are +x, -x, +y, -y, +z, -z.
#[derive(Clone, Debug)]
pub(crate) struct Brick {
    vertices: [Vec3; 8],
    vertex_chunks: [[[f32; 8]; 3]; 1],
    planes: [(Vec3, f32); 6],
    normal_chunks: [[[f32; 8]; 4]; 1],
}

impl Brick {
    #[inline]
    pub(crate) fn new(half: Vec3) -> Brick {
        let Vec3 { x, y, z } = half;
        let xs = [-x, x, -x, x, -x, x, -x, x];
        let ys = [-y, -y, y, y, -y, -y, y, y];
        let zs = [-z, -z, -z, -z, z, z, z, z];
        Brick {
            vertices: std::array::from_fn(|i| Vec3::new(xs[i], ys[i], zs[i])),
            vertex_chunks: [[xs, ys, zs]],
            planes: [
                (Vec3::X, x),
                (Vec3::NEG_X, x),
                (Vec3::Y, y),
                (Vec3::NEG_Y, y),
                (Vec3::Z, z),
                (Vec3::NEG_Z, z),
            ],
            normal_chunks: [[
                [1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0],
                [0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0],
                [0.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0],
                [x, x, y, y, z, z, x, x],
            ]],
        }
    }
}

const BOX_START: [u16; 7] = [0, 4, 8, 12, 16, 20, 24];
const BOX_FACES: [u16; 24] = [1, 3, 7, 5, 0, 4, 6, 2, 2, 6, 7, 3, 0, 1, 5, 4, 4, 5, 7, 6, 0, 2, 3, 1];
const BOX_EDGES: [HullEdge; 12] = box_edges();

/// Every edge of the box once, found in its faces.
const fn box_edges() -> [HullEdge; 12] {
    let mut edges = [HullEdge { vertices: [0; 2], faces: [0; 2] }; 12];
    let mut count = 0;
    let mut i = 0;
    while i < 24 {
        let (from, to) = (BOX_FACES[i], BOX_FACES[i / 4 * 4 + (i + 1) % 4]);
        if from < to {
            let mut k = 0;
            while k < 24 {
                if BOX_FACES[k] == to && BOX_FACES[k / 4 * 4 + (k + 1) % 4] == from {
                    edges[count] = HullEdge { vertices: [from, to], faces: [i as u16 / 4, k as u16 / 4] };
                    count += 1;
                }
                k += 1;
            }
        }
        i += 1;
    }
    edges
}

/// A triangle: face 0 is the front, from which it is touched, face 1 the back.
#[derive(Clone, Debug)]
pub(crate) struct Triangle {
    vertices: [Vec3; 3],
    vertex_chunks: [[[f32; 8]; 3]; 1],
    planes: [(Vec3, f32); 2],
    normal_chunks: [[[f32; 8]; 4]; 1],
}

const TRIANGLE_EDGES: [HullEdge; 3] = [
    HullEdge { vertices: [0, 1], faces: [0, 1] },
    HullEdge { vertices: [1, 2], faces: [0, 1] },
    HullEdge { vertices: [2, 0], faces: [0, 1] },
];

impl Triangle {
    /// Its front is where `eye` is. `None` if the corners are on a line.
    pub(crate) fn facing(corners: [Vec3; 3], eye: Vec3) -> Option<Triangle> {
        let [p, q, r] = corners;
        let cross = (q - p).cross(r - p);
        // The longest side bounds the rounding of the cross product.
        let size = (q - p).length_squared().max((r - p).length_squared());
        let normal = cross / cross.length();
        if !(cross.length_squared() > 1e-12 * size * size) || !normal.is_finite() {
            return None;
        }
        let front = normal.dot(eye - p) >= 0.0;
        let (normal, v) = if front { (normal, [p, q, r]) } else { (-normal, [p, r, q]) };
        let offset = normal.dot(p);
        let at = |axis: usize| std::array::from_fn(|i| v[if i < 3 { i } else { 0 }][axis]);
        Some(Triangle {
            vertices: v,
            vertex_chunks: [[at(0), at(1), at(2)]],
            planes: [(normal, offset), (-normal, -offset)],
            normal_chunks: [[[normal.x; 8], [normal.y; 8], [normal.z; 8], [offset; 8]]],
        })
    }
    pub(crate) fn normal(&self) -> Vec3 {
        self.planes[0].0
    }
    pub(crate) fn corners(&self) -> [Vec3; 3] {
        self.vertices
    }
}

#[cfg(test)]
mod tests;
