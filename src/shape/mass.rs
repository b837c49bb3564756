//! Mass, centre and inertia out of shapes and densities, in f64 throughout: a moment is a difference of
//! products, and f32 would lose half of it.

use super::Geometry;
use crate::error::{Error, finite, positive, within};
use glam::{DMat3, DQuat, DVec3, Mat3, Vec3};
use std::f64::consts::PI;

/// Mass, centre of mass and inertia about it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MassProperties {
    /// [kg]
    pub mass: f32,
    /// In the frame of the shape or body [m].
    #[cfg_attr(feature = "serde", serde(alias = "center"))]
    pub centre_of_mass: Vec3,
    /// About the centre, in the axes of the shape or body [kg m²].
    pub inertia: Mat3,
}

impl MassProperties {
    /// No mass.
    pub const ZERO: Self = MassProperties { mass: 0.0, centre_of_mass: Vec3::ZERO, inertia: Mat3::ZERO };

    /// Moments of a solid of even density [kg/m³]. Planes, meshes and height fields have no mass.
    pub fn of(geometry: &Geometry, density: f32) -> Self {
        Moments::of(geometry).scaled(density.into()).rounded()
    }

    /// Those of a body with known principal moments [kg m²]; `axes`: the rotation from its principal axes
    /// into its own. The inverse of [`MassProperties::principal`].
    pub fn from_principal(
        mass: f32,
        centre_of_mass: Vec3,
        moments: Vec3,
        axes: impl Into<glam::Quat>,
    ) -> Self {
        let turn = DMat3::from_quat(axes.into().as_dquat().normalize());
        let inertia = turn * DMat3::from_diagonal(moments.as_dvec3()) * turn.transpose();
        MassProperties { mass, centre_of_mass, inertia: inertia.as_mat3() }
    }

    /// The same solid, turned and then moved: from a shape's frame into the body's.
    pub fn transformed(&self, position: Vec3, rotation: glam::Quat) -> Self {
        let turn = DMat3::from_quat(rotation.as_dquat().normalize());
        let m = Moments::from(*self);
        Moments {
            mass: m.mass,
            centre: turn * m.centre + position.as_dvec3(),
            inertia: turn * m.inertia * turn.transpose(),
        }
        .rounded()
    }

    /// All of them as one body. What has no mass has no say.
    pub fn combine(parts: &[MassProperties]) -> Self {
        Moments::combine(parts.iter().map(|&p| p.into())).rounded()
    }

    /// The same distribution with another mass [kg]. Without mass there is nothing to scale, and the inertia
    /// stays zero.
    pub fn scaled_to(&self, mass: f32) -> Self {
        if self.mass <= 0.0 {
            return MassProperties { mass, ..*self };
        }
        let mut scaled = Moments::from(*self).scaled(f64::from(mass) / f64::from(self.mass)).rounded();
        // Not a rounding away from what was asked for.
        scaled.mass = mass;
        scaled
    }

    /// Checks that a solid could have these.
    ///
    /// # Errors
    /// If a number is not finite, the centre is beyond [`limits::MAX_LENGTH`](crate::limits::MAX_LENGTH)
    /// along an axis, the mass is not above zero, or the inertia is not symmetric (to 1e-4 of its size), not
    /// positive definite, or has a principal moment above the sum of the other two (by 1e-4 of it).
    pub fn validate(&self) -> Result<(), Error> {
        crate::limits::offset("centre of mass", self.centre_of_mass)?;
        for value in self.inertia.to_cols_array() {
            finite("inertia", value)?;
        }
        positive("mass", self.mass)?;
        let m = self.inertia;
        let size = m.x_axis.abs().max(m.y_axis.abs()).max(m.z_axis.abs()).max_element();
        let skew = (m.x_axis.y - m.y_axis.x)
            .abs()
            .max((m.x_axis.z - m.z_axis.x).abs())
            .max((m.y_axis.z - m.z_axis.y).abs());
        within("asymmetry of the inertia", skew, 0.0, 1e-4 * size, "at most 1e-4 of the inertia")?;
        let mut moments = self.principal().0.to_array();
        moments.sort_by(f32::total_cmp);
        let [small, middle, large] = moments;
        positive("smallest principal moment of inertia", small)?;
        let most = (f64::from(small) + f64::from(middle)) * 1.0001;
        within(
            "largest principal moment of inertia",
            large,
            0.0,
            most as f32,
            "at most the sum of the others",
        )
        .map(drop)
    }

    /// Principal moments [kg m²], and the rotation from principal axes into these axes: `inertia = R
    /// diag(moments) Rᵀ`. The axes are as near to x, y, z as they come, and not sorted by moment.
    pub fn principal(&self) -> (Vec3, glam::Quat) {
        let (moments, axes) = principal(Moments::from(*self).inertia);
        (moments.as_vec3(), axes.as_quat())
    }
}

