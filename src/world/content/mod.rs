//! Content of the world: bodies, their shapes and joints.

// The documentation of `World` lists its methods in this order.
mod bodies;

mod motion;

mod mass;

mod traits;

mod extents;

mod colliders;

mod shapes;

mod reshape;

mod heights;

mod joints;

mod ragdolls;

pub use extents::Aabb;
pub(crate) use motion::finite_position;
