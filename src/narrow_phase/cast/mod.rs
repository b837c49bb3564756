//! When two moving shapes first touch.
//!
//! Conservative advancement (Mirtich, *Impulse-based Dynamic Simulation*, 1996): find the gap along a
//! direction, go on for as long as it surely lasts, repeat. Three bounds say how long that is:
//!
//! - Without spin the gap along a fixed direction n shrinks by n · displacement, exactly. The distance of
//!   convex shapes is convex in time, so this is Newton's method from the safe side: a miss ends the search
//!   as soon as the nearest approach is behind, and a hit converges in a few steps.
//! - A spin w moves no point of the core faster along n than |w × n| r, where r is the extent of the core
//!   across the axis (Zhang, Lee and Kim, *Interactive Continuous Collision Detection for Non-convex
//!   Polyhedra*, 2006).
//! - That is dear for a rod which spins at 200 rad/s close to a floor: it takes thousands of steps. But an
//!   arc is close to its chord: between the gaps at two moments, both along the same n, the gap is at least
//!   their linear interpolation less the sagitta u (1 - u)/2 |w|² r. One more pair of support points then
//!   buys a step of the order of sqrt(gap), not gap.
//!
//! Casts of queries, which don't turn, have a search of their own (docs/decisions/advancement.md).
//!
//! The radius of a ball, a capsule or a fillet does not count as extent: turning it changes nothing.

pub(crate) mod ahead;
pub(crate) mod gates;
pub(crate) mod mesh;
pub(crate) mod mesh_cast;
pub(crate) mod motion;
pub(crate) mod path;
pub(crate) mod spin;
pub(crate) mod sweep;

use crate::narrow_phase::convex::gjk::{Accuracy, core_gap};
use crate::narrow_phase::convex::simplex::Simplex;
use crate::shape::support::{Pose, Support};
use crate::shape::{Collider, Kind};
use glam::{DMat3, DQuat, DVec3, Vec3};
use motion::{Motion, Turn, turn};
use path::BoxPath;

/// Steps until a search gives up and calls it a touch. Over 1500 random casts the mean is 5 and the most 33;
/// a rod whose tip passes 0.2 mm above a floor at 200 rad/s takes 10.
const MAX_STEPS: usize = 48;

/// Where two shapes first touch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    /// Fraction of the step, 0..=1: at most `tolerance` early, never late.
    pub(crate) fraction: f32,
    /// Unit, from a to b at the time of the touch, in the axes of the world.
    pub(crate) normal: Vec3,
}

/// First fraction of the step at which two convex shapes, or one and a plane, are within `tolerance` [m] of
/// each other; 0 if they are at the start. A search that doesn't settle counts as a touch.
///
/// [`tolerance`] gives one that fits two shapes.
pub(crate) fn cast_convex(a: &Collider, b: &Collider, motion: &Motion, tolerance: f32) -> Option<Touch> {
    let other = if b.kind == Kind::Plane { Other::Plane } else { Other::Convex(b.geometry.support()?) };
    Sweep::new(a.geometry.support()?, other, motion, tolerance).first_touch(1.0)
}

/// The tolerance for two shapes [m]: a thousandth of the smaller one, at most 0.0002 of the length unit, and
/// no less than the resolution of `f32` poses over the extent of the larger one. A real contact begins at ten
/// times as much.
pub(crate) fn tolerance(a: &Collider, b: &Collider, unit: f32) -> f32 {
    let (small, large) = if a.radius < b.radius { (a.radius, b.radius) } else { (b.radius, a.radius) };
    let large = if large.is_finite() { large } else { small };
    (1e-3 * small).min(2e-4 * unit).max(2.0 * f32::EPSILON * large)
}

/// The obstacle of a.
#[derive(Clone, Copy, Debug)]
pub(super) enum Other<'a> {
    Convex(Support<'a>),
    /// The half-space y <= 0 of b's frame.
    Plane,
}

/// A pair of shapes in motion, prepared for many evaluations of their gap.
#[derive(Clone, Debug)]
pub(super) struct Sweep<'a> {
    a: Support<'a>,
    b: Other<'a>,
    tolerance: f64,
    /// Position of a's centre of mass relative to b's, at the start [m].
    start: DVec3,
    displacement: DVec3,
    turn_a: Arc,
    turn_b: Arc,
    /// Approximate direction from a to b, in the axes of the world, or zero.
    hint: DVec3,
}

/// How a shape turns about its body's centre of mass.
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

/// The poses of both shapes at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    rotation_a: DMat3,
    pub(super) rotation_b: DMat3,
    /// Position of b's origin relative to a's.
    pub(super) offset: DVec3,
}

