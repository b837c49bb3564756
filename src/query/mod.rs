//! Questions about shapes that change nothing.

mod segment;

pub(crate) use segment::segment_hits;
