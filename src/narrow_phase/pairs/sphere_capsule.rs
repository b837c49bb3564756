//! Sphere against capsule, tapered or not: one point.
//!
//! A tapered capsule is the union of the balls along its axis whose radius runs linearly from bottom to top.
//! The normal of its side leans towards the thin end by an angle with sin = (bottom - top) / length, so the
//! ball that is nearest to a point is found in the plane of point and axis, by similar triangles.

use super::lanes_io::{ManifoldLanes, PairLanes, direction};
use crate::lanes::{Lanes, Vec3, kernel};

/// A tapered capsule as an axis with balls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis<L> {
    pub(crate) centre: Vec3<L>,
    /// Unit, from bottom to top.
    pub(crate) along: Vec3<L>,
    /// A unit vector square to it.
    pub(crate) across: Vec3<L>,
    pub(crate) half: L,
    /// Bottom, top.
    pub(crate) radius: [L; 2],
}

impl<L: Lanes> Axis<L> {
    /// From a capsule's size, its centre and its frame's x and y axes.
    #[inline(always)]
    pub(crate) fn new(size: &[L; 4], centre: Vec3<L>, along: Vec3<L>, across: Vec3<L>) -> Self {
        // Without length the bigger ball is the shape, and no radius is in between.
        let flat = size[0].lt(L::splat(1e-20));
        let bigger = size[1].max(size[2]);
        let radius = [L::select(flat, bigger, size[1]), L::select(flat, bigger, size[2])];
        Axis { centre, along, across, half: size[0], radius }
    }

    /// Sine of the angle by which the side's outward normal leans towards the top; within [-1, 1].
    #[inline(always)]
    pub(crate) fn lean(&self) -> L {
        let length = (self.half + self.half).max(L::splat(1e-30));
        ((self.radius[0] - self.radius[1]) / length).clamp(L::splat(-1.0), L::one())
    }

    #[inline(always)]
    pub(crate) fn at(&self, t: L) -> Vec3<L> {
        self.centre + self.along * t
    }

    /// Radius of the ball at `t` in [-half, half].
    #[inline(always)]
    pub(crate) fn radius_at(&self, t: L) -> L {
        let half = L::splat(0.5);
        let share = half + t * half / self.half.max(L::splat(1e-30));
        self.radius[0] + (self.radius[1] - self.radius[0]) * share
    }

    /// The ball whose surface is nearest to `point` (or in whose middle it is deepest): its place and radius.
    #[inline(always)]
    pub(crate) fn nearest_ball(&self, point: Vec3<L>) -> (L, L) {
        let from = point - self.centre;
        let y = from.dot(self.along);
        let x = (from - self.along * y).length();
        let (length, taper) = (self.half + self.half, self.radius[0] - self.radius[1]);
        let run = (length * length - taper * taper).max(L::splat(1e-30)).sqrt();
        let t = (y - x * taper / run).clamp(-self.half, self.half);
        // One end ball holds the other: it alone is the shape.
        let one_ball = taper.abs().ge(length);
        let t = L::select(one_ball, -(self.half * taper.sign()), t);
        (t, L::select(one_ball, self.radius[0].max(self.radius[1]), self.radius_at(t)))
    }

    /// From a ball round `centre` to this capsule: direction, distance from `centre` to the nearest ball's
    /// centre, where that is, and its radius. A centre on the axis is parted along the normal of the side.
    #[inline(always)]
    pub(crate) fn reach(&self, centre: Vec3<L>) -> (Vec3<L>, L, L, L) {
        let (t, radius) = self.nearest_ball(centre);
        let lean = self.lean();
        let side = self.across * (L::one() - lean * lean).max(L::zero()).sqrt() + self.along * lean;
        // Nearer to the axis than this, rounding could turn the direction along the axis, where there is
        // no way out.
        let least = L::splat(1e-5) * (self.half + radius);
        let (normal, distance) = direction(self.at(t) - centre, least, -side);
        (normal, distance, t, radius)
    }
}

kernel! {
    /// See the module.
    pub(crate) fn sphere_capsule<'a, L: Lanes>(p: &'a PairLanes<L>) -> ManifoldLanes<L> {
        let axes = p.rotation.to_matrix();
        let capsule = Axis::new(&p.size_b, p.position, axes.y, axes.x);
        let (normal, distance, _, radius) = capsule.reach(Vec3::zero());
        let separation = distance - (p.size_a[0] + radius);
        let position = normal * (p.size_a[0] + separation * L::splat(0.5));
        ManifoldLanes::single(normal, position, separation, p.margin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Quat;
    use crate::narrow_phase::Relative;
    use crate::narrow_phase::pairs::lanes_io::testing::*;
    use glam::{Vec3, vec3};

    #[test]
    fn the_separation_is_that_to_the_nearest_ball_at_any_width() {
        let mut pairs = pairs(2, 4000, 2.0);
        for (i, pair) in pairs.iter_mut().enumerate() {
            match i % 4 {
                0 => pair.2[2] = pair.2[1], // uniform
                1 => pair.2[0] *= 0.3,      // often one ball in the other
                _ => {}
            }
        }
        pairs[3].2[0] = 0.0;
        let found = same_at_any_width(&pairs, sphere_capsule, sphere_capsule, sphere_capsule);
        for (m, (relative, a, b, margin)) in found.iter().zip(&pairs) {
            let truth = between_capsules(relative, &[0.0, a[0], a[0], 0.0], b);
            assert!(m.gap() as f64 <= truth.max(0.0) + 1e-5);
            assert!(m.size() == (truth < *margin as f64) as u32 || (truth - *margin as f64).abs() < 1e-5);
            for point in m.points() {
                assert!((point.separation as f64 - truth).abs() < 2e-5, "{} {truth}", point.separation);
                let from = Relative { position: relative.position - point.position, ..*relative };
                let on_b = between_capsules(&from, &[0.0; 4], b);
                assert!((point.position.dot(m.normal) - a[0] - 0.5 * point.separation).abs() < 1e-5);
                // Beyond the axis of b the distance grows again.
                let shallow = truth > -0.1;
                assert!(!shallow || (on_b - 0.5 * point.separation as f64).abs() < 2e-5);
            }
        }
    }

    #[test]
    fn a_centre_on_the_axis_is_parted_through_the_side() {
        for (b, sine) in [([1.0, 0.2, 0.2, 0.0], 0.0), ([1.0, 0.6, 0.2, 0.0], 0.2)] {
            let relative = Relative { position: vec3(0.0, 0.3, 0.0), rotation: Quat::IDENTITY };
            let m = run::<f32>(&[(relative, [0.1; 4], b, 0.0)], sphere_capsule)[0];
            assert!((m.normal.dot(Vec3::NEG_Y) - sine).abs() < 1e-6);
            assert!(m.points[0].separation < -0.29);
        }
    }
}
