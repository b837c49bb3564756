use super::super::fixtures::{CONVEX, collider};
use super::*;
use crate::math::Quat;
use crate::narrow_phase::cast::motion::BodyPath;
use crate::random::Random;
use crate::shape::{Geometry, Kind};

fn path(centre: DVec3, displacement: Vec3) -> BodyPath {
    BodyPath { centre, rotation: Quat::IDENTITY, displacement, spin: Vec3::ZERO }
}

fn still(centre: DVec3) -> BodyPath {
    path(centre, Vec3::ZERO)
}

/// The distance at a moment, by the platform's rotations and the distance that `gjk` proves; half of minus
/// the size or so in overlap.
fn distance_at(a: &Collider, b: &Collider, (pa, pb): (&BodyPath, &BodyPath), t: f64) -> f64 {
    let place = |shape: &Collider, path: &BodyPath| {
        let spin = path.spin.as_dvec3() * t;
        let turned = DQuat::from_scaled_axis(spin) * path.rotation.as_dquat().normalize();
        let centre = path.centre + path.displacement.as_dvec3() * t;
        (turned * shape.rotation.as_dquat().normalize(), centre + turned * shape.position.as_dvec3())
    };
    let ((ra, xa), (rb, xb)) = (place(a, pa), place(b, pb));
    if b.kind == Kind::Plane {
        let up = rb * DVec3::Y;
        let lowest = super::super::fixtures::furthest(a, ra.conjugate() * -up);
        return (ra * lowest + xa - xb).dot(up);
    }
    let pose = Pose { rotation: DMat3::from_quat(ra.conjugate() * rb), position: ra.conjugate() * (xb - xa) };
    let (a, b) = (a.geometry.support().unwrap(), b.geometry.support().unwrap());
    let gap = core_gap(
        &a,
        &b,
        &pose,
        DVec3::ZERO,
        &mut Simplex::empty(),
        Accuracy { absolute: 0.0, relative: 1e-9 },
    );
    (if gap.overlap { 0.0 } else { gap.upper }) - a.radius - b.radius
}

fn cast(a: &Collider, b: &Collider, paths: (&BodyPath, &BodyPath), tolerance: f32) -> Option<Touch> {
    cast_convex(a, b, &Motion::new(a, paths.0, b, paths.1), tolerance)
}

/// Steps through the motion and compares. Answers (touched, unsettled).
fn check(a: &Collider, b: &Collider, paths: (&BodyPath, &BodyPath), steps: u32) -> (bool, bool) {
    let eps = tolerance(a, b, 1.0);
    let tol = f64::from(eps);
    let touch = cast(a, b, paths, eps);
    let end = touch.map_or(1.0, |t| f64::from(t.fraction));
    // The motion by one `f32` step of the fraction.
    let speed = f64::from((paths.0.displacement - paths.1.displacement).length())
        + f64::from(paths.0.spin.length() * (a.radius + a.position.length()))
        + f64::from(paths.1.spin.length()) * if b.radius.is_finite() { f64::from(b.radius) } else { 50.0 };
    let rounding = 1e-7 * speed + 1e-9;
    for i in 0..steps {
        let t = end * f64::from(i) / f64::from(steps);
        let d = distance_at(a, b, paths, t);
        let say = || format!("{:?} {:?} {paths:?} at {t} of {touch:?}: {d}", a.geometry, b.geometry);
        assert!(d > 0.0 || end == 0.0, "late: {}", say());
    }
    let Some(touch) = touch else { return (false, false) };
    assert!((touch.normal.length() - 1.0).abs() < 1e-5);
    let d = distance_at(a, b, paths, end);
    (true, d > 1.2 * tol + rounding)
}

