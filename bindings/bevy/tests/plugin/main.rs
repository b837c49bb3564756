//! The plugin in an app without a window.

mod common;
mod content;
mod events;
mod steps;
