//! Pairs in, manifolds out.

mod box_box;
mod capsule_box;
mod capsule_capsule;
mod cast;
mod cast_mesh;
mod clip;
mod convex;
#[cfg(test)]
pub(crate) mod fixtures;
mod gjk;
mod lanes_io;
mod manifold;
mod mesh;
mod motion;
mod polytope;
mod reduce;
mod round_polytope;
mod sat;
mod simplex;
mod sphere_box;
mod sphere_capsule;
mod sphere_sphere;
mod support;

pub(crate) use cast_mesh::Triangles;
pub(crate) use manifold::{MAX_POINTS, RawManifold, RawPoint};

/// Pose of shape `b` in the frame of shape `a`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Relative {
    pub(crate) position: glam::Vec3,
    pub(crate) rotation: glam::Quat,
}
