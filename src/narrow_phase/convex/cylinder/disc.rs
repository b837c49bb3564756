//! Contact points of a cap with a polygon, another cap, or a line.
//!
//! Seen along the normal of contact both faces are regions of a plane, and the separation is linear over it.
//! The points are the corners of the common area, the point of the rim that is deepest, and a few of the rim
//! that turn with the shape: they stay the same while it rests.

use super::frustum::Disc;
use crate::narrow_phase::contacts::manifold::RawPoint;
use crate::narrow_phase::convex::clip::{Cloud, Loop, key};
use glam::{Vec2, Vec3};

/// Directions of the points of a rim.
const RIM: [Vec2; 4] = [Vec2::X, Vec2::Y, Vec2::NEG_X, Vec2::NEG_Y];

/// Kinds of points, as parts of a key.
const ON_RIM: u32 = 0;
const CROSSING: u32 = 1;
const CORNER: u32 = 2;
/// In place of a direction of [`RIM`].
const DEEPEST: usize = 4;

/// A cap and the plane of the other shape, seen along the normal of contact.
pub(super) struct Face<'a> {
    disc: &'a Disc,
    /// +1 for a disc of `a`, -1 for one of `b`: the sign of a step along the normal from the disc to the
    /// plane.
    sign: f32,
    /// Unit, from a to b.
    normal: Vec3,
    margin: f32,
    /// Separation under the middle of the disc, and its slopes along x and z.
    middle: f32,
    slope: Vec2,
}

