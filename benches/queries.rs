//! Queries beside those of parry3d, in turn within one run: `cargo bench --bench queries [FILTER]`.
//!
//! Both answer the same questions on the same shapes, on one thread, each with trees of its own. A round
//! takes the time of all queries of each; printed are medians over the rounds in ns a query, and the median
//! of the ratios of rounds (parry's time over ours: above one, ours is faster). Both compute the normal.
//! Parry's single-precision world has no far-away positions, filters or handles to answer with. Lines with
//! `batch` are `World::cast_rays` beside `World::cast_ray` (the time of one by one over that of the batch:
//! above one, the batch is faster).
//!
//! The meshes of both have the same 100,000 triangles; the 10,000 bodies are boxes, balls, capsules and
//! cylinders.
#![allow(clippy::disallowed_methods, reason = "the other library is the other library's matter")]

#[path = "../src/random.rs"]
mod random;

use backstop::glam::{DVec3, Vec3};
use backstop::{
    BodyDesc, Geometry, HeightField, QueryFilter, Ray, RayHit, Settings, ShapeCast, ShapeDesc, TriangleMesh,
    World,
};
use parry3d::bounding_volume::Aabb;
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::query::{Ray as ParryRay, RayCast, ShapeCastOptions, cast_shapes};
use parry3d::shape::{SharedShape, TriMesh};
use random::Random;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

const ROUNDS: usize = 15;

fn vector(v: Vec3) -> Vector {
    Vector::from(v.to_array())
}

/// Times both in turn and prints the results.
fn beside(name: &str, queries: usize, mut ours: impl FnMut() -> usize, mut theirs: impl FnMut() -> usize) {
    if !is_wanted(name) {
        return;
    }
    let (found, other) = (ours(), theirs());
    let time = |f: &mut dyn FnMut() -> usize| {
        let start = Instant::now();
        black_box(f());
        start.elapsed().as_secs_f64() * 1e9 / queries as f64
    };
    let median = |mut v: Vec<f64>| {
        v.sort_by(f64::total_cmp);
        v[v.len() / 2]
    };
    let rounds: Vec<(f64, f64)> = (0..ROUNDS).map(|_| (time(&mut ours), time(&mut theirs))).collect();
    let (a, b) = (rounds.iter().map(|r| r.0).collect(), rounds.iter().map(|r| r.1).collect());
    let ratio = median(rounds.iter().map(|r| r.1 / r.0).collect());
    println!(
        "{name:44} {:8.0} ns   parry {:8.0} ns   ratio {ratio:5.2}   hits {found} and {other} of {queries}",
        median(a),
        median(b),
    );
}

/// Hills of 100,000 triangles, 100 m wide.
fn hills() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (n, size) = (224u32, 100.0);
    let height = |x: f32, z: f32| 3.0 * (x * 0.21).sin() * (z * 0.17).cos() + 0.5 * (x * 1.1 + z * 0.9).sin();
    let at = |i: u32| i as f32 / (n - 1) as f32 * size - 0.5 * size;
    let vertices = (0..n * n).map(|i| (at(i % n), at(i / n))).map(|(x, z)| Vec3::new(x, height(x, z), z));
    let triangles = (0..(n - 1) * (n - 1)).flat_map(|i| {
        let c = i / (n - 1) * n + i % (n - 1);
        [[c, c + n, c + 1], [c + 1, c + n, c + n + 1]]
    });
    (vertices.collect(), triangles.collect())
}

