//! The corners of triangles in lanes.

use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, f32x8};
use crate::shape::slabs::boxes_meet;
use glam::Vec3;

/// Eight triangles, by corner, axis and lane.
#[derive(Clone, Debug, Default)]
pub(crate) struct Corners([[[f32; 8]; 3]; 3]);

impl Corners {
    /// Puts a corner of a triangle in its lane.
    #[inline(always)]
    pub(crate) fn put(&mut self, lane: usize, corner: usize, at: Vec3) {
        let to = &mut self.0[corner];
        (to[0][lane], to[1][lane], to[2][lane]) = (at.x, at.y, at.z);
    }

    /// One corner of each triangle.
    #[inline(always)]
    pub(crate) fn corner<L: Lanes>(&self, corner: usize) -> LaneVec3<L> {
        let [x, y, z] = &self.0[corner];
        LaneVec3::new(L::load(x), L::load(y), L::load(z))
    }

    /// The boxes around the triangles: low and high corners.
    #[inline(always)]
    pub(crate) fn bounds(&self) -> (LaneVec3<f32x8>, LaneVec3<f32x8>) {
        let (a, b, c) = (self.corner(0), self.corner(1), self.corner(2));
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// A bit for each triangle whose box meets a box.
    #[inline(always)]
    pub(crate) fn meeting(&self, min: Vec3, max: Vec3) -> u32 {
        boxes_meet(self.bounds(), (LaneVec3::splat(min), LaneVec3::splat(max))).bits()
    }

    /// A bit for each triangle whose plane a segment keeps away from: see [`beyond`].
    #[inline(always)]
    pub(crate) fn beyond(&self, from: Vec3, to: Vec3, reach: f32) -> u32 {
        beyond([0, 1, 2].map(|k| self.corner::<f32x8>(k)), from, to, reach).bits()
    }

    #[inline(always)]
    pub(crate) fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let at = |k: usize| Vec3::from(self.0[k].map(|axis| axis[lane]));
        [at(0), at(1), at(2)]
    }
}

/// Whether a segment is all on one side of a triangle's plane, and further than `reach` from it [m]. A
/// triangle without area has no plane.
#[inline(always)]
pub(crate) fn beyond<L: Lanes>([a, b, c]: [LaneVec3<L>; 3], from: Vec3, to: Vec3, reach: f32) -> L::Mask {
    let (one, other) = (b - a, c - a);
    let normal = one.cross(other);
    let (start, end) = (LaneVec3::splat(from) - a, LaneVec3::splat(to) - a);
    let (first, last) = (start.dot(normal), end.dot(normal));
    // Sixteen roundings of the longest products: the normal of a sliver is uncertain.
    let sum = |v: LaneVec3<L>| v.x + v.y + v.z;
    let rounding = sum(one.abs()) * sum(other.abs()) * sum(start.abs().max(end.abs())) * L::splat(1e-6);
    let least = normal.length() * L::splat(reach) + rounding;
    (first.gt(least) & last.gt(least)) | (first.lt(-least) & last.lt(-least))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use glam::DVec3;

    /// By the same question in `f64`: how far the nearer end is from the plane, if both are on one side of
    /// it.
    #[test]
    fn what_is_beyond_a_plane_is_as_far_from_it_as_it_says() {
        let mut random = Random(5);
        let mut count = [0; 2];
        for i in 0..4000 {
            let size = [0.01, 1.0, 100.0][i % 3];
            let mut v = |size: f32| random.cube() * size;
            let (a, side) = (v(100.0), v(size));
            // Every fourth is a sliver: the third corner is almost on the first side.
            let third = if i % 4 == 0 { a + side * 0.7 + v(1e-5 * size) } else { a + v(size) };
            let corners = [a, a + side, third];
            let (from, to) = (a + v(2.0 * size), a + v(2.0 * size));
            let reach = 0.1 * size;
            let yes = beyond::<f32>(corners.map(LaneVec3::splat), from, to, reach);
            count[usize::from(yes)] += 1;
            if yes {
                let [a, b, c, from, to] = [a, a + side, third, from, to].map(Vec3::as_dvec3);
                let normal: DVec3 = (b - a).cross(c - a).normalize();
                let (start, end) = (normal.dot(from - a), normal.dot(to - a));
                assert!(start * end > 0.0 && start.abs().min(end.abs()) > f64::from(reach), "{i}");
            }
        }
        assert!(count[0] > 500 && count[1] > 500, "{count:?}");
        let flat = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0].map(LaneVec3::<f32>::splat);
        assert!(!beyond(flat, Vec3::Y, Vec3::Y * 2.0, 0.1));
    }
}
