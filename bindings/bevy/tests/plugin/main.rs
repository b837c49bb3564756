//! The plugin in an app without a window.

mod characters;
mod common;
mod content;
mod events;
mod steps;
