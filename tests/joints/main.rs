//! Limits, motors and conservation laws of joints: by calls, by mechanics, and at speed.

#[path = "../common/mod.rs"]
mod common;

mod analytic;
mod api;
mod bridges;
mod couplings;
mod energy;
mod fast;
mod locks;
mod loops;
mod motors;
mod physics;
mod poses;
mod ragdolls;
mod rings;
mod touching;
mod turns;
mod vehicle;
