//! Moments of solids, at a density of one.

use glam::{DMat3, DQuat, DVec3, Vec3};
use std::f64::consts::PI;

/// Mass, centre and inertia in f64; as part of a hull, at a density of one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    pub(crate) mass: f64,
    pub(crate) centre: DVec3,
    /// About the centre.
    pub(crate) inertia: DMat3,
}

impl Moments {
    pub(in crate::shape) const ZERO: Self = Moments { mass: 0.0, centre: DVec3::ZERO, inertia: DMat3::ZERO };

    /// Moments of a closed polyhedron, its faces counter-clockwise from outside.
    pub(in crate::shape) fn of_polyhedron(vertices: &[Vec3], faces: &[Vec<u16>]) -> Self {
        let middle = vertices.iter().map(|v| v.as_dvec3()).sum::<DVec3>() / vertices.len().max(1) as f64;
        let at = |i: u16| vertices[usize::from(i)].as_dvec3() - middle;
        let fans = faces
            .iter()
            .flat_map(|face| face[1..].windows(2).map(move |pair| [at(face[0]), at(pair[0]), at(pair[1])]));
        Self::around(middle, fans)
    }

    /// The same of triangles.
    pub(in crate::shape) fn of_triangles(triangles: &[[DVec3; 3]]) -> Self {
        let middle = triangles.iter().flatten().sum::<DVec3>() / (3 * triangles.len()).max(1) as f64;
        Self::around(middle, triangles.iter().map(|triangle| triangle.map(|p| p - middle)))
    }

    /// A sum over tetrahedra from the middle to each triangle, each with ∫ x xᵀ = det/120 (s sᵀ + a aᵀ + b bᵀ
    /// plus c cᵀ), s = a + b + c (Tonon, *Explicit exact formulas for the 3-D tetrahedron inertia tensor*,
    /// 2004).
    fn around(middle: DVec3, triangles: impl Iterator<Item = [DVec3; 3]>) -> Self {
        let (mut mass, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for [a, b, c] in triangles {
            let (det, s) = (a.dot(b.cross(c)), a + b + c);
            mass += det / 6.0;
            first += s * (det / 24.0);
            second += (outer(s) + outer(a) + outer(b) + outer(c)) * (det / 120.0);
        }
        if mass <= 0.0 {
            return Moments::ZERO;
        }
        let centre = first / mass;
        let spread = second - outer(centre) * mass;
        let trace = spread.x_axis.x + spread.y_axis.y + spread.z_axis.z;
        Moments { mass, centre: centre + middle, inertia: DMat3::from_diagonal(DVec3::splat(trace)) - spread }
    }

    /// Each about its own centre, all about the common one (parallel axes).
    pub(super) fn combine(parts: impl Iterator<Item = Moments> + Clone) -> Self {
        let massive = parts.filter(|p| p.mass > 0.0);
        let mass: f64 = massive.clone().map(|p| p.mass).sum();
        if mass <= 0.0 {
            return Moments::ZERO;
        }
        let centre = massive.clone().map(|p| p.centre * p.mass).sum::<DVec3>() / mass;
        let mut inertia = DMat3::ZERO;
        for p in massive {
            let d = p.centre - centre;
            inertia +=
                p.inertia + (DMat3::from_diagonal(DVec3::splat(d.length_squared())) - outer(d)) * p.mass;
        }
        Moments { mass, centre, inertia }
    }
}

pub(super) fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// A frustum between two discs on the y axis.
pub(in crate::shape) fn frustum(y0: f64, r0: f64, y1: f64, r1: f64) -> Moments {
    if y1 <= y0 {
        return Moments::ZERO;
    }
    revolve(y0, y1, |y| {
        let r = r0 + (r1 - r0) * (y - y0) / (y1 - y0);
        r * r
    })
}

/// The part of a ball around (0, c, 0) between two heights.
fn ball_part(c: f64, r: f64, y0: f64, y1: f64) -> Moments {
    revolve(y0, y1, |y| (r - (y - c)) * (r + (y - c)))
}

/// Two parts of balls and the frustum of the cone that touches both, split where it touches.
pub(in crate::shape) fn capsule(h: f64, bottom: f64, top: f64) -> Moments {
    if (bottom - top).abs() >= 2.0 * h {
        // One ball contains the other.
        let (c, r) = if bottom > top { (-h, bottom) } else { (h, top) };
        return ball_part(c, r, c - r, c + r);
    }
    // The cone touches both balls where their normals are up by the same sine.
    let sine = (bottom - top) / (2.0 * h);
    let cosine = ((1.0 - sine) * (1.0 + sine)).sqrt();
    let (y0, y1) = (-h + bottom * sine, h + top * sine);
    let parts = [
        ball_part(-h, bottom, -h - bottom, y0),
        frustum(y0, bottom * cosine, y1, top * cosine),
        ball_part(h, top, y1, h + top),
    ];
    Moments::combine(parts.into_iter())
}

/// A solid of revolution about y, of which `square` is the squared radius by height. Exact if that is a
/// polynomial of degree two: three Gauss points integrate degree five, and a moment of inertia needs four.
fn revolve(y0: f64, y1: f64, square: impl Fn(f64) -> f64) -> Moments {
    let (middle, half) = (0.5 * (y0 + y1), 0.5 * (y1 - y0));
    let step = half * 0.6_f64.sqrt();
    let gauss = [(middle - step, 5.0 / 9.0), (middle, 8.0 / 9.0), (middle + step, 5.0 / 9.0)];
    let integral = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        gauss.iter().map(|&(y, weight)| weight * half * PI * f(y, square(y))).sum()
    };
    let mass = integral(&|_, s| s);
    if mass <= 0.0 {
        return Moments::ZERO;
    }
    let centre = integral(&|y, s| s * (y - middle)) / mass + middle;
    // A disc has m r²/2 about its axis and half of that about a diameter.
    let axial = integral(&|_, s| 0.5 * s * s);
    let across = 0.5 * axial + integral(&|y, s| s * (y - centre) * (y - centre));
    Moments {
        mass,
        centre: DVec3::new(0.0, centre, 0.0),
        inertia: DMat3::from_diagonal(DVec3::new(across, axial, across)),
    }
}

