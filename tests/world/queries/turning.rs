//! Casts of shapes that turn: computed angles, dense samples, and equality with straight casts.

use super::*;

const HERE: DVec3 = DVec3::ZERO;

fn hit(world: &World, cast: &ShapeCast<'_>) -> Option<ShapeHit> {
    let hit = world.cast_shape(cast, &ALL()).unwrap();
    assert_eq!(world.cast_shape_any(cast, &ALL()).unwrap(), hit.is_some());
    let mut all = Vec::new();
    world.cast_shape_all(cast, &ALL(), &mut all).unwrap();
    assert_eq!(all.first(), hit.as_ref());
    hit
}

/// Expected: a rod of radius r that turns about its end meets a ball of radius R at the distance D and the
/// angle p when it is at p - asin((r + R) / D).
#[test]
fn a_rod_about_its_end_meets_a_ball_at_the_computed_angle() {
    for (reach, angle, radius) in [(1.2_f64, 0.9_f64, 0.2_f64), (1.9, 2.5, 0.1), (0.7, 5.0, 0.3)] {
        for far in [0.0, 1e6] {
            let mut world = world();
            let end = DVec3::new(far, 2.0, -far);
            let at = end + DVec3::new(reach * angle.cos(), reach * angle.sin(), 0.0);
            add(&mut world, BodyDesc::fixed().with_position(at), ball(radius as f32));
            // Along x from its end.
            let rod = Geometry::capsule(1.0, 0.05);
            let spin = Vec3::Z * 6.0;
            let cast = ShapeCast::new(&rod, end + DVec3::X, Vec3::ZERO)
                .with_rotation(Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2))
                .with_spin(spin)
                .with_pivot(Vec3::NEG_Y);
            let found = hit(&world, &cast).unwrap();
            let expected = (angle - ((0.05 + radius) / reach).asin()) / 6.0;
            let off = f64::from(found.fraction) - expected;
            // Early by the tolerance of a cast, and the rounding of positions far out.
            assert!(off <= 1e-7 && off > -1e-5 / reach, "{reach} {angle} {far}: {off}");
            assert!((found.point.distance(at) - radius).abs() < 1e-5);
            assert_eq!(found.depth, 0.0);
            // It stops before the ball if it turns less.
            let short = cast.with_spin(spin * (expected as f32 * 0.9999));
            assert_eq!(hit(&world, &short), None);
            let beyond = cast.position_at(found.fraction);
            assert!(beyond.distance(end) < 1.0 + 1e-6);
        }
    }
}

/// Expected: the corner of a square of half side a is at a √2 sin(π/4 + angle) below its middle.
#[test]
fn a_box_that_turns_meets_a_plane_and_a_slab_with_its_corner() {
    let height = 1.3;
    for (geometry, top) in
        [(Geometry::Plane, 0.0), (Geometry::cuboid(9.0, 1.0, 9.0), 1.0), (flat_field(), 0.0)]
    {
        let mut world = world();
        let shift = if matches!(geometry, Geometry::HeightField(_)) { -4.0 } else { 0.0 };
        add(&mut world, BodyDesc::fixed().with_position(DVec3::new(shift, 0.0, shift)), geometry);
        let cube = Geometry::cuboid(1.0, 1.0, 1.0);
        let cast = ShapeCast::new(&cube, DVec3::Y * (top + height), Vec3::ZERO).with_spin(Vec3::Z);
        let found = hit(&world, &cast).unwrap();
        let expected = (height / 2.0_f64.sqrt()).asin() - std::f64::consts::FRAC_PI_4;
        assert!((f64::from(found.fraction) - expected).abs() < 1e-5, "{found:?} {expected}");
        assert!(found.normal.distance(Vec3::Y) < 1e-3, "{found:?}");
        // Turning back and forth are the same, by symmetry; about the upright axis nothing is met.
        let back = hit(&world, &cast.with_spin(Vec3::NEG_Z)).unwrap();
        assert!((back.fraction - found.fraction).abs() < 1e-5);
        assert_eq!(hit(&world, &cast.with_spin(Vec3::Y * 30.0)), None);
    }
}

/// Shapes of every kind around the origin.
fn obstacles() -> Vec<World> {
    let mut random = Random(11);
    let mut worlds: Vec<World> = (0..5)
        .map(|kind| {
            let mut world = world();
            let turned = random.rotation();
            add(&mut world, BodyDesc::fixed().with_rotation(turned), convex(&mut random, kind));
            world
        })
        .collect();
    worlds.push(alone(Geometry::Plane));
    let heights = (0..81).map(|_| random.range(-0.5, 0.5)).collect();
    let field = HeightField::new(9, 9, Vec2::splat(0.5), heights).unwrap();
    let mut hill = world();
    add(
        &mut hill,
        BodyDesc::fixed().with_position(DVec3::new(-2.0, 0.0, -2.0)),
        Geometry::HeightField(Arc::new(field)),
    );
    worlds.push(hill);
    let corners: Vec<Vec3> = (0..24).map(|_| random.cube() * 1.2).collect();
    let triangles = (0..8).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut soup = world();
    let turned = random.rotation();
    let mesh = Geometry::Mesh(Arc::new(TriangleMesh::new(corners, triangles).unwrap()));
    add(&mut soup, BodyDesc::fixed().with_rotation(turned), mesh);
    worlds.push(soup);
    worlds
}

