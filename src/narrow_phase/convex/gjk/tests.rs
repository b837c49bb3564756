use super::*;
use crate::math::Quat;
use crate::narrow_phase::fixtures::{CONVEX, collider, depth, gap_along};
use crate::random::Random;
use crate::shape::{Geometry, Kind};

fn between(a: Geometry, b: Geometry, position: Vec3, rotation: Quat) -> Closest {
    let (a, b) = (collider(a), collider(b));
    let (sa, sb) = (a.geometry.support().unwrap(), b.geometry.support().unwrap());
    distance(&sa, &sb, &Relative { position, rotation }, Vec3::ZERO)
}

#[test]
fn distances_are_those_of_geometry() {
    let ball = |radius| Geometry::Sphere { radius };
    let id = Quat::IDENTITY;
    let near = |c: Closest, d: f32| assert!((c.distance - d).abs() <= 1e-6 * (1.0 + d), "{c:?} {d}");
    near(between(ball(1.0), ball(0.5), Vec3::new(3.0, 4.0, 0.0), id), 3.5);
    near(between(ball(1.0), ball(0.5), Vec3::new(0.6, 0.8, 0.0), id), -0.5);
    near(between(Geometry::capsule(2.0, 0.25), Geometry::capsule(2.0, 0.25), Vec3::X, id), 0.5);
    let cube = Geometry::cuboid(0.5, 0.5, 0.5);
    for d in [0.0, 1e-6, 1e-3, 1.0, 1e3] {
        // Face to face, edge to edge, corner to corner; touching too.
        near(between(cube.clone(), cube.clone(), Vec3::new(0.1, 1.0 + d, 0.0), id), d);
        near(between(cube.clone(), cube.clone(), Vec3::new(1.0 + d, 1.0 + d, 0.2), id), d * 2f32.sqrt());
        near(between(cube.clone(), cube.clone(), Vec3::splat(1.0 + d), id), d * 3f32.sqrt());
        let cylinder = Geometry::cylinder(0.5, 1.0);
        near(between(cube.clone(), cylinder.clone(), Vec3::Y * (1.0 + d), id), d);
        near(between(cylinder.clone(), cylinder, Vec3::Z * (2.0 + d), id), d);
    }
    let c = between(cube.clone(), ball(1.0), Vec3::Y * 2.0, id);
    assert_eq!((c.normal, c.point_a.y, c.point_b.y), (Vec3::Y, 0.5, 1.0));
    assert!(between(cube.clone(), cube, Vec3::new(0.3, 0.2, 0.1), id).overlap);
}

/// The answer proves itself: the points lie on the shapes at the distance, and along the normal nothing is
/// nearer. Every pair of kinds, sizes from 1 mm to 100 m, poses from overlap to far away.
#[test]
fn nearest_points_are_on_the_shapes_and_the_normal_separates_them() {
    let mut random = Random(1);
    let (mut apart, mut worst) = (0, 0.0_f64);
    for i in 0..if cfg!(miri) { 20 } else { 40_000 } {
        let (kind_a, kind_b) = (CONVEX[i % 5], CONVEX[i / 5 % 5]);
        let size = random.log_range(1e-3, 100.0);
        let other = if i % 3 == 0 { random.log_range(1e-3, 100.0) } else { size };
        let (a, b) = (random.shape(kind_a, size), random.shape(kind_b, other));
        let rel = Relative {
            position: random.direction() * random.range(0.0, 1.3) * (a.radius + b.radius),
            rotation: random.rotation_or_aligned(),
        };
        let hint = if i % 2 == 0 { Vec3::ZERO } else { random.direction() };
        let (sa, sb) = (a.geometry.support().unwrap(), b.geometry.support().unwrap());
        let c = distance(&sa, &sb, &rel, hint);
        let scale = f64::from(a.radius + b.radius);
        let (rotation, position) = (rel.rotation.as_dquat().normalize(), rel.position.as_dvec3());
        assert!(c.distance.is_finite() && c.normal.is_finite() && c.point_a.is_finite());
        assert!((c.normal.length() - 1.0).abs() < 1e-5);
        if c.overlap {
            // No direction tells them apart.
            for _ in 0..50 {
                let n = random.direction().as_dvec3().normalize();
                let gap = gap_along(&a, &b, rotation, position, n);
                assert!(gap <= 1e-6 * scale, "{kind_a:?} {kind_b:?} {rel:?} {gap}");
            }
            continue;
        }
        apart += 1;
        let d = f64::from(c.distance);
        let gap = gap_along(&a, &b, rotation, position, c.normal.as_dvec3().normalize());
        let error = (d - gap).abs() / scale;
        worst = worst.max(error);
        assert!(error < 2e-6, "{kind_a:?} {kind_b:?} {a:?} {b:?} {rel:?}: {d} {gap}");
        let (pa, pb) = (c.point_a.as_dvec3(), c.point_b.as_dvec3());
        assert!(((pb - pa).dot(c.normal.as_dvec3()) - d).abs() < 2e-6 * scale);
        // A smooth side tells a point's place only to the root of the distance's error.
        let on_b = rotation.conjugate() * (pb - position);
        if d >= 0.0 {
            assert!(depth(&a, pa) > -1e-5 * scale, "{kind_a:?}: {} of {scale}", depth(&a, pa));
            assert!(depth(&b, on_b) > -1e-5 * scale, "{kind_b:?}: {} of {scale}", depth(&b, on_b));
        }
    }
    assert!(apart > 10_000 || cfg!(miri));
    println!("{apart} apart, worst error {worst:e} of the size");
}

