//! Every pair with a cylinder against a search over directions in f64.

use crate::math::Quat;
use crate::narrow_phase::Relative;
use crate::narrow_phase::contacts::manifold::RawManifold;
use crate::narrow_phase::convex::collide_convex;
use crate::narrow_phase::convex::cylinder::cylinder_triangle;
use crate::narrow_phase::convex::testing::{Compared, Pair, brought, collider, shape};
use crate::narrow_phase::fixtures::CONVEX;
use crate::random::Random;
use crate::shape::{Collider, ConvexHull, Geometry, Kind};
use glam::Vec3;
use std::sync::Arc;

const MARGIN: f32 = 0.05;

/// The error of a manifold [m]: the loss of its normal against the best direction, how far the deepest point
/// is from the depth along the normal, or how far points are outside of the shapes.
fn error(found: &Compared, manifold: &RawManifold) -> f64 {
    let &Compared { distance, along, least, outside } = found;
    if manifold.count == 0 {
        return f64::from(MARGIN) - distance;
    }
    // Tilted by a little, deep overlap takes the surfaces aside. A point's place is known less well than the
    // distance: along a smooth side to its root.
    let outside = outside - 0.05 * (-distance).max(0.0);
    (distance - along).max((least - along).abs()).max(0.5 * outside)
}

/// Two shapes in any attitude (or in one where axes are along or across each other), brought together along
/// any direction until they are about `at` apart [m].
fn near(random: &mut Random, a: &Collider, b: &Collider, at: f32) -> Relative {
    let direction = random.direction();
    let rotation = match random.below(4) {
        0 => Quat::from_rotation_y(random.unit() * 6.0),
        1 => Quat::from_rotation_z(std::f32::consts::FRAC_PI_2) * Quat::from_rotation_y(random.unit() * 6.0),
        _ => random.turn(),
    };
    brought(a, b, direction, rotation, at)
}

/// How many contacts of pairs with a cylinder are off by more than a millimetre, on shapes of about a metre;
/// half of that may be the preference of a flat face.
fn failures(seed: u64, rounds: usize) -> usize {
    let mut failed = 0;
    for (i, other) in CONVEX.into_iter().enumerate() {
        let (a, b) = (Kind::Cylinder.min(other), Kind::Cylinder.max(other));
        let (mut random, mut worst) = (Random(seed + i as u64), 0.0f64);
        for _ in 0..if cfg!(miri) { 2 } else { rounds } {
            let (one, two) = (shape(&mut random, a), shape(&mut random, b));
            let at = [-0.05, -0.02, -0.005, -0.001, 0.0, 0.002, 0.03][random.below(7)];
            let rel = near(&mut random, &one, &two, at);
            let manifold = collide_convex(&one, &two, &rel, MARGIN);
            let found = Pair { a: &one, b: &two, rel }.compare(&manifold, MARGIN);
            worst = worst.max(error(&found, &manifold));
            if error(&found, &manifold) > 1e-3 {
                failed += 1;
                println!("{found:?} {a:?} {:?} {b:?} {:?} {rel:?}\n{manifold:?}", one.size, two.size);
            }
        }
        println!("{a:?} {b:?}: {worst}");
    }
    failed
}

#[test]
fn contacts_agree_with_a_search_over_directions() {
    assert_eq!(failures(0, 60), 0);
}

#[test]
#[ignore = "long"]
fn many_more_contacts_agree_with_a_search_over_directions() {
    assert_eq!(failures(100, 400), 0);
}

