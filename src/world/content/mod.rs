//! Content of the world: bodies, their shapes and joints.

mod bodies;
mod colliders;
mod joint_changes;
mod joint_readings;
mod joints;
mod mass;
mod motion;
mod ragdolls;
mod shapes;

pub(crate) use motion::finite_position;
