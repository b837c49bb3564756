//! Joints: limits and motors between two bodies.
//!
//! A joint is a list of limits and motors between two frames, as `KHR_physics_rigid_bodies` has it. Each
//! becomes rows of one of a few types ([`constraint`](crate::constraint)); a joint has rows only for its own
//! limits and motors.

mod coupling;
mod desc;
mod frames;
mod motion;
mod ragdoll;
mod row;
mod save;
mod store;

pub use coupling::{CoupledMotion, CouplingDesc};
pub(crate) use coupling::{Coupling, MAX_DISPLACEMENT, Term, check_factor, check_range};
pub use desc::{Frame, JointDesc};
pub(crate) use desc::{STRENGTH, THRESHOLD, check_loads};
pub(crate) use frames::{JointFrame, Placed, twist_of};
pub use motion::{Axes, Axis, Limit, Motion, Motor, Spring, SpringCoefficients};
pub(crate) use ragdoll::Link;
pub use ragdoll::{Bone, BoneJoint, Ragdoll, Skeleton};
pub(crate) use row::{Lock, LockKind, Row, RowKind};
pub(crate) use save::{JointLists, JointRecords, SavedJoints, group_code, group_of};
pub use store::JointEvent;
pub(crate) use store::{Joint, JointAdditions, Joints, is_guided};
