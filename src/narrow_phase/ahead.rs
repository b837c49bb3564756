//! Fast pairs that are apart: where do they really touch within the step?
//!
//! The same kernels run at the pose of first touch, and the separations they find are carried back along the relative
//! motion to the start of the step. A pair that does not touch gets no point at all, so nothing is pushed by what it
//! never reaches; and of a mesh only the first obstacle on the path counts.
use super::collide::Found;
use super::*;
use crate::broad_phase::Pair;
pub(crate) fn look_ahead(input: &Input<'_>, pair: &Pair, rel: &Relative) -> Option<(RawManifold, f32)> {
    None
}
pub(crate) fn look_ahead_mesh(input: &Input<'_>, pair: &Pair, rel: &Relative, out: &mut Found) {}
