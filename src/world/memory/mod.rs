//! Memory of the world: the needs of its content, the bytes held, and the budget.

mod assets;
mod budget;
mod demand;
mod model;
mod needs;
mod plan;
mod restoring;

pub(in crate::world) use assets::Assets;
pub(crate) use budget::Addition;
pub use model::{Feature, FeatureCost, FeatureReport};
pub(crate) use needs::{Demand, Needs};
pub use plan::{ContentForecast, Plan};
pub(crate) use restoring::{Brings, Replacement};
