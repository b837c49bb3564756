//! Rows of contacts: friction, then normal, packed in batches of eight manifolds.

pub(crate) mod batch;
pub(crate) mod body_pair;
mod columns;
pub(crate) mod crowd;
pub(crate) mod expect;
pub(crate) mod friction;
pub(crate) mod input;
pub(crate) mod pass;
pub(crate) mod prepare;
#[cfg(feature = "observe")]
pub(crate) mod readout;
mod response;
pub(crate) mod row;
pub(crate) mod rows;
pub(crate) mod soft;
pub(crate) mod softness;
pub(crate) mod step_lengths;
