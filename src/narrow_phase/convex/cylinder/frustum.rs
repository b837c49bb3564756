//! A cylinder, frustum or cone, exactly: how far it reaches, its caps and its side.

#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "a NaN must go the way of a zero")]

use crate::lanes::{Lanes, Vec3 as LaneVec3};
use crate::narrow_phase::convex::clip::Segment;
use crate::narrow_phase::convex::polytope::Pose;
pub(crate) use crate::shape::Frustum;
use crate::shape::{Collider, Geometry};
use glam::Vec3;

impl Frustum {
    pub(crate) fn of(shape: &Collider) -> Option<Frustum> {
        match shape.geometry {
            Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                Some(Frustum { half_height, bottom: radius_bottom, top: radius_top })
            }
            _ => None,
        }
    }

    /// The furthest along directions of unit length [m].
    #[inline(always)]
    pub(super) fn extent<L: Lanes>(&self, d: LaneVec3<L>) -> L {
        let flat = (d.x * d.x + d.z * d.z).sqrt();
        let rise = L::splat(self.half_height) * d.y;
        Lanes::max(flat * L::splat(self.bottom) - rise, flat * L::splat(self.top) + rise)
    }

    /// Unit vector from the axis towards a point or along a direction; x if that is on the axis.
    pub(super) fn outward(p: Vec3) -> Vec3 {
        let flat = (p.x * p.x + p.z * p.z).sqrt();
        if flat > 0.0 && flat < f32::MAX { Vec3::new(p.x / flat, 0.0, p.z / flat) } else { Vec3::X }
    }

    /// Outward normal of the side where a point is.
    pub(super) fn side_normal(&self, p: Vec3) -> Vec3 {
        let u = Frustum::outward(p);
        (u * (2.0 * self.half_height) + Vec3::Y * (self.bottom - self.top)).normalize()
    }

    /// Whether a cap faces along `d` more than the side does. The tip of a cone is none.
    pub(super) fn shows_cap(&self, d: Vec3) -> bool {
        let radius = if d.y > 0.0 { self.top } else { self.bottom };
        radius > 0.0 && d.y.abs() > self.side_normal(d).dot(d)
    }

    /// The upper or the lower cap of a frustum at `pose`.
    pub(super) fn cap(&self, up: bool, pose: &Pose) -> Disc {
        let axis = if up { pose.axes.y_axis } else { -pose.axes.y_axis };
        Disc {
            centre: pose.position + axis * self.half_height,
            axis,
            x: pose.axes.x_axis,
            z: pose.axes.z_axis,
            radius: if up { self.top } else { self.bottom },
        }
    }

    /// The straight line of the side that faces along `d` (in the frustum's own frame), at `pose`: bottom and
    /// top.
    pub(super) fn line(&self, d: Vec3, pose: &Pose) -> [Vec3; 2] {
        let u = Frustum::outward(d);
        let rise = Vec3::Y * self.half_height;
        [pose.point(u * self.bottom - rise), pose.point(u * self.top + rise)]
    }

    /// The part of the side that is furthest along `d`: its line, or the end of it that is further by more
    /// than `tolerance` [m].
    pub(super) fn furthest(&self, d: Vec3, tolerance: f32, pose: &Pose) -> Segment {
        let [low, high] = self.line(d, &Pose::IDENTITY).map(|end| end.dot(d));
        let index = match low - high {
            short if short > tolerance => [0, 0],
            short if short < -tolerance => [1, 1],
            _ => [0, 1],
        };
        let ends = self.line(d, pose);
        Segment { ends: index.map(|i| ends[i]), index }
    }
}

/// A cap: all points of the plane through `centre` within `radius`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disc {
    pub(super) centre: Vec3,
    /// Unit, outwards.
    pub(super) axis: Vec3,
    /// Two unit vectors in its plane.
    pub(super) x: Vec3,
    pub(super) z: Vec3,
    /// [m].
    pub(super) radius: f32,
}
