//! Cheap proofs that a centre's path crosses no static geometry.
//!
//! Most bodies fly, roll or lie still, and their centres don't come near a surface. So most paths need no
//! exact check: nothing touched the body and the narrow phase saw it pass all static geometry; or it stays
//! within a ball that is known to be empty; or it stays on one side of all nearby geometry.

use super::guard::Guard;
use crate::broad_phase::{Aabb, SearchSet};
use crate::shape::Geometry;
use glam::{DVec3, Vec3};

/// A ball without static geometry, found in an earlier step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Clear {
    pub(crate) centre: DVec3,
    pub(crate) radius: f32,
}

/// More than the rounding error of such coordinates [m].
fn slack(low: Vec3, high: Vec3) -> f32 {
    4e-6 * low.abs().max(high.abs()).max_element()
}

impl Guard<'_> {
    /// Whether a body is a single shape that contains its centre well inside. If such a shape passes
    /// something, or penetrates it by no more than `near` [m], the guard of the centre has nothing to do.
    pub(super) fn is_around(&self, own: &[u32], near: f32) -> bool {
        let &[c] = own else { return false };
        let c = &self.colliders[c as usize];
        c.position.length() + near <= 0.5 * c.inner_radius
    }

    /// Whether a body may move this far unchecked, because no static geometry is that close to its centre.
    pub(super) fn is_clear(
        &self,
        stack: &mut Vec<u32>,
        own: &[u32],
        clear: &mut Clear,
        from: DVec3,
        moved: Vec3,
    ) -> bool {
        let to = from + moved.as_dvec3();
        if moved == Vec3::ZERO || (to - clear.centre).length() < f64::from(clear.radius) {
            return true;
        }
        // Half of the inner ball: a body that lies on something is free to move by that much, and few
        // triangles overlap it.
        let most = 0.5 * self.inner(own);
        if moved.length() >= most {
            return false;
        }
        *clear = Clear { centre: from, radius: self.clearance(stack, from, most) };
        moved.length() < clear.radius
    }

    /// Distance of a point from static surfaces, at most `most`; zero inside of a solid shape [m].
    fn clearance(&self, stack: &mut Vec<u32>, centre: DVec3, most: f32) -> f32 {
        let free = self.is_free(stack, &[], centre, Vec3::ZERO, most);
        let least = if free { most } else { self.nearest(stack, &[], centre, most).0 };
        // Nothing remains of a distance below the resolution of `f32`.
        (least - 1e-6 * (least + centre.as_vec3().abs().max_element())).max(0.0)
    }

    /// Whether a path certainly keeps further than `least` [m] from all static geometry, because it stays on
    /// one side of the planes of all triangles whose boxes are near. That holds for most bodies that fly or
    /// roll; they then neither enter nor graze anything. `false` proves nothing.
    pub(super) fn is_free(
        &self,
        stack: &mut Vec<u32>,
        own: &[u32],
        from: DVec3,
        way: Vec3,
        least: f32,
    ) -> bool {
        let least = 1.01 * least;
        let (start, end) = (from.as_vec3(), (from + way.as_dvec3()).as_vec3());
        let reach = least + slack(start, end);
        let around = Aabb { min: start.min(end) - reach, max: start.max(end) + reach };
        let mut free = true;
        self.broad.in_box(stack, SearchSet::Statics, &around, |c| {
            let (collider, pose) = (&self.colliders[c as usize], &self.poses[c as usize]);
            if !free || !self.may_meet(own, c) {
                return;
            }
            let back = pose.rotation.conjugate();
            let start = back * (from - pose.position).as_vec3();
            let end = start + back * way;
            let reach = least + slack(start, end);
            free = match &collider.geometry {
                geometry if let Some(ground) = geometry.ground() => !ground.nears(start, end, reach),
                Geometry::Plane => start.y.min(end.y) > reach,
                Geometry::Box { half_extents } => {
                    let apart = start.min(end) - *half_extents;
                    let beyond = -start.max(end) - *half_extents;
                    apart.max(beyond).max_element() > reach
                }
                _ => false,
            };
        });
        free
    }
}
