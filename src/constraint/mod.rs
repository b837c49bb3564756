//! Contacts in, batches of rows out: ordered by importance, coloured, packed in lanes.

pub(crate) mod batch;
mod bounce;
mod colour;
mod contact_row;
mod order;
mod prepare;

pub(crate) use batch::{Batch, BatchRef, Rows};
pub(crate) use bounce::{bounce, track_approach};
pub(crate) use contact_row::{Pass, Softness, solve, store, warm_start};
pub(crate) use order::{Group, Stage};
pub(crate) use prepare::{PrepareInput, prepare};
