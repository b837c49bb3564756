//! Contact reduction: a few points that have the effect of many.
//!
//! Points of a pair of bodies are clustered by normals and positions (k-means, iterated until no point
//! changes its cluster; Moravánszky and Terdiman, *Fast contact reduction for dynamics simulation*, 2004).
//! Each cluster is projected onto its plane, and the corners of its convex hull are kept, or four of them,
//! which the engine's own reduction chooses. By the equivalence principle of rigid bodies, points inside the
//! hull of others change nothing: any wrench of theirs can come from the corners. So motion stays the same
//! after a reduction to the whole hull, but maybe not after a further one (`docs/methods.md` says by how
//! much).

#[cfg(test)]
mod comparison;
mod loss;

pub use loss::Loss;

use crate::methods::{Effort, Solution, admm};
use crate::problem::{Law, Matrix, Problem};
use backstop::observe::kept_points;
use glam::{DMat3, DVec3};

/// A point at which two bodies touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Position from the centre of mass of the body that is pushed [m].
    pub position: DVec3,
    /// The direction in which it is pushed; a unit vector.
    pub normal: DVec3,
    /// Overlap [m]; negative: they are apart.
    pub depth: f64,
}

/// Normals that are nearer than this to one of a cluster belong to it: the chord of 5 degrees.
const SAME: f64 = 0.0872;
/// The most clusters.
const CLUSTERS: usize = 4;
/// As many points as the engine leaves.
const ENGINE: usize = 4;
/// The most rounds of k-means, in case two equally good clusterings alternate.
const ROUNDS: usize = 100;

/// Which points of a cluster are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// All corners of its convex hull, and the deepest point.
    Hull,
    /// At most so many, in 1..=4.
    Most(usize),
}

/// The points to keep of each cluster, by their indices in ascending order. The deepest of a cluster is
/// always among them, or one as deep to 1e-4 of its extent. Points that are not finite are left out.
pub fn reduce(points: &[Point], keep: Keep) -> Vec<usize> {
    let sound = |&i: &usize| {
        let point = &points[i];
        point.position.is_finite() && point.normal.is_finite() && point.depth.is_finite()
    };
    let all: Vec<usize> = (0..points.len()).filter(sound).collect();
    let mut kept: Vec<usize> = Vec::new();
    for cluster in clusters(points, &all) {
        kept.extend(reduce_cluster(points, &cluster, keep));
    }
    kept.sort_unstable();
    kept
}

/// Clusters of points that push the same way.
fn clusters(points: &[Point], all: &[usize]) -> Vec<Vec<usize>> {
    let Some(&first) =
        all.iter().max_by(|&&a, &&b| points[a].depth.total_cmp(&points[b].depth).then(b.cmp(&a)))
    else {
        return Vec::new();
    };
    let size =
        all.iter().map(|&i| (points[i].position - points[first].position).length()).fold(1e-12, f64::max);
    // Positions separate clusters whose normals hardly differ.
    let feature = |i: usize| (points[i].normal, points[i].position * (SAME / size));
    let distance =
        |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0 - b.0).length_squared() + (a.1 - b.1).length_squared();
    let mut centres = vec![feature(first)];
    while centres.len() < CLUSTERS {
        // The point that is furthest from all seeds; the first seed is the deepest point.
        let apart = |i: usize| {
            centres.iter().map(|c| (c.0 - points[i].normal).length()).fold(f64::INFINITY, f64::min)
        };
        let far = all
            .iter()
            .map(|&i| (apart(i), i))
            .fold((0.0, first), |best, one| if one.0 > best.0 { one } else { best });
        if far.0 <= SAME {
            break;
        }
        centres.push(feature(far.1));
    }
    let nearest = |i: usize, centres: &[(DVec3, DVec3)]| {
        let own = feature(i);
        let of = |k: usize| distance(own, centres[k]);
        (0..centres.len()).fold(0, |best, k| if of(k) < of(best) { k } else { best })
    };
    let mut own: Vec<usize> = all.iter().map(|&i| nearest(i, &centres)).collect();
    for _ in 0..ROUNDS {
        for (k, centre) in centres.iter_mut().enumerate() {
            let members = || all.iter().zip(&own).filter(move |(_, of)| **of == k).map(|(&i, _)| feature(i));
            let count = members().count();
            if count > 0 {
                let sum = members().fold((DVec3::ZERO, DVec3::ZERO), |s, f| (s.0 + f.0, s.1 + f.1));
                *centre = (sum.0 / count as f64, sum.1 / count as f64);
            }
        }
        let next: Vec<usize> = all.iter().map(|&i| nearest(i, &centres)).collect();
        if std::mem::replace(&mut own, next) == own {
            break;
        }
    }
    let of = |k: usize| all.iter().zip(&own).filter(|(_, own)| **own == k).map(|(&i, _)| i).collect();
    (0..centres.len()).map(of).filter(|cluster: &Vec<usize>| !cluster.is_empty()).collect()
}

