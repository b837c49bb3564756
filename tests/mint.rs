//! Vectors and quaternions of other maths crates, by way of mint.

#![cfg(feature = "mint")]

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, Geometry, QueryFilter, Ray, Settings, ShapeCast, ShapeDesc, World};

/// Expected: each component in its place, both ways; mint puts a quaternion's scalar apart.
#[test]
fn vectors_and_quaternions_convert_both_ways() {
    let v = mint::Vector3 { x: 1.5_f32, y: -2.0, z: 0.25 };
    assert_eq!(Vec3::from(v), Vec3::new(1.5, -2.0, 0.25));
    assert_eq!(mint::Vector3::<f32>::from(Vec3::new(1.5, -2.0, 0.25)), v);
    let p = mint::Point3 { x: 1e9_f64, y: 0.1, z: -3.0 };
    assert_eq!(DVec3::from(p), DVec3::new(1e9, 0.1, -3.0));
    assert_eq!(mint::Point3::<f64>::from(DVec3::new(1e9, 0.1, -3.0)), p);
    let q = mint::Quaternion { v: mint::Vector3 { x: 0.5_f32, y: 0.5, z: -0.5 }, s: 0.5 };
    assert_eq!(Quat::from(q), Quat::from_xyzw(0.5, 0.5, -0.5, 0.5));
    assert_eq!(mint::Quaternion::<f32>::from(Quat::from_xyzw(0.5, 0.5, -0.5, 0.5)), q);
}

/// Expected: the same values come out of the world; builders take mint's types as they are.
#[test]
fn a_world_takes_them_and_gives_them_back() {
    let mut world = World::new(Settings::default()).unwrap();
    let at = mint::Vector3 { x: 1.0_f64, y: 2.0, z: 3.0 };
    let turned = mint::Quaternion { v: mint::Vector3 { x: 0.6_f32, y: 0.0, z: 0.0 }, s: 0.8 };
    let velocity = mint::Vector3 { x: 0.5_f32, y: 1.0, z: -1.0 };
    let unit = Geometry::cuboid(0.5, 0.5, 0.5);
    let body =
        BodyDesc::dynamic().with_position(at).with_rotation(turned).with_shape(ShapeDesc::new(unit.clone()));
    let body = world.add_body(&body).unwrap();
    world.set_velocity(body, velocity.into(), Vec3::ZERO).unwrap();
    let position: mint::Vector3<f64> = world.position(body).unwrap().into();
    assert_eq!(position, at);
    let rotation: mint::Quaternion<f32> = world.rotation(body).unwrap().into();
    assert!((rotation.s - 0.8).abs() < 1e-6 && (rotation.v.x - 0.6).abs() < 1e-6);
    let linear: mint::Vector3<f32> = world.linear_velocity(body).unwrap().into();
    assert_eq!(linear, velocity);

    let above = mint::Vector3 { x: 1.0_f64, y: 9.0, z: 3.0 };
    let hit = world.cast_ray(&Ray::between(above, at), &QueryFilter::only(body)).unwrap().unwrap();
    let point: mint::Vector3<f64> = hit.point.into();
    assert_eq!((point.x, point.z), (1.0, 3.0));
    let cast = ShapeCast::new(&unit, above, Vec3::NEG_Y * 9.0).with_rotation(turned);
    assert!(world.cast_shape_any(&cast, &QueryFilter::new()).unwrap());
}
