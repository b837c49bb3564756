//! Trees of joints, solved exactly.

pub(crate) mod close;
pub(crate) mod contacts;
pub(crate) mod cut;
pub(crate) mod damp;
pub(crate) mod free_rotation;
pub(crate) mod rattle;
pub(crate) mod slots;
pub(crate) mod spatial;
pub(crate) mod tree;
pub(crate) mod trees;
