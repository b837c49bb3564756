//! Pairs in, manifolds out.

mod bins;
mod cast;
mod collide;
pub(crate) mod contacts;
mod convex;
mod dispatch;
#[cfg(any(test, feature = "internals"))]
#[cfg_attr(not(test), allow(dead_code, reason = "benches use a part of what tests use"))]
pub(crate) mod fixtures;
mod input;
mod mesh;
mod pair_policy;
mod pair_state;
pub(crate) mod pairs;
mod relative;
mod seams;
mod segment;

pub(crate) use crate::shape::support::{Pose as SupportPose, Support};
pub(crate) use cast::ahead::out_by_the_centre;
pub(crate) use cast::mesh::{CastResult, cast_mesh, touches_mesh};
pub(crate) use cast::mesh_cast::MeshCast;
pub(crate) use cast::motion::{BodyPath, Motion};
pub(crate) use cast::{Touch, cast_convex, tolerance};
pub(crate) use collide::{NarrowStats, Scratch, collide};
pub(crate) use contacts::admit::{Census, ContactMemory, Cut, Kind as RowKind, RowCost, RowSpace};
pub(crate) use contacts::contact::{
    CHANGED_LOAD, Contact, ContactMut, ContactRef, NO_CONTACT, Point, UNKNOWN_LOAD,
};
pub(crate) use contacts::found::{FRESH_BYTES, LEAST_ROWS};
pub(crate) use contacts::manifold::{MAX_POINTS, RawManifold, RawPoint, most_points};
pub(crate) use contacts::store::{ContactCount, Contacts, SharedContacts};
pub(crate) use contacts::weight::Scale;
pub(crate) use convex::collide_convex;
pub(crate) use convex::gjk::{Accuracy, CoreGap, core_gap, distance};
#[cfg(feature = "observe")]
pub(crate) use convex::reduce::reduce;
pub(crate) use convex::simplex::{Simplex, from_triangle, off_triangle};
pub(crate) use input::Input;
pub(crate) use mesh::reach::Reach;
pub(crate) use mesh::{MeshScratch, collide_mesh};
pub(crate) use relative::Relative;
pub(crate) use segment::segment_hits;

/// Exports for `bench`, beside those for other stages.
#[cfg(feature = "internals")]
pub(crate) mod kernels {
    pub(crate) use super::fixtures::collider;
    pub(crate) use super::pairs::box_box::box_box;
    pub(crate) use super::pairs::capsule_box::{capsule_box, tapered_capsule_box};
    pub(crate) use super::pairs::capsule_capsule::{capsule_capsule, tapered_capsule_capsule};
    pub(crate) use super::pairs::lanes_io::{ManifoldLanes, PairLanes};
    pub(crate) use super::pairs::sphere_box::sphere_box;
    pub(crate) use super::pairs::sphere_capsule::sphere_capsule;
    pub(crate) use super::pairs::sphere_sphere::sphere_sphere;
}
