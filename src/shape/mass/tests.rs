use super::moments::outer;
use super::*;
use crate::random::Random;
use crate::shape::ConvexHull;
use glam::Quat;
use std::f64::consts::PI;
use std::sync::Arc;

fn close(a: MassProperties, b: MassProperties, relative: f32) {
    let size = b.inertia.x_axis.x.abs().max(b.inertia.y_axis.y.abs()).max(b.inertia.z_axis.z.abs());
    let reach = (size / b.mass).sqrt();
    assert!((a.mass - b.mass).abs() <= relative * b.mass, "{a:?} {b:?}");
    assert!(
        (a.centre_of_mass - b.centre_of_mass).abs().max_element()
            <= relative * (reach + b.centre_of_mass.length()),
        "{a:?} {b:?}"
    );
    for (x, y) in a.inertia.to_cols_array().into_iter().zip(b.inertia.to_cols_array()) {
        assert!((x - y).abs() <= relative * size, "{a:?} {b:?}");
    }
}

fn diagonal(mass: f64, y: f64, x_y_z: [f64; 3]) -> MassProperties {
    MassProperties {
        mass: mass as f32,
        centre_of_mass: Vec3::new(0.0, y as f32, 0.0),
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
        let (h, a, b) = (random.range64(0.2, 1.0), random.range64(0.1, 0.8), random.range64(0.1, 0.8));
        let (half_height, radius_bottom, radius_top) = (h as f32, a as f32, b as f32);
        let hull_points: Vec<Vec3> = (0..12).map(|_| random.cube64().as_vec3()).collect();
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
                Box::new(move |p| p.y.abs() <= h && p.x.hypot(p.z) <= a + (b - a) * (p.y / h + 1.0) / 2.0),
            ),
            _ => (
                Geometry::Hull(hull.clone()),
                Box::new(move |p| hull.planes.iter().all(|(n, o)| n.as_dvec3().dot(p) <= f64::from(*o))),
            ),
        };
        let (mut count, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        let (n, side) = (60_000, 1.8);
        for _ in 0..n {
            let p = random.cube64() * side;
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
            centre_of_mass: centre.as_vec3(),
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
        let half = (random.cube64().abs() + 0.1).as_vec3() * scale;
        let (rotation, position) = (random.rotation(), random.cube64().as_vec3() * scale);
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
        let half = (random.cube64().abs() * random.cube64().abs() + 0.01).as_vec3();
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
                .transformed(random.cube64().as_vec3(), random.rotation());
            needle.validate().unwrap();
            let plate = MassProperties::of(&Geometry::cuboid(1.0, thin, 1.0), 1000.0)
                .transformed(random.cube64().as_vec3(), random.rotation());
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
    assert!(refused(MassProperties { centre_of_mass: Vec3::INFINITY, ..good }).contains("centre of mass"));
    let inertia = |x: f32, y: f32, z: f32| Mat3::from_diagonal(Vec3::new(x, y, z));
    assert!(refused(MassProperties { inertia: inertia(1.0, 1.0, -0.1), ..good }).contains("smallest"));
    assert!(refused(MassProperties { inertia: inertia(1.0, 1.0, 2.1), ..good }).contains("largest"));
    let mut skew = good;
    skew.inertia.x_axis.y = 1.0;
    assert!(refused(skew).contains("asymmetry"));
    MassProperties { inertia: inertia(1.0, 1.0, 2.0), ..good }.validate().unwrap();
}
