//! To be written.
use super::*;
use crate::shape::Collider;
pub(crate) fn collide_convex(a: &Collider, b: &Collider, rel: &Relative, margin: f32) -> RawManifold {
    todo!()
}
