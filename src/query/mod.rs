//! Queries: rays, moving shapes, overlaps, nearest points. They change nothing.
//!
//! Every query searches two trees, of static and of moving shapes (`broad_phase/query_tree.rs`), nearest
//! boxes first, and tests each shape exactly, in the shape's own frame: by a difference of two `f64`
//! positions, so it is as exact far from the origin as near it. The result depends on the shapes alone, not
//! on the trees.

mod advance;
mod batch;
mod box_overlap;
mod candidates;
mod closest;
mod closest_shape;
mod filter;
mod overlap;
mod penetration;
mod probe;
mod ray;
mod ray_shape;
mod shape_cast;
mod turning;

pub use closest::ClosestPoint;
pub use filter::{QueryFilter, QueryTarget};
pub use overlap::Overlap;
pub(crate) use probe::Probe;
pub use ray::{Ray, RayHit};
pub use shape_cast::{ShapeCast, ShapeHit};

#[cfg(test)]
mod tests;
