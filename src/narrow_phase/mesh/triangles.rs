//! Eight triangles of a mesh or a height field at a time, in the frame of the shape that may touch them.

use super::nearby::Eight;
use super::patch::Touch;
use crate::config::tuning::THROUGH_SINE;
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3};
use crate::narrow_phase::convex::polytope::Pose;
use crate::shape::Ground;
use glam::Vec3;

/// Eight triangles in the shape's frame.
pub(in crate::narrow_phase) struct Triangles<L> {
    pub(in crate::narrow_phase) corners: [LaneVec3<L>; 3],
    /// Unit normal, to the side on which the shape belongs.
    pub(in crate::narrow_phase) front: LaneVec3<L>,
    /// Height of the shape's origin over the plane [m].
    pub(in crate::narrow_phase) height: L,
    /// Lanes in which the winding's own front is away from the shape.
    behind: u32,
    /// Lanes that hold a triangle whose normal is known.
    pub(in crate::narrow_phase) valid: u32,
    index: [u32; 8],
}

impl<L: Lanes> Triangles<L> {
    /// `side`: the point of the shape that tells on which side it belongs.
    #[inline(always)]
    pub(in crate::narrow_phase) fn new(eight: &Eight, lanes: u32, pose: &Pose, side: Vec3) -> Self {
        let m = &pose.axes;
        // Written out: arrays that are mapped or iterated over by value do not stay in registers.
        let (x_axis, y_axis, z_axis) =
            (LaneVec3::<L>::splat(m.x_axis), LaneVec3::splat(m.y_axis), LaneVec3::splat(m.z_axis));
        let position = LaneVec3::splat(pose.position);
        let mut corners = [position; 3];
        for (k, corner) in corners.iter_mut().enumerate() {
            let at = eight.corners.corner::<L>(k);
            *corner = x_axis * at.x + y_axis * at.y + z_axis * at.z + position;
        }
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let squared = cross.length_squared();
        let valid = squared.gt(L::splat(f32::MIN_POSITIVE));
        let length = Lanes::select(valid, squared, L::one()).sqrt();
        let before = cross.dot(LaneVec3::splat(side) - corners[0]);
        let behind = before.lt(L::zero());
        let scale = before.sign() / length;
        Triangles {
            corners,
            front: cross * scale,
            height: -cross.dot(corners[0]) * scale,
            behind: behind.bits(),
            valid: valid.bits() & lanes,
            index: eight.index,
        }
    }

    /// One of them.
    #[inline]
    pub(in crate::narrow_phase) fn touch(&self, lane: usize, ground: &Ground) -> Touch {
        let behind = self.behind >> lane & 1 != 0;
        Touch {
            corners: [self.corners[0].lane(lane), self.corners[1].lane(lane), self.corners[2].lane(lane)],
            front: self.front.lane(lane),
            behind,
            edges: ground.edges(self.index[lane]).seen(behind),
            index: self.index[lane],
        }
    }

    /// Separations of a box from each triangle: along the triangles' normals, and the largest along the box's
    /// own axes, with the axis: 0, 1, 2 towards +x, +y, +z, then 3, 4, 5 towards -x, -y, -z.
    ///
    /// An axis that would push the box out through the back of a triangle it overlaps does not count.
    #[inline(always)]
    pub(in crate::narrow_phase) fn separate(&self, centre: Vec3, half: Vec3) -> (L, L, L) {
        let [a, b, c] = self.corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let face = self.height - self.front.abs().dot(LaneVec3::splat(half));
        let f = self.front;
        let (c, h) = (LaneVec3::<L>::splat(centre), LaneVec3::<L>::splat(half));
        let mut best = Furthest::none();
        best.offer(0, low.x - c.x - h.x, f.x);
        best.offer(1, low.y - c.y - h.y, f.y);
        best.offer(2, low.z - c.z - h.z, f.z);
        best.offer(3, c.x - high.x - h.x, -f.x);
        best.offer(4, c.y - high.y - h.y, -f.y);
        best.offer(5, c.z - high.z - h.z, -f.z);
        (face, best.apart, best.name)
    }
}

/// The axis of each triangle along which it is furthest away.
pub(super) struct Furthest<L> {
    pub(super) apart: L,
    pub(super) name: L,
}

impl<L: Lanes> Furthest<L> {
    #[inline(always)]
    pub(super) fn none() -> Self {
        Furthest { apart: L::splat(f32::MIN), name: L::zero() }
    }

    /// `through`: component of the axis along the normal. An axis that would push the shape out through the
    /// back of a triangle it overlaps does not count.
    #[inline(always)]
    pub(super) fn offer(&mut self, name: usize, apart: L, through: L) {
        let wrong = through.gt(L::splat(THROUGH_SINE)) & apart.lt(L::zero());
        let better = apart.gt(self.apart) & !wrong;
        self.apart = Lanes::select(better, apart, self.apart);
        self.name = Lanes::select(better, L::splat(name as f32), self.name);
    }
}

/// The corner of each triangle that is nearest along a direction, and how far that is [m].
#[inline(always)]
pub(crate) fn nearest_corner<L: Lanes>(triangles: &Triangles<L>, u: LaneVec3<L>) -> (LaneVec3<L>, L) {
    let [a, b, c] = triangles.corners;
    let (along_a, along_b, along_c) = (u.dot(a), u.dot(b), u.dot(c));
    let b_first = along_b.lt(along_a);
    let (point, along) = (LaneVec3::select(b_first, b, a), Lanes::select(b_first, along_b, along_a));
    let c_first = along_c.lt(along);
    (LaneVec3::select(c_first, c, point), Lanes::select(c_first, along_c, along))
}
