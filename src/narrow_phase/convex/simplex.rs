//! The point of a simplex that is nearest to the origin: the inner step of
//! [`gjk`](crate::narrow_phase::convex::gjk).
//!
//! By Voronoi regions (Ericson, *Real-Time Collision Detection*, 5.1), but where several features may be the
//! nearest all of them are worked out and compared, rather than one decision after the other, where a wrong
//! turn on a sliver can't be taken back. The newest corner comes last, and any nearer point has it among its
//! corners.

use crate::shape::support::Pose;
use glam::{DVec3, Vec3};

/// Up to four points of b - a, in a's frame, with the points of a and b that they came from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simplex {
    pub(crate) count: usize,
    points: [DVec3; 4],
    /// In a's and in b's frame: of any pose, the same corners make a simplex.
    on_a: [DVec3; 4],
    on_b: [DVec3; 4],
    /// Weights of the nearest point, after [`Self::keep`].
    weights: [f64; 3],
}

/// The nearest point of one feature: up to three corners and their weights.
#[derive(Clone, Copy)]
pub(crate) struct Nearest {
    pub(crate) point: DVec3,
    count: usize,
    corners: [usize; 3],
    weights: [f64; 3],
}

impl Simplex {
    pub(crate) fn empty() -> Simplex {
        let zero = [DVec3::ZERO; 4];
        Simplex { count: 0, points: zero, on_a: zero, on_b: zero, weights: [1.0, 0.0, 0.0] }
    }

    /// The same corners after the shapes have moved.
    pub(crate) fn place(&mut self, pose: &Pose) {
        for i in 0..self.count {
            self.points[i] = pose.rotation * self.on_b[i] + pose.position - self.on_a[i];
        }
    }

    /// The longest of the points, squared.
    pub(crate) fn size_squared(&self) -> f64 {
        self.points[..self.count].iter().fold(0.0, |most, p| p.length_squared().max(most))
    }

    pub(crate) fn contains(&self, point: DVec3) -> bool {
        self.points[..self.count].contains(&point)
    }

    pub(crate) fn push(&mut self, point: DVec3, on_a: DVec3, on_b: DVec3) {
        self.points[self.count] = point;
        self.on_a[self.count] = on_a;
        self.on_b[self.count] = on_b;
        self.count += 1;
    }

    /// Takes back the last push.
    pub(crate) fn pop(&mut self) {
        self.count -= 1;
    }

    /// The feature nearest to the origin. None: the origin is inside.
    pub(crate) fn nearest(&self) -> Option<Nearest> {
        match self.count {
            1 => Some(Nearest { point: self.points[0], count: 1, corners: [0; 3], weights: [1.0, 0.0, 0.0] }),
            2 => Some(self.on_edge(0, 1)),
            3 => Some(self.on_triangle([0, 1, 2], self.normal([0, 1, 2]))),
            _ => self.on_tetrahedron(),
        }
    }

    /// Lets go of the corners that are not of this feature.
    pub(crate) fn keep(&mut self, nearest: &Nearest) {
        let at = nearest.corners;
        let points = at.map(|i| self.points[i]);
        let on_a = at.map(|i| self.on_a[i]);
        let on_b = at.map(|i| self.on_b[i]);
        self.points[..3].copy_from_slice(&points);
        self.on_a[..3].copy_from_slice(&on_a);
        self.on_b[..3].copy_from_slice(&on_b);
        self.weights = nearest.weights;
        self.count = nearest.count;
    }

    /// The nearest point's partner on a.
    pub(crate) fn point_a(&self) -> DVec3 {
        (0..self.count).fold(DVec3::ZERO, |sum, i| sum + self.on_a[i] * self.weights[i])
    }

    fn on_edge(&self, i: usize, j: usize) -> Nearest {
        let (p, q) = (self.points[i], self.points[j]);
        let edge = q - p;
        let (along, whole) = (-p.dot(edge), edge.dot(edge));
        if along <= 0.0 || whole == 0.0 {
            return Nearest { point: p, count: 1, corners: [i, i, i], weights: [1.0, 0.0, 0.0] };
        }
        if along >= whole {
            return Nearest { point: q, count: 1, corners: [j, j, j], weights: [1.0, 0.0, 0.0] };
        }
        let t = along / whole;
        Nearest { point: p + edge * t, count: 2, corners: [i, j, j], weights: [1.0 - t, t, 0.0] }
    }

