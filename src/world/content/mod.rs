//! Content of the world: bodies, their shapes and joints.

mod bodies;
mod colliders;
mod couplings;
mod extents;
mod heights;
mod joint_changes;
mod joint_readings;
mod joints;
mod mass;
mod motion;
mod ragdolls;
mod reshape;
mod shapes;
mod traits;

pub use extents::Aabb;
pub(crate) use motion::finite_position;