/// Rays of four kinds: down, slanting, level over the ground, and a fan as of a camera.
fn rays(kind: &str, count: usize) -> Vec<Ray> {
    let mut random = Random(7);
    (0..count)
        .map(|i| {
            let over = Vec3::new(random.range(-50.0, 50.0), 10.0, random.range(-50.0, 50.0));
            let (from, path) = match kind {
                "down" => (over, Vec3::NEG_Y * 30.0),
                "slanting" => (over, Vec3::new(random.range(-60.0, 60.0), -30.0, random.range(-60.0, 60.0))),
                "level" => (over * Vec3::new(1.0, 0.2, 1.0), random.cube() * Vec3::new(100.0, 2.0, 100.0)),
                _ => {
                    let side = (count as f32).sqrt() as usize;
                    let (u, v) =
                        ((i % side) as f32 / side as f32 - 0.5, (i / side) as f32 / side as f32 - 0.5);
                    (Vec3::new(0.0, 12.0, -50.0), Vec3::new(u * 100.0, -20.0 + v * 60.0, 100.0))
                }
            };
            Ray::new(from.as_dvec3(), path)
        })
        .collect()
}

fn mesh() {
    let (vertices, triangles) = hills();
    let theirs = TriMesh::new(vertices.iter().map(|&v| vector(v)).collect(), triangles.clone())
        .expect("a mesh of triangles");
    let mut world = World::new(Settings::default()).expect("default settings");
    let ours = TriangleMesh::new(vertices, triangles).expect("a mesh of triangles");
    println!("{} triangles", ours.triangle_count());
    let shape = ShapeDesc::new(Geometry::Mesh(Arc::new(ours)));
    world.add_body(&BodyDesc::fixed().with_shape(shape)).expect("a mesh may be static");
    for kind in ["down", "slanting", "level", "camera"] {
        let rays = rays(kind, 20_000);
        compare_rays(&format!("mesh, rays {kind}"), &world, &rays, |ray| {
            theirs.cast_ray_and_get_normal(&Pose::IDENTITY, ray, 1.0, true).is_some()
        });
    }
    let over = |r: &mut Random| Vec3::new(r.range(-40.0, 40.0), 6.0, r.range(-40.0, 40.0));
    let eye = |r: &mut Random| (over(r), r.cube() * Vec3::new(1.0, 0.1, 1.0) - Vec3::Y * 0.3);
    batch("mesh, cameras 90 degrees", &world, &cameras(eye, 1.0, 100.0));
    batch("mesh, cameras 30 degrees", &world, &cameras(eye, 0.27, 100.0));
    batch("mesh, sensors around", &world, &sensors(over, -0.3, 100.0));
    for call in [16, 32, 64] {
        let name = format!("mesh, cameras 30 degrees, batch of {call}");
        batch_of(call, &name, &world, &cameras(eye, 0.27, 100.0));
    }
    batch("mesh, echoes", &world, &echoes(over, 50.0));
    let ball = Geometry::Sphere { radius: 0.5 };
    let parry_ball = SharedShape::ball(0.5);
    let casts = rays("slanting", 2_000);
    compare_casts("mesh, balls slanting", &world, &ball, &casts, |from, path| {
        let to = Pose::from_parts(from, Rotation::IDENTITY);
        let options = ShapeCastOptions::with_max_time_of_impact(1.0);
        cast_shapes(&to, path, &*parry_ball, &Pose::IDENTITY, Vector::ZERO, &theirs, options)
            .is_ok_and(|h| h.is_some())
    });
}

/// The same hills as a height field.
fn field() {
    let (vertices, _) = hills();
    let n = vertices.len().isqrt();
    let cell = backstop::glam::Vec2::splat(100.0 / (n - 1) as f32);
    let field = HeightField::new(n, n, cell, vertices.iter().map(|v| v.y).collect()).expect("good heights");
    let mut world = World::new(Settings::default()).expect("default settings");
    let shape = ShapeDesc::new(Geometry::HeightField(Arc::new(field)));
    let at = DVec3::new(-50.0, 0.0, -50.0);
    world.add_body(&BodyDesc::fixed().with_position(at).with_shape(shape)).expect("a field may be static");
    let over = |r: &mut Random| Vec3::new(r.range(-40.0, 40.0), 6.0, r.range(-40.0, 40.0));
    let eye = |r: &mut Random| (over(r), r.cube() * Vec3::new(1.0, 0.1, 1.0) - Vec3::Y * 0.3);
    batch("field, rays down", &world, &rays("down", 20_000));
    batch("field, rays level", &world, &rays("level", 20_000));
    batch("field, cameras 90 degrees", &world, &cameras(eye, 1.0, 100.0));
    batch("field, cameras 30 degrees", &world, &cameras(eye, 0.27, 100.0));
    batch("field, sensors around", &world, &sensors(over, -0.3, 100.0));
}

