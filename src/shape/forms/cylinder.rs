//! Cylinders, frusta and cones.

use super::outline::{Line, Solid, Window, lathe, ring, turned};
use super::solid::{Entry, NearPoint, across, outwards, roots, within};
use super::support::{Core, Support};
use super::{Form, Kind};
use crate::error::Error;
use crate::lanes::{Lanes, Vec3 as LaneVec3};
use crate::limits::{length, length_or_zero};
use crate::math::Quat;
use crate::shape::mass::{Moments, frustum};
use glam::{DVec3, Vec3};

/// The hull of two discs around the y axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    pub(crate) half_height: f32,
    pub(crate) bottom: f32,
    pub(crate) top: f32,
}

impl Frustum {
    fn exact(self) -> [f64; 3] {
        [self.half_height, self.bottom, self.top].map(f64::from)
    }
}

impl<'a> Form<'a> for Frustum {
    const KIND: Kind = Kind::Cylinder;
    const NAME: &'static str = "cylinder";
    const CODE: u32 = 3;

    fn size(self) -> [f32; 4] {
        [self.half_height, self.bottom, self.top, 0.0]
    }

    fn validate(self) -> Result<(), Error> {
        length("cylinder half height", self.half_height)?;
        length_or_zero("cylinder radius", self.bottom)?;
        length_or_zero("cylinder radius", self.top)?;
        length("cylinder radius", self.bottom.max(self.top))
    }

    fn aabb(self) -> (Vec3, Vec3) {
        let r = self.bottom.max(self.top);
        let half = Vec3::new(r, self.half_height, r);
        (-half, half)
    }

    fn turned_bounds(self, rotation: Quat) -> (Vec3, Vec3) {
        let m = rotation.matrix();
        // How far a disc of radius 1 reaches along each axis: the root of 1 - y², without its cancellation.
        let disc = (m.x_axis * m.x_axis + m.z_axis * m.z_axis).map(f32::sqrt);
        let top_centre = m.y_axis * self.half_height;
        let (bottom, top) = (disc * self.bottom, disc * self.top);
        ((top_centre - top).min(-top_centre - bottom), (top_centre + top).max(-top_centre + bottom))
    }

    fn radius(self) -> f32 {
        let wide = self.bottom.max(self.top);
        (self.half_height * self.half_height + wide * wide).sqrt()
    }

    fn inner_radius(self) -> f32 {
        // Distance of the slanted side: the mean radius times the cosine of the slope.
        let (mean, slope) = (0.5 * (self.bottom + self.top), self.top - self.bottom);
        let height = 2.0 * self.half_height;
        self.half_height.min(mean * height / (height * height + slope * slope).sqrt())
    }

    fn holds(self, point: Vec3) -> bool {
        within(point, self.half_height, self.bottom, self.top)
    }

    fn core_end(self) -> Vec3 {
        Vec3::Y * (self.half_height - self.bottom.max(self.top)).max(0.0)
    }

    fn moments(self) -> Moments {
        let [half, bottom, top] = self.exact();
        frustum(-half, bottom, half, top)
    }