/// The same in f64; as part of a hull, at a density of one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    pub(crate) mass: f64,
    pub(crate) centre: DVec3,
    /// About the centre.
    pub(crate) inertia: DMat3,
}

impl From<MassProperties> for Moments {
    fn from(p: MassProperties) -> Self {
        Moments { mass: p.mass.into(), centre: p.centre_of_mass.as_dvec3(), inertia: p.inertia.as_dmat3() }
    }
}

impl Moments {
    const ZERO: Self = Moments { mass: 0.0, centre: DVec3::ZERO, inertia: DMat3::ZERO };

    /// At a density of one.
    pub(crate) fn of(geometry: &Geometry) -> Self {
        match *geometry {
            Geometry::Sphere { radius } => {
                let r = f64::from(radius);
                let mass = 4.0 / 3.0 * PI * r * r * r;
                Moments {
                    mass,
                    centre: DVec3::ZERO,
                    inertia: DMat3::from_diagonal(DVec3::splat(0.4 * mass * r * r)),
                }
            }
            Geometry::Box { half_extents } => {
                let h = half_extents.as_dvec3();
                let mass = 8.0 * h.x * h.y * h.z;
                let square = h * h * (mass / 3.0);
                let inertia = DVec3::new(square.y + square.z, square.z + square.x, square.x + square.y);
                Moments { mass, centre: DVec3::ZERO, inertia: DMat3::from_diagonal(inertia) }
            }
            Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                frustum(-f64::from(half_height), radius_bottom.into(), half_height.into(), radius_top.into())
            }
            Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                capsule(half_height.into(), radius_bottom.into(), radius_top.into())
            }
            Geometry::Hull(ref hull) => hull.moments,
            Geometry::Plane | Geometry::Mesh(_) | Geometry::HeightField(_) => Moments::ZERO,
        }
    }

    /// Moments of a closed polyhedron, its faces counter-clockwise from outside: a sum over tetrahedra from
    /// its middle, each with ∫ x xᵀ = det/120 (s sᵀ + a aᵀ + b bᵀ + c cᵀ), s = a + b + c (Tonon, *Explicit
    /// exact formulas for the 3-D tetrahedron inertia tensor*, 2004).
    pub(super) fn of_polyhedron(vertices: &[Vec3], faces: &[Vec<u16>]) -> Self {
        let middle = vertices.iter().map(|v| v.as_dvec3()).sum::<DVec3>() / vertices.len().max(1) as f64;
        let at = |i: u16| vertices[usize::from(i)].as_dvec3() - middle;
        let (mut mass, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for face in faces {
            for pair in face[1..].windows(2) {
                let (a, b, c) = (at(face[0]), at(pair[0]), at(pair[1]));
                let (det, s) = (a.dot(b.cross(c)), a + b + c);
                mass += det / 6.0;
                first += s * (det / 24.0);
                second += (outer(s) + outer(a) + outer(b) + outer(c)) * (det / 120.0);
            }
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
    fn combine(parts: impl Iterator<Item = Moments> + Clone) -> Self {
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

    fn scaled(self, factor: f64) -> Self {
        Moments { mass: self.mass * factor, centre: self.centre, inertia: self.inertia * factor }
    }

    /// In f32. A needle keeps at least [`THINNEST`] of its largest moment around its own axis: in turned axes
    /// f32 could not tell less from nothing, or from less than nothing.
    fn rounded(self) -> MassProperties {
        let Moments { mass, centre, mut inertia } = self;
        let (moments, axes) = principal(inertia);
        let least = THINNEST * moments.max_element();
        if moments.min_element() < least {
            let turn = DMat3::from_quat(axes);
            inertia = turn * DMat3::from_diagonal(moments.max(DVec3::splat(least))) * turn.transpose();
        }
        // Symmetric to the last bit, whatever the order of the products above.
        let inertia = (inertia + inertia.transpose()) * 0.5;
        MassProperties { mass: mass as f32, centre_of_mass: centre.as_vec3(), inertia: inertia.as_mat3() }
    }
}

// Rounding: of f32, sixteen times.
/// 16 roundings of f32: a needle a thousand times as long as it is thick still has its own.
const THINNEST: f64 = 16.0 * f32::EPSILON as f64 / 2.0;

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// A frustum between two discs on the y axis.
fn frustum(y0: f64, r0: f64, y1: f64, r1: f64) -> Moments {
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
fn capsule(h: f64, bottom: f64, top: f64) -> Moments {
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
fn principal(matrix: DMat3) -> (DVec3, DQuat) {
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

#[cfg(test)]
mod tests;