/// The corners of a cluster's hull and its deepest point, or the best of them.
fn reduce_cluster(points: &[Point], cluster: &[usize], keep: Keep) -> Vec<usize> {
    let normal: DVec3 = cluster.iter().map(|&i| points[i].normal).sum();
    let normal = normal.try_normalize().unwrap_or(DVec3::Y);
    let plane = normal.any_orthonormal_pair();
    let mut corners = hull(cluster.iter().map(|&i| (flat(&points[i], plane), i)).collect());
    // Of points as deep as each other a corner.
    let deepest = corners
        .iter()
        .chain(cluster)
        .copied()
        .fold(corners[0], |best, i| if points[i].depth > points[best].depth { i } else { best });
    if !corners.contains(&deepest) {
        corners.push(deepest);
    }
    let most = match keep {
        Keep::Hull => return corners,
        Keep::Most(most) => most.max(1),
    };
    if corners.len() > ENGINE {
        let raw = |&i: &usize| (points[i].position.as_vec3(), -points[i].depth as f32);
        let all: Vec<_> = corners.iter().map(raw).collect();
        corners = kept_points(&all, normal.as_vec3()).into_iter().map(|k| corners[k]).collect();
    }
    while corners.len() > most {
        let without = |k: usize| {
            let left = corners.iter().enumerate().filter(|&(i, _)| i != k);
            spread(&left.map(|(_, &i)| flat(&points[i], plane)).collect::<Vec<_>>())
        };
        let able = (0..corners.len()).filter(|&k| corners[k] != deepest);
        let Some(gone) = able.max_by(|&a, &b| without(a).total_cmp(&without(b)).then(b.cmp(&a))) else {
            break;
        };
        corners.remove(gone);
    }
    corners
}

/// Of three points twice their area, of two their distance.
fn spread(points: &[[f64; 2]]) -> f64 {
    match *points {
        [a, b, c] => turn(a, b, c).abs(),
        [a, b] => (b[0] - a[0]).hypot(b[1] - a[1]),
        _ => 0.0,
    }
}

/// Its place on a plane.
fn flat(point: &Point, (x, y): (DVec3, DVec3)) -> [f64; 2] {
    [point.position.dot(x), point.position.dot(y)]
}

/// Twice the area of a triangle, positive if it goes round anticlockwise.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Corners of the convex hull in order; points on its edges are not corners (Andrew 1979).
fn hull(mut points: Vec<([f64; 2], usize)>) -> Vec<usize> {
    points.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]).then(a.0[1].total_cmp(&b.0[1])).then(a.1.cmp(&b.1)));
    points.dedup_by(|a, b| a.0 == b.0);
    if points.len() < 3 {
        return points.into_iter().map(|(_, i)| i).collect();
    }
    let chain = |points: &mut dyn Iterator<Item = ([f64; 2], usize)>| {
        let mut out: Vec<([f64; 2], usize)> = Vec::new();
        for point in points {
            while let [.., a, b] = out.as_slice()
                && turn(a.0, b.0, point.0) <= 0.0
            {
                out.pop();
            }
            out.push(point);
        }
        out.pop();
        out
    };
    let mut lower = chain(&mut points.iter().copied());
    lower.extend(chain(&mut points.iter().rev().copied()));
    lower.into_iter().map(|(_, i)| i).collect()
}

/// A rigid body that meets something fixed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Mass [kg].
    pub mass: f64,
    /// Inertia about the centre of mass [kg m²].
    pub inertia: DMat3,
    /// Linear velocity of the centre of mass [m/s] and angular velocity [rad/s].
    pub velocity: [DVec3; 2],
    /// Coulomb's coefficient of friction.
    pub friction: f64,
}

impl Impact {
    /// Velocities after the impact, at which no point approaches, and the solution, to 1e-12.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn resolve(&self, points: &[Point]) -> Result<([DVec3; 2], Solution), backstop::Error> {
        let rows = 3 * points.len();
        let mut j: Vec<[DVec3; 2]> = Vec::with_capacity(rows);
        for point in points {
            let (t, s) = point.normal.any_orthonormal_pair();
            j.extend([point.normal, t, s].map(|d| [d, point.position.cross(d)]));
        }
        let inverse = self.inertia.inverse();
        let entry =
            |a: usize, b: usize| (a, b, j[a][0].dot(j[b][0]) / self.mass + j[a][1].dot(inverse * j[b][1]));
        let entries = (0..rows).flat_map(|a| (0..rows).map(move |b| (a, b)));
        let w = Matrix::from_entries(rows, entries.map(|(a, b)| entry(a, b)));
        let [v, spin] = self.velocity;
        let q = j.iter().map(|[linear, angular]| linear.dot(v) + angular.dot(spin)).collect();
        let problem = Problem::new(vec![Law::Contact { mu: self.friction }; points.len()], w, q)?;
        let solution = admm(&problem, &Effort { tolerance: 1e-12, ..Effort::default() });
        let (mut p, mut l) = (DVec3::ZERO, DVec3::ZERO);
        for ([linear, angular], r) in j.iter().zip(&solution.r) {
            p += *linear * *r;
            l += *angular * *r;
        }
        Ok(([v + p / self.mass, spin + inverse * l], solution))
    }
}

#[cfg(test)]
mod tests;