#[test]
fn casts_agree_with_small_steps() {
    let mut random = Random(11);
    let (mut hits, mut misses, mut unsettled) = (0, 0, 0);
    for i in 0..if cfg!(miri) { 5 } else { 1500 } {
        let (kind_a, kind_b) = (CONVEX[i % 5], CONVEX[i / 5 % 5]);
        let size = random.log_range(0.01, 5.0);
        let other = random.log_range(0.01, 20.0);
        let (mut a, mut b) = (random.shape(kind_a, size), random.shape(kind_b, other));
        for shape in [&mut a, &mut b] {
            if random.below(3) == 0 {
                shape.position = random.cube() * shape.radius;
                shape.rotation = random.turn();
            }
        }
        let reach = a.radius + b.radius + a.position.length() + b.position.length();
        let far = random.range(0.3, 3.0) * reach;
        let from = random.direction();
        // About at each other, often at a tangent; from slow to a hundred sizes a step.
        let aim = -from * far + random.direction() * reach * random.range(0.0, 1.0);
        let spins = |random: &mut Random| match random.below(3) {
            0 => Vec3::ZERO,
            1 => random.direction() * random.range(0.0, 0.5),
            _ => random.direction() * random.range(0.0, 8.0),
        };
        let origin = DVec3::new(3e5, -2e4, 7e5);
        let body = |random: &mut Random, centre: DVec3, displacement: Vec3| BodyPath {
            centre,
            rotation: random.rotation_or_aligned(),
            displacement,
            spin: spins(random),
        };
        let push = random.direction() * random.range(0.0, 3.0);
        let speed = random.log_range(0.2, 50.0);
        let pa = body(&mut random, origin + (from * far).as_dvec3(), aim * speed + push);
        let pb = body(&mut random, origin, push);
        let (hit, open) = check(&a, &b, (&pa, &pb), 300);
        hits += u32::from(hit);
        misses += u32::from(!hit);
        unsettled += u32::from(open);
    }
    println!("{hits} hits, {misses} misses, {unsettled} unsettled");
    assert!(cfg!(miri) || (hits > 300 && misses > 300));
    assert_eq!(unsettled, 0);
}

#[test]
fn casts_against_planes_agree_with_small_steps() {
    let mut random = Random(12);
    let plane = collider(Geometry::Plane);
    let (mut hits, mut misses, mut unsettled) = (0, 0, 0);
    for i in 0..if cfg!(miri) { 5 } else { 600 } {
        let a = random.shape(CONVEX[i % 5], 1.0);
        let rotation = random.rotation_or_aligned();
        let up = rotation * Vec3::Y;
        let start = up * random.range(0.6, 3.0) * a.radius + random.cube();
        let mut pa = path(start.as_dvec3(), random.cube() * random.log_range(0.1, 30.0));
        pa.spin = if i % 3 == 0 { Vec3::ZERO } else { random.cube() * random.range(0.0, 5.0) };
        let mut pb = still(DVec3::ZERO);
        pb.rotation = rotation;
        if i % 7 == 0 {
            pb.spin = random.cube() * 0.1;
        }
        let (hit, open) = check(&a, &plane, (&pa, &pb), 300);
        hits += u32::from(hit);
        misses += u32::from(!hit);
        unsettled += u32::from(open);
    }
    println!("{hits} hits, {misses} misses, {unsettled} unsettled");
    assert!(cfg!(miri) || (hits > 100 && misses > 100));
    assert_eq!(unsettled, 0);
}

/// 500 m/s at 60 Hz is 8.3 m a step.
#[test]
fn a_miss_by_a_millimetre_at_500_metres_a_second_is_a_miss() {
    let target = collider(Geometry::cuboid(0.5, 0.5, 0.5));
    let edge = |x: f64| Vec3::new(8.333, 0.0, 0.0) * x as f32;
    for (shape, half) in [
        (Geometry::Sphere { radius: 0.05 }, 0.05),
        (Geometry::cuboid(0.05, 0.05, 0.05), 0.05),
        (Geometry::capsule(0.1, 0.02), 0.12),
        (Geometry::cylinder(0.1, 0.05), 0.1),
    ] {
        let bullet = collider(shape);
        let eps = tolerance(&bullet, &target, 1.0);
        for x in [0.3, 1.0, 4.0] {
            for (gap, hit) in [(1e-3, false), (-1e-3, true)] {
                let from = DVec3::new(-1.5, 0.5 + half + gap, 0.1);
                let touch = cast(&bullet, &target, (&path(from, edge(x)), &still(DVec3::ZERO)), eps);
                assert_eq!(touch.is_some(), hit, "{:?} {gap} {touch:?}", bullet.geometry);
            }
        }
    }
    // Past a ball: the paths' nearest approach is a single moment.
    let (a, b) = (collider(Geometry::Sphere { radius: 0.05 }), collider(Geometry::Sphere { radius: 0.5 }));
    for (gap, hit) in [(1e-3, false), (2e-4, false), (-1e-5, true), (-1e-3, true)] {
        let from = DVec3::new(-4.0, 0.55 + gap, 0.0);
        let touch = cast(&a, &b, (&path(from, edge(1.0)), &still(DVec3::ZERO)), tolerance(&a, &b, 1.0));
        assert_eq!(touch.is_some(), hit, "{gap}");
    }
}

