//! Memory: bytes of a world, their prediction, and how it keeps to a budget.

mod add;
mod impacts;
mod keeps;
mod later;
mod model;
mod parts;
mod piles;
mod plan;
mod rolling;
mod rows;
mod shedding;
