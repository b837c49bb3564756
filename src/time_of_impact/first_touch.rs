//! First touch of two colliders on the rest of their paths.

use crate::config::Measures;
use crate::narrow_phase::{BodyPath, CastResult, MeshCast, Motion, Touch, cast_convex, cast_mesh, tolerance};
use crate::shape::Collider;
use glam::Vec3;

/// No touch: beyond the step.
pub(super) const NEVER: Touch = Touch { fraction: 2.0, normal: Vec3::Y };

/// When the shapes first touch, as a fraction of the paths. Touches at their beginning don't count, nor does
/// a triangle in whose plane a shape slides: the contacts of the start of the step have handled these.
/// `share`: of the engine's own tolerance for a touch.
pub(super) fn first_touch(
    a: &Collider,
    path_a: &BodyPath,
    b: &Collider,
    path_b: &BodyPath,
    share: f32,
    measures: Measures,
) -> Option<Touch> {
    let motion = Motion::new(a, path_a, b, path_b);
    let close = (tolerance(a, b, measures.unit) * share).max(2.0 * f32::EPSILON * a.radius);
    let touch = match b.kind {
        kind if kind.is_ground() => {
            let cast = MeshCast::first(close, measures.touch.max(close));
            match cast_mesh(a, b, &motion.relative(0.0), &motion, cast, None) {
                CastResult::First(touch) => Some(touch),
                CastResult::Near | CastResult::Free => None,
            }
        }
        _ => cast_convex(a, b, &motion, close),
    };
    touch.filter(|touch| touch.fraction > 0.0 && touch.fraction <= 1.0)
}
