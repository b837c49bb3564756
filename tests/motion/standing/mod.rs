//! Structures: rest, stability, and which rows are obeyed best.

mod heaps;
mod jenga;
mod kinds;
mod order;
mod rest;
mod slopes;
mod stability;
mod tower;
