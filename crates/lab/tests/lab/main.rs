//! The methods of the lab, its meter and its exact cases.

#[path = "../../../../tests/common/mod.rs"]
mod common;

mod accuracy;
mod adds_up;
mod cases;
mod detection;
mod impacts;
mod inactive_edges;
mod lcp;
mod penalty;
mod problems;
mod ragdoll;
mod rolling_and_couplings;
mod simbench;
mod tosses;
mod world_solver;
