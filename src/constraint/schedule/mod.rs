//! The order in which rows are solved: importance, colours without a shared dynamic body, sort keys.

pub(crate) mod arrange;
mod budget;
pub(crate) mod colour;
mod facts;
pub(crate) mod keys;
pub(crate) mod order;
pub(crate) mod part;
