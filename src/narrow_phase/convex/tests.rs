use super::testing::*;
use super::*;
use crate::math::Quat;
use crate::narrow_phase::fixtures::CONVEX;
use crate::shape::{ConvexHull, Geometry};
use std::sync::Arc;

const MARGIN: f32 = 0.05;

/// How far normal and points may be from the reference [m]: faces are preferred by 5 % of the overlap and
/// half a millimetre.
fn tolerance(pair: &Pair, distance: f64) -> f64 {
    let size = f64::from(pair.a.radius.min(pair.b.radius));
    1e-5 + 1e-3 * size + 0.06 * (-distance).max(0.0)
}

fn check(pair: &Pair) -> RawManifold {
    let manifold = collide_convex(pair.a, pair.b, &pair.rel, MARGIN);
    let Compared { distance, along, least, outside } = pair.compare(&manifold, MARGIN);
    let tolerance = tolerance(pair, distance);
    let margin = f64::from(MARGIN);
    let kinds = (pair.a.kind, pair.a.size, pair.b.kind, pair.b.size);
    let what = format!("{kinds:?} {:?}\n{manifold:?}\ndistance {distance}", pair.rel);
    if manifold.count == 0 {
        assert!(distance > margin - tolerance, "missed: {what}");
        // Nearer than the slow reference is exact to.
        let [a, b] = [pair.a, pair.b].map(|shape| shape.geometry.support().unwrap());
        let exact = gjk::distance(&a, &b, &pair.rel, Vec3::ZERO).distance;
        assert!(manifold.gap() < exact + 1e-5, "{exact}, nearer than said: {what}");
        return manifold;
    }
    assert!(distance < margin + tolerance, "too far: {what}");
    assert!((manifold.normal.length() - 1.0).abs() < 1e-5, "normal: {what}");
    // A nearly flat face may stand for edges: parts beside it reach below it, but it is as deep as they are,
    // and moved out along its normal by that depth the shapes are apart.
    let solid = |kind| matches!(kind, Kind::Box | Kind::Hull);
    let by_flat_face = solid(pair.a.kind) && solid(pair.b.kind) && manifold.count > 1 && distance < 0.0;
    let depth = if by_flat_face && along < distance - tolerance {
        let mut rel = pair.rel;
        rel.position -= manifold.normal * distance as f32;
        let left = Pair { a: pair.a, b: pair.b, rel }.signed_distance();
        assert!(left > -tolerance, "{left} left, along the normal: {what}");
        distance
    } else {
        along
    };
    assert!(depth > distance - tolerance, "not the way out, {along}: {what}");
    assert!((least - depth).abs() < tolerance, "depth {least} but {along} along the normal: {what}");
    assert!(outside < 2.0 * tolerance, "off by {outside}: {what}");
    manifold
}

/// Random poses at which the signed distance is near `at` [m].
fn sweep(a: Kind, b: Kind, seed: u64, rounds: usize) {
    let mut random = Random(seed);
    for round in 0..rounds {
        let (one, two) = (shape(&mut random, a), shape(&mut random, b));
        let (direction, rotation) = (random.direction(), random.turn());
        let rotation = if round % 5 == 4 { Quat::IDENTITY } else { rotation };
        let at = [-0.1, -0.02, -0.001, 0.002, 0.03][random.below(5)];
        check(&Pair { a: &one, b: &two, rel: brought(&one, &two, direction, rotation, at) });
    }
}

#[test]
fn round_pairs_agree_with_the_slow_reference() {
    for (i, a) in CONVEX[..2].iter().enumerate() {
        for (j, b) in CONVEX.iter().enumerate().skip(i) {
            sweep(*a, *b, (10 * i + j) as u64, 20);
        }
    }
}

#[test]
fn boxes_and_hulls_agree_with_the_slow_reference() {
    sweep(Kind::Box, Kind::Box, 1, 60);
    sweep(Kind::Box, Kind::Hull, 2, 60);
    sweep(Kind::Hull, Kind::Hull, 3, 60);
}

