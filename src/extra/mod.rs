//! What games write again and again, made of public calls: a grab, and levels of detail.

mod grab;
mod level_of_detail;

pub use grab::{Grab, GrabSettings};
pub use level_of_detail::LevelOfDetail;