    fn normal(&self, corners: [usize; 3]) -> DVec3 {
        let [a, b, c] = corners.map(|i| self.points[i]);
        (b - a).cross(c - a)
    }

    fn on_triangle(&self, corners: [usize; 3], normal: DVec3) -> Nearest {
        let [a, b, c] = corners.map(|i| self.points[i]);
        let area = normal.length_squared();
        let [i, j, k] = corners;
        // A sliver's normal is noise; its edges know as well where it is.
        let sliver = area <= 1e-24 * (b - a).length_squared() * (c - a).length_squared();
        let weights = [normal.dot(b.cross(c)), normal.dot(c.cross(a)), normal.dot(a.cross(b))];
        if !sliver && weights.iter().all(|&w| w > 0.0) {
            let whole = 1.0 / (weights[0] + weights[1] + weights[2]);
            return Nearest {
                point: normal * (normal.dot(a) / area),
                count: 3,
                corners,
                weights: weights.map(|w| w * whole),
            };
        }
        // Outside: the nearest point is on an edge that the origin is beyond.
        let mut best: Option<Nearest> = None;
        for ((p, q), weight) in [(j, k), (k, i), (i, j)].into_iter().zip(weights) {
            if sliver || weight <= 0.0 {
                let next = self.on_edge(p, q);
                if best.is_none_or(|b| next.point.length_squared() < b.point.length_squared()) {
                    best = Some(next);
                }
            }
        }
        best.unwrap_or_else(|| self.on_edge(i, j))
    }

    fn on_tetrahedron(&self) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        for (face, top) in [([0, 1, 3], 2), ([1, 2, 3], 0), ([2, 0, 3], 1)] {
            let normal = self.normal(face);
            let a = self.points[face[0]];
            let up = normal.dot(self.points[top] - a);
            let out = -normal.dot(a);
            // A flat tetrahedron has no inside.
            let flat = up * up <= 1e-24 * normal.length_squared() * (self.points[top] - a).length_squared();
            if flat || up * out < 0.0 {
                let next = self.on_triangle(face, normal);
                if best.is_none_or(|b| next.point.length_squared() < b.point.length_squared()) {
                    best = Some(next);
                }
            }
        }
        best
    }
}

/// Vector from the nearest point of a triangle, which may be a sliver, to a point [m].
pub(crate) fn from_triangle(point: Vec3, corners: [Vec3; 3]) -> DVec3 {
    off_triangle(point.as_dvec3(), corners)
}

/// The same from a point in `f64`.
pub(crate) fn off_triangle(point: DVec3, corners: [Vec3; 3]) -> DVec3 {
    let mut simplex = Simplex::empty();
    for corner in corners {
        simplex.push(corner.as_dvec3() - point, DVec3::ZERO, DVec3::ZERO);
    }
    simplex.nearest().map_or(DVec3::ZERO, |nearest| -nearest.point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::vec3;

    /// Against a fine grid of points of the triangle, degenerate ones too.
    #[test]
    fn no_point_of_the_triangle_is_nearer() {
        let mut seed = 5u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        for i in 0..600 {
            let mut v = || vec3(next(), next(), next());
            let (point, a, b) = (v() * 2.0, v(), v());
            let c = match i % 6 {
                0 => a,
                1 => b,
                2 => a.midpoint(b),
                _ => v(),
            };
            let b = if i % 18 == 3 { a } else { b };
            let found = from_triangle(point, [a, b, c]);
            let n = 60;
            let mut least = f32::INFINITY;
            for j in 0..=n {
                for k in 0..=n - j {
                    let (s, t) = (j as f32 / n as f32, k as f32 / n as f32);
                    least = least.min((point - (a + (b - a) * s + (c - a) * t)).length());
                }
            }
            let far = found.length() as f32;
            assert!(far <= least + 1e-5 && far > least - 0.1, "{far} {least} {a} {b} {c} {point}");
        }
    }
}
