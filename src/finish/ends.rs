//! Ends of limbs: what the path of a body's centre says nothing about.
//!
//! A forearm whirls through a thin wall while its centre stays in front of it, and hooks in there. So of bodies in trees the
//! two ends of each long shape's core are looked at as well, and the tree stops before one of them crosses what is static.

use super::guard::{Guard, stop};
use crate::body::Pose;
use crate::config::tuning::{GUARD_DISTANCE, GUARD_GRAZE, SLOW_END};
use crate::shape::{Collider, Geometry};
use glam::Vec3;

/// An end that would cross static geometry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Share of the way that it may go.
    pub(super) share: f32,
    /// From the body's centre, at the end of the way [m].
    pub(super) arm: Vec3,
    /// Of what it would cross, against its motion.
    pub(super) normal: Vec3,
}

impl Guard<'_> {
    /// The first end of a body's shapes that crosses static geometry on its way from pose to pose.
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
                // What is slow keeps less of a distance, or limbs that lie somewhere would be held for nothing.
                let slow = length <= SLOW_END * collider.inner_radius;
                let keep =
                    if slow { GUARD_GRAZE * GUARD_DISTANCE } else { GUARD_DISTANCE } * collider.inner_radius;
                if length == 0.0 || slow && self.is_free(stack, own, from, way, keep) {
                    continue;
                }
                let reach = way * (1.0 + keep / length);
                let Some((fraction, normal)) = self.first_static(stack, own, from, reach) else { continue };
                // What comes back to the side of its centre may do so.
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

/// The ends of a long shape's core, from its body's centre [m]; none of what is not long.
pub(super) fn ends_of(shape: &Collider) -> impl Iterator<Item = Vec3> + use<'_> {
    let core = core(&shape.geometry);
    core.into_iter().flat_map(|core| [-core, core]).map(|end| shape.position + shape.rotation * end)
}

/// From the middle of a long shape to the end of its core; none of what is not long.
fn core(geometry: &Geometry) -> Option<Vec3> {
    let core = match *geometry {
        Geometry::Capsule { half_height, .. } => Vec3::Y * half_height,
        Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
            Vec3::Y * (half_height - radius_bottom.max(radius_top)).max(0.0)
        }
        Geometry::Box { half_extents } => {
            let (least, most) = (half_extents.min_element(), half_extents.max_element());
            let along = |x: f32| if x == most { x - least } else { 0.0 };
            Vec3::new(along(half_extents.x), along(half_extents.y), along(half_extents.z))
        }
        _ => Vec3::ZERO,
    };
    (core != Vec3::ZERO).then_some(core)
}
