//! What inactive edges of a mesh are worth: bodies that slide over its seams.
#![cfg(feature = "lab")]

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

/// The greatest speed upwards [m/s] and loss of speed [m/s] of a body that slides at 5 m/s without friction for three seconds.
fn slide(geometry: Geometry, half_height: f64, inactive: bool) -> (f32, f32) {
    let (vertices, triangles) = grid();
    let mesh = if inactive {
        TriangleMesh::new(vertices, triangles)
    } else {
        TriangleMesh::with_active_edges(vertices, triangles)
    };
    let material = Material::default().with_friction(0.0);
    let shape = |geometry| ShapeDesc { material, ..ShapeDesc::new(geometry) };
    let mut world = World::new(Settings::default()).unwrap();
    let ground = shape(Geometry::Mesh(Arc::new(mesh.unwrap())));
    world.add_body(&BodyDesc::fixed().with_shape(ground)).unwrap();
    let desc = BodyDesc::dynamic()
        .at(DVec3::new(-8.0, half_height, 0.13))
        .moving(Vec3::new(5.0, 0.0, 0.3), Vec3::ZERO);
    let body = world.add_body(&desc.with_shape(shape(geometry))).unwrap();
    let (mut hop, mut loss) = (0.0_f32, 0.0_f32);
    for _ in 0..180 {
        world.step(1.0 / 60.0).unwrap();
        let v = world.linear_velocity(body).unwrap();
        hop = hop.max(v.y);
        loss = loss.max(5.0 - v.x);
    }
    (hop, loss)
}

/// On a plane nothing turns a body aside: with inactive edges it keeps its speed and its height. Where every edge counts, some shape
/// trips.
#[test]
fn inactive_edges_keep_bodies_from_tripping() {
    let shapes = [
        ("sphere", Geometry::Sphere { radius: 0.25 }, 0.25),
        ("capsule", Geometry::Capsule { half_height: 0.3, radius_bottom: 0.2, radius_top: 0.2 }, 0.5),
        ("box", Geometry::cuboid(0.25, 0.25, 0.25), 0.25),
    ];
    let mut worst = 0.0_f32;
    for (name, geometry, half_height) in shapes {
        let (hop, loss) = slide(geometry.clone(), half_height, true);
        let (trip, lost) = slide(geometry, half_height, false);
        println!(
            "{name:8} inactive: {hop:.1e} m/s up, {loss:.1e} m/s lost; all active: {trip:.1e}, {lost:.1e}"
        );
        assert!(hop < 1e-3 && loss < 1e-3, "{name}: {hop} m/s up, {loss} m/s lost");
        worst = worst.max(trip).max(lost);
    }
    assert!(worst > 1e-2, "{worst}");
}
