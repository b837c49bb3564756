//! To be written.
use super::*;
use crate::shape::Collider;
#[derive(Debug, Default)]
pub(crate) struct MeshScratch {}
impl MeshScratch {
    pub(crate) fn bytes(&self) -> (usize, usize) {
        (0, 0)
    }
}
pub(crate) fn collide_mesh(
    a: &Collider,
    b: &Collider,
    rel: &Relative,
    margin: f32,
    scratch: &mut MeshScratch,
    out: &mut Vec<RawManifold>,
) {
    todo!()
}
