//! What the tests share: floors of three kinds, worlds out of scenes, and a little mathematics.
#![allow(dead_code, reason = "each test uses a part of it")]

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::scene::Scene;
use backstop::{BodyDesc, BodyHandle, Geometry, Material, Settings, ShapeDesc, TriangleMesh, World};
use std::sync::Arc;

/// Standard gravity of every world here [m/s²].
pub(crate) const G: f64 = 9.81;

/// A static surface at y = 0.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Floor {
    Box,
    Plane,
    /// Flat, of 800 triangles of 1 m.
    Mesh,
}

impl Floor {
    pub(crate) const ALL: [Floor; 3] = [Floor::Box, Floor::Plane, Floor::Mesh];

    pub(crate) fn desc(self, material: Material) -> BodyDesc {
        let (geometry, y) = match self {
            Floor::Box => (Geometry::cuboid(20.0, 1.0, 20.0), -1.0),
            Floor::Plane => (Geometry::Plane, 0.0),
            Floor::Mesh => (flat_mesh(10, 1.0), 0.0),
        };
        let mut shape = ShapeDesc::new(geometry);
        (shape.material, shape.position) = (material, Vec3::new(0.0, y, 0.0));
        BodyDesc::fixed().with_shape(shape)
    }
}

/// A flat mesh of squares of `cell` metres, `half` of them to each side of the origin.
pub(crate) fn flat_mesh(half: i32, cell: f32) -> Geometry {
    let n = (2 * half + 1) as u32;
    let vertices = (0..n * n)
        .map(|i| Vec3::new((i % n) as f32 - half as f32, 0.0, (i / n) as f32 - half as f32) * cell)
        .collect();
    let triangles = (0..(n - 1) * (n - 1))
        .flat_map(|i| {
            let corner = i / (n - 1) * n + i % (n - 1);
            [[corner, corner + n, corner + 1], [corner + 1, corner + n, corner + n + 1]]
        })
        .collect();
    Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()))
}

pub(crate) fn shape(geometry: Geometry, material: Material) -> ShapeDesc {
    let mut shape = ShapeDesc::new(geometry);
    shape.material = material;
    shape
}

pub(crate) fn dynamic(geometry: Geometry, material: Material, at: Vec3) -> BodyDesc {
    BodyDesc::dynamic().at(at).with_shape(shape(geometry, material))
}

/// A world with the scene in it.
pub(crate) fn world_of(scene: &Scene, settings: Settings) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(Settings { gravity: scene.gravity, ..settings }).unwrap();
    let bodies = scene.add_to(&mut world).unwrap().bodies;
    (world, bodies)
}

pub(crate) fn steps(world: &mut World, count: u32, dt: f32) {
    for _ in 0..count {
        world.step(dt).unwrap();
    }
}

/// A rotation about an axis by degrees.
pub(crate) fn turned(axis: Vec3, degrees: f32) -> Quat {
    Quat::from_axis_angle(axis, degrees.to_radians())
}

/// Everything that a body has is a number.
pub(crate) fn all_finite(world: &World) -> bool {
    world.bodies().all(|b| {
        world.position(b).unwrap().is_finite()
            && world.rotation(b).unwrap().is_finite()
            && world.linear_velocity(b).unwrap().is_finite()
            && world.angular_velocity(b).unwrap().is_finite()
    })
}

/// Horizontal length.
pub(crate) fn sideways(v: DVec3) -> f64 {
    v.x.hypot(v.z)
}
