//! Seeded shots at static targets, to measure tunnelling.
//!
//! A [`Shot`] is a world of its own: one dynamic body, one target, a velocity, and how time is stepped. The
//! shot got through if the body's centre of mass is on the wrong side of the target at the end of any step.
//! Otherwise the depth of its deepest point beyond the surface is measured after each step, and the work of
//! the guard is counted. Everything follows from seed and number of the shot, so one that gets through can be
//! run again alone, under any mode, in a test.

mod body;
mod depth;
mod draw;
mod moving;
mod shot;
mod tally;
mod target;
#[cfg(test)]
mod tests;

pub use body::SHAPES;
pub use moving::{MOVING_TARGETS, MovingShot};
pub use shot::{DEEP, DEEP_SHARE, Flight, Flights, GAIN, MODES, Outcome, STUCK, STUCK_STEPS, Shot};
pub use tally::{Count, Depths, Quantiles, Tally, Through};
pub use target::{TARGETS, Targets};
