//! Spheres and capsules against a cylinder.

#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "a NaN must go the way of a zero")]

use super::frustum::Frustum;
use crate::config::tuning::LINE_TOUCH_ASIDE;
use crate::narrow_phase::contacts::manifold::RawManifold;
use crate::narrow_phase::convex::polytope::Pose;
use crate::narrow_phase::convex::round_polytope::Core;
use crate::shape::Collider;
use glam::{Vec2, Vec3};

/// A sphere or capsule and a cylinder, in the frame of the cylinder; the normal points to the cylinder.
///
/// The signed distance of a point from the frustum is exact and, like that of any convex set, convex: so is
/// the distance of the balls of a capsule. Lying along a side or on a cap gives two points.
pub(crate) fn round_cylinder(core: &Core, shape: &Collider, margin: f32) -> RawManifold {
    let mut manifold = RawManifold::default();
    let Some(frustum) = Frustum::of(shape) else { return manifold };
    let s = frustum.nearest_ball(core);
    let (distance, out) = frustum.distance(core.at(s));
    let nearest = distance - core.radius_at(s);
    if nearest > margin {
        return manifold;
    }
    let n = -out;
    manifold.normal = n;
    let mut add = |s: f32, distance: f32, key: u32| {
        let separation = distance - core.radius_at(s);
        manifold.add(margin, core.at(s) + n * (0.5 * (distance + core.radius_at(s))), separation, key);
        separation
    };
    let mut least = f32::MAX;
    if let Some((low, high, height)) = frustum.shared(core, s, out) {
        for (s, key) in [(low, 0), (high, 1)] {
            least = least.min(add(s, height(s), key));
        }
    }
    if least > nearest + 1e-4 * shape.radius {
        add(s, distance, 2);
    }
    manifold
}

impl Frustum {
    /// The ball of a core that comes nearest: where the distance of the balls stops falling. By false
    /// position, with the weight of an end that stays halved (Dowell and Jarratt, *A modified regula falsi
    /// method*, 1971): a search for the least value itself would know the place only to the root of the
    /// rounding.
    fn nearest_ball(&self, core: &Core) -> f32 {
        if core.is_ball() {
            return 0.0;
        }
        let rate = |s: f32| self.distance(core.at(s)).1.dot(core.along) - core.growth;
        let (mut low, mut high) = ((0.0, rate(0.0)), (1.0, rate(1.0)));
        if low.1 >= 0.0 {
            return 0.0;
        }
        if high.1 <= 0.0 {
            return 1.0;
        }
        let level = 1e-6 * core.along.length();
        let mut last = 0.0f32;
        for i in 0..48 {
            // Across a kink the false position may creep.
            let s = if i % 3 == 2 {
                0.5 * (low.0 + high.0)
            } else {
                (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1)
            };
            let at = rate(s);
            if at.abs() <= level || high.0 - low.0 < 1e-6 {
                return s;
            }
            if at < 0.0 {
                low = (s, at);
                high.1 *= if last < 0.0 { 0.5 } else { 1.0 };
            } else {
                high = (s, at);
                low.1 *= if last > 0.0 { 0.5 } else { 1.0 };
            }
            last = at;
        }
        0.5 * (low.0 + high.0)
    }

    /// Signed distance of a point and the way out: in the half plane of the axis and the point a frustum is
    /// three segments.
    fn distance(&self, p: Vec3) -> (f32, Vec3) {
        let u = Frustum::outward(p);
        let c = Vec2::new((p.x * p.x + p.z * p.z).sqrt(), p.y);
        let corners = [
            Vec2::new(0.0, -self.half_height),
            Vec2::new(self.bottom, -self.half_height),
            Vec2::new(self.top, self.half_height),
            Vec2::new(0.0, self.half_height),
        ];
        let (mut inside, mut out) = ((f32::MIN, Vec2::Y), (f32::MAX, Vec2::Y));
        for i in 0..3 {
            let (p, along) = (corners[i], corners[i + 1] - corners[i]);
            let squared = along.length_squared();
            if !(squared > 0.0) {
                continue;
            }
            let normal = Vec2::new(along.y, -along.x) / squared.sqrt();
            let height = normal.dot(c - p);
            if height > inside.0 {
                inside = (height, normal);
            }
            let t = (along.dot(c - p) / squared).clamp(0.0, 1.0);
            let away = c - (p + along * t);
            if away.length_squared() < out.0 {
                out = (away.length_squared(), away);
            }
        }
        let length = out.0.sqrt();
        let (distance, n) =
            if inside.0 > 0.0 && length > 0.0 { (length, out.1 / length) } else { (inside.0, inside.1) };
        (distance, u * n.x + Vec3::Y * n.y)
    }

    /// The part of a core that lies along the side or on a cap, if it does at the ball `s` with the way out
    /// `out`; and the height of its balls' centres there, along `out`.
    fn shared(&self, core: &Core, s: f32, out: Vec3) -> Option<(f32, f32, impl Fn(f32) -> f32 + use<>)> {
        let (p, d) = (core.start, core.along);
        let length = d.length();
        // The line along which the balls touch: a tapered core lies on it with its axis raised.
        let touch = d - out * core.growth;
        if !(length > 0.0) || out.dot(touch).abs() > 0.1 * length {
            return None;
        }
        // Along the way out, how high a ball's centre is over the cap or the line.
        let (low, high, heights, aside) = if out.y.abs() > 0.999 {
            // Over the cap: a disc.
            let (y, r) =
                if out.y > 0.0 { (self.half_height, self.top) } else { (-self.half_height, self.bottom) };
            let (a, b) = (d.x * d.x + d.z * d.z, p.x * d.x + p.z * d.z);
            let root = b * b - a * (p.x * p.x + p.z * p.z - r * r);
            if !(root > 0.0 && a > 0.0) {
                return None;
            }
            let heights = [0.0, 1.0].map(|s| (core.at(s).y - y) / out.y);
            ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a, heights, 0.0)
        } else {
            let u = Frustum::outward(core.at(s));
            let [bottom, top] = self.line(u, &Pose::IDENTITY);
            let line = top - bottom;
            let aside = touch.cross(line).length() / line.length();
            if aside > 0.1 * length {
                return None;
            }
            // As seen along the way out.
            let seen = d - out * out.dot(d);
            let ends = [bottom, top].map(|q| seen.dot(q - p) / seen.dot(d));
            let heights = [0.0, 1.0].map(|s| {
                let over = core.at(s) - bottom;
                out.dot(over - line * (seen.dot(over) / seen.dot(line)))
            });
            (ends[0].min(ends[1]), ends[0].max(ends[1]), heights, aside)
        };
        let (low, high) = (low.max(0.0), high.min(1.0));
        // If two lines cross, their ends are beside each other.
        let aside = (high - low) * aside;
        (high - low > 1e-3 && aside <= LINE_TOUCH_ASIDE * self.bottom.max(self.top)).then_some((
            low,
            high,
            move |s: f32| heights[0] + (heights[1] - heights[0]) * s,
        ))
    }
}
