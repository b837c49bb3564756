//! When a convex shape that moves straight ahead first touches another, and how deep it is in it at the
//! start.
//!
//! Without rotation the gap along a fixed direction shrinks evenly, so conservative advancement (Mirtich,
//! 1996) with the separating direction of GJK is Newton's method from the safe side: it converges in a few
//! steps, and never steps too far. It differs from the search of `narrow_phase/cast` in its definition of a
//! touch and in its answer (docs/decisions/advancement.md).

use super::penetration::{Depth, depth};
use crate::narrow_phase::{Accuracy, CoreGap, Simplex, Support, SupportPose, core_gap};
use glam::DVec3;

/// Steps until a search gives up and calls it a touch. Paths that graze take the most, about twenty.
const MAX_STEPS: usize = 64;

/// Where two shapes first touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// Fraction of the path, 0..=1; a little early, never late.
    pub(super) fraction: f64,
    /// Unit, from the moving shape to the other, in the moving one's frame.
    pub(super) normal: DVec3,
    /// On the other's surface, in the frame that the moving one has at the start.
    pub(super) point: DVec3,
    /// How far they overlap at the start [m]; zero if they don't.
    pub(super) depth: f64,
}

/// The input of a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    /// Path of the moving shape, in its frame [m].
    pub(super) path: DVec3,
    /// Gaps up to this size are touches [m].
    pub(super) tolerance: f64,
    /// Ignore an overlap at the start if the path leads out of it.
    pub(super) skip_inside: bool,
}

/// The first touch up to the fraction `most`, which has no other influence on it. `pose`: of b in a's frame
/// at the start; `hint`: about the direction from a to b.
pub(super) fn first_touch(
    a: &Support,
    b: &Support,
    pose: &SupportPose,
    hint: DVec3,
    course: &Course,
    most: f64,
) -> Option<Touch> {
    let radii = a.radius + b.radius;
    let (mut pose, start) = (*pose, pose.position);
    let mut simplex = Simplex::empty();
    let mut t = 0.0;
    let mut found = None;
    for step in 0..MAX_STEPS {
        let accuracy = Accuracy { absolute: 0.1 * course.tolerance, relative: 1e-3 };
        let gap = core_gap(a, b, &pose, hint, &mut simplex, accuracy);
        if step == 0 && (gap.overlap || gap.upper <= radii) {
            return overlap(a, b, &pose, &gap, course);
        }
        let touch = Touch {
            fraction: t,
            normal: gap.normal,
            point: gap.point_b - gap.normal * b.radius + course.path * t,
            depth: 0.0,
        };
        let allowance = gap.lower - radii;
        let closing = course.path.dot(gap.normal);
        // The gap stays open to the end of the path.
        if closing <= 0.0 || t + allowance / closing > 1.0 {
            return None;
        }
        if allowance <= course.tolerance {
            return Some(touch);
        }
        // Aims at half of the tolerance, so that it is reached in finitely many steps.
        t += (allowance - 0.5 * course.tolerance) / closing;
        if t > most {
            return None;
        }
        pose.position = start - course.path * t;
        found = Some(touch);
    }
    found.map(|touch| Touch { fraction: t, ..touch })
}

/// An overlap at the start.
pub(super) fn overlap(
    a: &Support,
    b: &Support,
    pose: &SupportPose,
    gap: &CoreGap,
    course: &Course,
) -> Option<Touch> {
    let Depth { depth, normal, point } = depth(a, b, pose, gap);
    let stays = !course.skip_inside || course.path.dot(normal) > 0.0;
    stays.then_some(Touch { fraction: 0.0, normal, point, depth })
}

/// Whether two shapes overlap or touch.
pub(super) fn overlaps(a: &Support, b: &Support, pose: &SupportPose, hint: DVec3) -> bool {
    let radii = a.radius + b.radius;
    let accuracy = Accuracy { absolute: 1e-9, relative: 1e-6 };
    let gap = core_gap(a, b, pose, hint, &mut Simplex::empty(), accuracy);
    gap.overlap || gap.upper <= radii
}

/// Height of the lowest point of a over the plane through the origin of b's frame, whose normal is b's y
/// axis; with the normal and that point, in a's frame.
pub(super) fn over_plane(a: &Support, pose: &SupportPose) -> (f64, DVec3, DVec3) {
    let up = pose.rotation.y_axis;
    let lowest = a.support(-up) - up * a.radius;
    (up.dot(lowest - pose.position), up, lowest)
}

/// [`first_touch`] with the half-space below a plane.
pub(super) fn first_touch_plane(
    a: &Support,
    pose: &SupportPose,
    course: &Course,
    most: f64,
) -> Option<Touch> {
    let (height, up, lowest) = over_plane(a, pose);
    let closing = -up.dot(course.path);
    if height <= 0.0 {
        let stays = !course.skip_inside || closing > 0.0;
        let point = lowest - up * height;
        return stays.then_some(Touch { fraction: 0.0, normal: -up, point, depth: -height });
    }
    let t = ((height - 0.5 * course.tolerance) / closing).max(0.0);
    (closing > 0.0 && height / closing <= 1.0 && t <= most).then(|| {
        let point = lowest + course.path * t;
        Touch { fraction: t, normal: -up, point: point - up * up.dot(point - pose.position), depth: 0.0 }
    })
}
