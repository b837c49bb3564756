//! backstop: rigid-body physics for game runtimes.
#![allow(dead_code, unused_imports, reason = "under construction")]

#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod bench;
mod body;
mod broad_phase;
mod config;
mod constraint;
mod error;
mod finish;
mod forces;
mod handle;
mod lanes;
mod memory;
mod movers;
mod narrow_phase;
mod query;
pub mod scene;
mod shape;
mod solver;
mod step;
mod threads;
mod world;

pub use body::{BodyDesc, BodyKind};
pub use config::{Continuous, FrictionCone, FrictionModel, Settings};
pub use error::Error;
pub use finish::{StageTimes, StepReport};
pub use glam;
pub use handle::{BodyHandle, ShapeHandle};
pub use memory::{Bytes, Category, MemoryReport};
pub use shape::{
    Combine, ConvexHull, Filter, Geometry, HeightField, MassProperties, Material, ShapeDesc, TriangleMesh,
};
pub use world::World;