#[test]
fn cylinders_agree_with_the_slow_reference() {
    sweep(Kind::Box, Kind::Cylinder, 1, 40);
    sweep(Kind::Cylinder, Kind::Hull, 2, 40);
    sweep(Kind::Cylinder, Kind::Cylinder, 3, 40);
}

/// More of the above; says how many poses fail and shows each.
#[test]
#[ignore = "long"]
fn many_more_poses_agree_with_the_slow_reference() {
    let mut failed = vec![];
    for (i, a) in CONVEX.into_iter().enumerate() {
        for b in CONVEX.into_iter().skip(i) {
            for seed in 0..150 {
                if std::panic::catch_unwind(|| sweep(a, b, 1000 + seed, 2)).is_err() {
                    failed.push((a, b, seed));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} of 4500: {failed:?}", failed.len());
}

fn at(y: f32) -> Relative {
    Relative { position: Vec3::Y * y, rotation: Quat::IDENTITY }
}

/// Splinters: the face that looks at the wall most need not have the vertex that is nearest to it. The
/// distance is the height of the lowest vertex, at any margin.
#[test]
fn the_nearest_vertex_of_a_splinter_is_found_at_any_distance() {
    let mut random = Random(14);
    let wall = collider(Geometry::cuboid(50.0, 50.0, 0.01));
    for round in 0..2000 {
        let size = Vec3::new(0.1, 0.02 + 0.08 * random.unit(), 0.01);
        let points: Vec<Vec3> = (0..8 + random.below(20)).map(|_| random.direction() * size).collect();
        let splinter = collider(Geometry::Hull(Arc::new(ConvexHull::new(&points).unwrap())));
        let rotation =
            if round % 2 == 0 { random.turn() } else { Quat::from_rotation_x(0.2 * random.unit()) };
        let height = 0.5 * random.unit();
        let lowest = extent(&splinter, (rotation.conjugate() * Vec3::NEG_Z).as_dvec3());
        let position = Vec3::new(-45.0, 20.0, 0.01 + lowest as f32 + height);
        let manifold = collide_convex(&wall, &splinter, &Relative { position, rotation }, 4.0);
        let least = manifold.points().iter().map(|p| p.separation).fold(f32::MAX, f32::min);
        assert!((least - height).abs() < 1e-4, "{round}: {least} at {height}\n{manifold:?}");
        assert!((manifold.normal - Vec3::Z).length() < 1e-5, "{round}: {manifold:?}");
    }
}

/// The equal box on top covers the one below: contact in all four corners, however they are turned.
#[test]
fn equal_boxes_on_top_of_each_other_meet_in_four_corners() {
    let one = collider(Geometry::cuboid(0.5, 0.4, 0.3));
    for y in [0.79, 0.8, 0.81] {
        let manifold = check(&Pair { a: &one, b: &one, rel: at(y) });
        assert_eq!(manifold.count, 4);
        assert_eq!(manifold.normal, Vec3::Y);
        for p in manifold.points() {
            assert!((p.position.abs() - Vec3::new(0.5, 0.5 * y, 0.3)).abs().max_element() < 1e-3);
            assert!((p.separation - (y - 0.8)).abs() < 1e-6);
        }
        // A hair aside, the same features meet.
        let mut rel = at(y);
        rel.position += Vec3::new(2e-5, 0.0, -1e-5);
        let moved = collide_convex(&one, &one, &rel, MARGIN);
        assert_eq!(moved.points.map(|p| p.key), manifold.points.map(|p| p.key));
    }
}

#[test]
fn identical_hulls_at_one_place_and_other_degenerate_poses_give_numbers() {
    let mut random = Random(11);
    for a in CONVEX {
        for b in CONVEX {
            let (one, two) = (shape(&mut random, a.min(b)), shape(&mut random, a.max(b)));
            let same = if a == b { &one } else { &two };
            for position in [Vec3::ZERO, Vec3::Y * 1e-20, Vec3::X * 1e10] {
                for rotation in [Quat::IDENTITY, Quat::from_xyzw(1.0, 0.0, 0.0, 0.0)] {
                    let manifold = collide_convex(&one, same, &Relative { position, rotation }, MARGIN);
                    assert!(manifold.normal.is_finite());
                    assert_eq!(manifold.count == 0, position.x > 1.0, "{a:?} {b:?}");
                    for p in manifold.points() {
                        assert!(p.position.is_finite() && p.separation.is_finite());
                    }
                }
            }
        }
    }
    // Needles, plates and cones.
    let thin = [
        Geometry::cuboid(1.0, 1e-4, 1.0),
        Geometry::cuboid(1e-4, 1.0, 1e-4),
        Geometry::cylinder(1e-3, 1.0),
        Geometry::cylinder(1.0, 1e-3),
        Geometry::Cylinder { half_height: 0.5, radius_bottom: 0.5, radius_top: 0.0 },
        Geometry::Cylinder { half_height: 0.5, radius_bottom: 0.0, radius_top: 0.5 },
        Geometry::capsule(0.0, 0.1),
    ]
    .map(collider);
    for a in &thin {
        for b in &thin {
            for _ in 0..20 {
                let rel = Relative { position: random.cube() * 0.5, rotation: random.turn() };
                let manifold = collide_convex(a, b, &rel, MARGIN);
                assert!(manifold.normal.is_finite());
                assert!(manifold.points().iter().all(|p| p.position.is_finite() && p.separation <= MARGIN));
            }
        }
    }
}

/// By the geometry of the shapes: the points that touch the plane are known.
#[test]
fn shapes_rest_on_a_half_space_by_their_lowest_points() {
    let plane = collider(Geometry::Plane);
    let rests = |geometry: Geometry, rotation: Quat, height: f32| {
        let rel =
            Relative { position: rotation.conjugate() * Vec3::Y * -height, rotation: rotation.conjugate() };
        let manifold = collide_convex(&collider(geometry), &plane, &rel, MARGIN);
        let down = rotation * manifold.normal;
        assert!((down - Vec3::NEG_Y).length() < 1e-6);
        for p in manifold.points() {
            let world = rotation * p.position + Vec3::Y * height;
            assert!((world.y - 0.5 * p.separation).abs() < 1e-5);
        }
        manifold
    };
    let quarter = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
    assert_eq!(rests(Geometry::Sphere { radius: 1.0 }, quarter, 0.99).count, 1);
    assert_eq!(rests(Geometry::capsule(1.0, 0.5), quarter, 0.51).count, 2);
    assert_eq!(rests(Geometry::capsule(1.0, 0.5), Quat::IDENTITY, 1.51).count, 1);
    assert_eq!(rests(Geometry::cuboid(1.0, 0.5, 1.0), Quat::IDENTITY, 0.49).count, 4);
    assert_eq!(rests(Geometry::cylinder(1.0, 0.5), Quat::IDENTITY, 0.99).count, 4);
    // A cylinder that rolls touches with both ends of one line at every angle, just at its radius.
    for i in 0..100 {
        let turned = quarter * Quat::from_rotation_y(0.1 * i as f32);
        let manifold = rests(Geometry::cylinder(1.0, 0.5), turned, 0.49);
        assert_eq!(manifold.count, 2);
        assert!(manifold.points().iter().all(|p| (p.separation + 0.01).abs() < 1e-6));
    }
}

/// The same cylinder on a box: as on the plane.
#[test]
fn a_cylinder_rolls_and_stands_on_a_box_as_on_a_plane() {
    let (ground, drum) = (collider(Geometry::cuboid(5.0, 1.0, 5.0)), collider(Geometry::cylinder(1.0, 0.5)));
    for i in 0..100 {
        let rotation =
            Quat::from_rotation_z(std::f32::consts::FRAC_PI_2) * Quat::from_rotation_y(0.1 * i as f32);
        for height in [1.49, 1.51] {
            let rel = Relative { position: Vec3::new(0.3, height, 0.1), rotation };
            let manifold = collide_convex(&ground, &drum, &rel, MARGIN);
            assert_eq!(manifold.count, 2, "{i}: {manifold:?}");
            assert!((manifold.normal - Vec3::Y).length() < 1e-5);
            assert!(manifold.points().iter().all(|p| (p.separation - (height - 1.5)).abs() < 1e-5));
        }
        let standing = Quat::from_rotation_y(0.1 * i as f32);
        let rel = Relative { position: Vec3::new(0.3, 1.99, 0.1), rotation: standing };
        let manifold = collide_convex(&ground, &drum, &rel, MARGIN);
        assert_eq!(manifold.count, 4);
        let spread = manifold.points().iter().map(|p| (p.position - rel.position).x.abs()).sum::<f32>();
        assert!(spread > 0.99, "{spread}");
    }
    // Two logs, one on the other: the normal joins their axes.
    let turn = Quat::from_rotation_y(0.3);
    let manifold =
        collide_convex(&drum, &drum, &Relative { position: Vec3::new(0.6, 0.0, 0.79), rotation: turn }, 0.01);
    assert_eq!(manifold.count, 2);
    assert!((manifold.normal - Vec3::new(0.6, 0.0, 0.79).normalize()).length() < 1e-3, "{manifold:?}");
}

/// A corner that passes beside a face is not in its way: the normal is the way between the corners.
#[test]
fn apart_at_corners_the_normal_joins_the_nearest_points() {
    let one = collider(Geometry::cuboid(0.5, 0.5, 0.5));
    let rel = Relative { position: Vec3::new(1.02, 1.02, 0.2), rotation: Quat::IDENTITY };
    let manifold = check(&Pair { a: &one, b: &one, rel });
    assert!((manifold.normal - Vec3::new(1.0, 1.0, 0.0).normalize()).length() < 1e-4);
    assert_eq!(manifold.count, 2);
}

#[test]
fn a_pair_in_the_wrong_order_is_the_same_contact_seen_from_the_other() {
    let mut random = Random(3);
    let (one, two) = (shape(&mut random, Kind::Sphere), shape(&mut random, Kind::Hull));
    let rotation = random.turn();
    let rel = Relative { position: Vec3::X * (one.radius + 0.3), rotation };
    let (forth, other) =
        (collide_convex(&one, &two, &rel, 2.0), collide_convex(&two, &one, &rel.inverse(), 2.0));
    assert!(forth.count > 0 && (other.normal + rotation.conjugate() * forth.normal).length() < 1e-5);
}

/// A hull of the corners of a box.
fn box_of_planes(half: Vec3) -> Collider {
    let sign = |i: usize| if i & 1 == 0 { -1.0 } else { 1.0 };
    let corners: Vec<Vec3> = (0..8).map(|i| half * Vec3::new(sign(i), sign(i >> 1), sign(i >> 2))).collect();
    testing::collider(Geometry::hull(ConvexHull::new(&corners).unwrap()))
}

/// A shape over the middle of the face of a wide box, apart or in it by a hair, and leaning by a hair.
/// Expected: the contact is as near as the lowest point, however far around contacts are looked for. By a
/// face that leans the other one, wider by far, shows less than the truth.
#[test]
fn what_lies_in_the_middle_of_a_face_touches_that_face() {
    let mut random = testing::Random(1);
    let half = Vec3::new(1.05, 0.23, 1.05);
    let grounds = [box_of_planes(half), testing::collider(Geometry::cuboid(half.x, half.y, half.z))];
    for i in 0..100_000 {
        let size = Vec3::new(random.range(0.2, 0.5), random.range(0.2, 0.4), random.range(0.2, 0.5));
        let shape = match i % 3 {
            0 => testing::collider(Geometry::cuboid(size.x, size.y, size.z)),
            1 => box_of_planes(size),
            _ => testing::collider(Geometry::cylinder(size.y, size.x)),
        };
        let lean = random.direction() * libm::powf(10.0, random.range(-7.0, -3.0));
        let turn = Quat::from_rotation_y(random.range(-3.0, 3.0))
            * Quat::from_xyzw(lean.x, 0.0, lean.z, 1.0).normalize();
        let gap = random.range(-3e-4, 3e-4);
        let at = Vec3::new(random.range(-0.3, 0.3), half.y + size.y + gap, random.range(-0.3, 0.3));
        let low =
            -testing::extent(&shape, (turn.conjugate() * Vec3::NEG_Y).as_dvec3()) as f32 + at.y - half.y;
        let rel = Relative { position: at, rotation: turn }.inverse();
        let margin = [0.02, 0.3, 0.9][i / 6 % 3];
        let raw = collide_convex(&shape, &grounds[i / 3 % 2], &rel, margin);
        let nearest = raw.points().iter().map(|p| p.separation).fold(f32::INFINITY, f32::min);
        // Along a normal that leans a point may show as much less as it is away from the middle.
        assert!((nearest - low).abs() < 2e-4, "{i} {margin} {gap} {lean}: {nearest} for {low}, {raw:?}");
        assert!(raw.count > 2, "{i} {margin} {gap} {lean}: {raw:?}");
    }
}

/// A wheel on the level of a face, beside it. Expected: as far from the face as its nearest point. A contact
/// as near as the face is low would be pushed as the wheel turns.
#[test]
fn a_wheel_beside_a_face_touches_the_border() {
    let mut random = testing::Random(2);
    let half = Vec3::new(1.05, 0.23, 1.05);
    let grounds = [box_of_planes(half), testing::collider(Geometry::cuboid(half.x, half.y, half.z))];
    for i in 0..40_000 {
        let (radius, width) = (random.range(0.15, 0.5), random.range(0.05, 0.2));
        let round =
            if i % 3 == 0 { Geometry::capsule(width, radius) } else { Geometry::cylinder(width, radius) };
        let (shape, ground) = (testing::collider(round), &grounds[i / 3 % 2]);
        let turn = Quat::from_rotation_y(random.range(-3.0, 3.0))
            * Quat::from_rotation_x(std::f32::consts::FRAC_PI_2)
            * Quat::from_rotation_y(random.range(-3.0, 3.0));
        let gap = random.range(-2e-5, 2e-5);
        let at = Vec3::new(random.range(0.8, 1.3), half.y + radius + gap, random.range(-1.3, 1.3));
        let rel = Relative { position: at, rotation: turn }.inverse();
        let raw = collide_convex(&shape, ground, &rel, 0.3);
        let (one, other) = (shape.geometry.support().unwrap(), ground.geometry.support().unwrap());
        let apart = gjk::distance(&one, &other, &rel, Vec3::ZERO);
        let nearest = raw.points().iter().map(|p| p.separation).fold(f32::INFINITY, f32::min);
        // A shape that leans by little acts near the lowest line.
        let across = (turn * Vec3::Y).cross(Vec3::Y);
        let off = |p: &RawPoint| (turn * p.position).dot(across).abs();
        let worst = raw.points().iter().map(off).fold(0.0, f32::max);
        let level = (turn * raw.normal).y < -0.9999;
        assert!(!level || worst < 0.02 * radius + 1e-3, "{i} {at} {gap}: {worst} {raw:?}");
        if apart.overlap || apart.distance < 1e-3 || apart.distance > 0.3 {
            continue;
        }
        assert!((nearest - apart.distance).abs() < 5e-4, "{i} {at} {gap}: {nearest} for {apart:?}, {raw:?}");
    }
}
