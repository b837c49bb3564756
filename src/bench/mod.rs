//! Pieces of the engine, ready to be timed one at a time by `benches/kernels.rs`. Not part of the interface:
//! behind the feature `internals`, and free to change in any version.
//!
//! The stages don't depend on it: they expose their private parts in modules named `kernels`.

mod boxes;
mod pairs;
mod rows;
mod updates;

pub use boxes::kernels as boxes;
pub use pairs::{Ground, cast, convex, distance, lanes, mesh};
pub use rows::{preparing, records, rows};
pub use updates::kernels as updates;

/// A benchmark.
pub struct Kernel {
    /// Its name, within its group.
    pub name: String,
    /// Number of boxes, pairs or contacts of a run.
    pub elements: u64,
    /// One run.
    pub run: Box<dyn FnMut()>,
}

impl Kernel {
    /// A run of `elements` pieces.
    pub fn new(name: impl Into<String>, elements: usize, run: impl FnMut() + 'static) -> Self {
        Kernel { name: name.into(), elements: elements as u64, run: Box::new(run) }
    }
}
