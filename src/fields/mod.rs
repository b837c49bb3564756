//! What acts on many bodies at once: explosions, water, wind, magnets.
//!
//! Each is plain data that the caller keeps, and a call before a step: the step itself knows of forces and
//! impulses only, so recordings, snapshots and rollback need nothing more. Bodies that sleep are left alone
//! by all but explosions. See [`Explosion`], [`Fluid`], [`Wind`], [`Attractor`].

mod attractor;
mod explosion;
mod fluid;
mod region;
mod silhouette;
mod wind;

pub use attractor::Attractor;
pub use explosion::Explosion;
pub use fluid::Fluid;
pub use wind::Wind;
