//! Batches of rays have the bits of rays one by one.

use super::*;

/// All there is to say of a hit, to the bit.
type HitBits = (BodyHandle, ShapeHandle, u32, [u64; 3], [u32; 3], Option<u32>, bool);

fn bits_of(hit: &Option<RayHit>) -> Option<HitBits> {
    hit.map(|h| {
        let (point, normal) = (h.point.to_array().map(f64::to_bits), h.normal.to_array().map(f32::to_bits));
        (h.body, h.shape, h.fraction.to_bits(), point, normal, h.triangle, h.inside)
    })
}

/// A crowd on a field, above meshes rough and flat, with a plane, a sensor, and some bodies twice.
fn crowd_and_meshes(centre: DVec3) -> World {
    let order: Vec<usize> = (0..300).collect();
    let mut world = crowd(centre, 11, &order);
    let mut random = Random(14);
    let n = 33;
    let vertices = (0..n * n).map(|i| Vec3::new((i % n) as f32, random.range(0.0, 2.0), (i / n) as f32));
    let vertices = vertices.collect();
    let triangles = (0..n * (n - 1)).filter(|c| c % n < n - 1);
    let triangles = triangles.flat_map(|c| [[c, c + n, c + 1], [c + 1, c + n, c + n + 1]]).collect();
    let rough = Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()));
    let at = |x: f64, y: f64, z: f64| BodyDesc::fixed().with_position(centre + DVec3::new(x, y, z));
    add(&mut world, at(-16.0, -5.0, -16.0).with_rotation(random.rotation()), rough);
    for _ in 0..2 {
        add(&mut world, at(0.0, -12.0, 0.0), common::flat_mesh(16, 1.0));
        add(&mut world, at(3.0, 4.0, 5.0), Geometry::cuboid(1.0, 2.0, 3.0));
    }
    add(&mut world, at(0.0, -14.0, 0.0), Geometry::Plane);
    let mut sensor = ShapeDesc::new(ball(3.0));
    sensor.sensor = true;
    world.add_body(&at(0.0, 6.0, 0.0).with_shape(sensor)).unwrap();
    world
}

/// Rays that a batch may be made of, of each kind some hundred.
fn bundles(centre: DVec3) -> Vec<Vec<Ray>> {
    let mut random = Random(12);
    let scattered: Vec<Ray> =
        (0..700).map(|_| Ray::new(centre + on_grid(&mut random, 25.0), random.cube() * 40.0)).collect();
    let mut camera = |down: f32, wide: f32, far: f32| -> Vec<Ray> {
        let eye = centre + on_grid(&mut random, 8.0) + DVec3::Y * 5.0;
        let place = |i: i32| ((i as f32 + 0.5) / 16.0 - 1.0) * wide;
        let way = |i: i32| Vec3::new(place(i % 32), down, place(i / 32) + 0.3);
        (0..32 * 32).map(|i| Ray::new(eye, way(i) * far)).collect()
    };
    let cameras = [camera(-1.0, 1.0, 30.0), camera(-0.2, 0.1, 60.0), camera(0.3, 2.0, 1e4)];
    // On the corners and edges of flat meshes: all triangles there are met at the same fraction.
    let grid = |i: i32| centre + DVec3::new(f64::from(i % 30 - 15), -10.0, f64::from(i / 30 - 15) * 0.5);
    let straight: Vec<Ray> = (0..900).map(|i| Ray::new(grid(i), Vec3::NEG_Y * 3.0)).collect();
    let around = |i: i32| {
        let angle = libm::sincosf(i as f32 * 0.0175);
        Ray::new(centre + DVec3::Y, Vec3::new(angle.1, -0.2, angle.0) * 50.0)
    };
    let sensor = (0..360).map(around).collect();
    let still = scattered.iter().map(|ray| Ray { path: Vec3::ZERO, ..*ray }).collect();
    let along_x =
        |i: i32| Ray::new(centre + DVec3::new(-40.0, f64::from(i) * 0.05 - 16.0, 1.0), Vec3::X * 80.0);
    let level = (0..400).map(along_x).collect();
    // The same rays with and without a length, near and far: neighbours that have little in common.
    let mixed = scattered.iter().zip(&straight).zip(&cameras[0]).enumerate();
    let mixed = mixed.map(|(i, ((a, b), c))| match i % 5 {
        0 => *a,
        1 => Ray { path: Vec3::ZERO, ..*b },
        2 => Ray { path: c.path * 1e8, ..*c },
        _ => *c,
    });
    let mixed = mixed.collect();
    let short: Vec<Ray> = cameras[0].iter().map(|ray| Ray { path: ray.path * 0.2, ..*ray }).collect();
    let [a, b, c] = cameras;
    vec![scattered, a, b, c, straight, sensor, still, level, mixed, short]
}

#[test]
fn a_batch_has_the_bits_of_one_by_one() {
    for centre in [DVec3::ZERO, DVec3::new(1e6, -3e5, 2e5)] {
        let mut world = crowd_and_meshes(centre);
        let one = world.bodies().nth(50).unwrap();
        let late = |body: BodyHandle, _: ShapeHandle| body > one;
        let filters = [
            ALL(),
            ALL().skipping_inside(),
            ALL().with_sensors().excluding(one),
            QueryFilter::only_static(),
            QueryFilter::only_dynamic(),
            ALL().with_predicate(&late),
        ];
        let (mut met, mut triangles, mut inside) = (0, 0, 0);
        for step in 0..2 {
            for rays in bundles(centre) {
                for filter in &filters {
                    let mut hits = vec![None; rays.len()];
                    world.cast_rays(&rays, filter, &mut hits).unwrap();
                    for (ray, hit) in rays.iter().zip(&hits) {
                        let single = world.cast_ray(ray, filter).unwrap();
                        assert_eq!(bits_of(hit), bits_of(&single), "{ray:?} {filter:?}");
                    }
                    met += hits.iter().flatten().count();
                    triangles += hits.iter().flatten().filter(|h| h.triangle.is_some()).count();
                    inside += hits.iter().flatten().filter(|h| h.inside).count();
                }
            }
            if step == 0 {
                world.step(1.0 / 60.0).unwrap();
            }
        }
        println!("{met} hits, {triangles} of triangles, {inside} inside");
        assert!(met > 20_000 && triangles > 5_000 && inside > 1_000);
        let rays = &bundles(centre)[1];
        for count in [0, 1, 8, 31, 32, 33, 63, 64, 65, 95, 96, 130] {
            let mut hits = vec![None; count];
            world.cast_rays(&rays[..count], &ALL(), &mut hits).unwrap();
            let single: Vec<_> = rays[..count].iter().map(|r| world.cast_ray(r, &ALL()).unwrap()).collect();
            assert_eq!(hits, single);
        }
    }
}
