//! To be written.
use crate::shape::Collider;
use glam::Vec3;
pub(crate) struct SegmentHit {
    pub(crate) fraction: f32,
    pub(crate) normal: Vec3,
}
pub(crate) fn segment_hits(shape: &Collider, from: Vec3, to: Vec3) -> Option<SegmentHit> {
    None
}