/// Corners against faces and edges against edges, all of them.
#[test]
fn boxes_and_triangles_agree_with_brute_force() {
    let mut random = Random(2);
    for i in 0..if cfg!(miri) { 5 } else { 4_000 } {
        let size = random.log_range(1e-3, 100.0);
        let corners = [random.cube() * size, random.cube() * size, random.cube() * size];
        let shape = random.shape(Kind::Box, size);
        let rel = Relative {
            position: random.direction() * random.range(0.5, 2.0) * size,
            rotation: if i % 2 == 0 { Quat::IDENTITY } else { random.turn() },
        };
        let found =
            distance(&shape.geometry.support().unwrap(), &Support::triangle(corners), &rel, Vec3::ZERO);
        let q = rel.rotation.as_dquat().normalize();
        let triangle = corners.map(|c| q * c.as_dvec3() + rel.position.as_dvec3());
        let expected = brute_force(shape.size, triangle);
        if found.overlap {
            continue;
        }
        let error = (f64::from(found.distance) - expected).abs();
        assert!(error < 3e-7 * f64::from(size) * 4.0, "{shape:?} {corners:?} {rel:?}: {found:?} {expected}");
    }
}

fn point_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    (a + (b - a) * t - p).length()
}

fn segment_segment(a: [DVec3; 2], b: [DVec3; 2]) -> f64 {
    let ends = point_segment(a[0], b[0], b[1])
        .min(point_segment(a[1], b[0], b[1]))
        .min(point_segment(b[0], a[0], a[1]))
        .min(point_segment(b[1], a[0], a[1]));
    let (u, v, w) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let n = u.cross(v);
    let whole = n.length_squared();
    if whole < 1e-20 * u.length_squared() * v.length_squared() {
        return ends;
    }
    let (s, t) = (v.cross(w).dot(n) / whole, u.cross(w).dot(n) / whole);
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        return ends.min(w.dot(n).abs() / whole.sqrt());
    }
    ends
}

fn point_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let edges = point_segment(p, a, b).min(point_segment(p, b, c)).min(point_segment(p, c, a));
    let n = (b - a).cross(c - a).normalize();
    let inside = [(a, b), (b, c), (c, a)].iter().all(|(q, r)| (*r - *q).cross(p - *q).dot(n) >= 0.0);
    if inside { edges.min((p - a).dot(n).abs()) } else { edges }
}

fn brute_force(size: [f32; 4], triangle: [DVec3; 3]) -> f64 {
    let [x, y, z, _] = size.map(f64::from);
    let half = DVec3::new(x, y, z);
    let corner = |i: usize| {
        let s = |b: usize| if i >> b & 1 == 0 { 1.0 } else { -1.0 };
        half * DVec3::new(s(0), s(1), s(2))
    };
    let mut best = f64::MAX;
    for i in 0..8 {
        best = best.min(point_triangle(corner(i), triangle));
        for j in [i ^ 1, i ^ 2, i ^ 4] {
            for k in 0..3 {
                best =
                    best.min(segment_segment([corner(i), corner(j)], [triangle[k], triangle[(k + 1) % 3]]));
            }
        }
    }
    for p in triangle {
        best = best.min((p - p.clamp(-half, half)).length());
    }
    best
}

#[test]
fn odd_input_gives_finite_answers() {
    let cube = Geometry::cuboid(0.5, 0.5, 0.5);
    let flat = Support::triangle([Vec3::ZERO, Vec3::X, Vec3::X * 2.0]);
    let point = Support::triangle([Vec3::ONE; 3]);
    let shape = collider(cube);
    let cube = shape.geometry.support().unwrap();
    for (a, b) in [(&flat, &cube), (&cube, &point), (&flat, &flat), (&point, &point)] {
        for position in [Vec3::ZERO, Vec3::Y * 0.5, Vec3::splat(1e-30), Vec3::X * 1e6] {
            let c = distance(a, b, &Relative { position, rotation: Quat::IDENTITY }, Vec3::ZERO);
            assert!(c.distance.is_finite() && (c.normal.length() - 1.0).abs() < 1e-5, "{c:?}");
        }
    }
}
