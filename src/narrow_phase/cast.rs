//! When two moving shapes first touch.
//!
//! Conservative advancement (Mirtich, *Impulse-based Dynamic Simulation*, 1996): find the gap along a direction,
//! go on for as long as it surely lasts, repeat. Three bounds say how long that is:
//!
//! - Without spin the gap along a fixed direction n shrinks by n · displacement, exactly. The distance of convex
//!   shapes is convex in time, so this is Newton's method from the safe side: a miss ends the search as soon as the
//!   nearest approach is behind, and a hit converges in a few steps.
//! - A spin w moves no point of the core faster along n than |w × n| r, where r is the extent of the core across the
//!   axis (Zhang, Lee and Kim, *Interactive Continuous Collision Detection for Non-convex Polyhedra*, 2006).
//! - That is dear for a rod which spins at 200 rad/s close to a floor: it takes thousands of steps. But an arc is
//!   close to its chord: between the gaps at two moments, both along the same n, the gap is at least their linear
//!   interpolation less the sagitta u (1 - u)/2 |w|² r. One more pair of support points then buys a step of the order
//!   of sqrt(gap), not gap.
//!
//! The radius of a ball, a capsule or a fillet does not count as extent: turning it changes nothing.

use super::gjk::core_gap;
use super::motion::{Motion, Turn, turn};
use super::simplex::Simplex;
use super::support::{Pose, Support};
use crate::shape::Collider;
use glam::{DMat3, DQuat, DVec3, Vec3};

/// Steps until a search gives up and calls it a touch. Over 1500 random casts the mean is 5 and the most 33; a rod
/// whose tip passes 0.2 mm above a floor at 200 rad/s takes 10.
const MAX_STEPS: usize = 48;

/// Where two shapes first touch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    /// Of the step, 0..=1. At most `tolerance` early, never late.
    pub(crate) fraction: f32,
    /// Unit, from a to b at the time of the touch, in the axes of the world.
    pub(crate) normal: Vec3,
}

/// First fraction of the step at which two convex shapes are within `tolerance` [m] of each other; 0 if they are at
/// the start. A search that doesn't settle counts as a touch.
///
/// [`tolerance`] says what fits two shapes.
pub(crate) fn cast_convex(a: &Collider, b: &Collider, motion: &Motion, tolerance: f32) -> Option<Touch> {
    let (a, b) = (Support::of(a)?, Support::of(b)?);
    Sweep::new(a, Other::Convex(b), motion, tolerance).first_touch(1.0)
}

/// The same against a plane.
pub(crate) fn cast_plane(a: &Collider, _plane: &Collider, motion: &Motion, tolerance: f32) -> Option<Touch> {
    Sweep::new(Support::of(a)?, Other::Plane, motion, tolerance).first_touch(1.0)
}

/// The tolerance for two shapes [m]: a thousandth of the smaller one, at most 0.0002 of the length unit, and no less than
/// what `f32` poses resolve over the extent of the larger one. A real contact begins at ten times as much.
pub(crate) fn tolerance(a: &Collider, b: &Collider, unit: f32) -> f32 {
    let (small, large) = if a.radius < b.radius { (a.radius, b.radius) } else { (b.radius, a.radius) };
    let large = if large.is_finite() { large } else { small };
    (1e-3 * small).min(2e-4 * unit).max(2.0 * f32::EPSILON * large)
}

/// What a moves against.
#[derive(Clone, Copy, Debug)]
pub(super) enum Other<'a> {
    Convex(Support<'a>),
    /// The half-space y <= 0 of b's frame.
    Plane,
}

/// A pair of shapes in motion, made ready for many looks at it.
#[derive(Clone, Debug)]
pub(super) struct Sweep<'a> {
    a: Support<'a>,
    b: Other<'a>,
    tolerance: f64,
    /// Of a's body's centre from b's.
    start: DVec3,
    displacement: DVec3,
    turn_a: Arc,
    turn_b: Arc,
    /// About the direction from a to b, in the axes of the world, or zero.
    hint: DVec3,
}

/// A shape's way around its body's centre.
#[derive(Clone, Copy, Debug)]
struct Arc {
    rotation: DMat3,
    lever: DVec3,
    /// Rotation vector over the step; zero if it moves no point by as much as the tolerance shows.
    spin: DVec3,
    rate: f64,
    /// Extent of the core across the axis of the spin [m].
    reach: f64,
}

