//! Trees of joints, solved exactly.

pub(crate) mod close;
pub(crate) mod contacts;
pub(crate) mod cut;
pub(crate) mod damp;
pub(crate) mod free_rotation;
mod geometric_stiffness;
pub(crate) mod node;
pub(crate) mod rattle;
pub(crate) mod slots;
pub(crate) mod spatial;
mod sweep;
mod transfer;
pub(crate) mod tree;
pub(crate) mod trees;
