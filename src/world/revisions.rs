//! Change counters of the data that snapshots share.

use std::any::Any;
use std::sync::{Mutex, Weak};

/// A part of snapshots, as long as one refers to it.
pub(crate) type SharedPart = Weak<dyn Any + Send + Sync>;

/// Change counters of the data that snapshots share, and the parts that the last snapshot wrote, as long as
/// one refers to them.
#[derive(Debug, Default)]
pub(crate) struct Revisions {
    /// Changes of static bodies.
    pub(crate) fixed: u64,
    /// Changes of everything else.
    pub(crate) moving: u64,
    /// For both, the revision of the part that was written, and the part. Only snapshots know its type.
    pub(crate) written: Mutex<[(u64, Option<SharedPart>); 2]>,
}
