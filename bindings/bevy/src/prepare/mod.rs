//! Before a step: what entities say reaches the world.

mod bodies;
mod couplings;
mod hierarchy;
mod joints;
mod motion;
mod shapes;

pub(crate) use bodies::{add_bodies_and_shapes, change_bodies};
pub(crate) use couplings::sync_couplings;
pub(crate) use hierarchy::{Hierarchy, pose_by};
pub(crate) use joints::sync_joints;
pub(crate) use motion::{find_changed, find_written, read_motion, read_poses};
pub(crate) use shapes::change_shapes;
