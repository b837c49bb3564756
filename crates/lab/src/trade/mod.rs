//! The trade of speed for accuracy, measured: a scene is run over a grid of settings, and each [`Cell`] of it
//! is compared with a finely resolved [`Reference`] of the same scene. `docs/trade.md` says what the errors
//! mean and has the results of the shipped scenes.
//!
//! Errors are the same to the bit on every machine; costs are the machine's.
//!
//! ```
//! use backstop_lab::trade::{Cell, Measure, Reference, Span, Track};
//! use backstop_scene::Standing;
//!
//! # fn main() -> Result<(), backstop::Error> {
//! let scene = Standing::Tower(2).scene(1.0, 1000.0);
//! let span = Span { frame_rate: 30, frames: 15 };
//! let members = (0..Track::MEMBERS).map(|member| Track::member(&scene, span, 480, member));
//! let reference = Reference::new(members.collect::<Result<_, _>>()?)?;
//! let cell = Cell::default();
//! let errors = reference.measure(&scene, &cell.settings(&scene), cell.world_solver(), cell.hz)?;
//! assert!(errors.of(Measure::Trajectory) < 1e-3);
//! # Ok(())
//! # }
//! ```

mod cell;
mod clock;
mod errors;
mod front;
mod grid;
mod heap;
mod reference;
mod run;
mod track;

pub use cell::{Cell, ContinuousChoice, FrictionLaw};
pub use errors::{Errors, Limits, Measure};
pub use front::{best_within, cheapest_within, front};
pub use grid::{Axis, Grid};
pub use reference::Reference;
pub use run::{Span, cost};
pub use track::Track;
