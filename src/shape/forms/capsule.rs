//! Capsules, whose ends may differ.

use super::outline::{Line, Solid, Window, capsule_profile, lathe, ring, seams, turned};
use super::solid::{Entry, NearPoint, across, ball, outwards, roots, within};
use super::support::{Core, Support};
use super::{Form, Kind};
use crate::error::Error;
use crate::lanes::{Lanes, Vec3 as LaneVec3};
use crate::limits::{length, length_or_zero};
use crate::math::Quat;
use crate::shape::mass::{Moments, capsule};
use glam::{DVec3, Vec3};

/// The hull of two balls on the y axis.
#[derive(Clone, Copy)]
pub(in crate::shape) struct Capsule {
    pub(in crate::shape) half_height: f32,
    pub(in crate::shape) bottom: f32,
    pub(in crate::shape) top: f32,
}

impl Capsule {
    /// The same, larger by `extra`, in `f64`.
    fn cone(self, extra: f64) -> Cone {
        let half = f64::from(self.half_height);
        let (bottom, top) = (f64::from(self.bottom) + extra, f64::from(self.top) + extra);
        let lean = if half > 0.0 { (bottom - top) / (2.0 * half) } else { 2f64.copysign(bottom - top) };
        Cone { half, bottom, top, lean, flat: (1.0 - lean * lean).max(0.0).sqrt() }
    }
}

impl<'a> Form<'a> for Capsule {
    const KIND: Kind = Kind::Capsule;
    const NAME: &'static str = "capsule";
    const CODE: u32 = 1;

    fn size(self) -> [f32; 4] {
        [self.half_height, self.bottom, self.top, 0.0]
    }

    fn validate(self) -> Result<(), Error> {
        length_or_zero("capsule half height", self.half_height)?;
        length("capsule radius", self.bottom)?;
        length("capsule radius", self.top)
    }

    fn aabb(self) -> (Vec3, Vec3) {
        let r = self.bottom.max(self.top);
        let half = Vec3::new(r, self.half_height + r, r);
        (-half, half)
    }

    fn turned_bounds(self, rotation: Quat) -> (Vec3, Vec3) {
        let top_centre = rotation * Vec3::Y * self.half_height;
        let (bottom, top) = (Vec3::splat(self.bottom), Vec3::splat(self.top));
        ((top_centre - top).min(-top_centre - bottom), (top_centre + top).max(-top_centre + bottom))
    }

    fn radius(self) -> f32 {
        self.half_height + self.bottom.max(self.top)
    }

    /// The mean radius, unless one ball is all there is of it.
    fn inner_radius(self) -> f32 {
        (0.5 * (self.bottom + self.top)).max(self.bottom.max(self.top) - self.half_height)
    }

    /// The cone between the balls is sufficient; points of the balls beyond it may be left out.
    fn holds(self, point: Vec3) -> bool {
        within(point, self.half_height, self.bottom, self.top)
    }

    fn core_end(self) -> Vec3 {
        Vec3::Y * self.half_height
    }

    fn moments(self) -> Moments {
        capsule(self.half_height.into(), self.bottom.into(), self.top.into())
    }

    #[inline]
    fn support(self) -> Option<Support<'a>> {
        let Cone { half, bottom, top, .. } = self.cone(0.0);
        let least = bottom.min(top);
        let core = if bottom == top {
            Core::Segment { half }
        } else {
            Core::Tapered { half, bottom: bottom - least, top: top - least }
        };
        Some(Support { core, radius: least })
    }

    #[inline(always)]
    fn lane_support<L: Lanes>(self, d: LaneVec3<L>) -> LaneVec3<L> {
        let (x, y, z) = (L::splat(self.half_height), L::splat(self.bottom), L::splat(self.top));
        let top = (x * d.y + z).gt(y - x * d.y);
        let ball = d * Lanes::select(top, z, y);
        LaneVec3::new(ball.x, ball.y + Lanes::select(top, x, -x), ball.z)
    }

    #[inline]
    fn enter(self, start: DVec3, path: DVec3, extra: f64) -> Option<Entry> {
        self.cone(extra).enter(start, path)
    }

    fn contains(self, at: DVec3) -> bool {
        self.cone(0.0).above(at).0 < 0.0
    }

    fn nearest(self, at: DVec3) -> Option<NearPoint> {
        let (distance, normal) = self.cone(0.0).above(at);
        Some(NearPoint { point: at - normal * distance, normal, distance })
    }

    fn solid(self) -> Solid {
        lathe(&capsule_profile(self.half_height, self.bottom, self.top))
    }

    fn lines(self, _window: Window, line: &mut Line<'_>) {
        turned(&capsule_profile(self.half_height, self.bottom, self.top), line);
        let (seams, _) = seams(self.half_height, self.bottom, self.top);
        seams.into_iter().for_each(|(y, radius)| ring(y, radius, line));
    }
}