fn compare_rays(name: &str, world: &World, rays: &[Ray], theirs: impl Fn(&ParryRay) -> bool) {
    let filter = QueryFilter::new();
    let converted: Vec<ParryRay> =
        rays.iter().map(|r| ParryRay::new(vector(r.from.as_vec3()), vector(r.path))).collect();
    let single =
        || rays.iter().filter(|ray| world.cast_ray(ray, &filter).is_ok_and(|hit| hit.is_some())).count();
    let all = || converted.iter().filter(|ray| theirs(ray)).count();
    beside(name, rays.len(), single, all);
    batch(name, world, rays);
}

/// Rays in calls of 1024 beside the same rays one by one, call by call, each first as often as the other. Of
/// each call the least time of all rounds counts: a busy machine adds to times and never takes from them.
fn batch(name: &str, world: &World, rays: &[Ray]) {
    batch_of(1024, &format!("{name}, batch"), world, rays);
}

/// The same in calls of so many rays.
fn batch_of(call: usize, name: &str, world: &World, rays: &[Ray]) {
    if !is_wanted(name) {
        return;
    }
    let filter = QueryFilter::new();
    let mut hits = vec![None::<RayHit>; call];
    let mut times = vec![(f64::INFINITY, f64::INFINITY); rays.len().div_ceil(call)];
    for round in 0..2 * ROUNDS {
        for (rays, least) in rays.chunks(call).zip(&mut times) {
            let hits = &mut hits[..rays.len()];
            // The second finds the data of the first in the cache.
            for turn in [round, round + 1] {
                let start = Instant::now();
                let time = if turn % 2 == 0 {
                    world.cast_rays(rays, &filter, hits).expect("good rays");
                    &mut least.0
                } else {
                    for (ray, hit) in rays.iter().zip(hits.iter_mut()) {
                        *hit = world.cast_ray(ray, &filter).expect("a good ray");
                    }
                    &mut least.1
                };
                *time = time.min(start.elapsed().as_secs_f64());
                black_box(&hits);
            }
        }
    }
    let sum = times.iter().fold((0.0, 0.0), |sum, t| (sum.0 + t.0, sum.1 + t.1));
    let each = 1e9 / rays.len() as f64;
    println!(
        "{name:50} {:8.0} ns   single {:8.0} ns   ratio {:5.2}",
        sum.0 * each,
        sum.1 * each,
        sum.1 / sum.0,
    );
}

fn is_wanted(name: &str) -> bool {
    name.contains(&std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or_default())
}

/// Rays of cameras of 32 by 32 pixels, one after the other; `wide` is half the width of the picture at the
/// distance 1.
fn cameras(at: impl Fn(&mut Random) -> (Vec3, Vec3), wide: f32, far: f32) -> Vec<Ray> {
    let mut random = Random(5);
    let mut rays = Vec::new();
    for _ in 0..20 {
        let (eye, ahead) = at(&mut random);
        let ahead = ahead.normalize();
        let (right, up) = (ahead.cross(Vec3::Y).normalize(), ahead.cross(Vec3::Y).cross(ahead).normalize());
        for i in 0..32 * 32 {
            let place = |k: i32| ((k as f32 + 0.5) / 16.0 - 1.0) * wide;
            let way = ahead + right * place(i % 32) - up * place(i / 32);
            rays.push(Ray::new(eye.as_dvec3(), way.normalize() * far));
        }
    }
    rays
}