    #[inline]
    fn support(self) -> Option<Support<'a>> {
        let [half, bottom, top] = self.exact();
        Some(Support { core: Core::Frustum { half, bottom, top }, radius: 0.0 })
    }

    #[inline(always)]
    fn lane_support<L: Lanes>(self, d: LaneVec3<L>) -> LaneVec3<L> {
        let (x, y, z) = (L::splat(self.half_height), L::splat(self.bottom), L::splat(self.top));
        let across = (d.x * d.x + d.z * d.z).sqrt();
        let top = (x * d.y + z * across).gt(y * across - x * d.y);
        let apart = across.gt(L::zero());
        let r = Lanes::select(top, z, y) / Lanes::select(apart, across, L::one());
        LaneVec3::new(d.x * r, Lanes::select(top, x, -x), d.z * r)
    }

    #[inline]
    fn enter(self, start: DVec3, path: DVec3, extra: f64) -> Option<Entry> {
        let [half, bottom, top] = self.exact().map(|length| length + extra);
        enter(start, path, half, bottom, top)
    }

    fn contains(self, at: DVec3) -> bool {
        let [half, bottom, top] = self.exact();
        at.y.abs() < half && across(at) < 0.5 * (bottom + top) - 0.5 * (bottom - top) * at.y / half
    }

    /// In the half plane through the axis: the nearest of two caps and a side.
    fn nearest(self, at: DVec3) -> Option<NearPoint> {
        let [half, bottom, top] = self.exact();
        let (out, away) = (across(at), outwards(at));
        let side = (top - bottom, 2.0 * half);
        let whole = side.0 * side.0 + side.1 * side.1;
        let t = (((out - bottom) * side.0 + (at.y + half) * side.1) / whole).clamp(0.0, 1.0);
        let facing = (away * side.1 - DVec3::Y * side.0) / whole.sqrt();
        let of = |out: f64, y: f64, facing: DVec3| NearPoint::outside(at, away * out + DVec3::Y * y, facing);
        let mut best = of(bottom + side.0 * t, -half + side.1 * t, facing);
        for cap in [of(out.min(top), half, DVec3::Y), of(out.min(bottom), -half, -DVec3::Y)] {
            if cap.distance < best.distance {
                best = cap;
            }
        }
        Some(best)
    }

    fn solid(self) -> Solid {
        let (h, b, t) = (self.half_height, self.bottom, self.top);
        lathe(&[(-h, 0.0), (-h, b), (h, t), (h, 0.0)])
    }

    fn lines(self, _window: Window, line: &mut Line<'_>) {
        let ends = [(-self.half_height, self.bottom), (self.half_height, self.top)];
        turned(&ends, line);
        ends.into_iter().for_each(|(y, radius)| ring(y, radius, line));
    }
}

/// Where a path enters the part of a cone between two heights.
fn enter(start: DVec3, path: DVec3, half: f64, bottom: f64, top: f64) -> Option<Entry> {
    // Radius at a height: mean - lean y.
    let (mean, lean) = (0.5 * (bottom + top), 0.5 * (bottom - top) / half);
    let caps = [(DVec3::Y, half), (-DVec3::Y, half)];
    // The part of the line between the caps.
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut normal = DVec3::Y;
    for (n, offset) in caps {
        let (above, slope) = (n.dot(start) - offset, n.dot(path));
        if slope == 0.0 {
            if above > 0.0 {
                return None;
            }
        } else if slope < 0.0 {
            if above / -slope > enter {
                (enter, normal) = (above / -slope, n);
            }
        } else {
            leave = leave.min(-above / slope);
        }
    }
    // x² + z² - (mean - lean y)² <= 0; between the caps only the cone's own half is left.
    let rest = mean - lean * start.y;
    let a = path.x * path.x + path.z * path.z - lean * path.y * lean * path.y;
    let b = start.x * path.x + start.z * path.z + lean * path.y * rest;
    let c = start.x * start.x + start.z * start.z - rest * rest;
    let mut round_enter = f64::NEG_INFINITY;
    match roots(a, b, c) {
        None if a > 0.0 || c > 0.0 => return None,
        None => {}
        Some((t0, t1)) if a > 0.0 => {
            round_enter = t0;
            leave = leave.min(t1);
        }
        // Along the side: one root.
        Some((t0, _)) if a == 0.0 && b < 0.0 => round_enter = t0,
        // Steeper than the side: inside up to the first root, or from the second.
        Some((t0, _)) if a == 0.0 || enter <= t0 => leave = leave.min(t0),
        Some((_, t1)) => round_enter = t1,
    }
    if round_enter > enter {
        enter = round_enter;
        let p = start + path * enter;
        normal = DVec3::new(p.x, 0.0, p.z).normalize_or_zero() + DVec3::Y * lean;
    }
    (enter >= 0.0 && enter <= leave.min(1.0)).then_some((enter, normal))
}