#[test]
fn a_bullet_stops_at_a_thin_plate() {
    let mut random = Random(13);
    let plate = collider(Geometry::cuboid(2.0, 0.0005, 2.0));
    let bullet = collider(Geometry::Sphere { radius: 0.004 });
    for _ in 0..200 {
        // 2000 m/s at 60 Hz.
        let away = random.direction();
        let away = Vec3::new(away.x, away.y.abs().max(0.2), away.z).normalize();
        let through = random.cube() * Vec3::new(1.5, 0.0, 1.5);
        let before = random.range(0.1, 20.0);
        let from = (through + away * before).as_dvec3();
        let paths = (&path(from, away * -33.0), &still(DVec3::ZERO));
        let touch = cast(&bullet, &plate, paths, tolerance(&bullet, &plate, 1.0)).unwrap();
        let expected = (from.y - 0.0045) / (33.0 * f64::from(away.y));
        assert!((f64::from(touch.fraction) - expected).abs() < 1e-6, "{touch:?} {expected}");
        assert!((touch.normal + Vec3::Y).length() < 1e-3);
    }
}

/// 200 rad/s at 60 Hz is more than half a turn a step. A rod whose tip passes close over a floor, without and
/// with contact; and one against a plate.
#[test]
fn a_spinning_rod_hits_what_its_tip_reaches() {
    let floor = collider(Geometry::cuboid(5.0, 0.5, 5.0));
    let plane = collider(Geometry::Plane);
    for rod in
        [Geometry::capsule(0.48, 0.02), Geometry::cuboid(0.005, 0.5, 0.005), Geometry::cylinder(0.5, 0.01)]
    {
        let rod = collider(rod);
        let reach = f64::from(rod.radius);
        for (gap, hit) in
            [(0.2, false), (1e-2, false), (1e-3, false), (2e-4, false), (-2e-4, true), (-0.1, true)]
        {
            let mut pa = path(DVec3::Y * (reach + gap), Vec3::ZERO);
            pa.rotation = Quat::from_rotation_z(1.2);
            pa.spin = Vec3::new(0.0, 0.0, 200.0 / 60.0);
            let pb = still(DVec3::Y * -0.5);
            for (other, at) in [(&floor, &pb), (&plane, &still(DVec3::ZERO))] {
                let touch = cast(&rod, other, (&pa, at), tolerance(&rod, other, 1.0));
                assert_eq!(touch.is_some(), hit, "{:?} {gap} {touch:?}", rod.geometry);
                check(&rod, other, (&pa, at), 1000);
            }
        }
    }
}

#[test]
fn a_wheel_rolls_along_a_floor_without_touching() {
    let wheel = collider(Geometry::cylinder(0.1, 0.3));
    let floor = collider(Geometry::cuboid(50.0, 0.5, 50.0));
    let mut pa = path(DVec3::Y * 0.3005, Vec3::X * 0.5);
    pa.rotation = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    pa.spin = Vec3::Z * -1.7;
    assert!(cast(&wheel, &floor, (&pa, &still(DVec3::Y * -0.5)), tolerance(&wheel, &floor, 1.0)).is_none());
}

#[test]
fn shapes_that_touch_at_the_start_touch_at_zero() {
    let cube = collider(Geometry::cuboid(0.5, 0.5, 0.5));
    for y in [0.0, 0.9, 1.0, 1.000_04] {
        let paths = (&path(DVec3::Y * y, Vec3::X), &still(DVec3::ZERO));
        assert_eq!(cast(&cube, &cube, paths, tolerance(&cube, &cube, 1.0)).map(|t| t.fraction), Some(0.0));
    }
}

#[test]
fn the_pose_of_the_touch_is_the_kernels_pose() {
    let mut random = Random(14);
    for _ in 0..100 {
        let (mut a, b) = (random.shape(Kind::Box, 1.0), random.shape(Kind::Hull, 1.0));
        a.position = random.cube();
        let body = |random: &mut Random| BodyPath {
            centre: random.cube().as_dvec3() * 4.0,
            rotation: random.turn(),
            displacement: random.cube() * 4.0,
            spin: random.cube() * 3.0,
        };
        let paths = (body(&mut random), body(&mut random));
        let motion = Motion::new(&a, &paths.0, &b, &paths.1);
        let t = random.range(0.0, 1.0);
        let rel = motion.relative(t);
        let pose =
            Pose { rotation: DMat3::from_quat(rel.rotation.as_dquat()), position: rel.position.as_dvec3() };
        let found = core_gap(
            &a.geometry.support().unwrap(),
            &b.geometry.support().unwrap(),
            &pose,
            DVec3::ZERO,
            &mut Simplex::empty(),
            Accuracy { absolute: 0.0, relative: 1e-9 },
        );
        let expected = distance_at(&a, &b, (&paths.0, &paths.1), f64::from(t));
        assert!((found.upper - expected).abs() < 3e-6, "{} {expected}", found.upper);
    }
}
