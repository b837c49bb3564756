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
use super::support::{Pose, Support};
use crate::shape::Collider;
use glam::{DMat3, DQuat, DVec3, Vec3};

/// Steps until a search gives up and calls it a touch. Hits take 3 to 12, near misses of a spinning body 30.
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

/// The tolerance for two shapes [m]: 1e-4 of the smaller one, at most 0.1 mm, and no less than what `f32` poses
/// resolve over the extent of the larger one.
pub(crate) fn tolerance(a: &Collider, b: &Collider) -> f32 {
    let (small, large) = if a.radius < b.radius { (a.radius, b.radius) } else { (b.radius, a.radius) };
    let large = if large.is_finite() { large } else { small };
    (1e-4 * small).min(1e-4).max(2.0 * f32::EPSILON * large)
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
}

/// A shape's way around its body's centre.
#[derive(Clone, Copy, Debug)]
struct Arc {
    rotation: DQuat,
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
                let mut turn = Arc::still(&motion.b);
                (turn.spin, turn.reach) = (motion.b.spin.as_dvec3(), far);
                turn.rate = turn.spin.length();
                turn
            }
        };
        Sweep { a, b, tolerance, start: motion.start, displacement, turn_a, turn_b }
    }

    /// The first moment of a touch up to `limit`.
    pub(super) fn first_touch(&self, limit: f64) -> Option<Touch> {
        // Steps end short of the tolerance, so that the last one is not the limit of infinitely many.
        let target = 0.5 * self.tolerance;
        let still = self.turn_a.rate == 0.0 && self.turn_b.rate == 0.0;
        let (mut t, mut normal) = (0.0, DVec3::ZERO);
        let mut placed = self.placed(0.0);
        for _ in 0..MAX_STEPS {
            let gap;
            (gap, normal) = self.gap(&placed, normal);
            if gap <= self.tolerance {
                return Some(touch(t, normal));
            }
            let approach = self.displacement.dot(normal);
            let closing = match self.b {
                // Its normal turns, and with it the share of the displacement that counts.
                Other::Plane if self.turn_b.rate > 0.0 => {
                    self.displacement.length()
                        + self.turn_a.rate * self.turn_a.reach
                        + self.turn_b.rate * self.turn_b.reach
                }
                _ => approach + self.turn_a.speed(normal) + self.turn_b.speed(normal),
            };
            if closing <= 0.0 {
                return None;
            }
            let mut step = (gap - target) / closing;
            if !still && t + step < limit {
                step = step.max(self.long_step(t, limit, normal, gap, target));
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

    /// How long the gap along `normal` lasts by the chords of the arcs.
    fn long_step(&self, t: f64, limit: f64, normal: DVec3, gap: f64, target: f64) -> f64 {
        if matches!(self.b, Other::Plane) && self.turn_b.rate > 0.0 {
            return 0.0;
        }
        let bend = self.bend(normal);
        // As far as the sagitta takes half of the gap.
        let reach = if bend > 0.0 { (4.0 * gap / bend).sqrt().min(limit - t) } else { limit - t };
        let then = self.gap_along(&self.placed(t + reach), normal);
        // gap + u (then - gap) - u (1 - u) curve = target
        let curve = 0.5 * bend * reach * reach;
        let slope = then - gap - curve;
        let root = slope * slope - 4.0 * curve * (gap - target);
        if slope >= 0.0 || root < 0.0 {
            return reach;
        }
        reach * (2.0 * (gap - target) / (root.sqrt() - slope)).min(1.0)
    }

    /// Puts a triangle of the same mesh in b's place.
    pub(super) fn set_triangle(&mut self, triangle: Support<'a>, motion: &Motion) {
        self.b = Other::Convex(triangle);
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
        self.turn_a.rate * self.turn_a.speed(normal) + self.turn_b.rate * self.turn_b.speed(normal)
    }

    pub(super) fn placed(&self, t: f64) -> Placed {
        let (turned_a, turned_b) = (turn(self.turn_a.spin * t), turn(self.turn_b.spin * t));
        Placed {
            rotation_a: DMat3::from_quat(turned_a * self.turn_a.rotation),
            rotation_b: DMat3::from_quat(turned_b * self.turn_b.rotation),
            offset: turned_b * self.turn_b.lever
                - turned_a * self.turn_a.lever
                - self.start
                - self.displacement * t,
        }
    }

    /// From the origin of a to that of b, without spin.
    fn offset(&self, t: f64) -> DVec3 {
        self.turn_b.lever - self.turn_a.lever - self.start - self.displacement * t
    }

    /// A lower bound of the distance, and the direction from a to b along which it holds.
    pub(super) fn gap(&self, placed: &Placed, hint: DVec3) -> (f64, DVec3) {
        let Other::Convex(b) = &self.b else {
            let normal = -placed.rotation_b.y_axis;
            return (self.gap_along(placed, normal), normal);
        };
        let to_a = placed.rotation_a.transpose();
        let pose = Pose { rotation: to_a * placed.rotation_b, position: to_a * placed.offset };
        let found = core_gap(&self.a, b, &pose, to_a * hint, 0.1 * self.tolerance, 1e-3);
        let radii = self.a.radius + b.radius;
        (found.lower - radii, placed.rotation_a * found.normal)
    }

    /// The gap along a direction.
    pub(super) fn gap_along(&self, placed: &Placed, normal: DVec3) -> f64 {
        let point_a = placed.rotation_a * self.a.support(placed.rotation_a.transpose() * normal);
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

fn touch(t: f64, normal: DVec3) -> Touch {
    Touch { fraction: t as f32, normal: normal.as_vec3() }
}

impl Arc {
    fn still(motion: &Turn) -> Arc {
        Arc {
            rotation: motion.rotation.as_dquat().normalize(),
            lever: motion.lever.as_dvec3(),
            spin: DVec3::ZERO,
            rate: 0.0,
            reach: 0.0,
        }
    }

    fn of(motion: &Turn, tolerance: f64, shape: &Support) -> Arc {
        let still = Arc::still(motion);
        let Arc { rotation, lever, .. } = still;
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
        Arc { rotation, lever, spin, rate, reach }
    }

    /// The most by which the spin moves a point of the core along `normal` in a whole step [m].
    fn speed(&self, normal: DVec3) -> f64 {
        self.spin.cross(normal).length() * self.reach
    }
}
