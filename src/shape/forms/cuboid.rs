//! Boxes.

use super::outline::{self, Line, Solid, Window};
use super::solid::{Entry, NearPoint, clip};
use super::support::{Core, Support};
use super::{Form, Kind};
use crate::error::Error;
use crate::lanes::{Lanes, Vec3 as LaneVec3};
use crate::limits::length;
use crate::math::Quat;
use crate::shape::mass::Moments;
use glam::{DMat3, DVec3, Vec3};

#[derive(Clone, Copy)]
pub(in crate::shape) struct Cuboid {
    pub(in crate::shape) half: Vec3,
}

impl<'a> Form<'a> for Cuboid {
    const KIND: Kind = Kind::Box;
    const NAME: &'static str = "box";
    const CODE: u32 = 2;

    fn size(self) -> [f32; 4] {
        [self.half.x, self.half.y, self.half.z, 0.0]
    }

    fn validate(self) -> Result<(), Error> {
        self.half.to_array().iter().try_for_each(|&x| length("box half extents", x))
    }

    fn aabb(self) -> (Vec3, Vec3) {
        (-self.half, self.half)
    }

    fn turned_bounds(self, rotation: Quat) -> (Vec3, Vec3) {
        let (m, h) = (rotation.matrix(), self.half);
        let half = m.x_axis.abs() * h.x + m.y_axis.abs() * h.y + m.z_axis.abs() * h.z;
        (-half, half)
    }

    fn inner_radius(self) -> f32 {
        self.half.min_element()
    }

    fn holds(self, point: Vec3) -> bool {
        point.abs().cmplt(self.half).all()
    }

    fn core_end(self) -> Vec3 {
        let (least, most) = (self.half.min_element(), self.half.max_element());
        let along = |x: f32| if x == most { x - least } else { 0.0 };
        Vec3::new(along(self.half.x), along(self.half.y), along(self.half.z))
    }

    fn moments(self) -> Moments {
        let h = self.half.as_dvec3();
        let mass = 8.0 * h.x * h.y * h.z;
        let square = h * h * (mass / 3.0);
        let inertia = DVec3::new(square.y + square.z, square.z + square.x, square.x + square.y);
        Moments { mass, centre: DVec3::ZERO, inertia: DMat3::from_diagonal(inertia) }
    }

    #[inline]
    fn support(self) -> Option<Support<'a>> {
        Some(Support { core: Core::Box(self.half.as_dvec3()), radius: 0.0 })
    }

    #[inline(always)]
    fn lane_support<L: Lanes>(self, d: LaneVec3<L>) -> LaneVec3<L> {
        let half = LaneVec3::<L>::splat(self.half);
        LaneVec3::new(half.x * d.x.sign(), half.y * d.y.sign(), half.z * d.z.sign())
    }

    #[inline]
    fn enter(self, start: DVec3, path: DVec3, extra: f64) -> Option<Entry> {
        let half = self.half.as_dvec3() + extra;
        let faces = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(half.to_array());
        clip(start, path, faces.flat_map(|(axis, half)| [(axis, half), (-axis, half)]))
    }

    fn contains(self, at: DVec3) -> bool {
        at.abs().cmplt(self.half.as_dvec3()).all()
    }

    fn nearest(self, at: DVec3) -> Option<NearPoint> {
        let half = self.half.as_dvec3();
        let point = at.clamp(-half, half);
        let on = (at.abs() - half).to_array();
        let axis = if on[0] >= on[1] && on[0] >= on[2] { 0 } else { 1 + usize::from(on[2] > on[1]) };
        let mut facing = DVec3::ZERO;
        facing[axis] = 1f64.copysign(at[axis]);
        Some(NearPoint::outside(at, point, facing))
    }

    fn solid(self) -> Solid {
        let half = self.half;
        let corner =
            |i: u32| Vec3::from_array([0, 1, 2].map(|a| if i >> a & 1 == 0 { -half[a] } else { half[a] }));
        let quads: [[u32; 4]; 6] =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        ((0..8).map(corner).collect(), triangles)
    }

    fn lines(self, _window: Window, line: &mut Line<'_>) {
        outline::cuboid(-self.half, self.half, line);
    }
}
