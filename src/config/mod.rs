//! Settings, the order of rows, and the numbers that are chosen once for all worlds.

mod order;
mod settings;
pub(crate) mod tuning;

pub(crate) use order::Place;
pub use order::{Order, RowGroup};
pub(crate) use settings::Start;
pub use settings::{Continuous, ContinuousMethod, FrictionCone, FrictionModel, Settings};
