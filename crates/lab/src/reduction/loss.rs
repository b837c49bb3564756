//! What a reduction loses.
//!
//! Impulses at points of a plane along its normal are one impulse at their centre of pressure, which can be
//! anywhere in the convex hull of the points. Hence the torque that they can resist about an axis in the
//! plane is the impulse times how far the hull reaches across that axis.

use super::{Point, flat, hull, turn};
use glam::DVec3;

/// Directions in which the reach is measured.
const DIRECTIONS: u32 = 360;

/// What some points of a plane are worth beside all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    /// Area of their convex hull, as a share of that of all.
    pub area: f64,
    /// How far their hull reaches from the centroid of the hull of all, as a share of how far that reaches:
    /// of all directions the least. It is the share of torque that they resist; negative where the centroid
    /// is outside of their hull.
    pub reach: f64,
    /// Its mean over all directions.
    pub mean_reach: f64,
    /// Distance from their hull to the centre of pressure of all points if each presses by its depth, as a
    /// share of the greatest reach: if it is not zero, they can't bear a load that all bear.
    pub outside: f64,
}

impl Loss {
    /// What the points `kept` of a plane with this normal are worth. None if all points are on a line.
    pub fn new(points: &[Point], kept: &[usize], normal: DVec3) -> Option<Loss> {
        let plane = normal.try_normalize()?.any_orthonormal_pair();
        let at = |i: usize| flat(&points[i], plane);
        let corners = |of: &mut dyn Iterator<Item = usize>| -> Vec<[f64; 2]> {
            hull(of.map(|i| (at(i), i)).collect()).into_iter().map(at).collect()
        };
        let (all, some) = (corners(&mut (0..points.len())), corners(&mut kept.iter().copied()));
        let (whole, centre) = area_and_centroid(&all)?;
        let reach = |of: &[[f64; 2]], d: [f64; 2]| {
            of.iter().map(|p| (p[0] - centre[0]) * d[0] + (p[1] - centre[1]) * d[1]).fold(f64::MIN, f64::max)
        };
        let (mut least, mut sum, mut most) = (f64::INFINITY, 0.0, 0.0_f64);
        for k in 0..DIRECTIONS {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / f64::from(DIRECTIONS));
            let (of_all, of_some) = (reach(&all, [cos, sin]), reach(&some, [cos, sin]));
            least = least.min(of_some / of_all);
            sum += of_some / of_all;
            most = most.max(of_all);
        }
        let press: f64 = points.iter().map(|point| point.depth.max(0.0)).sum();
        let pressure = |k: usize| {
            let moment = points.iter().enumerate().map(|(i, point)| point.depth.max(0.0) * at(i)[k]);
            if press > 0.0 { moment.sum::<f64>() / press } else { centre[k] }
        };
        Some(Loss {
            area: area_and_centroid(&some).map_or(0.0, |some| some.0 / whole),
            reach: least,
            mean_reach: sum / f64::from(DIRECTIONS),
            outside: distance(&some, [0, 1].map(pressure)) / most,
        })
    }
}

/// Of a convex polygon whose corners go round anticlockwise; none if it has no area.
fn area_and_centroid(corners: &[[f64; 2]]) -> Option<(f64, [f64; 2])> {
    let first = *corners.first()?;
    let (mut twice, mut moment) = (0.0, [0.0; 2]);
    for pair in corners.windows(2) {
        let area = turn(first, pair[0], pair[1]);
        twice += area;
        for k in 0..2 {
            moment[k] += area * (first[k] + pair[0][k] + pair[1][k]) / 3.0;
        }
    }
    (twice > 0.0).then(|| (0.5 * twice, moment.map(|m| m / twice)))
}

/// From a convex polygon to a point; zero inside.
fn distance(corners: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let sides = || (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
    if corners.len() > 2 && sides().all(|(a, b)| turn(a, b, p) >= 0.0) {
        return 0.0;
    }
    let from_side = |(a, b): ([f64; 2], [f64; 2])| {
        let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        let size = along[0] * along[0] + along[1] * along[1];
        let t = if size > 0.0 { ((to[0] * along[0] + to[1] * along[1]) / size).clamp(0.0, 1.0) } else { 0.0 };
        (to[0] - t * along[0]).hypot(to[1] - t * along[1])
    };
    sides().map(from_side).fold(f64::INFINITY, f64::min)
}
