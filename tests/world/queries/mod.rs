//! Promises of queries: exact answers on every shape, filters, the world as it is now, far from the origin
//! as near it, clear errors, any thread, any order. `src/query/tests.rs` checks them against all shapes one
//! by one and against dense samples; here another library has its say as well.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

mod answers;
mod batch;
mod one;
mod parry;
mod refused;
mod same;
mod seen;
mod turning;

use crate::common::{self, random::Random};
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    BodyDesc, BodyHandle, ClosestPoint, ConvexHull, Error, Filter, Geometry, HeightField, Overlap,
    QueryFilter, Ray, RayHit, Settings, ShapeCast, ShapeDesc, ShapeHandle, ShapeHit, TriangleMesh, World,
};
use std::sync::Arc;

const ALL: fn() -> QueryFilter<'static> = QueryFilter::new;

fn world() -> World {
    World::new(Settings::default()).unwrap()
}

fn add(world: &mut World, desc: BodyDesc, geometry: Geometry) -> BodyHandle {
    world.add_body(&desc.with_shape(ShapeDesc::new(geometry))).unwrap()
}

fn alone(geometry: Geometry) -> World {
    let mut world = world();
    add(&mut world, BodyDesc::fixed(), geometry);
    world
}

fn ball(radius: f32) -> Geometry {
    Geometry::Sphere { radius }
}

fn cube_hull() -> Geometry {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    Geometry::Hull(Arc::new(ConvexHull::new(&(0..8).map(corner).collect::<Vec<_>>()).unwrap()))
}

fn flat_field() -> Geometry {
    Geometry::HeightField(Arc::new(HeightField::new(9, 9, Vec2::ONE, vec![0.0; 81]).unwrap()))
}

fn ray(from: [f64; 3], path: [f32; 3]) -> Ray {
    Ray::new(DVec3::from(from), Vec3::from(path))
}

fn first(world: &World, ray: Ray) -> Option<RayHit> {
    let hit = world.cast_ray(&ray, &ALL()).unwrap();
    assert_eq!(world.cast_ray_any(&ray, &ALL()).unwrap(), hit.is_some());
    let mut all = Vec::new();
    world.cast_ray_all(&ray, &ALL(), &mut all).unwrap();
    assert_eq!(all.first(), hit.as_ref());
    hit
}

/// On a grid of 1/64 m, which numbers of 1e6 m still know.
fn on_grid(random: &mut Random, size: f32) -> DVec3 {
    (random.cube() * size * 64.0).round().as_dvec3() / 64.0
}

fn convex(random: &mut Random, kind: usize) -> Geometry {
    let mut size = || random.range(0.2, 1.0);
    let (x, y, z) = (size(), size(), size());
    match kind % 5 {
        0 => ball(x),
        1 => Geometry::capsule(x, y),
        2 => Geometry::cuboid(x, y, z),
        3 => Geometry::cylinder(x, y),
        _ => {
            let points: Vec<Vec3> = (0..20).map(|_| random.cube()).collect();
            Geometry::Hull(Arc::new(ConvexHull::new(&points).unwrap()))
        }
    }
}

/// A crowd of bodies with its hill; each body's place in `order` is its number.
fn crowd(centre: DVec3, seed: u64, order: &[usize]) -> World {
    let mut random = Random(seed);
    let mut world = world();
    let mut descs: Vec<BodyDesc> = (0..order.len() - 1)
        .map(|i| {
            let kind = [BodyDesc::dynamic(), BodyDesc::fixed(), BodyDesc::kinematic()][i % 3].clone();
            let at = centre + on_grid(&mut random, 20.0);
            let (turned, shape) = (random.rotation(), convex(&mut random, i));
            kind.with_position(at).with_rotation(turned).with_shape(ShapeDesc::new(shape))
        })
        .collect();
    let hill: Vec<f32> = (0..41 * 41).map(|_| random.range(-1.0, 1.0)).collect();
    let hill = HeightField::new(41, 41, Vec2::ONE, hill).unwrap();
    let at = centre - DVec3::new(20.0, 15.0, 20.0);
    descs.push(
        BodyDesc::fixed().with_position(at).with_shape(ShapeDesc::new(Geometry::HeightField(Arc::new(hill)))),
    );
    for &i in order {
        let mut desc = descs[i].clone();
        desc.user_data = i as u64;
        world.add_body(&desc).unwrap();
    }
    world
}