/// Eigenvalues and eigenvectors of a symmetric matrix, by Jacobi's rotations (Golub and Van Loan, *Matrix
/// Computations*, 8.5): exact for a diagonal matrix, and no angle is above 45 degrees, so the axes stay near
/// their own.
pub(in crate::shape) fn principal(matrix: DMat3) -> (DVec3, DQuat) {
    let mut m = matrix.to_cols_array_2d();
    let mut axes = DMat3::IDENTITY.to_cols_array_2d();
    // Quadratic convergence: four or five sweeps do.
    for _ in 0..12 {
        let off = m[0][1].abs() + m[0][2].abs() + m[1][2].abs();
        if off <= 1e-18 * (m[0][0].abs() + m[1][1].abs() + m[2][2].abs()) {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[p][q] == 0.0 {
                continue;
            }
            let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut m {
                let (a, b) = (row[p], row[q]);
                (row[p], row[q]) = (c * a - s * b, s * a + c * b);
            }
            for k in 0..3 {
                let (a, b) = (m[p][k], m[q][k]);
                (m[p][k], m[q][k]) = (c * a - s * b, s * a + c * b);
                // `axes[i]` is the i-th axis.
                let (a, b) = (axes[p][k], axes[q][k]);
                (axes[p][k], axes[q][k]) = (c * a - s * b, s * a + c * b);
            }
            (m[p][q], m[q][p]) = (0.0, 0.0);
        }
    }
    let moments = DVec3::new(m[0][0], m[1][1], m[2][2]);
    (moments, DQuat::from_mat3(&DMat3::from_cols_array_2d(&axes)).normalize())
}
