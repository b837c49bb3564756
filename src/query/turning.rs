//! When a convex shape that moves and turns first touches another.
//!
//! Conservative advancement (Mirtich, 1996) with the separating direction of GJK. Along that direction the
//! motion of every point is bounded to second order: its velocity now is exact, and the rotation adds at most
//! half of its centripetal acceleration times the time squared. The point that comes furthest by this bound
//! is a support point, so a step is the root of a concave function, found from the safe side. Near a touch it
//! is Newton's method, and no step goes too far.

use super::advance::{Course, Touch, over_plane, overlap};
use super::penetration::{Depth, depth};
use crate::narrow_phase::{Accuracy, Simplex, Support, SupportPose, core_gap};
use glam::{DMat3, DQuat, DVec3};

/// Steps until a search gives up and calls it a touch. Fast turns past a near surface take the most.
const MAX_STEPS: usize = 256;
/// Trials of one step's length.
const TRIALS: usize = 24;

/// A motion of a shape over fractions 0..=1, in the frame that it has at the start. The pivot moves straight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    /// Displacement of the pivot [m].
    pub(super) path: DVec3,
    /// Unit axis of the rotation, and its angle [rad].
    pub(super) axis: DVec3,
    pub(super) angle: f64,
    /// The pivot in the shape's frame [m].
    pub(super) pivot: DVec3,
    /// The most that points of the core are away from the axis [m].
    pub(super) reach: f64,
}

impl Turning {
    pub(super) fn new(shape: &Support, path: DVec3, spin: DVec3, pivot: DVec3) -> Turning {
        let angle = spin.length();
        let axis = spin / angle;
        // A round shape that turns about its own axis stays as it is.
        let on_axis = axis.cross(DVec3::Y).length() < 1e-12 && pivot.with_y(0.0) == DVec3::ZERO;
        let angle = if shape.is_round() && on_axis { 0.0 } else { angle };
        Turning { path, axis, angle, pivot, reach: shape.reach(axis, DQuat::IDENTITY, -pivot) }
    }

    fn turned(&self, t: f64) -> DQuat {
        let half = 0.5 * self.angle * t;
        let v = self.axis * libm::sin(half);
        DQuat::from_xyzw(v.x, v.y, v.z, libm::cos(half))
    }

    /// Rotation and displacement of the shape's frame at a fraction.
    fn at(&self, t: f64) -> (DMat3, DVec3) {
        let turned = DMat3::from_quat(self.turned(t));
        (turned, self.pivot + self.path * t - turned * self.pivot)
    }

    /// Velocity of a point of the shape at the start, per fraction [m].
    fn velocity(&self, point: DVec3) -> DVec3 {
        self.path + (self.axis * self.angle).cross(point - self.pivot)
    }

    /// How far from the pivot the shape gets along a unit direction, however it turns [m].
    pub(super) fn swept(&self, shape: &Support, along: DVec3) -> f64 {
        let high = shape.support(self.axis).dot(self.axis) - self.axis.dot(self.pivot);
        let low = shape.support(-self.axis).dot(self.axis) - self.axis.dot(self.pivot);
        let height = high.abs().max(low.abs());
        let cosine = along.dot(self.axis);
        height * cosine.abs() + self.reach * (1.0 - cosine * cosine).max(0.0).sqrt() + shape.radius
    }
}

/// Separation of a moving shape from another one at a moment.
struct Gap {
    /// Unit, from the moving shape to the other, in the frame of the start.
    normal: DVec3,
    /// Nothing of the other shape is lower along the normal than this [m].
    height: f64,
    /// On the other's surface, in the frame of the start.
    point: DVec3,
}

/// The first touch up to the fraction `most`; see [`super::advance::first_touch`].
pub(super) fn first_touch_turning(
    a: &Support,
    b: &Support,
    pose: &SupportPose,
    hint: DVec3,
    motion: &Turning,
    course: &Course,
    most: f64,
) -> Option<Touch> {
    let accuracy = Accuracy { absolute: 0.1 * course.tolerance, relative: 1e-3 };
    let radii = a.radius + b.radius;
    let mut simplex = Simplex::empty();
    let start = core_gap(a, b, pose, hint, &mut simplex, accuracy);
    if start.overlap || start.upper <= radii {
        let Depth { point, .. } = depth(a, b, pose, &start);
        let course = Course { path: motion.velocity(point), ..*course };
        return overlap(a, b, pose, &start, &course);
    }
    let gap_at = |t: f64| {
        let (turned, moved) = motion.at(t);
        let back = turned.transpose();
        let now = SupportPose { rotation: back * pose.rotation, position: back * (pose.position - moved) };
        // The other shape turns in the moving frame, so no simplex is kept.
        let gap = core_gap(a, b, &now, back * hint, &mut Simplex::empty(), accuracy);
        if gap.overlap {
            return None;
        }
        let normal = turned * gap.normal;
        let low = pose.rotation * b.support(pose.rotation.transpose() * -normal) + pose.position;
        let point = moved + turned * (gap.point_b - gap.normal * b.radius);
        Some(Gap { normal, height: normal.dot(low) - b.radius, point })
    };
    advance(a, motion, course, most, gap_at)
}

