//! Pairs in, manifolds out.

mod admit;
mod ahead;
#[cfg(feature = "internals")]
pub(crate) mod bench;
mod bins;
mod box_apart;
mod box_box;
mod box_face;
mod capsule_box;
mod capsule_capsule;
mod cast;
mod cast_mesh;
mod clip;
mod collide;
mod contact;
mod convex;
mod cylinder;
#[cfg(any(test, feature = "internals"))]
#[cfg_attr(not(test), allow(dead_code, reason = "benches use a part of what tests use"))]
pub(crate) mod fixtures;
mod found;
mod gates;
mod gjk;
mod hull_triangle;
mod lanes_io;
mod manifold;
mod mesh;
mod mesh_box;
mod mesh_capsule;
mod mesh_cylinder;
mod mesh_found;
mod mesh_hull;
mod mesh_hull_face;
mod mesh_merge;
mod mesh_patch;
mod mesh_path;
mod mesh_reach;
mod mesh_sphere;
mod mesh_sweep;
mod motion;
mod nearby;
mod polytope;
mod reduce;
mod round_polytope;
mod sat;
mod segment;
mod simplex;
mod sphere_box;
mod sphere_capsule;
mod sphere_sphere;
mod spin;
mod support;
mod touched;
mod weight;

pub(crate) use admit::{RowCost, RowSpace};
pub(crate) use ahead::out_by_the_centre;
pub(crate) use bins::GHOST_GAP;
pub(crate) use cast::{cast_convex, cast_plane, tolerance};
pub(crate) use cast_mesh::{Asked, Cast, Triangles, ask_mesh};
pub(crate) use collide::{Input, NarrowStats, Scratch, collide};
pub(crate) use contact::{Contact, Contacts, HOLD, NONE, Point, UNKNOWN_LOAD};
pub(crate) use convex::collide_convex;
pub(crate) use found::FRESH_BYTES;
pub(crate) use gjk::{CoreGap, core_gap, distance};
pub(crate) use manifold::{MAX_POINTS, RawManifold, RawPoint};
pub(crate) use mesh::{MeshScratch, collide_mesh};
pub(crate) use mesh_reach::Reach;
pub(crate) use motion::{BodyPath, Motion};
pub(crate) use segment::{Entry, ball, capsule, cuboid, frustum, plane, polyhedron, segment_hits};
pub(crate) use simplex::{Simplex, from_triangle, off_triangle};
pub(crate) use support::{Pose as SupportPose, Support};
pub(crate) use weight::{Scale, Threshold, Weight};

/// Pose of shape `b` in the frame of shape `a`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Relative {
    pub(crate) position: glam::Vec3,
    pub(crate) rotation: glam::Quat,
}
