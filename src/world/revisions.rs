//! How often what snapshots share was changed.

use std::any::Any;
use std::sync::{Mutex, Weak};

/// A part of snapshots, as long as one has it.
pub(crate) type SharedPart = Weak<dyn Any + Send + Sync>;

/// How often what snapshots share was changed, and the parts that the last snapshot wrote, as long as one has them.
#[derive(Debug, Default)]
pub(crate) struct Revisions {
    /// What is static.
    pub(crate) fixed: u64,
    /// All else.
    pub(crate) moving: u64,
    /// Of both, the revision of the part that was written, and the part. Snapshots know what it is.
    pub(crate) kept: Mutex<[(u64, Option<SharedPart>); 2]>,
}