/// Rays of sound: from a few places all around, in no order.
fn echoes(at: impl Fn(&mut Random) -> Vec3, far: f32) -> Vec<Ray> {
    let mut random = Random(6);
    let mut rays = Vec::new();
    for _ in 0..20 {
        let eye = at(&mut random);
        for _ in 0..1000 {
            rays.push(Ray::new(eye.as_dvec3(), random.cube().normalize_or(Vec3::X) * far));
        }
    }
    rays
}

/// Rays of sensors that turn once around, a ray a degree.
fn sensors(at: impl Fn(&mut Random) -> Vec3, down: f32, far: f32) -> Vec<Ray> {
    let mut random = Random(5);
    let mut rays = Vec::new();
    for _ in 0..60 {
        let eye = at(&mut random);
        for i in 0..360 {
            let angle = (i as f32).to_radians();
            let way = Vec3::new(angle.cos(), down, angle.sin());
            rays.push(Ray::new(eye.as_dvec3(), way.normalize() * far));
        }
    }
    rays
}

fn compare_casts(
    name: &str,
    world: &World,
    shape: &Geometry,
    ways: &[Ray],
    theirs: impl Fn(Vector, Vector) -> bool,
) {
    let filter = QueryFilter::new();
    let ours = || {
        let hit = |way: &&Ray| {
            world.cast_shape(&ShapeCast::new(shape, way.from, way.path), &filter).is_ok_and(|h| h.is_some())
        };
        ways.iter().filter(hit).count()
    };
    let other = || ways.iter().filter(|way| theirs(vector(way.from.as_vec3()), vector(way.path))).count();
    beside(name, ways.len(), ours, other);
}

/// 10,000 bodies and their equivalents in the other library, in a cube or spread over a plain.
fn crowd(
    extent: Vec3,
    kind: impl Fn() -> BodyDesc,
    random: &mut Random,
) -> (World, Vec<(Pose, SharedShape)>) {
    let mut world = World::new(Settings::default()).expect("default settings");
    let mut theirs: Vec<(Pose, SharedShape)> = Vec::new();
    for i in 0..10_000 {
        let size = 0.2 + random.cube().abs();
        let (geometry, shape) = match i % 4 {
            0 => (Geometry::cuboid(size.x, size.y, size.z), SharedShape::cuboid(size.x, size.y, size.z)),
            1 => (Geometry::Sphere { radius: size.x }, SharedShape::ball(size.x)),
            2 => (Geometry::capsule(size.x, size.y), SharedShape::capsule_y(size.x, size.y)),
            _ => (Geometry::cylinder(size.x, size.y), SharedShape::cylinder(size.x, size.y)),
        };
        let (at, turned) = (random.cube() * extent, random.rotation());
        let desc =
            kind().with_position(at.as_dvec3()).with_rotation(turned).with_shape(ShapeDesc::new(geometry));
        world.add_body(&desc).expect("a good body");
        let rotation = Rotation::from_array(turned.to_array());
        theirs.push((Pose::from_parts(vector(at), rotation), shape));
    }
    (world, theirs)
}

