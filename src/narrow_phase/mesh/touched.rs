//! The parts of a mesh or height field that a shape rests on, which a cast can skip.

use crate::config::tuning::SAME_PLANE_COSINE;
use crate::lanes::{Lanes, Vec3 as LaneVec3, ones};
use crate::narrow_phase::convex::polytope::Pose;
use crate::shape::{Collider, Kind};
use glam::Vec3;

/// Triangles and planes that a shape touches, in its frame. Each has a contact, which keeps the shape in
/// front of it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Touched {
    triangles: [u32; 8],
    triangle_count: usize,
    /// Unit normal, and offset along it [m].
    planes: [(Vec3, f32); 4],
    plane_count: usize,
    /// Whether one contact keeps the whole shape in front of a plane. It does for a ball. A rod that lies on
    /// a post with its middle may still turn, and strike the ground beside it.
    whole: bool,
}

impl Touched {
    /// Empty.
    pub(crate) fn of(a: &Collider) -> Touched {
        Touched { whole: a.kind == Kind::Sphere, ..Touched::default() }
    }

    /// Adds a triangle, if there is space.
    pub(crate) fn add_triangle(&mut self, index: u32) {
        if let Some(place) = self.triangles.get_mut(self.triangle_count) {
            *place = index;
            self.triangle_count += 1;
        }
    }

    /// Adds the plane of a face, if there is space and the plane is new.
    ///
    /// If the shape moves towards the plane by more than `margin`, parts of it that are higher than those
    /// with a contact may strike it: the other end of a rod that lands on one. Then the plane is not added,
    /// unless a shape can have only one contact with it.
    pub(crate) fn add_plane(&mut self, front: Vec3, offset: f32, path: Vec3, margin: f32) {
        if !self.whole && -path.dot(front) > margin {
            return;
        }
        if self.planes[..self.plane_count].iter().any(|(other, _)| other.dot(front) > SAME_PLANE_COSINE) {
            return;
        }
        if let Some(place) = self.planes.get_mut(self.plane_count) {
            *place = (front, offset);
            self.plane_count += 1;
        }
    }

    pub(crate) fn has(&self, triangle: u32) -> bool {
        self.triangles[..self.triangle_count].contains(&triangle)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.triangle_count == 0 && self.plane_count == 0
    }

    /// The same in a frame that has this pose in the present one.
    pub(crate) fn seen_from(&self, pose: &Pose) -> Touched {
        let mut seen = *self;
        for (front, offset) in &mut seen.planes[..self.plane_count] {
            *offset -= front.dot(pose.position);
            *front = pose.back(*front);
        }
        seen
    }

    /// Those of up to eight triangles, one bit each, that are not among the touched ones.
    pub(crate) fn without(&self, lanes: u32, index: &[u32; 8]) -> u32 {
        ones(lanes).filter(|&lane| !self.has(index[lane])).fold(0, |left, lane| left | 1 << lane)
    }

    /// Which of eight triangles lie in one of the planes, or within `lip` of it [m]: the contact with the
    /// plane is one with them too. If it keeps the whole shape in front of the plane, also those behind it.
    #[inline(always)]
    pub(crate) fn hides<L: Lanes>(&self, corners: &[LaneVec3<L>; 3], lip: f32) -> L::Mask {
        let mut hidden = L::one().lt(L::zero());
        for &(front, offset) in &self.planes[..self.plane_count] {
            let front = LaneVec3::splat(front);
            let ([a, b, c], offset) = (corners, L::splat(offset));
            let (a, b, c) = (front.dot(*a) - offset, front.dot(*b) - offset, front.dot(*c) - offset);
            let most = Lanes::max(Lanes::max(a, b), c);
            let least = Lanes::min(Lanes::min(a, b), c);
            let depth = L::splat(if self.whole { f32::INFINITY } else { lip });
            hidden = hidden | (most.le(L::splat(lip)) & least.ge(-depth));
        }
        hidden
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Mask, f32x8};
    use crate::narrow_phase::mesh::Triangles;
    use crate::narrow_phase::mesh::nearby::Eight;

    /// A floor at -1, a step of 0.2 mm and one of 2 mm on it, a wall that the path leads into, and a floor
    /// below.
    #[test]
    fn what_lies_in_a_touched_plane_is_hidden_and_from_a_ball_what_is_below() {
        let mut touched = Touched::default();
        touched.add_plane(Vec3::Y, -1.0, Vec3::X, 0.01);
        touched.add_plane(Vec3::X, 4.0, -Vec3::X, 0.01);
        let mut eight = Eight::default();
        for (i, y) in [-1.0, -0.9998, -0.998, -3.0].into_iter().enumerate() {
            let at = |x: f32, z: f32| Vec3::new(x, y, z);
            eight.push(i as u32, [at(5.0, 0.0), at(5.0, 1.0), at(6.0, 0.0)]);
        }
        let wall = [Vec3::new(4.0, -1.0, 0.0), Vec3::new(4.0, -1.0, 1.0), Vec3::new(4.0, 0.0, 0.0)];
        eight.push(4, wall);
        let triangles = Triangles::<f32x8>::new(&eight, eight.lanes(), &Pose::IDENTITY, Vec3::ZERO);
        assert_eq!(touched.hides(&triangles.corners, 5e-4).bits() & eight.lanes(), 0b00011);
        touched.whole = true;
        assert_eq!(touched.hides(&triangles.corners, 5e-4).bits() & eight.lanes(), 0b01011);
        assert_eq!(Touched::default().hides(&triangles.corners, 5e-4).bits() & eight.lanes(), 0);
    }

    #[test]
    fn what_there_is_no_place_for_is_left_out() {
        let mut touched = Touched::default();
        for i in 0..20 {
            touched.add_triangle(100 + i);
            let angle = 0.1 * i as f32;
            touched.add_plane(Vec3::new(libm::sinf(angle), libm::cosf(angle), 0.0), 0.0, Vec3::ZERO, 0.0);
            // The same plane is not added twice.
            touched.add_plane(Vec3::Y, 0.0, Vec3::ZERO, 0.0);
        }
        assert!(touched.has(107) && !touched.has(108) && !touched.has(0));
        assert_eq!(touched.plane_count, 4);
    }
}