/// How far two shapes are apart at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    /// A lower bound of the distance [m].
    pub(super) lower: f64,
    /// Direction from a to b along which it holds.
    pub(super) normal: DVec3,
}

impl<'a> Sweep<'a> {
    pub(super) fn new(a: Support<'a>, b: Other<'a>, motion: &Motion, tolerance: f32) -> Sweep<'a> {
        let tolerance = f64::from(tolerance);
        let displacement = motion.displacement.as_dvec3();
        let turn_a = Arc::of(&motion.a, tolerance, &a);
        let turn_b = match &b {
            Other::Convex(b) => Arc::of(&motion.b, tolerance, b),
            Other::Plane => {
                // A touch is within reach of a, so that much of the plane counts.
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

    /// [`Sweep::first_touch`] from a moment before which nothing touches, given the poses, the gap with its
    /// direction, and the simplex at that moment.
    pub(super) fn touch_after(
        &self,
        mut t: f64,
        mut placed: Placed,
        start: Gap,
        mut simplex: Simplex,
        limit: f64,
    ) -> Option<Touch> {
        let Gap { lower: mut gap, mut normal } = start;
        // Steps end short of the tolerance, so that the last one is not the limit of infinitely many.
        let target = 0.5 * self.tolerance;
        let still = self.turn_a.rate == 0.0 && self.turn_b.rate == 0.0;
        for step in 0..MAX_STEPS {
            if step > 0 {
                Gap { lower: gap, normal } = self.gap(&placed, &mut simplex);
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

    /// When a comes within the tolerance of the plane of the triangle in b's place, which does not turn. It
    /// cannot touch the triangle before that. The search begins at a moment before which nothing touches,
    /// with the plane `gap` away along `normal`. `None` if it reaches the plane no sooner than `limit`.
    pub(super) fn reach_plane(
        &self,
        mut t: f64,
        mut placed: Placed,
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

    /// How long the gap along `normal` surely lasts, by the chords of the arcs.
    fn long_step(&self, t: f64, normal: DVec3, gap: f64, target: f64) -> f64 {
        let bend = self.bend(normal);
        // The step over which the sagitta takes half of the gap.
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

    /// Puts a triangle of the same mesh in b's place; `hint` is the approximate direction towards it.
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

    /// The path of a's origin in the frame that b has at the start, as if nothing turned, and the half
    /// extents of a box that moves along it and contains a at all times.
    pub(super) fn path_in_b(&self, motion: &Motion) -> BoxPath {
        let placed = self.placed(0.0);
        let to_b = placed.rotation_b.transpose();
        let from = to_b * -placed.offset;
        let mut inflate = self.a.half_extents(to_b * placed.rotation_a);
        // Turning moves no point of a by more than twice its distance from the axis.
        inflate += DVec3::splat(self.turn_a.reach * self.turn_a.rate.min(2.0));
        if motion.b.spin != Vec3::ZERO {
            let far = self.start.length()
                + self.displacement.length()
                + self.turn_a.lever.length()
                + self.a.half_extents(DMat3::IDENTITY).length();
            inflate += DVec3::splat(far * f64::from(motion.b.spin.length()).min(2.0));
        }
        let to = from + to_b * self.displacement;
        // `f32` rounds the path; the tolerance alone may be less than that in a large mesh.
        inflate += DVec3::splat(self.tolerance + 1e-6 * (from.length() + to.length()));
        BoxPath { from: from.as_vec3(), to: to.as_vec3(), inflate: inflate.as_vec3() }
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

    /// From the origin of a to that of b, if nothing turns.
    fn offset(&self, t: f64) -> DVec3 {
        self.turn_b.lever - self.turn_a.lever - self.start - self.displacement * t
    }

    pub(super) fn gap(&self, placed: &Placed, simplex: &mut Simplex) -> Gap {
        let Other::Convex(b) = &self.b else {
            let normal = -placed.rotation_b.y_axis;
            return Gap { lower: self.gap_along(placed, normal), normal };
        };
        let to_a = placed.rotation_a.transpose();
        let pose = Pose { rotation: to_a * placed.rotation_b, position: to_a * placed.offset };
        let accuracy = Accuracy { absolute: 0.1 * self.tolerance, relative: 1e-3 };
        let found = core_gap(&self.a, b, &pose, to_a * self.hint, simplex, accuracy);
        let radii = self.a.radius + b.radius;
        Gap { lower: found.lower - radii, normal: placed.rotation_a * found.normal }
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

fn unit(rotation: crate::math::Quat) -> DQuat {
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
        // Turning about its own axis of symmetry moves no surface of a round shape.
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
mod tests;
