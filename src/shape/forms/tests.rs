use crate::shape::{ConvexHull, Geometry};
use glam::Vec3;
use std::sync::Arc;

/// Smallest and largest distance of the surface from the origin, over a section through the y axis.
fn surface(points: impl Iterator<Item = (f32, f32)>) -> (f32, f32) {
    points.map(|(x, y)| x.hypot(y)).fold((f32::MAX, 0.0), |(a, b), d| (a.min(d), b.max(d)))
}

#[test]
fn radii_of_a_frustum_are_those_of_its_surface() {
    for (h, a, b) in [(1.0_f32, 0.5_f32, 0.5_f32), (0.3, 1.0, 0.2), (2.0, 0.0, 1.0), (0.2, 3.0, 0.0)] {
        let frustum = Geometry::Cylinder { half_height: h, radius_bottom: a, radius_top: b };
        let points = (0..=2000).flat_map(|i| {
            let t = i as f32 / 2000.0;
            [(a * t, -h), (b * t, h), (a + (b - a) * t, h * (2.0 * t - 1.0))]
        });
        let (near, far) = surface(points);
        assert!((frustum.inner_radius() - near).abs() < 1e-3 && frustum.inner_radius() <= near * 1.000_001);
        assert!((frustum.radius() - far).abs() < 1e-6);
    }
}

#[test]
fn radii_of_a_capsule_follow_from_its_support() {
    for (h, a, b) in [(1.0_f32, 0.5_f32, 0.5_f32), (0.3, 1.0, 0.2), (0.5, 0.4, 0.7), (0.0, 2.0, 2.0)] {
        let capsule = Geometry::Capsule { half_height: h, radius_bottom: a, radius_top: b };
        // A convex shape around the origin contains the ball of its least support, and reaches its
        // greatest.
        let support = (0..=2000).map(|i| i as f32 / 1000.0 - 1.0).map(|y| (h * y + b).max(-h * y + a));
        let (near, far) = support.fold((f32::MAX, 0.0_f32), |(n, f), s| (n.min(s), f.max(s)));
        assert!((capsule.inner_radius() - near).abs() < 1e-3 && capsule.inner_radius() <= near + 1e-6);
        assert!((capsule.radius() - far).abs() < 1e-6);
    }
}

#[test]
fn a_hull_has_the_radii_of_its_box_and_no_ball_around_an_origin_outside() {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let hull = |offset: f32| {
        let points: Vec<Vec3> =
            (0..8).map(|i| corner(i) * Vec3::new(1.0, 2.0, 3.0) + Vec3::X * offset).collect();
        Geometry::Hull(Arc::new(ConvexHull::new(&points).unwrap()))
    };
    let cuboid = Geometry::cuboid(1.0, 2.0, 3.0);
    assert_eq!((hull(0.0).radius(), hull(0.0).inner_radius()), (cuboid.radius(), cuboid.inner_radius()));
    assert_eq!(hull(0.25).inner_radius(), 0.75);
    assert_eq!(hull(5.0).inner_radius(), 0.0);
}
