//! Spheres.

use super::outline::{Line, Solid, Window, arc, capsule_profile, lathe};
use super::solid::{Entry, NearPoint, ball};
use super::support::{Core, Support};
use super::{Form, Kind};
use crate::error::Error;
use crate::lanes::{Lanes, Vec3 as LaneVec3};
use crate::limits::length;
use crate::math::Quat;
use crate::shape::mass::Moments;
use glam::{DMat3, DVec3, Vec3};
use std::f32::consts::TAU;
use std::f64::consts::PI;

#[derive(Clone, Copy)]
pub(in crate::shape) struct Ball {
    pub(in crate::shape) radius: f32,
}

impl<'a> Form<'a> for Ball {
    const KIND: Kind = Kind::Sphere;
    const NAME: &'static str = "sphere";
    const CODE: u32 = 0;

    fn size(self) -> [f32; 4] {
        [self.radius, 0.0, 0.0, 0.0]
    }

    fn validate(self) -> Result<(), Error> {
        length("sphere radius", self.radius)
    }

    fn aabb(self) -> (Vec3, Vec3) {
        (Vec3::splat(-self.radius), Vec3::splat(self.radius))
    }

    fn turned_bounds(self, _rotation: Quat) -> (Vec3, Vec3) {
        self.aabb()
    }

    fn radius(self) -> f32 {
        self.radius
    }

    fn inner_radius(self) -> f32 {
        self.radius
    }

    fn holds(self, point: Vec3) -> bool {
        point.length() < self.radius
    }

    fn moments(self) -> Moments {
        let r = f64::from(self.radius);
        let mass = 4.0 / 3.0 * PI * r * r * r;
        let inertia = DMat3::from_diagonal(DVec3::splat(0.4 * mass * r * r));
        Moments { mass, centre: DVec3::ZERO, inertia }
    }

    #[inline]
    fn support(self) -> Option<Support<'a>> {
        Some(Support { core: Core::Point, radius: self.radius.into() })
    }

    #[inline(always)]
    fn lane_support<L: Lanes>(self, d: LaneVec3<L>) -> LaneVec3<L> {
        d * L::splat(self.radius)
    }

    #[inline]
    fn enter(self, start: DVec3, path: DVec3, extra: f64) -> Option<Entry> {
        ball(start, path, f64::from(self.radius) + extra)
    }

    fn contains(self, at: DVec3) -> bool {
        let radius = f64::from(self.radius);
        at.length_squared() < radius * radius
    }

    fn nearest(self, at: DVec3) -> Option<NearPoint> {
        let normal = at.normalize_or(DVec3::Y);
        Some(NearPoint::outside(at, normal * f64::from(self.radius), normal))
    }

    fn solid(self) -> Solid {
        lathe(&capsule_profile(0.0, self.radius, self.radius))
    }

    fn lines(self, _window: Window, line: &mut Line<'_>) {
        for (u, v) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)] {
            arc(Vec3::ZERO, u * self.radius, v * self.radius, (0.0, TAU), line);
        }
    }
}
