//! backstop: rigid-body physics for game runtimes.
#![allow(dead_code, unused_imports, reason = "under construction")]

mod body;
mod broad_phase;
mod config;
mod error;
mod handle;
mod lanes;
mod memory;
mod narrow_phase;
mod query;
pub mod scene;
mod shape;
mod threads;
