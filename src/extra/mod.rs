//! What games write again and again, made of public calls: a grab.

mod grab;

pub use grab::{Grab, GrabSettings};
