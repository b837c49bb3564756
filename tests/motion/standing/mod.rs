//! What stands: rest, stability, and which rows are obeyed best.

mod heaps;
mod order;
mod rest;
mod stability;
mod tower;
