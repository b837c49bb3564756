//! Predicted motion in, pairs out.

mod bvh;
mod pairs;
mod segment;