/// Two balls and, where neither contains the other, the cone that touches both.
struct Cone {
    half: f64,
    bottom: f64,
    top: f64,
    /// Sine and cosine of the angle by which the side leans: its normals point up by it.
    lean: f64,
    flat: f64,
}

impl Cone {
    fn mean(&self) -> f64 {
        0.5 * (self.bottom + self.top)
    }

    /// Above the surface of the cone, and along it from the middle.
    fn side(&self, p: DVec3) -> (f64, f64) {
        let out = across(p);
        (out * self.flat + p.y * self.lean - self.mean(), p.y * self.flat - out * self.lean)
    }

    /// The centre of the lower or the upper ball, and its radius.
    fn ball(&self, low: bool) -> (DVec3, f64) {
        if low { (-DVec3::Y * self.half, self.bottom) } else { (DVec3::Y * self.half, self.top) }
    }

    /// Signed distance from the surface, and its direction.
    fn above(&self, at: DVec3) -> (f64, DVec3) {
        let (above, along) = self.side(at);
        // One ball holds the other; or beyond an end.
        if self.lean.abs() >= 1.0 || along.abs() >= self.half * self.flat {
            let low = if self.lean.abs() >= 1.0 { self.lean > 0.0 } else { along < 0.0 };
            let (centre, radius) = self.ball(low);
            let off = at - centre;
            return (off.length() - radius, off.normalize_or(DVec3::Y));
        }
        (above, outwards(at) * self.flat + DVec3::Y * self.lean)
    }

    fn enter(&self, start: DVec3, path: DVec3) -> Option<Entry> {
        let &Cone { half, bottom, top, lean, flat } = self;
        if lean.abs() >= 1.0 {
            let (at, radius) = self.ball(bottom > top);
            return ball(start - at, path, radius);
        }
        let (above, along) = self.side(start);
        let inside = if along.abs() <= half * flat {
            above < 0.0
        } else {
            let (at, radius) = self.ball(along < 0.0);
            (start - at).length_squared() < radius * radius
        };
        if inside {
            return None;
        }
        let mut first: Option<Entry> = None;
        let mut take = |entry: Option<Entry>| {
            if let Some(entry) = entry
                && first.is_none_or(|f| entry.0 < f.0)
            {
                first = Some(entry);
            }
        };
        let centre = DVec3::Y * half;
        take(ball(start + centre, path, bottom));
        take(ball(start - centre, path, top));
        // (x² + z²) flat² = (mean - y lean)²
        let squared = |p: DVec3, q: DVec3| (p.x * q.x + p.z * q.z) * flat * flat;
        let mean = self.mean();
        let rest = mean - start.y * lean;
        let a = squared(path, path) - path.y * lean * path.y * lean;
        let b = squared(start, path) + rest * path.y * lean;
        let c = squared(start, start) - rest * rest;
        if let Some((t0, t1)) = roots(a, b, c) {
            for t in [t0, t1] {
                let p = start + path * t;
                let across = DVec3::new(p.x, 0.0, p.z);
                let normal = across.normalize_or_zero() * flat + DVec3::Y * lean;
                let on_side = self.side(p).1.abs() <= half * flat && mean - p.y * lean >= 0.0;
                if (0.0..=1.0).contains(&t) && on_side && normal.dot(path) < 0.0 {
                    take(Some((t, normal)));
                }
            }
        }
        first
    }
}
