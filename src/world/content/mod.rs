//! Content of the world: bodies, their shapes and joints.

mod bodies;
mod colliders;
mod extents;
mod heights;
mod joints;
mod mass;
mod motion;
mod ragdolls;
mod reshape;
mod shapes;
mod traits;

pub use extents::Aabb;
pub(crate) use motion::finite_position;
