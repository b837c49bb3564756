//! Settings, the order of rows, and the numbers that are chosen once for all worlds.

mod fields;
mod measures;
mod order;
mod settings;
pub(crate) mod tuning;
#[cfg(feature = "serde")]
pub(crate) mod unbounded;

pub use fields::Field;
pub(crate) use fields::fields;
pub(crate) use measures::Measures;
pub(crate) use order::Place;
pub use order::{Order, RowGroup};
pub(crate) use settings::Start;
pub use settings::{ContinuousMethod, ContinuousMode, FrictionCone, FrictionModel, Settings};
