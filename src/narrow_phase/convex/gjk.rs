//! Distance of two convex shapes.
//!
//! Gilbert, Johnson and Keerthi (1988) on cores with a radius: the point of b - a nearest to the origin, by
//! way of simplices (van den Bergen, *Collision Detection in Interactive 3D Environments*, 2003). Each
//! direction tried also gives a *lower* bound: no point of b is nearer to a along it. The search ends when
//! the two bounds meet, and a cast steps by the lower one, so that its answer never hangs on how far a search
//! got.

use super::simplex::Simplex;
use crate::narrow_phase::Relative;
use crate::shape::support::{Pose, Support};
use glam::{DVec3, Vec3};

/// Round shapes close in on the rim step by step; polytopes need a handful.
const MAX_ITERATIONS: usize = 32;

/// How far two shapes are apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closest {
    /// Between the surfaces [m]: below zero where only the radii overlap. If the cores overlap, minus the
    /// radii, and the normal is a mere guess.
    pub(crate) distance: f32,
    /// Unit, from a to b, in a's frame.
    pub(crate) normal: Vec3,
    /// On the surface of a and of b, in a's frame.
    #[allow(dead_code, reason = "tests check the answer by it; closest-point queries will return it")]
    pub(crate) point_a: Vec3,
    pub(crate) point_b: Vec3,
    /// Whether the cores overlap (touch, within rounding).
    pub(crate) overlap: bool,
}

/// Distance, normal and nearest points. `hint`: about the direction from a to b, zero if unknown; a good one
/// saves a step or two.
pub(crate) fn distance(a: &Support, b: &Support, rel: &Relative, hint: Vec3) -> Closest {
    let accuracy = Accuracy { absolute: 0.0, relative: 1e-7 };
    let gap = core_gap(a, b, &rel.exact(), hint.as_dvec3(), &mut Simplex::empty(), accuracy);
    let radii = a.radius + b.radius;
    Closest {
        distance: (if gap.overlap { -radii } else { gap.upper - radii }) as f32,
        normal: gap.normal.as_vec3(),
        point_a: (gap.point_a + gap.normal * a.radius).as_vec3(),
        point_b: (gap.point_b - gap.normal * b.radius).as_vec3(),
        overlap: gap.overlap,
    }
}

/// Known bounds of the distance of two cores.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoreGap {
    /// Unit, from a to b, in a's frame.
    pub(crate) normal: DVec3,
    /// No point of b's core is nearer to a's along the normal [m].
    pub(crate) lower: f64,
    /// The nearest points found are this far apart [m].
    pub(crate) upper: f64,
    /// The nearest points found on the cores, in a's frame.
    pub(crate) point_a: DVec3,
    pub(crate) point_b: DVec3,
    /// Whether the cores overlap; then both bounds are zero and the normal is the last one tried.
    pub(crate) overlap: bool,
}

impl CoreGap {
    fn overlapping(normal: DVec3, point: DVec3) -> CoreGap {
        CoreGap { normal, lower: 0.0, upper: 0.0, point_a: point, point_b: point, overlap: true }
    }
}

/// How close the bounds of a distance have to be for a search to end: either suffices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accuracy {
    /// [m]
    pub(crate) absolute: f64,
    /// Share of the distance of the surfaces.
    pub(crate) relative: f64,
}

/// Start of a search.
enum Start {
    /// A direction that is likely to be near the normal.
    Guess(DVec3),
    /// A direction that separates the shapes: it stays the normal unless a better one is found.
    Separating(DVec3),
}

/// Searches for the distance of two cores. `simplex`: that of an earlier search of the same shapes, after
/// which they may have moved, or empty; then the search begins along `hint`.
pub(crate) fn core_gap(
    a: &Support,
    b: &Support,
    pose: &Pose,
    hint: DVec3,
    simplex: &mut Simplex,
    accuracy: Accuracy,
) -> CoreGap {
    let guess = [hint, pose.position].into_iter().find(|d| d.length_squared() > 0.0);
    let normal = guess.unwrap_or(DVec3::X).normalize_or(DVec3::X);
    search(a, b, pose, Start::Guess(normal), simplex, accuracy)
}

/// As [`core_gap`], for two shapes that the unit vector `normal` is known to separate: it stays the answer
/// unless another one beats it by more than `accuracy` [m].
pub(crate) fn gap_from(a: &Support, b: &Support, pose: &Pose, normal: DVec3, accuracy: f64) -> CoreGap {
    let accuracy = Accuracy { absolute: accuracy, relative: 0.0 };
    search(a, b, pose, Start::Separating(normal), &mut Simplex::empty(), accuracy)
}

fn search(
    a: &Support,
    b: &Support,
    pose: &Pose,
    start: Start,
    simplex: &mut Simplex,
    accuracy: Accuracy,
) -> CoreGap {
    let (Start::Guess(mut normal) | Start::Separating(mut normal)) = start;
    let radii = a.radius + b.radius;
    let to_b = pose.rotation.transpose();
    // The point of b - a that is nearest along `d`, with its parts on a and on b.
    let lowest = |d: DVec3| {
        let (on_a, on_b) = (a.support(d), b.support(to_b * -d));
        (pose.rotation * on_b + pose.position - on_a, on_a, on_b)
    };
    simplex.place(pose);
    let mut lower = f64::NEG_INFINITY;
    if simplex.count == 0 {
        let (first, on_a, on_b) = lowest(normal);
        simplex.push(first, on_a, on_b);
        if matches!(start, Start::Separating(_)) {
            lower = first.dot(normal);
        }
    }
    // The farthest that b - a has shown so far: values that are small against it are rounding.
    let mut size = simplex.size_squared();
    let Some(first) = simplex.nearest() else {
        return CoreGap::overlapping(normal, simplex.point_a());
    };
    simplex.keep(&first);
    let mut nearest = first.point;
    for _ in 0..MAX_ITERATIONS {
        let squared = nearest.length_squared();
        if squared <= 1e-24 * size {
            return CoreGap::overlapping(normal, simplex.point_a());
        }
        let length = squared.sqrt();
        let direction = nearest / length;
        let (point, on_a, on_b) = lowest(direction);
        let bound = point.dot(direction);
        if bound > lower {
            (lower, normal) = (bound, direction);
        }
        size = size.max(point.length_squared());
        let enough = (accuracy.relative * (length - radii)).max(accuracy.absolute).max(1e-9 * size.sqrt());
        if length - lower <= enough || simplex.contains(point) {
            break;
        }
        simplex.push(point, on_a, on_b);
        let Some(next) = simplex.nearest() else {
            simplex.pop();
            return CoreGap::overlapping(normal, simplex.point_a());
        };
        // No nearer: rounding has the last word.
        if next.point.length_squared() >= squared {
            simplex.pop();
            break;
        }
        simplex.keep(&next);
        nearest = next.point;
    }
    let upper = nearest.length();
    let point_a = simplex.point_a();
    CoreGap { normal, lower: lower.min(upper), upper, point_a, point_b: point_a + nearest, overlap: false }
}

#[cfg(test)]
mod tests;
