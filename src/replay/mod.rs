//! Recording a run, and playing it again.
//!
//! A recording is the calls that changed a world, in their order, with hashes of the results of each stage of
//! each step. The same calls give the same bits, so a replay shows the run as it was; if it does not, the
//! hashes tell in which step, stage and body it first diverged.
//!
//! Hooks are code: a recording has their decisions instead. Queries change nothing and are not recorded.
//!
//! ```
//! use backstop::replay::{RecordingBuffer, Replay};
//! use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let buffer = RecordingBuffer::default();
//! let mut world = World::new(Settings::default())?;
//! world.start_recording(buffer.clone())?; // or a file
//! let ball = BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.5 }));
//! world.add_body(&ball)?;
//! for _ in 0..60 {
//!     world.step(1.0 / 60.0)?;
//! }
//! world.stop_recording()?;
//!
//! let played = Replay::open(&buffer.bytes()[..])?.run()?;
//! assert_eq!((played.steps, played.divergence), (60, None));
//! # Ok(())
//! # }
//! ```

mod call;
mod compare;
mod error;
mod file;
mod geometry;
mod hash;
mod hooks;
mod play;
mod probe;
mod tape;
#[cfg(test)]
mod tests;

pub use compare::{DivergedBody, Divergence};
pub use error::ReplayError;
pub use file::RecordingBuffer;
pub use play::{Played, Progress, Replay};
pub use probe::Stage;
pub use tape::Recorded;
