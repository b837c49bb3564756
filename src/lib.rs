//! backstop: rigid-body physics for game runtimes.
#![allow(dead_code, unused_imports, reason = "under construction")]

mod broad_phase;
mod config;
mod error;
mod handle;
mod lanes;
mod memory;
mod narrow_phase;
mod query;
mod shape;
mod threads;
