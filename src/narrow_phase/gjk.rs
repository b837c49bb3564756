//! Distance of two convex shapes.
//!
//! Gilbert, Johnson and Keerthi (1988) on cores with a radius: the point of b - a nearest to the origin, by way of
//! simplices (van den Bergen, *Collision Detection in Interactive 3D Environments*, 2003). Each direction tried also
//! gives a *lower* bound: no point of b is nearer to a along it. The search ends when the two bounds meet, and a cast
//! steps by the lower one, so that its answer never hangs on how far a search got.

use super::Relative;
use super::simplex::Simplex;
use super::support::{Pose, Support};
use glam::{DMat3, DVec3, Vec3};

/// Round shapes close in on the rim step by step; polytopes need a handful.
const MAX_ITERATIONS: usize = 32;

/// How far two shapes are apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closest {
    /// Between the surfaces [m]: below zero where only the radii overlap. If the cores overlap, minus the radii, and
    /// the normal is a mere guess.
    pub(crate) distance: f32,
    /// Unit, from a to b, in a's frame.
    pub(crate) normal: Vec3,
    /// On the surface of a and of b, in a's frame.
    pub(crate) point_a: Vec3,
    pub(crate) point_b: Vec3,
    /// Whether the cores overlap (touch, within rounding).
    pub(crate) overlap: bool,
}

/// Distance, normal and nearest points. `hint`: about the direction from a to b, zero if unknown; a good one saves
/// a step or two.
pub(crate) fn distance(a: &Support, b: &Support, rel: &Relative, hint: Vec3) -> Closest {
    let pose = Pose {
        rotation: DMat3::from_quat(rel.rotation.as_dquat().normalize()),
        position: rel.position.as_dvec3(),
    };
    let gap = core_gap(a, b, &pose, hint.as_dvec3(), 0.0, 1e-7);
    let radii = a.radius + b.radius;
    Closest {
        distance: (if gap.overlap { -radii } else { gap.upper - radii }) as f32,
        normal: gap.normal.as_vec3(),
        point_a: (gap.point_a + gap.normal * a.radius).as_vec3(),
        point_b: (gap.point_b - gap.normal * b.radius).as_vec3(),
        overlap: gap.overlap,
    }
}

/// What is known of the distance of two cores.
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

/// Searches until the bounds are within `accuracy` [m] of each other, or within the share `relative` of the distance
/// of the surfaces.
pub(crate) fn core_gap(
    a: &Support,
    b: &Support,
    pose: &Pose,
    hint: DVec3,
    accuracy: f64,
    relative: f64,
) -> CoreGap {
    let radii = a.radius + b.radius;
    let to_b = pose.rotation.transpose();
    // The point of b - a that is nearest along `d`, with its part on a.
    let lowest = |d: DVec3| {
        let on_a = a.support(d);
        (pose.rotation * b.support(to_b * -d) + pose.position - on_a, on_a)
    };
    let start = [hint, pose.position, DVec3::X].into_iter().find(|d| d.length_squared() > 0.0);
    let mut direction = start.unwrap_or(DVec3::X).normalize_or(DVec3::X);
    let (first, on_a) = lowest(direction);
    let mut simplex = Simplex::of(first, on_a);
    let mut nearest = first;
    // The farthest that the b - a has shown so far: what is small against it is rounding.
    let mut size = first.length_squared();
    let mut lower = f64::NEG_INFINITY;
    let mut normal = direction;
    for _ in 0..MAX_ITERATIONS {
        let squared = nearest.length_squared();
        if squared <= 1e-24 * size {
            return CoreGap::overlapping(normal, simplex.point_a());
        }
        let length = squared.sqrt();
        direction = nearest / length;
        let (point, on_a) = lowest(direction);
        let bound = point.dot(direction);
        if bound > lower {
            (lower, normal) = (bound, direction);
        }
        let enough = (relative * (length - radii)).max(accuracy).max(1e-9 * size.sqrt());
        if length - lower <= enough || simplex.contains(point) {
            break;
        }
        size = size.max(point.length_squared());
        let before = simplex;
        simplex.push(point, on_a);
        let Some(next) = simplex.reduce() else {
            return CoreGap::overlapping(normal, before.point_a());
        };
        // No nearer: rounding has the last word.
        if next.length_squared() >= squared {
            simplex = before;
            break;
        }
        nearest = next;
    }
    let upper = nearest.length();
    let point_a = simplex.point_a();
    CoreGap { normal, lower: lower.min(upper), upper, point_a, point_b: point_a + nearest, overlap: false }
}
