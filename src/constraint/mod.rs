//! Contacts in, batches of rows out: ordered by importance, coloured, packed in lanes.

mod arrange;
mod batch;
mod bounce;
mod colour;
pub(crate) mod contact_row;
mod impact_friction;
mod order;
mod prepare;

pub(crate) use arrange::{PrepareScratch, Prepared};
pub(crate) use batch::{Batch, Rows};
pub(crate) use bounce::{BounceInput, BounceScratch, bounce};
pub(crate) use impact_friction::rub;
pub(crate) use order::{Group, Stage};
pub(crate) use prepare::{PrepareInput, prepare};
