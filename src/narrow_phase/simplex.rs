//! The point of a simplex that is nearest to the origin: the inner step of [`gjk`](super::gjk).
//!
//! Every candidate feature is worked out and the nearest wins, rather than one decision after the other (Ericson,
//! *Real-Time Collision Detection*, 5.1) where a wrong turn on a sliver can't be taken back. Signed volumes
//! (Montanari, Petrinic and Barbieri, *Improving the GJK Algorithm*, 2017) reach the same by other means.

use glam::DVec3;

/// Up to four points of b - a with the points of a that they came from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simplex {
    pub(super) count: usize,
    pub(super) points: [DVec3; 4],
    pub(super) on_a: [DVec3; 4],
    /// Weights of the nearest point, after [`Self::reduce`].
    pub(super) weights: [f64; 4],
}

/// The nearest point of one feature: up to three corners and their weights.
#[derive(Clone, Copy)]
struct Nearest {
    point: DVec3,
    count: usize,
    corners: [usize; 3],
    weights: [f64; 3],
}

impl Simplex {
    pub(super) fn of(point: DVec3, on_a: DVec3) -> Simplex {
        let zero = DVec3::ZERO;
        Simplex {
            count: 1,
            points: [point, zero, zero, zero],
            on_a: [on_a, zero, zero, zero],
            weights: [1.0, 0.0, 0.0, 0.0],
        }
    }

    pub(super) fn contains(&self, point: DVec3) -> bool {
        self.points[..self.count].contains(&point)
    }

    pub(super) fn push(&mut self, point: DVec3, on_a: DVec3) {
        self.points[self.count] = point;
        self.on_a[self.count] = on_a;
        self.count += 1;
    }

    /// The point nearest to the origin; only the corners that make it up stay. None: the origin is inside.
    pub(super) fn reduce(&mut self) -> Option<DVec3> {
        let nearest = match self.count {
            1 => Nearest { point: self.points[0], count: 1, corners: [0; 3], weights: [1.0, 0.0, 0.0] },
            2 => self.on_edge(0, 1),
            3 => self.on_triangle([0, 1, 2]),
            _ => self.on_tetrahedron()?,
        };
        let (points, on_a) = (self.points, self.on_a);
        self.count = nearest.count;
        for i in 0..nearest.count {
            self.points[i] = points[nearest.corners[i]];
            self.on_a[i] = on_a[nearest.corners[i]];
            self.weights[i] = nearest.weights[i];
        }
        Some(nearest.point)
    }

    /// The nearest point's partner on a.
    pub(super) fn point_a(&self) -> DVec3 {
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

    fn on_triangle(&self, corners: [usize; 3]) -> Nearest {
        let [a, b, c] = corners.map(|i| self.points[i]);
        let normal = (b - a).cross(c - a);
        let area = normal.dot(normal);
        // A sliver's normal is noise; its edges know as well where it is.
        if area > 1e-24 * (b - a).length_squared() * (c - a).length_squared() {
            let weights = [normal.dot(b.cross(c)), normal.dot(c.cross(a)), normal.dot(a.cross(b))];
            if weights.iter().all(|&w| w > 0.0) {
                let whole = weights[0] + weights[1] + weights[2];
                return Nearest {
                    point: normal * (normal.dot(a) / area),
                    count: 3,
                    corners,
                    weights: weights.map(|w| w / whole),
                };
            }
        }
        let [i, j, k] = corners;
        let mut best = self.on_edge(i, j);
        for (p, q) in [(j, k), (k, i)] {
            let next = self.on_edge(p, q);
            if next.point.length_squared() < best.point.length_squared() {
                best = next;
            }
        }
        best
    }

    fn on_tetrahedron(&self) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        for (face, top) in [([0, 1, 3], 2), ([1, 2, 3], 0), ([2, 0, 3], 1), ([0, 1, 2], 3)] {
            let [a, b, c] = face.map(|i| self.points[i]);
            let normal = (b - a).cross(c - a);
            let up = normal.dot(self.points[top] - a);
            let out = -normal.dot(a);
            // A flat tetrahedron has no inside.
            let flat = up * up <= 1e-24 * normal.length_squared() * (self.points[top] - a).length_squared();
            if flat || up * out < 0.0 {
                let next = self.on_triangle(face);
                if best.is_none_or(|b| next.point.length_squared() < b.point.length_squared()) {
                    best = Some(next);
                }
            }
        }
        best
    }
}
