//! Bodies: what the caller describes.

mod desc;

pub use desc::{BodyDesc, BodyKind};
