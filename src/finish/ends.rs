//! Ends of limbs: the path of a body's centre does not tell where they go.
//!
//! A forearm may swing through a thin wall while its centre stays in front of it, and get caught there. So
//! for bodies in trees of joints both ends of each long shape's core are checked as well, and the tree stops
//! before one of them crosses static geometry.

use super::guard::{Guard, stop};
use crate::body::Pose;
use crate::config::tuning::{GUARD_DISTANCE, GUARD_GRAZE, SLOW_END};
use crate::shape::Collider;
use glam::Vec3;

/// An end that would cross static geometry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Share of its path that it may go.
    pub(super) share: f32,
    /// From the body's centre, at the end of the path [m].
    pub(super) arm: Vec3,
    /// Normal of the geometry that it would cross, against its motion.
    pub(super) normal: Vec3,
}

impl Guard<'_> {
    /// The first end of a body's shapes that crosses static geometry on its path between two poses.
    pub(super) fn crossing(
        &self,
        stack: &mut Vec<u32>,
        own: &[u32],
        before: &Pose,
        after: &Pose,
    ) -> Option<Crossing> {
        let mut first: Option<Crossing> = None;
        for &c in own {
            let collider = &self.colliders[c as usize];
            if collider.is_sensor() {
                continue;
            }
            for end in ends_of(collider) {
                let from = before.position + (before.rotation * end).as_dvec3();
                let arm = after.rotation * end;
                let way = (after.position + arm.as_dvec3() - from).as_vec3();
                let length = way.length();
                // Slow ends keep less distance, or limbs at rest would be stopped for nothing.
                let slow = length <= SLOW_END * collider.inner_radius;
                let keep =
                    if slow { GUARD_GRAZE * GUARD_DISTANCE } else { GUARD_DISTANCE } * collider.inner_radius;
                if length == 0.0 || slow && self.is_free(stack, own, from, way, keep) {
                    continue;
                }
                let reach = way * (1.0 + keep / length);
                let Some((fraction, normal)) = self.first_static(stack, own, from, reach) else { continue };
                // An end may cross back to the side of its centre.
                let hit = from + (reach * fraction).as_dvec3();
                if (before.position - hit).as_vec3().dot(normal) <= 0.0 {
                    continue;
                }
                let Some(share) = stop(reach, length, keep, fraction, normal) else { continue };
                let share = (share * (length + keep) / length).min(1.0);
                if first.is_none_or(|first| share < first.share) {
                    first = Some(Crossing { share, arm, normal });
                }
            }
        }
        first
    }
}

/// The ends of a long shape's core, from its body's centre [m]; none for other shapes.
pub(super) fn ends_of(shape: &Collider) -> impl Iterator<Item = Vec3> + use<'_> {
    let core = Some(shape.geometry.core_end()).filter(|core| *core != Vec3::ZERO);
    core.into_iter().flat_map(|core| [-core, core]).map(|end| shape.position + shape.rotation * end)
}
