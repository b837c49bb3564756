//! Rows of joints: locks, limits, springs and motors, packed in batches of one row type.

pub(crate) mod arrange;
pub(crate) mod batch;
mod coupling;
pub(crate) mod ends;
pub(crate) mod fill;
pub(crate) mod kinds;
pub(crate) mod line;
pub(crate) mod lock;
pub(crate) mod measure;
pub(crate) mod nets;
pub(crate) mod row;
pub(crate) mod run;
pub(crate) mod spring;
pub(crate) mod store;
pub(crate) mod table;