/// [`first_touch_turning`] with the half-space below a plane.
pub(super) fn first_touch_plane_turning(
    a: &Support,
    pose: &SupportPose,
    motion: &Turning,
    course: &Course,
    most: f64,
) -> Option<Touch> {
    let (height, up, lowest) = over_plane(a, pose);
    if height <= 0.0 {
        let stays = !course.skip_inside || motion.velocity(lowest).dot(up) < 0.0;
        let point = lowest - up * height;
        return stays.then_some(Touch { fraction: 0.0, normal: -up, point, depth: -height });
    }
    advance(a, motion, course, most, |t| {
        let (turned, moved) = motion.at(t);
        let down = turned.transpose() * -up;
        let lowest = moved + turned * a.support(down) - up * a.radius;
        let point = lowest - up * up.dot(lowest - pose.position);
        Some(Gap { normal: -up, height: -up.dot(pose.position), point })
    })
}

/// Advances from gap to gap. `gap_at`: the gap at a fraction, none if the cores overlap there by rounding.
fn advance(
    a: &Support,
    motion: &Turning,
    course: &Course,
    most: f64,
    mut gap_at: impl FnMut(f64) -> Option<Gap>,
) -> Option<Touch> {
    let mut t = 0.0;
    let mut found = None;
    for _ in 0..MAX_STEPS {
        let Some(gap) = gap_at(t) else { break };
        let bound = Bound::new(a, motion, &gap, t);
        let allowance = bound.gap(0.0);
        // The gap stays open to the end of the path.
        if bound.gap(1.0 - t) > 0.0 && allowance > 0.0 {
            return None;
        }
        let touch = Touch { fraction: t, normal: gap.normal, point: gap.point, depth: 0.0 };
        if allowance <= 0.0 || (allowance <= course.tolerance && bound.closing() > 0.0) {
            return Some(touch);
        }
        // Aims at half of the tolerance, so that it is reached in finitely many steps.
        t += bound.step(0.5 * course.tolerance.min(allowance), 1.0 - t);
        if t > most {
            return None;
        }
        found = Some(touch);
    }
    found.map(|touch| Touch { fraction: t, ..touch })
}

/// A lower bound of the gap along a fixed direction, after a further fraction of the motion: concave.
struct Bound<'a> {
    a: &'a Support<'a>,
    motion: &'a Turning,
    /// Into the shape's frame at the moment.
    back: DMat3,
    normal: DVec3,
    /// Spin across the normal: n × ω.
    across: DVec3,
    /// Height of the other shape over the pivot along the normal, less the radius [m].
    height: f64,
    /// How fast the pivot closes in, and the most that points may accelerate along the normal [m].
    closing: f64,
    bend: f64,
}

impl<'a> Bound<'a> {
    fn new(a: &'a Support<'a>, motion: &'a Turning, gap: &Gap, t: f64) -> Bound<'a> {
        let normal = gap.normal;
        let across = normal.cross(motion.axis) * motion.angle;
        Bound {
            a,
            motion,
            back: motion.at(t).0.transpose(),
            normal,
            across,
            height: gap.height - a.radius - normal.dot(motion.pivot + motion.path * t),
            closing: normal.dot(motion.path),
            bend: 0.5 * across.length() * motion.angle * motion.reach,
        }
    }

    /// The bound after a further fraction [m].
    fn gap(&self, more: f64) -> f64 {
        let d = self.back * (self.normal + self.across * more);
        let furthest = (self.a.support(d) - self.motion.pivot).dot(d);
        self.height - self.closing * more - furthest - self.bend * more * more
    }

    /// How fast the gap closes now, per fraction [m].
    fn closing(&self) -> f64 {
        let furthest = self.a.support(self.back * self.normal) - self.motion.pivot;
        self.closing + furthest.dot(self.back * self.across)
    }

    /// How far the motion may go on, at most by `left`, until the bound is down to `target` [m].
    fn step(&self, target: f64, left: f64) -> f64 {
        let (mut low, mut high) = (0.0, left);
        let (mut above, mut below) = (self.gap(0.0) - target, self.gap(left) - target);
        if below >= 0.0 {
            return left;
        }
        for i in 0..TRIALS {
            // A concave function is above its chords, so their roots are safe; halves bring the other end in.
            let chord = low + (high - low) * (above / (above - below));
            let middle = if i % 2 == 0 { chord } else { 0.5 * (low + high) };
            let value = self.gap(middle) - target;
            if value >= 0.0 {
                (low, above) = (middle, value);
            } else {
                (high, below) = (middle, value);
            }
            if high - low <= 1e-3 * low || above <= 1e-3 * target {
                break;
            }
        }
        low
    }
}