/// Both shapes at a moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    rotation_a: DMat3,
    pub(super) rotation_b: DMat3,
    /// Origin of b's shape from a's.
    pub(super) offset: DVec3,
}

/// A box that goes straight.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxPath {
    pub(super) from: DVec3,
    pub(super) to: DVec3,
    /// Half extents.
    pub(super) inflate: DVec3,
}

impl<'a> Sweep<'a> {
    pub(super) fn new(a: Support<'a>, b: Other<'a>, motion: &Motion, tolerance: f32) -> Sweep<'a> {
        let tolerance = f64::from(tolerance);
        let displacement = motion.displacement.as_dvec3();
        let turn_a = Arc::of(&motion.a, tolerance, &a);
        let turn_b = match &b {
            Other::Convex(b) => Arc::of(&motion.b, tolerance, b),
            Other::Plane => {
                // What touches is within reach of a, so that much of the plane counts.
                let far = a.half_extents(DMat3::IDENTITY).length() + f64::from(motion.a.lever.length());
                let far = far + motion.start.length() + displacement.length();
                let mut turn = Arc::still(&motion.b, unit(motion.b.rotation));
                (turn.spin, turn.reach) = (motion.b.spin.as_dvec3(), far);
                turn.rate = turn.spin.length();
                turn
            }
        };
        Sweep { a, b, tolerance, start: motion.start, displacement, turn_a, turn_b, hint: DVec3::ZERO }
    }

    /// The moment of the first touch, if it is before `limit`; the limit has no other influence on it.
    pub(super) fn first_touch(&self, limit: f64) -> Option<Touch> {
        let placed = self.placed(0.0);
        let mut simplex = Simplex::empty();
        let start = self.gap(&placed, &mut simplex);
        self.touch_after(0.0, placed, start, simplex, limit)
    }

    /// The same, with what is known of a moment before which nothing touches: where the shapes are, the gap and its
    /// direction, and the simplex.
    pub(super) fn touch_after(
        &self,
        mut t: f64,
        mut placed: Placed,
        (mut gap, mut normal): (f64, DVec3),
        mut simplex: Simplex,
        limit: f64,
    ) -> Option<Touch> {
        // Steps end short of the tolerance, so that the last one is not the limit of infinitely many.
        let target = 0.5 * self.tolerance;
        let still = self.turn_a.rate == 0.0 && self.turn_b.rate == 0.0;
        for step in 0..MAX_STEPS {
            if step > 0 {
                (gap, normal) = self.gap(&placed, &mut simplex);
            }
            if gap <= self.tolerance {
                return Some(touch(t, normal));
            }
            let closing = if self.is_turning_plane() {
                // Its normal turns, and with it the share of the displacement that counts.
                self.displacement.length()
                    + self.turn_a.rate * self.turn_a.reach
                    + self.turn_b.rate * self.turn_b.reach
            } else {
                self.displacement.dot(normal) + self.turn_a.speed(normal) + self.turn_b.speed(normal)
            };
            if closing <= 0.0 {
                return None;
            }
            let mut step = (gap - target) / closing;
            if !still && t + step < limit {
                step = step.max(self.long_step(t, normal, gap, target));
            }
            t += step;
            if t >= limit {
                return None;
            }
            if still {
                placed.offset = self.offset(t);
            } else {
                placed = self.placed(t);
            }
        }
        Some(touch(t, normal))
    }

    /// When a comes within the tolerance of the plane of the triangle in b's place, which does not turn and is `gap`
    /// away along `normal` at a moment before which nothing touches; not before that can it touch the triangle. None if
    /// that is not before `limit`.
    pub(super) fn reach_plane(
        &self,
        (mut t, mut placed): (f64, Placed),
        mut gap: f64,
        normal: DVec3,
        limit: f64,
    ) -> Option<(f64, Placed)> {
        let target = 0.5 * self.tolerance;
        let closing = self.displacement.dot(normal) + self.turn_a.speed(normal);
        if closing <= 0.0 {
            return None;
        }
        for _ in 0..MAX_STEPS {
            if gap <= self.tolerance {
                break;
            }
            let mut step = (gap - target) / closing;
            if self.turn_a.rate > 0.0 && t + step < limit {
                step = step.max(self.long_step(t, normal, gap, target));
            }
            t += step;
            if t >= limit {
                return None;
            }
            placed = self.placed(t);
            gap = self.gap_along(&placed, normal);
        }
        Some((t, placed))
    }

    /// The point of a that is furthest along `normal`, from its origin.
    pub(super) fn furthest(&self, placed: &Placed, normal: DVec3) -> DVec3 {
        self.furthest_of_core(placed, normal) + normal * self.a.radius
    }

    fn furthest_of_core(&self, placed: &Placed, normal: DVec3) -> DVec3 {
        placed.rotation_a * self.a.support(placed.rotation_a.transpose() * normal)
    }

    /// How long the gap along `normal` lasts by the chords of the arcs.
    fn long_step(&self, t: f64, normal: DVec3, gap: f64, target: f64) -> f64 {
        let bend = self.bend(normal);
        // As far as the sagitta takes half of the gap.
        let reach = if bend > 0.0 { (4.0 * gap / bend).sqrt().min(1.0 - t) } else { 1.0 - t };
        let then = self.placed(t + reach);
        // A plane shows no gap but along its own normal, as it is then; `bend` allows for that.
        let normal = if self.is_turning_plane() { -then.rotation_b.y_axis } else { normal };
        let then = self.gap_along(&then, normal);
        // gap + u (then - gap) - u (1 - u) curve = target
        let curve = 0.5 * bend * reach * reach;
        let slope = then - gap - curve;
        let root = slope * slope - 4.0 * curve * (gap - target);
        if slope >= 0.0 || root < 0.0 {
            return reach;
        }
        reach * (2.0 * (gap - target) / (root.sqrt() - slope)).min(1.0)
    }

    /// Puts a triangle of the same mesh in b's place, about in this direction.
    pub(super) fn set_triangle(&mut self, triangle: Support<'a>, motion: &Motion, hint: DVec3) {
        self.b = Other::Convex(triangle);
        self.hint = hint;
        if motion.b.spin != Vec3::ZERO {
            self.turn_b = Arc::of(&motion.b, self.tolerance, &triangle);
        }
    }

    pub(super) fn b_spins(&self) -> bool {
        self.turn_b.rate > 0.0
    }

    /// The way of a's origin in the frame that b has at the start, as if nothing turned, and the half extents of a
    /// box along it that holds a at all times.
    pub(super) fn path_in_b(&self, motion: &Motion) -> BoxPath {
        let placed = self.placed(0.0);
        let to_b = placed.rotation_b.transpose();
        let from = to_b * -placed.offset;
        let mut inflate = self.a.half_extents(to_b * placed.rotation_a);
        // No point of a gets further from where it would be without the spin than twice its distance from the axis.
        inflate += DVec3::splat(self.turn_a.reach * self.turn_a.rate.min(2.0));
        if motion.b.spin != Vec3::ZERO {
            let far = self.start.length()
                + self.displacement.length()
                + self.turn_a.lever.length()
                + self.a.half_extents(DMat3::IDENTITY).length();
            inflate += DVec3::splat(far * f64::from(motion.b.spin.length()).min(2.0));
        }
        BoxPath { from, to: from + to_b * self.displacement, inflate }
    }

    /// An upper bound of the second derivative of the gap along `normal` [m per step²].
    pub(super) fn bend(&self, normal: DVec3) -> f64 {
        let (a, b) = (&self.turn_a, &self.turn_b);
        if self.is_turning_plane() {
            // The height of a point of a in the plane's frame: centrifugal, Coriolis, and its own.
            let speed = self.displacement.length() + a.rate * a.reach;
            return b.rate * b.rate * b.reach + 2.0 * b.rate * speed + a.rate * a.rate * a.reach;
        }
        a.rate * a.speed(normal) + b.rate * b.speed(normal)
    }

    fn is_turning_plane(&self) -> bool {
        matches!(self.b, Other::Plane) && self.turn_b.rate > 0.0
    }

    pub(super) fn placed(&self, t: f64) -> Placed {
        let (rotation_a, lever_a) = self.turn_a.at(t);
        let (rotation_b, lever_b) = self.turn_b.at(t);
        Placed { rotation_a, rotation_b, offset: lever_b - lever_a - self.start - self.displacement * t }
    }

    /// From the origin of a to that of b, without spin.
    fn offset(&self, t: f64) -> DVec3 {
        self.turn_b.lever - self.turn_a.lever - self.start - self.displacement * t
    }

    /// A lower bound of the distance, and the direction from a to b along which it holds.
    pub(super) fn gap(&self, placed: &Placed, simplex: &mut Simplex) -> (f64, DVec3) {
        let Other::Convex(b) = &self.b else {
            let normal = -placed.rotation_b.y_axis;
            return (self.gap_along(placed, normal), normal);
        };
        let to_a = placed.rotation_a.transpose();
        let pose = Pose { rotation: to_a * placed.rotation_b, position: to_a * placed.offset };
        let found = core_gap(&self.a, b, &pose, to_a * self.hint, simplex, (0.1 * self.tolerance, 1e-3));
        let radii = self.a.radius + b.radius;
        (found.lower - radii, placed.rotation_a * found.normal)
    }

    /// The gap along a direction.
    pub(super) fn gap_along(&self, placed: &Placed, normal: DVec3) -> f64 {
        let point_a = self.furthest_of_core(placed, normal);
        let (point_b, radii) = match &self.b {
            Other::Convex(b) => {
                let local = placed.rotation_b.transpose() * -normal;
                (placed.rotation_b * b.support(local), self.a.radius + b.radius)
            }
            Other::Plane => (DVec3::ZERO, self.a.radius),
        };
        (point_b + placed.offset - point_a).dot(normal) - radii
    }
}

