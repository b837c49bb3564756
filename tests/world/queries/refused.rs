//! Bad input is refused.

use super::*;

#[test]
fn bad_input_is_refused_and_leaves_buffers_as_they_were() {
    let world = alone(ball(1.0));
    let bad_rays = [
        ray([f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ray([0.0, f64::INFINITY, 0.0], [1.0, 0.0, 0.0]),
        ray([0.0, 1e16, 0.0], [1.0, 0.0, 0.0]),
        ray([0.0, 0.0, 0.0], [f32::NAN, 0.0, 0.0]),
        ray([0.0, 0.0, 0.0], [0.0, 0.0, f32::INFINITY]),
        ray([0.0, 0.0, 0.0], [0.0, 2e15, 0.0]),
    ];
    let mut hits = Vec::new();
    world.cast_ray_all(&ray([0.0, 5.0, 0.0], [0.0, -10.0, 0.0]), &ALL(), &mut hits).unwrap();
    let before = hits.clone();
    for ray in bad_rays {
        let is_bad = |e: &Error| matches!(e.innermost(), Error::NotFinite { .. } | Error::OutOfRange { .. });
        assert!(is_bad(&world.cast_ray(&ray, &ALL()).unwrap_err()));
        assert!(is_bad(&world.cast_ray_any(&ray, &ALL()).unwrap_err()));
        assert!(is_bad(&world.cast_ray_all(&ray, &ALL(), &mut hits).unwrap_err()));
        let mut places = [Some(before[0]), None];
        assert!(is_bad(
            &world.cast_rays(&[Ray::new(DVec3::Y, Vec3::Y), ray], &ALL(), &mut places).unwrap_err()
        ));
        assert_eq!(places, [Some(before[0]), None]);
        let shape = ball(1.0);
        assert!(is_bad(&world.cast_shape(&ShapeCast::new(&shape, ray.from, ray.path), &ALL()).unwrap_err()));
        if ray.path.is_finite() && ray.path.length() < 1e15 {
            assert!(is_bad(&world.closest_point(ray.from, 1.0, &ALL()).unwrap_err()));
            let overlap = world.overlap_any(&shape, ray.from, Quat::IDENTITY, &ALL());
            assert!(is_bad(&overlap.unwrap_err()));
        }
    }
    assert_eq!(hits, before);
    let rays = [Ray::new(DVec3::Y, Vec3::Y)];
    assert!(matches!(
        world.cast_rays(&rays, &ALL(), &mut []),
        Err(Error::Count { expected: 1, found: 0, .. })
    ));
    for distance in [f32::NAN, -1.0, f32::INFINITY] {
        assert!(world.closest_point(DVec3::Y, distance, &ALL()).is_err());
    }
    for hollow in [Geometry::Plane, common::flat_mesh(2, 1.0), flat_field()] {
        let found = world.cast_shape(&ShapeCast::new(&hollow, DVec3::Y, Vec3::Y), &ALL());
        let Err(Error::NotConvex { shape }) = found else { panic!("{found:?}") };
        assert_eq!(shape, hollow.kind_name());
        assert!(world.overlap_any(&hollow, DVec3::Y, Quat::IDENTITY, &ALL()).is_err());
    }
    for empty in [ball(0.0), Geometry::cuboid(1.0, 0.0, 1.0), ball(f32::NAN), ball(1e20)] {
        assert!(world.cast_shape(&ShapeCast::new(&empty, DVec3::Y, Vec3::Y), &ALL()).is_err(), "{empty:?}");
    }
    let shape = ball(1.0);
    for rotation in [Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)] {
        assert!(world.overlap_any(&shape, DVec3::Y, rotation, &ALL()).is_err());
        assert!(
            world
                .cast_shape(&ShapeCast::new(&shape, DVec3::Y, Vec3::Y).with_rotation(rotation), &ALL())
                .is_err()
        );
    }
    // As large as may be: no panic, no nonsense.
    let far = ray([1e15, -1e15, 1e15], [-1e15, 1e15, -1e15]);
    assert!(first(&world, far).is_none_or(|hit| hit.point.is_finite()));
    assert!(world.cast_shape(&ShapeCast::new(&shape, far.from, far.path), &ALL()).is_ok());
    assert!(world.closest_point(far.from, 1e15, &ALL()).is_ok());
}
