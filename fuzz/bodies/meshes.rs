//! Vertices and triangles to a mesh that is the ground of a world.

use super::check;
use super::input::Input;
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, Geometry, QueryFilter, Ray, Settings, ShapeCast, ShapeDesc, TriangleMesh, World};
use std::sync::Arc;

pub fn run(bytes: &[u8]) {
    let input = &mut Input::new(bytes);
    let vertices = input.points(40);
    let count = vertices.len() + usize::from(input.byte() == 0);
    let triangles: Vec<[u32; 3]> =
        (0..input.below(60)).map(|_| [0; 3].map(|_: u32| input.below(count.max(1)) as u32)).collect();
    let Ok(mesh) = TriangleMesh::new(vertices, triangles) else { return };
    let (low, high) = mesh.aabb();
    assert!(low.is_finite() && high.is_finite() && low.cmple(high).all());
    assert!((0..mesh.triangle_count() as u32).all(|i| mesh.corners(i).is_some()));
    let mut world = World::new(Settings::default()).expect("usual settings");
    let ground = ShapeDesc::new(Geometry::Mesh(Arc::new(mesh)));
    world.add_body(&BodyDesc::fixed().with_shape(ground)).expect("a mesh");
    let middle = (low + (high - low) * 0.5).as_dvec3();
    for i in 0..4 {
        let mut shape = ShapeDesc::new(input.geometry());
        shape.density = 100.0;
        let at = middle + DVec3::new(f64::from(i), 1.0 + f64::from(i), 0.0);
        drop(
            world.add_body(
                &BodyDesc::dynamic()
                    .with_position(at)
                    .with_velocity(input.vector(), Vec3::ZERO)
                    .with_shape(shape),
            ),
        );
    }
    for _ in 0..4 {
        world.step(1.0 / 60.0).expect("a usual step");
        check(&world);
        let ray = Ray::new(input.place(), input.vector());
        if let Ok(Some(hit)) = world.cast_ray(&ray, &QueryFilter::default()) {
            assert!((0.0..=1.0).contains(&hit.fraction) && hit.normal.is_finite(), "{hit:?}");
        }
        let ball = Geometry::Sphere { radius: input.size() };
        if let Ok(Some(hit)) =
            world.cast_shape(&ShapeCast::new(&ball, input.place(), input.vector()), &QueryFilter::default())
        {
            assert!((0.0..=1.0).contains(&hit.fraction), "{hit:?}");
        }
    }
}