fn unit(rotation: glam::Quat) -> DQuat {
    rotation.as_dquat().normalize()
}

fn touch(t: f64, normal: DVec3) -> Touch {
    Touch { fraction: t as f32, normal: normal.as_vec3() }
}

impl Arc {
    fn still(motion: &Turn, rotation: DQuat) -> Arc {
        Arc {
            rotation: DMat3::from_quat(rotation),
            lever: motion.lever.as_dvec3(),
            spin: DVec3::ZERO,
            rate: 0.0,
            reach: 0.0,
        }
    }

    fn of(motion: &Turn, tolerance: f64, shape: &Support) -> Arc {
        let rotation = unit(motion.rotation);
        let still = Arc::still(motion, rotation);
        let lever = still.lever;
        let spin = motion.spin.as_dvec3();
        let rate = spin.length();
        if rate == 0.0 {
            return still;
        }
        let axis = spin / rate;
        let reach = shape.reach(axis, rotation, lever);
        // No chord is longer than the arc, or than twice the radius.
        let unseen = 0.1 * tolerance;
        if reach * rate.min(2.0) <= unseen {
            return still;
        }
        // A wheel that turns on its own axle goes nowhere by that.
        if shape.is_round() {
            let own = rotation * DVec3::Y;
            let wobble = spin - own * spin.dot(own);
            let tilt = wobble.length();
            let swing = axis.cross(lever).length() * rate.min(2.0);
            if swing + tilt * shape.reach(wobble.normalize_or(own), rotation, DVec3::ZERO) <= unseen {
                return still;
            }
        }
        Arc { spin, rate, reach, ..still }
    }

