//! The plugin in an app without a window.

mod characters;
mod common;
mod content;
#[cfg(feature = "diagnostics")]
mod diagnostics;
mod events;
mod hooks;
#[cfg(feature = "mesh")]
mod meshes;
mod observers;
#[cfg(feature = "picking")]
mod picking;
#[cfg(feature = "replay")]
mod recording;
#[cfg(feature = "reflect")]
mod reflection;
mod steps;
