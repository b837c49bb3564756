//! Around the stages of a step: their inputs and buffers, clocks, observers, and bodies that have to be
//! stopped.

mod buffers;
mod clock;
mod faults;
mod inputs;
mod observers;
mod stage;

pub(crate) use buffers::Buffers;
pub(crate) use observers::Change;
#[cfg(feature = "observe")]
pub(crate) use observers::StepMeter;
#[cfg(feature = "replay")]
pub(crate) use observers::{Recorder, each_call};
pub(crate) use stage::{Part, PartTimes, Stage};