/// A triangle is a hull that is 0.2 mm thick: apart from it the two are felt alike, at faces, edges and
/// corners.
#[test]
fn a_triangle_is_touched_as_a_thin_hull() {
    let mut random = Random(9);
    let top = [Vec3::new(-0.9, 0.0, -0.6), Vec3::new(0.8, 0.0, -0.7), Vec3::new(0.1, 0.0, 0.9)];
    let points: Vec<Vec3> = top.into_iter().chain(top.map(|p| p - Vec3::Y * 2e-4)).collect();
    let hull = collider(Geometry::Hull(Arc::new(ConvexHull::new(&points).unwrap())));
    for _ in 0..if cfg!(miri) { 5 } else { 200 } {
        let one = shape(&mut random, Kind::Cylinder);
        let at = [0.001, 0.002, 0.01, 0.03][random.below(4)];
        let rel = near(&mut random, &one, &hull, at);
        let pair = Pair { a: &one, b: &hull, rel };
        let distance = pair.signed_distance();
        let manifold = cylinder_triangle(&one, top.map(|p| rel.position + rel.rotation * p), MARGIN);
        let what = format!("{:?} {rel:?} {manifold:?} {distance}", one.size);
        if distance < 3e-4 || distance > 0.9 * f64::from(MARGIN) {
            continue;
        }
        assert!(manifold.count > 0, "{what}");
        let along = pair.along(manifold.normal.as_dvec3().normalize());
        let least = manifold.least();
        assert!(distance - along < 1.2e-3, "{along} {what}");
        assert!((f64::from(least) - along).abs() < 1.2e-3, "{along} {what}");
    }
}

/// Rim against rim: two equal discs side by side and tilted by 2 φ meet where their rims are nearest, on the
/// line between their middles; by the geometry of the section through both axes.
#[test]
fn two_rims_meet_in_one_point_between_the_axes() {
    let wheel = collider(Geometry::cylinder(0.1, 0.5));
    for (lean, gap) in [(0.2f32, 0.01f32), (0.2, -0.01), (0.6, 0.01), (0.6, -0.002)] {
        // The second leans away from the first in the plane of both: of the first the side's middle is not
        // reached.
        let rotation = Quat::from_rotation_z(lean);
        let (s, c) = (libm::sinf(lean), libm::cosf(lean));
        // The lowest rim point of the second, towards the first, is (-c r, -s r) + (s h, -c h) from its
        // middle or with +h, whichever is further to the left.
        let left = 0.5 * c + 0.1 * s;
        let height = 0.1 * c - 0.5 * s;
        let rel = Relative { position: Vec3::new(0.5 + left + gap, -height, 0.0), rotation };
        let manifold = collide_convex(&wheel, &wheel, &rel, MARGIN);
        assert_eq!(manifold.count, 1, "{manifold:?}");
        assert!((manifold.normal - Vec3::X).length() < 2e-3, "{manifold:?}");
        assert!((manifold.points[0].separation - gap).abs() < 1e-5, "{manifold:?}");
        assert!((manifold.points[0].position - Vec3::new(0.5 + 0.5 * gap, 0.0, 0.0)).length() < 2e-3);
    }
}

/// A cylinder that stands on its cap touches with four points of its rim, one that lies with both ends of a
/// line; on a triangle too.
#[test]
fn at_rest_it_stands_on_four_points_and_lies_on_two() {
    let (h, r) = (0.4f32, 0.5f32);
    let drum = collider(Geometry::cylinder(h, r));
    let slab = collider(Geometry::cylinder(0.2, 3.0));
    let floor = [Vec3::new(-9.0, 0.0, -8.0), Vec3::new(9.0, 0.0, -8.0), Vec3::new(0.0, 0.0, 9.0)];
    for i in 0..50 {
        let spin = Quat::from_rotation_y(0.13 * i as f32);
        for (rotation, height, count) in
            [(spin, h, 4), (Quat::from_rotation_z(std::f32::consts::FRAC_PI_2) * spin, r, 2)]
        {
            let middle = Vec3::new(0.2, height - 1e-3, -0.1);
            let back = rotation.conjugate();
            let local = |p: Vec3| back * (p - middle);
            let on_mesh = cylinder_triangle(&drum, floor.map(local), MARGIN);
            let rel = Relative { position: local(Vec3::NEG_Y * 0.2), rotation: back };
            let on_slab = collide_convex(&drum, &slab, &rel, MARGIN);
            for manifold in [on_mesh, on_slab] {
                assert_eq!(manifold.count, count, "{i} {manifold:?}");
                assert!((rotation * manifold.normal + Vec3::Y).length() < 1e-5, "{i} {manifold:?}");
                for p in manifold.points() {
                    assert!((p.separation + 1e-3).abs() < 1e-5, "{i} {manifold:?}");
                    let along_axis = p.position.y.abs();
                    let round = p.position.x.hypot(p.position.z);
                    assert!((along_axis - h).abs() < 1e-3 && (round - r).abs() < 2e-3, "{i} {manifold:?}");
                }
            }
        }
    }
}
