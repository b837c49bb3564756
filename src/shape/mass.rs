//! Mass, centre and inertia out of shapes and densities, in f64 throughout: a moment is a difference of products, and
//! f32 would lose half of it.

use super::Geometry;
use crate::error::{Error, finite, finite3, positive, within};
use glam::{DMat3, DQuat, DVec3, Mat3, Quat, Vec3};
use std::f64::consts::PI;

/// Mass, centre of mass and inertia about it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MassProperties {
    /// [kg]
    pub mass: f32,
    /// In the frame of the shape or body [m].
    pub center: Vec3,
    /// About the centre, in the axes of the shape or body [kg m²].
    pub inertia: Mat3,
}

impl MassProperties {
    /// No mass.
    pub const ZERO: Self = MassProperties { mass: 0.0, center: Vec3::ZERO, inertia: Mat3::ZERO };

    /// Of a solid of even density [kg/m³]. Planes, meshes and height fields have no mass.
    pub fn of(geometry: &Geometry, density: f32) -> Self {
        Moments::of(geometry).scaled(density.into()).rounded()
    }

    /// The same solid, turned and then moved: from a shape's frame into the body's.
    pub fn transformed(&self, position: Vec3, rotation: Quat) -> Self {
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

    /// The same distribution with another mass [kg]. Without mass there is nothing to scale, and the inertia stays
    /// zero.
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
    /// If a number is not finite, the mass is not above zero, or the inertia is not symmetric (to 1e-4 of its size),
    /// not positive definite, or has a principal moment above the sum of the other two (by 1e-4 of it).
    pub fn validate(&self) -> Result<(), Error> {
        finite3("centre of mass", self.center)?;
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

    /// Principal moments [kg m²], and the rotation from principal axes into these axes:
    /// `inertia = R diag(moments) Rᵀ`. The axes are as near to x, y, z as they come, and not sorted by moment.
    pub fn principal(&self) -> (Vec3, Quat) {
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
        Moments { mass: p.mass.into(), centre: p.center.as_dvec3(), inertia: p.inertia.as_dmat3() }
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

    /// Of a closed polyhedron, its faces counter-clockwise from outside: a sum over tetrahedra from its middle, each
    /// with ∫ x xᵀ = det/120 (s sᵀ + a aᵀ + b bᵀ + c cᵀ), s = a + b + c (Tonon, *Explicit exact formulas for the 3-D
    /// tetrahedron inertia tensor*, 2004).
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

    /// In f32. A needle keeps at least [`THINNEST`] of its largest moment around its own axis: in turned axes f32
    /// could not tell less from nothing, or from less than nothing.
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
        MassProperties { mass: mass as f32, center: centre.as_vec3(), inertia: inertia.as_mat3() }
    }
}

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

/// A solid of revolution about y, of which `square` is the squared radius by height. Exact if that is a polynomial of
/// degree two: three Gauss points integrate degree five, and a moment of inertia needs four.
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
    // Of a disc: m r²/2 about its axis, half of that across.
    let axial = integral(&|_, s| 0.5 * s * s);
    let across = 0.5 * axial + integral(&|y, s| s * (y - centre) * (y - centre));
    Moments {
        mass,
        centre: DVec3::new(0.0, centre, 0.0),
        inertia: DMat3::from_diagonal(DVec3::new(across, axial, across)),
    }
}

/// Eigenvalues and eigenvectors of a symmetric matrix, by Jacobi's rotations (Golub and Van Loan, *Matrix
/// Computations*, 8.5): exact for a diagonal matrix, and no angle is above 45 degrees, so the axes stay near their own.
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
mod tests {
    use super::*;
    use crate::shape::ConvexHull;
    use std::sync::Arc;

