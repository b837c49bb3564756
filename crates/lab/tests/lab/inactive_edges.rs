//! The effect of inactive edges of a mesh: bodies that slide over its seams.

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, Geometry, Material, Settings, ShapeDesc, TriangleMesh, World};
use std::sync::Arc;

/// A flat square of 40 m in triangles of half a metre.
fn grid() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let n = 80;
    let at = |i: u32| i as f32 * 0.5 - 20.0;
    let vertices = (0..=n).flat_map(|z| (0..=n).map(move |x| Vec3::new(at(x), 0.0, at(z)))).collect();
    let quads = (0..n).flat_map(|z| (0..n).map(move |x| z * (n + 1) + x));
    let triangles = quads.flat_map(|i| [[i, i + n + 1, i + 1], [i + 1, i + n + 1, i + n + 2]]).collect();
    (vertices, triangles)
}

/// Bodies that fall, tumble and slide at 10 m/s without friction for two seconds: by how much the velocity
/// along the plane of any of them changes [m/s]. Nothing on a frictionless plane changes it.
fn swerve(geometry: &Geometry, inactive: bool) -> f64 {
    let (vertices, triangles) = grid();
    let mesh = if inactive {
        TriangleMesh::new(vertices, triangles)
    } else {
        TriangleMesh::with_active_edges(vertices, triangles)
    };
    let mesh = Arc::new(mesh.unwrap());
    let material = Material::default().with_friction(0.0);
    let shape = |geometry| ShapeDesc::new(geometry).with_material(material);
    let mut worst = 0.0_f64;
    for i in 0..8 {
        let mut world = World::new(Settings::default()).unwrap();
        world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Mesh(mesh.clone())))).unwrap();
        let start = DVec3::new(-12.0, 0.7 + 0.05 * f64::from(i), 0.13 * f64::from(i));
        let along = Vec3::new(10.0, 0.0, 1.0);
        let spin = Vec3::new(3.0 - i as f32, 1.0 + i as f32, 5.0 - 2.0 * i as f32);
        let desc = BodyDesc::dynamic().with_position(start).with_velocity(along, spin);
        let body = world.add_body(&desc.with_shape(shape(geometry.clone()))).unwrap();
        for _ in 0..120 {
            world.step(1.0 / 60.0).unwrap();
        }
        let change = world.linear_velocity(body).unwrap() - along;
        worst = worst.max(f64::from(change.x.hypot(change.z)));
    }
    worst
}

/// With inactive edges the velocity along the plane is kept to a millimetre per second; where every edge
/// counts, some shape trips.
#[test]
fn inactive_edges_keep_bodies_from_tripping() {
    let shapes = [
        ("sphere", Geometry::Sphere { radius: 0.25 }),
        ("capsule", Geometry::Capsule { half_height: 0.3, radius_bottom: 0.2, radius_top: 0.2 }),
        ("box", Geometry::cuboid(0.25, 0.25, 0.25)),
        ("plank", Geometry::cuboid(0.6, 0.05, 0.2)),
    ];
    let mut worst = 0.0_f64;
    for (name, geometry) in shapes {
        let (inactive, active) = (swerve(&geometry, true), swerve(&geometry, false));
        println!(
            "{name:8} swerves by {inactive:.1e} m/s with inactive edges, {active:.1e} m/s if all are active"
        );
        assert!(inactive < 1e-3, "{name}: {inactive} m/s");
        worst = worst.max(active);
    }
    assert!(worst > 0.1, "{worst}");
}