/// Expected: by samples, no overlap before the touch, and none at all without one; at the touch a gap of some
/// micrometres, closed by a short straight cast.
#[test]
fn turning_casts_agree_with_dense_samples() {
    let mut random = Random(3);
    let (mut touched, mut missed) = (0, 0);
    for (kind, world) in obstacles().iter().enumerate() {
        for round in 0..120 {
            let form = convex(&mut random, round);
            let from = random.cube().as_dvec3() * 3.0 + DVec3::Y * 1.5;
            let spin = random.cube() * [0.3, 3.0, 12.0][round % 3];
            let path = (random.cube() * 2.0).as_dvec3() - from * f64::from(random.unit());
            let cast = ShapeCast::new(&form, from, path.as_vec3())
                .with_rotation(random.rotation())
                .with_spin(spin)
                .with_pivot(if round % 4 == 0 { random.cube() } else { Vec3::ZERO });
            let overlaps = |t: f32| {
                let turned = cast.rotation_at(t);
                world.overlap_any(&form, cast.position_at(t), turned, &ALL()).unwrap()
            };
            let found = hit(world, &cast);
            let name = format!("{kind} {round}: {cast:?} {found:?}");
            let until = found.map_or(1.0, |found| found.fraction);
            for i in 0..400 {
                let t = until * i as f32 / 400.0;
                assert!(!overlaps(t) || until == 0.0, "{name} at {t}");
            }
            let Some(found) = found else {
                missed += 1;
                assert!(!overlaps(1.0), "{name}");
                continue;
            };
            touched += 1;
            if found.fraction == 0.0 {
                assert!(overlaps(0.0) || found.depth == 0.0, "{name}");
                continue;
            }
            assert_eq!(found.depth, 0.0);
            // Poses are rounded to f32, and so is the place of the touch.
            let closing = ShapeCast::new(&form, cast.position_at(until), found.normal * -5e-5);
            let closing = closing.with_rotation(cast.rotation_at(until));
            assert!(world.cast_shape_any(&closing, &ALL()).unwrap(), "{name}");
            let near = world.closest_point(found.point, 1e-4, &ALL()).unwrap();
            assert!(near.is_some(), "{name}");
        }
    }
    println!("{touched} touches, {missed} misses");
    assert!(touched > 200 && missed > 200);
}

/// Expected: bits, without spin; a short time, with a small one.
#[test]
fn without_spin_it_is_the_straight_cast() {
    let mut random = Random(8);
    let order: Vec<usize> = (0..60).collect();
    let world = crowd(HERE, 5, &order);
    for round in 0..200 {
        let form = convex(&mut random, round);
        let cast = ShapeCast::new(&form, random.cube().as_dvec3() * 20.0, random.cube() * 20.0)
            .with_rotation(random.rotation());
        let straight = hit(&world, &cast);
        assert_eq!(hit(&world, &cast.with_pivot(random.cube())), straight);
        let turned = hit(&world, &cast.with_spin(Vec3::X * 1e-9));
        if let (Some(one), Some(other)) = (straight, turned) {
            assert!((one.fraction - other.fraction).abs() < 1e-4, "{one:?} {other:?}");
        }
    }
}

/// Expected: kinematics.
#[test]
fn a_motion_is_said_in_three_ways() {
    let form = Geometry::cuboid(0.5, 0.2, 0.1);
    let turned = Quat::from_rotation_y(0.4);
    let moving =
        ShapeCast::moving(&form, DVec3::ONE, Vec3::X * 3.0, Vec3::Y * 2.0, 0.5).with_rotation(turned);
    assert_eq!((moving.path, moving.spin), (Vec3::X * 1.5, Vec3::Y));
    let end = (moving.position_at(1.0), moving.rotation_at(1.0));
    assert!(end.0.distance(DVec3::new(2.5, 1.0, 1.0)) < 1e-7);
    assert!(end.1.angle_between(Quat::from_rotation_y(1.4)) < 1e-3);
    let between = ShapeCast::between(&form, (DVec3::ONE, turned), end);
    assert!(between.spin.distance(Vec3::Y) < 1e-5 && between.path == moving.path);
    // About a corner, which stays where it is.
    let corner = Vec3::new(0.5, 0.2, 0.1);
    let about = ShapeCast::new(&form, HERE, Vec3::ZERO).with_spin(Vec3::ONE * 2.0).with_pivot(corner);
    for t in [0.0, 0.3, 1.0] {
        let place = about.position_at(t) + (about.rotation_at(t) * corner).as_dvec3();
        assert!(place.distance(corner.as_dvec3()) < 1e-6, "{place}");
    }
    let world = alone(ball(1.0));
    for spin in [Vec3::NAN, Vec3::X * 1001.0] {
        assert!(world.cast_shape(&moving.with_spin(spin), &ALL()).is_err());
    }
    assert!(world.cast_shape(&moving.with_pivot(Vec3::INFINITY), &ALL()).is_err());
}

/// Expected: by its rules: an overlap counts with its depth, and with `skip_inside` only if it goes deeper.
#[test]
fn overlaps_at_the_start_follow_the_rules() {
    let world = alone(Geometry::cuboid(1.0, 1.0, 1.0));
    let form = Geometry::cuboid(0.5, 0.1, 0.1);
    // Its left end is 0.1 m in the right side; the middle is outside.
    let cast = ShapeCast::new(&form, DVec3::X * 1.4, Vec3::ZERO).with_spin(Vec3::Z);
    let found = hit(&world, &cast).unwrap();
    assert!(found.fraction == 0.0 && (found.depth - 0.1).abs() < 1e-4, "{found:?}");
    assert!(found.normal.distance(Vec3::X) < 1e-4);
    let skipping = ALL().skipping_inside();
    assert_eq!(world.cast_shape(&ShapeCast { path: Vec3::X, ..cast }, &skipping).unwrap(), None);
    let deeper = world.cast_shape(&ShapeCast { path: Vec3::NEG_X, ..cast }, &skipping).unwrap().unwrap();
    assert_eq!(deeper.fraction, 0.0);
}
