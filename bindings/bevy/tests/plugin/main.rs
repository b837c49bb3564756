//! The plugin in an app without a window.

mod characters;
mod common;
mod content;
mod events;
#[cfg(feature = "replay")]
mod recording;
#[cfg(feature = "reflect")]
mod reflection;
mod steps;