impl<'a> Face<'a> {
    /// `None` where the plane stands on edge. `on_b`: whose disc it is.
    pub(super) fn new(
        disc: &'a Disc,
        on_b: bool,
        (plane, offset): (Vec3, f32),
        normal: Vec3,
        margin: f32,
    ) -> Option<Face<'a>> {
        let (steep, own) = (plane.dot(normal), disc.axis.dot(normal));
        if steep.abs() < 0.02 || own.abs() < 0.02 {
            return None;
        }
        let sign = if on_b { -1.0 } else { 1.0 };
        let middle = sign * (offset - plane.dot(disc.centre)) / steep;
        let slope = Vec2::new(plane.dot(disc.x), plane.dot(disc.z)) * (-sign / steep);
        Some(Face { disc, sign, normal, margin, middle, slope })
    }

    fn at(&self, p: Vec2) -> Vec3 {
        self.disc.centre + self.disc.x * p.x + self.disc.z * p.y
    }

    /// A point in the disc's own plane, as seen along the normal.
    fn seen(&self, p: Vec3) -> Vec2 {
        let away = p - self.disc.centre;
        let in_plane = away - self.normal * (self.disc.axis.dot(away) / self.disc.axis.dot(self.normal));
        Vec2::new(in_plane.dot(self.disc.x), in_plane.dot(self.disc.z))
    }

    fn separation(&self, p: Vec2) -> f32 {
        self.middle + self.slope.dot(p)
    }

    fn push(&self, p: Vec2, key: u32, cloud: &mut Cloud) {
        let separation = self.separation(p);
        if separation <= self.margin {
            let position = self.at(p) + self.normal * (0.5 * self.sign * separation);
            cloud.push(RawPoint { position, separation, key });
        }
    }

    /// The point of the rim where the separation is least, if it leans by more than `tolerance` [m] at all.
    fn deepest(&self, tolerance: f32) -> Option<Vec2> {
        let steep = self.slope.length();
        (steep * self.disc.radius > tolerance).then(|| self.slope * (-self.disc.radius / steep))
    }

    /// The points of the rim that are `inside` the other face.
    pub(super) fn rim(&self, tolerance: f32, inside: impl Fn(Vec2) -> bool, cloud: &mut Cloud) {
        let of = usize::from(self.sign < 0.0);
        for (i, direction) in RIM.iter().enumerate() {
            let p = *direction * self.disc.radius;
            if inside(p) {
                self.push(p, key(ON_RIM, i, of), cloud);
            }
        }
        if let Some(p) = self.deepest(tolerance).filter(|&p| inside(p)) {
            self.push(p, key(ON_RIM, DEEPEST, of), cloud);
        }
    }

    /// With a polygon in that plane. `tolerance` [m]: for inside, and for level.
    pub(super) fn polygon(&self, polygon: &Loop, tolerance: f32, cloud: &mut Cloud) {
        let (corners, index) = polygon.corners();
        let count = corners.len();
        let mut seen = [Vec2::ZERO; 24];
        for (to, corner) in seen.iter_mut().zip(corners) {
            *to = self.seen(*corner);
        }
        let next = |i: usize| seen[if i + 1 < count { i + 1 } else { 0 }];
        let twice_area: f32 = (0..count).map(|i| (seen[i] - seen[0]).perp_dot(next(i) - seen[0])).sum();
        // Outward unit normal and distance from the middle of each side.
        let mut sides = [(Vec2::ZERO, 0.0f32); 24];
        let mut least = f32::MAX;
        for i in 0..count {
            let along = next(i) - seen[i];
            let length = along.length();
            // A side without length bounds nothing.
            if length > 0.0 {
                let out = Vec2::new(along.y, -along.x) * (twice_area.signum() / length);
                sides[i] = (out, out.dot(seen[i]));
                least = least.min(sides[i].1);
            } else {
                sides[i].1 = f32::MAX;
            }
        }
        let sides = &sides[..count];
        let r = self.disc.radius;
        let whole = least >= r;
        let inside = |p: Vec2| whole || sides.iter().all(|(out, offset)| out.dot(p) <= offset + tolerance);
        self.rim(tolerance, inside, cloud);
        if whole {
            return;
        }
        for (i, (out, offset)) in sides.iter().enumerate() {
            let vertex = usize::from(index[i]);
            if seen[i].length_squared() <= r * r {
                self.push(seen[i], key(CORNER, vertex, 0), cloud);
            }
            let half = r * r - offset * offset;
            if half > 0.0 {
                let (along, half) = (Vec2::new(-out.y, out.x), half.sqrt());
                let (from, to) = (along.dot(seen[i]), along.dot(next(i)));
                for (k, t) in [-half, half].into_iter().enumerate() {
                    if from.min(to) <= t && t <= from.max(to) {
                        self.push(*out * *offset + along * t, key(CROSSING, vertex, k), cloud);
                    }
                }
            }
        }
    }

    /// With a line of another shape's side: the ends of its part over the disc. `self` is made of a plane
    /// that the line is in.
    pub(super) fn line(&self, ends: [Vec3; 2], cloud: &mut Cloud) {
        let [p, q] = ends.map(|end| self.seen(end));
        let d = q - p;
        let (a, b, c) = (d.length_squared(), p.dot(d), p.length_squared() - self.disc.radius.powi(2));
        let root = b * b - a * c;
        // A line that is seen as a point.
        if a <= 1e-12 * self.disc.radius.powi(2) {
            if c <= 0.0 {
                self.push(p, key(CORNER, 0, 0), cloud);
            }
            return;
        }
        if root < 0.0 {
            return;
        }
        let (low, high) = ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a);
        if high < 0.0 || low > 1.0 {
            return;
        }
        let name = |end: usize, cut: bool| key(if cut { CROSSING } else { CORNER }, end, 0);
        self.push(p + d * low.max(0.0), name(0, low > 0.0), cloud);
        self.push(p + d * high.min(1.0), name(1, high < 1.0), cloud);
    }

    /// With another cap, whose own view of this one is `other`.
    pub(super) fn disc(&self, other: &Face, tolerance: f32, cloud: &mut Cloud) {
        let (r, s) = (self.disc.radius, other.disc.radius);
        let centre = self.seen(other.disc.centre);
        let apart = centre.length();
        let within = |from: &Face, to: &Face, p: Vec2| {
            to.seen(from.at(p)).length_squared() <= (to.disc.radius + tolerance).powi(2)
        };
        if apart + s <= r + tolerance {
            return other.rim(tolerance, |_| true, cloud);
        }
        if apart + r <= s + tolerance {
            return self.rim(tolerance, |_| true, cloud);
        }
        self.rim(tolerance, |p| within(self, other, p), cloud);
        other.rim(tolerance, |p| within(other, self, p), cloud);
        let along = (r * r - s * s + apart * apart) / (2.0 * apart);
        let half = r * r - along * along;
        if half <= 0.0 || apart <= 0.0 {
            return;
        }
        let (out, half) = (centre / apart, half.sqrt());
        for (k, half) in [half, -half].into_iter().enumerate() {
            if let Some(p) = self.on_both(other, out * along + out.perp() * half) {
                self.push(p, key(CROSSING, DEEPEST, k), cloud);
            }
        }
    }

    /// Where the rim of the other crosses this one near `p`: seen along the normal one of them is an ellipse.
    fn on_both(&self, other: &Face, mut p: Vec2) -> Option<Vec2> {
        let (r, s) = (self.disc.radius, other.disc.radius);
        let mut off = f32::MAX;
        for _ in 0..4 {
            let q = other.seen(self.at(p));
            off = q.length_squared() - s * s;
            if off.abs() <= 1e-5 * s * s {
                break;
            }
            // Newton's method on this rim.
            let turned = other.seen(self.at(p + p.perp())) - q;
            let rate = 2.0 * q.dot(turned);
            let step = off / rate;
            if !step.is_finite() || step.abs() > 0.5 {
                return None;
            }
            p = (p - p.perp() * step).normalize_or_zero() * r;
        }
        (off.abs() <= 1e-3 * s * s).then_some(p)
    }
}
