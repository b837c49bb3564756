//! Promises of a world to its caller: calls, errors, events, queries, sleep, memory, snapshots, determinism.
#![allow(
    clippy::duplicate_mod,
    reason = "bodies of fuzz targets bring the helpers that they share with tests"
)]

#[path = "../common/mod.rs"]
mod common;

mod bad_input;
mod basics;
mod bodies;
mod budget;
mod calls;
mod changes;
mod character;
mod churn;
mod decomposition;
mod determinism;
mod each_call;
mod events;
mod faults;
mod fuzzed;
mod kinds;
mod levels;
mod queries;
mod reading;
mod replay;
mod sleep;
mod snapshot;
mod told;