    /// Numbers in 0..1 (SplitMix64).
    struct Random(u64);
    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        }
        fn between(&mut self, low: f64, high: f64) -> f64 {
            low + (high - low) * self.unit()
        }
        fn cube(&mut self) -> DVec3 {
            DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
        }
        fn rotation(&mut self) -> Quat {
            let v = self.cube();
            Quat::from_xyzw(v.x as f32, v.y as f32, v.z as f32, self.between(-1.0, 1.0) as f32).normalize()
        }
    }

    fn close(a: MassProperties, b: MassProperties, relative: f32) {
        let size = b.inertia.x_axis.x.abs().max(b.inertia.y_axis.y.abs()).max(b.inertia.z_axis.z.abs());
        let reach = (size / b.mass).sqrt();
        assert!((a.mass - b.mass).abs() <= relative * b.mass, "{a:?} {b:?}");
        assert!(
            (a.center - b.center).abs().max_element() <= relative * (reach + b.center.length()),
            "{a:?} {b:?}"
        );
        for (x, y) in a.inertia.to_cols_array().into_iter().zip(b.inertia.to_cols_array()) {
            assert!((x - y).abs() <= relative * size, "{a:?} {b:?}");
        }
    }

    fn diagonal(mass: f64, y: f64, x_y_z: [f64; 3]) -> MassProperties {
        MassProperties {
            mass: mass as f32,
            center: Vec3::new(0.0, y as f32, 0.0),
            inertia: Mat3::from_diagonal(DVec3::from_array(x_y_z).as_vec3()),
        }
    }

    #[test]
    fn textbook_solids_have_their_textbook_moments() {
        // Ball 2/5 m r², box m/3 (b² + c²) in half sides, cylinder m r²/2 and m (3 r² + (2h)²)/12.
        let ball = MassProperties::of(&Geometry::Sphere { radius: 2.0 }, 3.0);
        let m = 3.0 * 4.0 / 3.0 * PI * 8.0;
        close(ball, diagonal(m, 0.0, [1.6 * m; 3]), 1e-6);
        let cuboid = MassProperties::of(&Geometry::cuboid(1.0, 2.0, 3.0), 0.5);
        close(cuboid, diagonal(24.0, 0.0, [8.0 * 13.0, 8.0 * 10.0, 8.0 * 5.0]), 1e-6);
        let cylinder = MassProperties::of(&Geometry::cylinder(1.5, 2.0), 1.0);
        let m = PI * 4.0 * 3.0;
        close(cylinder, diagonal(m, 0.0, [m * 21.0 / 12.0, m * 2.0, m * 21.0 / 12.0]), 1e-6);
        // A cone of height H: centre at H/4 above the base, 3/10 m r² axial, m (3/20 r² + 3/80 H²) across.
        let cone = Geometry::Cylinder { half_height: 2.0, radius_bottom: 1.5, radius_top: 0.0 };
        let m = PI * 2.25 * 4.0 / 3.0;
        let across = m * (0.15 * 2.25 + 0.0375 * 16.0);
        close(MassProperties::of(&cone, 1.0), diagonal(m, -1.0, [across, m * 0.3 * 2.25, across]), 1e-6);
        // Two half balls and a cylinder: half a ball has its centre at 3/8 r and 83/320 m r² across about it.
        let (r, h) = (0.5, 1.25);
        let (mc, mh) = (PI * r * r * 2.0 * h, 2.0 / 3.0 * PI * r * r * r);
        let d = h + 0.375 * r;
        let across = mc * (3.0 * r * r + 4.0 * h * h) / 12.0 + 2.0 * mh * (83.0 / 320.0 * r * r + d * d);
        let axial = mc * r * r / 2.0 + 2.0 * mh * 0.4 * r * r;
        let capsule = MassProperties::of(&Geometry::capsule(1.25, 0.5), 1.0);
        close(capsule, diagonal(mc + 2.0 * mh, 0.0, [across, axial, across]), 1e-6);
        assert_eq!(MassProperties::of(&Geometry::Plane, 1.0), MassProperties::ZERO);
    }

    #[test]
    fn limits_of_a_capsule_are_balls_and_the_capsule_of_one_radius() {
        let capsule = |half_height, radius_bottom, radius_top| {
            MassProperties::of(&Geometry::Capsule { half_height, radius_bottom, radius_top }, 1.0)
        };
        let ball = |radius, y| {
            let m = MassProperties::of(&Geometry::Sphere { radius }, 1.0);
            m.transformed(Vec3::new(0.0, y, 0.0), Quat::IDENTITY)
        };
        close(capsule(0.0, 1.0, 1.0), ball(1.0, 0.0), 1e-6);
        close(capsule(0.25, 2.0, 0.5), ball(2.0, -0.25), 1e-6);
        close(capsule(0.25, 0.5, 2.0), ball(2.0, 0.25), 1e-6);
        // Just before one ball contains the other.
        close(capsule(0.25, 1.0, 0.500_01), ball(1.0, -0.25), 1e-5);
        close(capsule(0.5, 1.0_f32.next_down(), f32::MIN_POSITIVE), ball(1.0, -0.5), 1e-5);
        close(capsule(1.0, 0.5, 0.500_001), capsule(1.0, 0.5, 0.5), 1e-5);
    }

    #[test]
    fn any_solid_agrees_with_a_count_of_random_points() {
        let mut random = Random(4);
        for round in 0..6 {
            let (h, a, b) = (random.between(0.2, 1.0), random.between(0.1, 0.8), random.between(0.1, 0.8));
            let (half_height, radius_bottom, radius_top) = (h as f32, a as f32, b as f32);
            let hull_points: Vec<Vec3> = (0..12).map(|_| random.cube().as_vec3()).collect();
            let hull = Arc::new(ConvexHull::new(&hull_points).unwrap());
            let (geometry, inside): (Geometry, Box<dyn Fn(DVec3) -> bool>) = match round % 3 {
                0 => (
                    Geometry::Capsule { half_height, radius_bottom, radius_top },
                    // Inside one of the balls on the axis, whose radii go evenly from one end to the other.
                    Box::new(move |p| {
                        (0..=400).any(|i| {
                            let t = f64::from(i) / 400.0;
                            p.distance(DVec3::new(0.0, h * (2.0 * t - 1.0), 0.0)) <= a + (b - a) * t
                        })
                    }),
                ),
                1 => (
                    Geometry::Cylinder { half_height, radius_bottom, radius_top },
                    Box::new(move |p| {
                        p.y.abs() <= h && p.x.hypot(p.z) <= a + (b - a) * (p.y / h + 1.0) / 2.0
                    }),
                ),
                _ => (
                    Geometry::Hull(hull.clone()),
                    Box::new(move |p| hull.planes.iter().all(|(n, o)| n.as_dvec3().dot(p) <= f64::from(*o))),
                ),
            };
            let (mut count, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
            let (n, side) = (60_000, 1.8);
            for _ in 0..n {
                let p = random.cube() * side;
                if inside(p) {
                    count += 1.0;
                    first += p;
                    second += outer(p);
                }
            }
            let centre = first / count;
            let spread = second - outer(centre) * count;
            let trace = spread.x_axis.x + spread.y_axis.y + spread.z_axis.z;
            let unit = (2.0 * side).powi(3) / f64::from(n);
            let inertia = (DMat3::from_diagonal(DVec3::splat(trace)) - spread) * unit;
            let counted = MassProperties {
                mass: (count * unit) as f32,
                center: centre.as_vec3(),
                inertia: inertia.as_mat3(),
            };
            // Three standard deviations of a count, which is some thousand.
            close(MassProperties::of(&geometry, 1.0), counted, (4.0 / count.sqrt()) as f32);
        }
    }

    #[test]
    fn a_hull_of_a_box_weighs_as_the_box_wherever_it_is() {
        let mut random = Random(8);
        for scale in [1e-3, 1.0, 300.0] {
            let half = (random.cube().abs() + 0.1).as_vec3() * scale;
            let (rotation, position) = (random.rotation(), random.cube().as_vec3() * scale);
            let corners: Vec<Vec3> = (0..8)
                .map(|i| {
                    let corner = Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
                    rotation * (corner * half) + position
                })
                .collect();
            let hull = Geometry::Hull(Arc::new(ConvexHull::new(&corners).unwrap()));
            let cuboid = MassProperties::of(&Geometry::Box { half_extents: half }, 7.0);
            close(MassProperties::of(&hull, 7.0), cuboid.transformed(position, rotation), 2e-6);
        }
    }

    #[test]
    fn parts_make_the_whole() {
        // A box cut in two unequal parts.
        let part = |from: f32, to: f32| {
            let half = Vec3::new(0.5 * (to - from), 1.0, 0.5);
            MassProperties::of(&Geometry::Box { half_extents: half }, 2.0)
                .transformed(Vec3::new(0.5 * (from + to), 0.0, 0.0), Quat::IDENTITY)
        };
        let parts = [part(-1.0, -0.3), MassProperties::ZERO, part(-0.3, 1.0)];
        close(MassProperties::combine(&parts), part(-1.0, 1.0), 1e-6);
        assert_eq!(MassProperties::combine(&[]), MassProperties::ZERO);
        let scaled = part(-1.0, 1.0).scaled_to(10.0);
        close(scaled, MassProperties::of(&Geometry::cuboid(1.0, 1.0, 0.5), 10.0 / 4.0), 1e-6);
        assert_eq!(scaled.mass, 10.0);
    }

    #[test]
    fn principal_axes_make_the_inertia_again() {
        let mut random = Random(11);
        for _ in 0..500 {
            let half = (random.cube().abs() * random.cube().abs() + 0.01).as_vec3();
            let mass = MassProperties::of(&Geometry::Box { half_extents: half }, 1.0)
                .transformed(Vec3::ZERO, random.rotation());
            mass.validate().unwrap();
            let (moments, axes) = mass.principal();
            let turn = Mat3::from_quat(axes);
            let again = turn * Mat3::from_diagonal(moments) * turn.transpose();
            close(MassProperties { inertia: again, ..mass }, mass, 2e-6);
        }
        let cuboid = MassProperties::of(&Geometry::cuboid(1.0, 2.0, 3.0), 1.0);
        assert_eq!(cuboid.principal().1, Quat::IDENTITY);
    }

    #[test]
    fn a_needle_in_any_direction_has_moments_that_hold() {
        let mut random = Random(12);
        for thin in [1e-2, 1e-3, 1e-4, 1e-6] {
            for _ in 0..50 {
                let needle = MassProperties::of(&Geometry::cuboid(thin, 1.0, thin), 1000.0)
                    .transformed(random.cube().as_vec3(), random.rotation());
                needle.validate().unwrap();
                let plate = MassProperties::of(&Geometry::cuboid(1.0, thin, 1.0), 1000.0)
                    .transformed(random.cube().as_vec3(), random.rotation());
                plate.validate().unwrap();
            }
        }
    }

    #[test]
    fn what_no_solid_has_is_refused_by_name() {
        let good = MassProperties::of(&Geometry::cuboid(1.0, 2.0, 3.0), 1.0);
        let refused = |m: MassProperties| m.validate().unwrap_err().to_string();
        assert!(refused(MassProperties { mass: 0.0, ..good }).contains("mass must be above zero"));
        assert!(refused(MassProperties { mass: f32::NAN, ..good }).contains("mass must be finite"));
        assert!(refused(MassProperties { center: Vec3::INFINITY, ..good }).contains("centre of mass"));
        let inertia = |x: f32, y: f32, z: f32| Mat3::from_diagonal(Vec3::new(x, y, z));
        assert!(refused(MassProperties { inertia: inertia(1.0, 1.0, -0.1), ..good }).contains("smallest"));
        assert!(refused(MassProperties { inertia: inertia(1.0, 1.0, 2.1), ..good }).contains("largest"));
        let mut skew = good;
        skew.inertia.x_axis.y = 1.0;
        assert!(refused(skew).contains("asymmetry"));
        MassProperties { inertia: inertia(1.0, 1.0, 2.0), ..good }.validate().unwrap();
    }
}