fn bodies(name: &str, extent: Vec3, kind: impl Fn() -> BodyDesc) {
    let mut random = Random(3);
    let (world, theirs) = crowd(extent, kind, &mut random);
    let boxes: Vec<Aabb> = theirs.iter().map(|(pose, shape)| shape.compute_aabb(pose)).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let rays: Vec<Ray> = (0..20_000)
        .map(|_| Ray::new((random.cube() * extent).as_dvec3(), random.cube() * extent.max_element()))
        .collect();
    compare_rays(&format!("{name}, rays"), &world, &rays, |ray| {
        let first = tree.cast_ray(ray, 1.0, |leaf, most| {
            let (pose, shape) = &theirs[leaf as usize];
            shape.cast_ray(pose, ray, most, true)
        });
        first.is_some_and(|(leaf, _)| {
            let (pose, shape) = &theirs[leaf as usize];
            shape.cast_ray_and_get_normal(pose, ray, 1.0, true).is_some()
        })
    });
    let far = extent.max_element();
    let eye = |r: &mut Random| (r.cube() * extent * 0.5, r.cube() * (extent / far));
    batch(&format!("{name}, cameras 90 degrees"), &world, &cameras(eye, 1.0, far));
    batch(&format!("{name}, cameras 30 degrees"), &world, &cameras(eye, 0.27, far));
    let over = |r: &mut Random| r.cube() * extent * 0.5;
    batch(&format!("{name}, sensors around"), &world, &sensors(over, 0.0, far));
    batch(&format!("{name}, echoes"), &world, &echoes(over, far));
    let ball = Geometry::Sphere { radius: 0.5 };
    let parry_ball = SharedShape::ball(0.5);
    compare_casts(&format!("{name}, balls"), &world, &ball, &rays[..2_000], |from, path| {
        let options = ShapeCastOptions::with_max_time_of_impact(1.0);
        let ray = ParryRay::new(from, path);
        // The way that Rapier goes: boxes grown by the shape's, nearest first.
        let best = tree.find_best(
            1.0,
            |node, best| {
                let mut aabb = node.aabb();
                (aabb.mins, aabb.maxs) = (aabb.mins - Vector::splat(0.5), aabb.maxs + Vector::splat(0.5));
                aabb.cast_local_ray(&ray, best, true).unwrap_or(f32::MAX)
            },
            |leaf, best| {
                let (pose, shape) = &theirs[leaf as usize];
                let to = Pose::from_parts(from, Rotation::IDENTITY);
                let options = ShapeCastOptions { max_time_of_impact: best, ..options };
                let hit = cast_shapes(&to, path, &*parry_ball, pose, Vector::ZERO, &**shape, options);
                hit.ok().flatten().map(|h| h.time_of_impact)
            },
        );
        best.is_some()
    });
    let filter = QueryFilter::new();
    let points: Vec<DVec3> = rays.iter().map(|r| r.from).collect();
    let ours = || {
        points.iter().filter(|p| world.closest_point(**p, 10.0, &filter).is_ok_and(|h| h.is_some())).count()
    };
    let other = || {
        let near = |p: &&DVec3| {
            let at = vector(p.as_vec3());
            tree.project_point(at, 10.0, |leaf, _| {
                let (pose, shape) = &theirs[leaf as usize];
                Some(shape.project_point(pose, at, true))
            })
            .is_some()
        };
        points.iter().filter(near).count()
    };
    beside(&format!("{name}, nearest points"), points.len(), ours, other);
}

/// Time to bring the tree up to date, of 10,000 bodies that fall; steps alone are not timed.
fn after_a_step() {
    let mut random = Random(3);
    let mut world = World::new(Settings::default()).expect("default settings");
    for _ in 0..10_000 {
        let shape = ShapeDesc::new(Geometry::cuboid(0.3, 0.2, 0.1));
        let at = (random.cube() * 200.0).as_dvec3();
        world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(shape)).expect("a good body");
    }
    let (ray, filter) = (Ray::new(DVec3::ZERO, Vec3::Y), QueryFilter::new());
    let mut times: Vec<f64> = (0..40)
        .map(|_| {
            world.step(1.0 / 60.0).expect("dt is above zero");
            let start = Instant::now();
            black_box(world.cast_ray(&ray, &filter)).expect("a good ray");
            start.elapsed().as_secs_f64() * 1e9 / 10_000.0
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("first query after a step: {:.1} ns for each of 10,000 shapes that move", times[20]);
}

fn main() {
    after_a_step();
    mesh();
    field();
    bodies("10,000 static in a cube", Vec3::splat(60.0), BodyDesc::fixed);
    bodies("10,000 dynamic on a plain", Vec3::new(250.0, 5.0, 250.0), BodyDesc::dynamic);
}
