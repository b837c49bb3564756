//! What acts on many bodies at once: explosions, water, wind, magnets.
//!
//! Each is plain data that the caller keeps, and a call before a step: the step itself knows of forces and
//! impulses only, so recordings, snapshots and rollback need nothing more. See [`Explosion`].

mod explosion;
mod silhouette;

pub use explosion::Explosion;
