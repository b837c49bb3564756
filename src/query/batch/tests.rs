//! Streams of incoherent rays, from anywhere to anywhere, which a batch would cast one by one.

use super::stream::RayStream;
use crate::query::tests::world;
use crate::query::{QueryFilter, Ray, RayHit};
use crate::random::Random;
use crate::shape::RAYS;
use glam::{DVec3, Vec3};

#[test]
fn rays_with_nothing_in_common_answer_in_a_stream_as_alone() {
    let mut random = Random(41);
    for centre in [DVec3::ZERO, DVec3::new(-3e5, 1e6, 77.7)] {
        let world = world(&mut random, centre, 200);
        let mut stream = RayStream::new();
        let mut met = 0;
        for i in 0..if cfg!(miri) { 2 } else { 60 } {
            let filter = if i % 3 == 0 { QueryFilter::new().skipping_inside() } else { QueryFilter::new() };
            let rays: Vec<Ray> = (0..1 + i * 7 % RAYS)
                .map(|k| {
                    let path =
                        if k % 11 == 10 { Vec3::ZERO } else { random.cube() * random.range(0.0, 60.0) };
                    Ray::new(centre + random.cube().as_dvec3() * 20.0, path)
                })
                .collect();
            let mut hits: Vec<Option<RayHit>> = vec![None; rays.len()];
            stream.cast(&world, &rays, &filter, &mut hits).unwrap();
            let alone: Vec<_> = rays.iter().map(|ray| world.first_on_ray(ray, &filter).unwrap()).collect();
            assert_eq!(hits, alone);
            met += alone.iter().flatten().count();
        }
        assert!(cfg!(miri) || met > 500, "{met}");
    }
}