    /// The shape's rotation and lever after a fraction of the step.
    fn at(&self, t: f64) -> (DMat3, DVec3) {
        if self.rate == 0.0 || t == 0.0 {
            return (self.rotation, self.lever);
        }
        let turned = DMat3::from_quat(turn(self.spin * t));
        (turned * self.rotation, turned * self.lever)
    }

    /// The most by which the spin moves a point of the core along `normal` in a whole step [m].
    fn speed(&self, normal: DVec3) -> f64 {
        self.spin.cross(normal).length() * self.reach
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{CONVEX, Random, collider};
    use super::super::motion::BodyPath;
    use super::*;
    use crate::shape::{Geometry, Kind};
    use glam::Quat;

    fn path(centre: DVec3, displacement: Vec3) -> BodyPath {
        BodyPath { centre, rotation: Quat::IDENTITY, displacement, spin: Vec3::ZERO }
    }

    fn still(centre: DVec3) -> BodyPath {
        path(centre, Vec3::ZERO)
    }

    /// The distance at a moment, by the platform's rotations and the distance that `gjk` proves; half of minus the
    /// size or so in overlap.
    fn distance_at(a: &Collider, b: &Collider, (pa, pb): (&BodyPath, &BodyPath), t: f64) -> f64 {
        let place = |shape: &Collider, path: &BodyPath| {
            let spin = path.spin.as_dvec3() * t;
            let turned = DQuat::from_scaled_axis(spin) * path.rotation.as_dquat().normalize();
            let centre = path.centre + path.displacement.as_dvec3() * t;
            (turned * shape.rotation.as_dquat().normalize(), centre + turned * shape.position.as_dvec3())
        };
        let ((ra, xa), (rb, xb)) = (place(a, pa), place(b, pb));
        if b.kind == Kind::Plane {
            let up = rb * DVec3::Y;
            let lowest = super::super::fixtures::furthest(a, ra.conjugate() * -up);
            return (ra * lowest + xa - xb).dot(up);
        }
        let pose =
            Pose { rotation: DMat3::from_quat(ra.conjugate() * rb), position: ra.conjugate() * (xb - xa) };
        let (a, b) = (Support::of(a).unwrap(), Support::of(b).unwrap());
        let gap = core_gap(&a, &b, &pose, DVec3::ZERO, &mut Simplex::empty(), (0.0, 1e-9));
        (if gap.overlap { 0.0 } else { gap.upper }) - a.radius - b.radius
    }

    fn cast(a: &Collider, b: &Collider, paths: (&BodyPath, &BodyPath), tolerance: f32) -> Option<Touch> {
        let motion = Motion::new(a, paths.0, b, paths.1);
        match b.kind {
            Kind::Plane => cast_plane(a, b, &motion, tolerance),
            _ => cast_convex(a, b, &motion, tolerance),
        }
    }

    /// Steps through the motion and compares. Answers (touched, unsettled).
    fn check(a: &Collider, b: &Collider, paths: (&BodyPath, &BodyPath), steps: u32) -> (bool, bool) {
        let eps = tolerance(a, b, 1.0);
        let tol = f64::from(eps);
        let touch = cast(a, b, paths, eps);
        let end = touch.map_or(1.0, |t| f64::from(t.fraction));
        // What a step in f32 of the fraction moves.
        let speed = f64::from((paths.0.displacement - paths.1.displacement).length())
            + f64::from(paths.0.spin.length() * (a.radius + a.position.length()))
            + f64::from(paths.1.spin.length())
                * if b.radius.is_finite() { f64::from(b.radius) } else { 50.0 };
        let rounding = 1e-7 * speed + 1e-9;
        for i in 0..steps {
            let t = end * f64::from(i) / f64::from(steps);
            let d = distance_at(a, b, paths, t);
            let say = || format!("{:?} {:?} {paths:?} at {t} of {touch:?}: {d}", a.geometry, b.geometry);
            assert!(d > 0.0 || end == 0.0, "late: {}", say());
        }
        let Some(touch) = touch else { return (false, false) };
        assert!((touch.normal.length() - 1.0).abs() < 1e-5);
        let d = distance_at(a, b, paths, end);
        (true, d > 1.2 * tol + rounding)
    }

    #[test]
    fn casts_agree_with_small_steps() {
        let mut random = Random(11);
        let (mut hits, mut misses, mut unsettled) = (0, 0, 0);
        for i in 0..if cfg!(miri) { 5 } else { 1500 } {
            let (kind_a, kind_b) = (CONVEX[i % 5], CONVEX[i / 5 % 5]);
            let size = random.log_range(0.01, 5.0);
            let other = random.log_range(0.01, 20.0);
            let (mut a, mut b) = (random.shape(kind_a, size), random.shape(kind_b, other));
            for shape in [&mut a, &mut b] {
                if random.below(3) == 0 {
                    shape.position = random.cube() * shape.radius;
                    shape.rotation = random.rotation();
                }
            }
            let reach = a.radius + b.radius + a.position.length() + b.position.length();
            let far = random.range(0.3, 3.0) * reach;
            let from = random.direction();
            // About at each other, often at a tangent; from slow to a hundred sizes a step.
            let aim = -from * far + random.direction() * reach * random.range(0.0, 1.0);
            let spins = |random: &mut Random| match random.below(3) {
                0 => Vec3::ZERO,
                1 => random.direction() * random.range(0.0, 0.5),
                _ => random.direction() * random.range(0.0, 8.0),
            };
            let origin = DVec3::new(3e5, -2e4, 7e5);
            let body = |random: &mut Random, centre: DVec3, displacement: Vec3| BodyPath {
                centre,
                rotation: random.rotation_or_aligned(),
                displacement,
                spin: spins(random),
            };
            let push = random.direction() * random.range(0.0, 3.0);
            let speed = random.log_range(0.2, 50.0);
            let pa = body(&mut random, origin + (from * far).as_dvec3(), aim * speed + push);
            let pb = body(&mut random, origin, push);
            let (hit, open) = check(&a, &b, (&pa, &pb), 300);
            hits += u32::from(hit);
            misses += u32::from(!hit);
            unsettled += u32::from(open);
        }
        println!("{hits} hits, {misses} misses, {unsettled} unsettled");
        assert!(cfg!(miri) || (hits > 300 && misses > 300));
        assert_eq!(unsettled, 0);
    }

    #[test]
    fn casts_against_planes_agree_with_small_steps() {
        let mut random = Random(12);
        let plane = collider(Geometry::Plane);
        let (mut hits, mut misses, mut unsettled) = (0, 0, 0);
        for i in 0..if cfg!(miri) { 5 } else { 600 } {
            let a = random.shape(CONVEX[i % 5], 1.0);
            let rotation = random.rotation_or_aligned();
            let up = rotation * Vec3::Y;
            let start = up * random.range(0.6, 3.0) * a.radius + random.cube();
            let mut pa = path(start.as_dvec3(), random.cube() * random.log_range(0.1, 30.0));
            pa.spin = if i % 3 == 0 { Vec3::ZERO } else { random.cube() * random.range(0.0, 5.0) };
            let mut pb = still(DVec3::ZERO);
            pb.rotation = rotation;
            if i % 7 == 0 {
                pb.spin = random.cube() * 0.1;
            }
            let (hit, open) = check(&a, &plane, (&pa, &pb), 300);
            hits += u32::from(hit);
            misses += u32::from(!hit);
            unsettled += u32::from(open);
        }
        println!("{hits} hits, {misses} misses, {unsettled} unsettled");
        assert!(cfg!(miri) || (hits > 100 && misses > 100));
        assert_eq!(unsettled, 0);
    }

    /// 500 m/s at 60 Hz is 8.3 m a step.
    #[test]
    fn a_miss_by_a_millimetre_at_500_metres_a_second_is_a_miss() {
        let target = collider(Geometry::cuboid(0.5, 0.5, 0.5));
        let edge = |x: f64| Vec3::new(8.333, 0.0, 0.0) * x as f32;
        for (shape, half) in [
            (Geometry::Sphere { radius: 0.05 }, 0.05),
            (Geometry::cuboid(0.05, 0.05, 0.05), 0.05),
            (Geometry::capsule(0.1, 0.02), 0.12),
            (Geometry::cylinder(0.1, 0.05), 0.1),
        ] {
            let bullet = collider(shape);
            let eps = tolerance(&bullet, &target, 1.0);
            for x in [0.3, 1.0, 4.0] {
                for (gap, hit) in [(1e-3, false), (-1e-3, true)] {
                    let from = DVec3::new(-1.5, 0.5 + half + gap, 0.1);
                    let touch = cast(&bullet, &target, (&path(from, edge(x)), &still(DVec3::ZERO)), eps);
                    assert_eq!(touch.is_some(), hit, "{:?} {gap} {touch:?}", bullet.geometry);
                }
            }
        }
        // Past a ball: the paths' nearest approach is a single moment.
        let (a, b) =
            (collider(Geometry::Sphere { radius: 0.05 }), collider(Geometry::Sphere { radius: 0.5 }));
        for (gap, hit) in [(1e-3, false), (2e-4, false), (-1e-5, true), (-1e-3, true)] {
            let from = DVec3::new(-4.0, 0.55 + gap, 0.0);
            let touch = cast(&a, &b, (&path(from, edge(1.0)), &still(DVec3::ZERO)), tolerance(&a, &b, 1.0));
            assert_eq!(touch.is_some(), hit, "{gap}");
        }
    }

    #[test]
    fn a_bullet_stops_at_a_thin_plate() {
        let mut random = Random(13);
        let plate = collider(Geometry::cuboid(2.0, 0.0005, 2.0));
        let bullet = collider(Geometry::Sphere { radius: 0.004 });
        for _ in 0..200 {
            // 2000 m/s at 60 Hz.
            let away = random.direction();
            let away = Vec3::new(away.x, away.y.abs().max(0.2), away.z).normalize();
            let through = random.cube() * Vec3::new(1.5, 0.0, 1.5);
            let before = random.range(0.1, 20.0);
            let from = (through + away * before).as_dvec3();
            let paths = (&path(from, away * -33.0), &still(DVec3::ZERO));
            let touch = cast(&bullet, &plate, paths, tolerance(&bullet, &plate, 1.0)).unwrap();
            let expected = (from.y - 0.0045) / (33.0 * f64::from(away.y));
            assert!((f64::from(touch.fraction) - expected).abs() < 1e-6, "{touch:?} {expected}");
            assert!((touch.normal + Vec3::Y).length() < 1e-3);
        }
    }

    /// 200 rad/s at 60 Hz is more than half a turn a step. A rod whose tip passes close over a floor, without and
    /// with contact; and one against a plate.
    #[test]
    fn a_spinning_rod_hits_what_its_tip_reaches() {
        let floor = collider(Geometry::cuboid(5.0, 0.5, 5.0));
        let plane = collider(Geometry::Plane);
        for rod in [
            Geometry::capsule(0.48, 0.02),
            Geometry::cuboid(0.005, 0.5, 0.005),
            Geometry::cylinder(0.5, 0.01),
        ] {
            let rod = collider(rod);
            let reach = f64::from(rod.radius);
            for (gap, hit) in
                [(0.2, false), (1e-2, false), (1e-3, false), (2e-4, false), (-2e-4, true), (-0.1, true)]
            {
                let mut pa = path(DVec3::Y * (reach + gap), Vec3::ZERO);
                pa.rotation = Quat::from_rotation_z(1.2);
                pa.spin = Vec3::new(0.0, 0.0, 200.0 / 60.0);
                let pb = still(DVec3::Y * -0.5);
                for (other, at) in [(&floor, &pb), (&plane, &still(DVec3::ZERO))] {
                    let touch = cast(&rod, other, (&pa, at), tolerance(&rod, other, 1.0));
                    assert_eq!(touch.is_some(), hit, "{:?} {gap} {touch:?}", rod.geometry);
                    check(&rod, other, (&pa, at), 1000);
                }
            }
        }
    }

    #[test]
    fn a_wheel_rolls_along_a_floor_without_touching() {
        let wheel = collider(Geometry::cylinder(0.1, 0.3));
        let floor = collider(Geometry::cuboid(50.0, 0.5, 50.0));
        let mut pa = path(DVec3::Y * 0.3005, Vec3::X * 0.5);
        pa.rotation = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        pa.spin = Vec3::Z * -1.7;
        assert!(
            cast(&wheel, &floor, (&pa, &still(DVec3::Y * -0.5)), tolerance(&wheel, &floor, 1.0)).is_none()
        );
    }

    #[test]
    fn shapes_that_touch_at_the_start_touch_at_zero() {
        let cube = collider(Geometry::cuboid(0.5, 0.5, 0.5));
        for y in [0.0, 0.9, 1.0, 1.000_04] {
            let paths = (&path(DVec3::Y * y, Vec3::X), &still(DVec3::ZERO));
            assert_eq!(
                cast(&cube, &cube, paths, tolerance(&cube, &cube, 1.0)).map(|t| t.fraction),
                Some(0.0)
            );
        }
    }

    #[test]
    fn the_pose_of_the_touch_is_the_kernels_pose() {
        let mut random = Random(14);
        for _ in 0..100 {
            let (mut a, b) = (random.shape(Kind::Box, 1.0), random.shape(Kind::Hull, 1.0));
            a.position = random.cube();
            let body = |random: &mut Random| BodyPath {
                centre: random.cube().as_dvec3() * 4.0,
                rotation: random.rotation(),
                displacement: random.cube() * 4.0,
                spin: random.cube() * 3.0,
            };
            let paths = (body(&mut random), body(&mut random));
            let motion = Motion::new(&a, &paths.0, &b, &paths.1);
            let t = random.range(0.0, 1.0);
            let rel = motion.relative(t);
            let pose = Pose {
                rotation: DMat3::from_quat(rel.rotation.as_dquat()),
                position: rel.position.as_dvec3(),
            };
            let found = core_gap(
                &Support::of(&a).unwrap(),
                &Support::of(&b).unwrap(),
                &pose,
                DVec3::ZERO,
                &mut Simplex::empty(),
                (0.0, 1e-9),
            );
            let expected = distance_at(&a, &b, (&paths.0, &paths.1), f64::from(t));
            assert!((found.upper - expected).abs() < 3e-6, "{} {expected}", found.upper);
        }
    }
}
