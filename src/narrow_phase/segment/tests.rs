//! Tests of segments against shapes.

use super::*;
use crate::narrow_phase::fixtures::{CONVEX, collider, depth};
use crate::random::Random;
use crate::shape::Geometry;

fn hit(geometry: Geometry, from: Vec3, to: Vec3) -> Option<SegmentHit> {
    segment_hits(&collider(geometry), from, to)
}

/// Against many points of the segment: none inside before the hit, and at the hit the surface.
#[test]
fn segments_enter_where_dense_samples_do() {
    let mut random = Random(31);
    let (mut hits, mut misses) = (0, 0);
    for i in 0..if cfg!(miri) { 10 } else { 3000 } {
        let size = random.log_range(1e-3, 100.0);
        let shape = random.shape(CONVEX[i % 5], size);
        let far = random.range(0.5, 3.0) * shape.radius;
        let from = random.direction() * far;
        let through = random.cube() * shape.radius;
        let to = match i % 4 {
            // Along an axis: where slabs divide by zero.
            0 => from * Vec3::new(1.0, -2.0, 1.0),
            1 => from * Vec3::new(-2.0, 1.0, 1.0),
            _ => from + (through - from) * random.range(0.5, 3.0),
        };
        let found = segment_hits(&shape, from, to);
        let (p, d) = (from.as_dvec3(), to.as_dvec3() - from.as_dvec3());
        let scale = f64::from(shape.radius);
        let end = found.map_or(1.0, |h| f64::from(h.fraction));
        let inside = depth(&shape, p) > 0.0;
        if inside {
            assert!(found.is_none() || depth(&shape, p) < 1e-5 * scale, "{shape:?} {from} {to}");
            continue;
        }
        for k in 0..200 {
            let t = end * f64::from(k) / 200.0;
            let deep = depth(&shape, p + d * t);
            assert!(deep <= 2e-6 * scale, "{:?} {from} {to}: {deep} at {t} of {found:?}", shape.geometry);
        }
        let Some(found) = found else {
            misses += 1;
            continue;
        };
        hits += 1;
        let at = p + d * end;
        // The tapered capsule of the reference is a row of balls: a little less than the capsule.
        assert!(depth(&shape, at).abs() <= 1e-5 * scale, "{:?} {from} {to} {found:?}", shape.geometry);
        let n = found.normal.as_dvec3();
        assert!((n.length() - 1.0).abs() < 1e-5 && n.dot(d) <= 1e-6 * d.length());
        assert!(depth(&shape, at + n * 1e-3 * scale) < 0.0, "{:?} {from} {to} {found:?}", shape.geometry);
    }
    println!("{hits} hits, {misses} misses");
    assert!(cfg!(miri) || (hits > 700 && misses > 300));
}

#[test]
fn what_grazes_hits_and_what_leaves_does_not() {
    let cube = Geometry::cuboid(0.5, 0.5, 0.5);
    let x = |y: f32| (Vec3::new(-2.0, y, 0.1), Vec3::new(2.0, y, 0.1));
    let hits = |g: &Geometry, (from, to)| hit(g.clone(), from, to).is_some();
    let ball = Geometry::Sphere { radius: 0.5 };
    let cylinder = Geometry::cylinder(0.5, 0.5);
    for shape in [&cube, &cylinder] {
        assert!(hits(shape, x(0.5)) && hits(shape, x(-0.5)) && !hits(shape, x(0.501)));
    }
    assert!(hits(&ball, (Vec3::new(-2.0, 0.5, 0.0), Vec3::new(2.0, 0.5, 0.0))));
    for shape in [&cube, &ball, &cylinder, &Geometry::capsule(0.125, 0.375)] {
        let top = Vec3::Y * 0.5;
        assert!(hits(shape, (top, Vec3::ZERO)), "in from the surface");
        assert!(!hits(shape, (top, Vec3::Y)), "away from it");
        assert!(!hits(shape, (Vec3::ZERO, Vec3::Y * 3.0)), "out from within");
        assert!(!hits(shape, (Vec3::Y, Vec3::Y)), "no way at all");
        // Ends on the surface.
        assert!(hits(shape, (Vec3::Y, top)));
    }
}

#[test]
fn planes_are_crossed_downwards() {
    let at = |a: f32, b: f32| hit(Geometry::Plane, Vec3::new(1.0, a, 2.0), Vec3::new(3.0, b, 2.0));
    assert_eq!(at(1.0, -3.0), Some(SegmentHit { fraction: 0.25, normal: Vec3::Y }));
    assert_eq!(at(0.0, -1.0).map(|h| h.fraction), Some(0.0));
    assert_eq!(at(1.0, 0.0).map(|h| h.fraction), Some(1.0));
    assert_eq!([at(-1.0, 1.0), at(-1.0, -2.0), at(0.0, 1.0), at(1.0, 0.5), at(0.0, 0.0)], [None; 5]);
}

#[test]
fn triangles_face_whoever_comes() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Z];
    let mesh = crate::shape::TriangleMesh::new(corners, vec![[0, 1, 2]]).unwrap();
    let mesh = Geometry::Mesh(mesh.into());
    let at = |y: f32| Vec3::new(0.25, y, 0.25);
    let hit = |from: f32, to: f32| hit(mesh.clone(), at(from), at(to));
    assert_eq!(hit(1.0, -3.0), Some(SegmentHit { fraction: 0.25, normal: Vec3::Y }));
    assert_eq!(hit(-1.0, 1.0), Some(SegmentHit { fraction: 0.5, normal: Vec3::NEG_Y }));
    assert_eq!(hit(1.0, 0.5), None);
}

#[test]
fn a_cone_has_a_tip_and_a_capsule_in_a_ball_is_the_ball() {
    let cone = Geometry::Cylinder { half_height: 1.0, radius_bottom: 1.0, radius_top: 0.0 };
    let down = hit(cone.clone(), Vec3::Y * 3.0, Vec3::Y * -3.0).unwrap();
    assert!((down.fraction - 1.0 / 3.0).abs() < 1e-6);
    // Steeper than the side, from above and from below; along the side itself.
    let steep = hit(cone.clone(), Vec3::new(0.6, 3.0, 0.0), Vec3::new(0.4, -3.0, 0.0)).unwrap();
    assert!(steep.normal.x > 0.5 && steep.normal.y > 0.3);
    let under = hit(cone.clone(), Vec3::new(0.4, -3.0, 0.0), Vec3::new(0.6, 3.0, 0.0)).unwrap();
    assert_eq!(under.normal, Vec3::NEG_Y);
    assert!(hit(cone.clone(), Vec3::new(-0.5, 2.0, 0.0), Vec3::new(1.5, -2.0, 0.0)).is_some());
    assert!(hit(cone, Vec3::new(0.1, 1.0, 0.0), Vec3::new(1.2, -1.0, 0.0)).is_none());
    let ball = Geometry::Capsule { half_height: 0.1, radius_bottom: 1.0, radius_top: 0.5 };
    let top = hit(ball, Vec3::Y * 2.9, Vec3::Y * -1.1).unwrap();
    assert!((top.fraction - 0.5).abs() < 1e-5, "{top:?}");
}
