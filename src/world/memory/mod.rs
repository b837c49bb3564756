//! Memory of the world: what its content needs, what it holds, and what its budget allows.

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
