//! What games write again and again, made of public calls: a grab, the body of a character, and levels of
//! detail.

mod character_body;
mod grab;
mod level_of_detail;

pub use character_body::CharacterBody;
pub use grab::{Grab, GrabSettings};
pub use level_of_detail::LevelOfDetail;
