//! Meshes, height fields and hulls at another scale: where bodies come to lie on them, and their masses.

use super::common::{self, G};
use backstop::glam::{DVec3, Vec2, Vec3};
use backstop::{
    BodyDesc, ConvexHull, Error, Geometry, HeightField, MassProperties, Material, QueryFilter, Ray, Settings,
    ShapeDesc, TriangleMesh, World,
};
use backstop_scene::Terrain;

fn hills() -> TriangleMesh {
    let (vertices, triangles) = Terrain::bumpy(24, 1.0).mesh();
    TriangleMesh::new(vertices, triangles).unwrap()
}

fn world_on(geometry: Geometry) -> World {
    let mut world = World::new(Settings::default()).unwrap();
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(geometry))).unwrap();
    world
}

/// Expected: x' = s x, so a ray down at s x meets s_y times the height that the terrain has at x.
#[test]
fn rays_meet_a_scaled_mesh_where_its_vertices_say() {
    let terrain = Terrain::bumpy(24, 1.0);
    for scale in
        [Vec3::new(2.0, 0.5, 3.0), Vec3::new(-2.0, 0.5, 1.5), Vec3::new(1.0, -1.0, 1.0), Vec3::NEG_ONE]
    {
        let mesh = hills().scaled(scale).unwrap();
        assert_eq!(mesh.triangle_count(), hills().triangle_count());
        let world = world_on(Geometry::mesh(mesh));
        for i in 0..400 {
            let (x, z) = ((i % 20) as f32 * 1.13 - 10.9, (i / 20) as f32 * 1.07 - 10.3);
            let ray =
                Ray::new(DVec3::new((x * scale.x).into(), 50.0, (z * scale.z).into()), Vec3::NEG_Y * 100.0);
            let hit = world.cast_ray(&ray, &QueryFilter::default()).unwrap().unwrap();
            let expected = f64::from(terrain.height(x, z) * scale.y);
            assert!((ray.at(hit.fraction).y - expected).abs() < 2e-5, "{scale} {x} {z}");
        }
    }
}

/// Fronts stay fronts: a box of triangles that wind outwards has the volume of its sides when mirrored too,
/// by the divergence theorem.
#[test]
fn a_mirrored_mesh_winds_outwards() {
    let half = Vec3::new(1.0, 2.0, 3.0);
    let sign = |i: u32, bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
    let vertices = (0..8).map(|i| Vec3::new(sign(i, 0), sign(i, 1), sign(i, 2)) * half).collect();
    let quads = [[1, 3, 7, 5], [0, 4, 6, 2], [2, 6, 7, 3], [0, 1, 5, 4], [4, 5, 7, 6], [0, 2, 3, 1]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    let mesh = TriangleMesh::new(vertices, triangles).unwrap();
    for scale in [Vec3::ONE, Vec3::new(-1.0, 1.0, 2.0), Vec3::new(-1.0, -0.5, 1.0), Vec3::NEG_ONE] {
        let scaled = mesh.scaled(scale).unwrap();
        let volume: f32 =
            (0..12).map(|i| scaled.corners(i).unwrap()).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        let expected = 48.0 * scale.abs().element_product();
        assert!((volume - expected).abs() < 1e-4 * expected, "{scale} {volume}");
    }
}

/// Flat ground that is scaled and mirrored: a box slides over its seams as over a plane. Expected, by
/// Coulomb's law: from 4 m/s with friction 0.2 it comes to rest after v² / (2 μ g).
#[test]
fn a_box_slides_over_the_seams_of_a_mirrored_mesh() {
    let Geometry::Mesh(flat) = common::flat_mesh(10, 1.0) else { unreachable!() };
    for scale in [Vec3::new(-3.0, 1.0, 0.7), Vec3::new(2.0, -1.0, 1.0)] {
        let material = Material::default().with_friction(0.2);
        let mut world = World::new(Settings::default()).unwrap();
        let ground = common::shape(Geometry::mesh(flat.scaled(scale).unwrap()), material);
        world.add_body(&BodyDesc::fixed().with_shape(ground)).unwrap();
        let desc = common::dynamic(Geometry::cuboid(0.3, 0.1, 0.3), material, Vec3::new(-1.7, 0.1, 0.05));
        let body = world.add_body(&desc.with_velocity(Vec3::new(4.0, 0.0, 0.0), Vec3::ZERO)).unwrap();
        common::steps(&mut world, 360, 1.0 / 60.0);
        let position = world.position(body).unwrap();
        let way = 16.0 / (2.0 * 0.2 * G);
        assert!((position.x + 1.7 - way).abs() < 0.05 * way, "{scale} {position}");
        assert!((position.y - 0.1).abs() < 2e-3 && (position.z - 0.05).abs() < 1e-2, "{scale} {position}");
    }
}

/// Expected: the volume times |s_x s_y s_z|, the centre times s; a field's heights times s_y.
#[test]
fn hulls_and_fields_scale_too() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.7, 0.9, 0.8)];
    let hull = ConvexHull::new(&corners).unwrap();
    let before = MassProperties::of(&Geometry::hull(hull.clone()), 1.0);
    for scale in [Vec3::new(2.0, 3.0, 0.5), Vec3::new(-2.0, 3.0, 0.5), Vec3::NEG_ONE] {
        let after = MassProperties::of(&Geometry::hull(hull.scaled(scale).unwrap()), 1.0);
        let mass = before.mass * scale.abs().element_product();
        assert!((after.mass - mass).abs() < 1e-5 * mass, "{scale}");
        assert!((after.centre_of_mass - before.centre_of_mass * scale).length() < 1e-5, "{scale}");
    }
    let heights: Vec<f32> = (0..25).map(|i| (i % 5) as f32 * 0.25).collect();
    let field = HeightField::new(5, 5, Vec2::ONE, heights).unwrap();
    let scaled = field.scaled(Vec3::new(2.0, -3.0, 0.5)).unwrap();
    assert_eq!(scaled.aabb(), (Vec3::new(0.0, -3.0, 0.0), Vec3::new(8.0, 0.0, 2.0)));
    let world = world_on(Geometry::height_field(scaled));
    let ray = Ray::new(DVec3::new(3.0, 5.0, 0.7), Vec3::NEG_Y * 10.0);
    let hit = world.cast_ray(&ray, &QueryFilter::default()).unwrap().unwrap();
    assert!((ray.at(hit.fraction).y + 0.75 * 1.5).abs() < 1e-5);
}

#[test]
fn scales_that_flatten_are_refused() {
    let hull = ConvexHull::new(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]).unwrap();
    let field = HeightField::new(2, 2, Vec2::ONE, vec![0.0; 4]).unwrap();
    for scale in [Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, f32::NAN, 1.0), Vec3::new(1.0, 1.0, f32::INFINITY)]
    {
        assert!(
            hull.scaled(scale).is_err() && hills().scaled(scale).is_err() && field.scaled(scale).is_err()
        );
    }
    assert!(matches!(field.scaled(Vec3::new(-1.0, 1.0, 1.0)), Err(Error::OutOfRange { .. })));
    assert!(hills().scaled(Vec3::splat(1e9)).is_err());
}
