//! The rays of a stream that look for the first triangle of one mesh or height field.

use super::bvh::Path;
use super::segment_triangle::SegmentTest;
use crate::shape::stream::{RAYS, Stream, Walk};

/// Up to [`RAYS`] rays in the frame of a shape, and the first hit of each.
#[derive(Debug)]
pub(crate) struct TriangleRays {
    /// For meshes.
    pub(crate) stream: Stream,
    pub(crate) walk: Walk,
    /// For height fields.
    pub(crate) paths: [Path; RAYS],
    pub(crate) tests: [SegmentTest; RAYS],
    /// The fraction and the triangle; before it meets one, how far a ray looks and `u32::MAX`.
    pub(crate) nearest: [(f32, u32); RAYS],
    pub(crate) rays: u64,
}

impl TriangleRays {
    pub(crate) fn new() -> TriangleRays {
        TriangleRays {
            stream: Stream::new(),
            walk: Walk::new(),
            paths: [Path::default(); RAYS],
            tests: [SegmentTest::default(); RAYS],
            nearest: [(0.0, u32::MAX); RAYS],
            rays: 0,
        }
    }

    /// Without rays, for the next shape.
    pub(crate) fn clear(&mut self) {
        self.rays = 0;
    }

    /// One bit for each ray that was added and has a length.
    pub(crate) fn rays(&self) -> u64 {
        self.rays
    }

    /// The fraction at which a ray of these meets a triangle first, and which.
    pub(crate) fn first(&self, ray: usize) -> Option<(f32, u32)> {
        let nearest = self.nearest[ray];
        (nearest.1 != u32::MAX).then_some(nearest)
    }
}

/// Makes a triangle that is met at a fraction the nearest if it is: of two at the same fraction the lower
/// index counts.
#[inline(always)]
pub(crate) fn take(nearest: &mut (f32, u32), t: f32, index: u32) {
    if t < nearest.0 || (t == nearest.0 && index < nearest.1) {
        *nearest = (t, index);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::ones;
    use crate::lanes::{Mask, f32x8};
    use crate::random::Random;
    use crate::shape::mesh::testing::{bumpy, terrain};
    use crate::shape::{Corners, Ground, HeightField};
    use glam::Vec3;

    /// Fans and rays from anywhere to anywhere, through the vertices half of the time.
    fn rays(random: &mut Random, through: &[Vec3], spread: f32) -> Vec<(Vec3, Vec3)> {
        let eye = random.cube() * 12.0 + Vec3::Y * 5.0;
        let ahead = through[random.below(through.len())];
        (0..RAYS)
            .map(|i| {
                let mut to = ahead + random.cube() * spread;
                if i % 2 == 0 {
                    to = through[random.below(through.len())];
                }
                let from = if spread > 5.0 { random.cube() * 15.0 } else { eye };
                (from, (to - from) * random.range(0.5, 2.0))
            })
            .collect()
    }

    #[test]
    fn rays_together_meet_the_triangles_of_rays_alone() {
        let mesh = terrain(40);
        // The same ground, which begins at the field's origin.
        let at = |i: usize| i as f32 * 0.5 - 10.0;
        let heights = (0..41 * 41).map(|i| bumpy(at(i % 41), at(i / 41))).collect();
        let field = HeightField::new(41, 41, glam::Vec2::splat(0.5), heights).unwrap();
        let mut random = Random(3);
        let mut together = TriangleRays::new();
        let mut hits = [0, 0];
        for i in 0..if cfg!(miri) { 4 } else { 600 } {
            let shape = if i % 2 == 0 { Ground::Mesh(&mesh) } else { Ground::Field(&field) };
            let mut rays = rays(&mut random, &mesh.vertices, [0.5, 3.0, 20.0][i % 3]);
            if i % 2 == 1 {
                rays.iter_mut().for_each(|ray| ray.0 += Vec3::new(10.0, 0.0, 10.0));
            }
            let most = if i % 5 == 0 { 0.6 } else { 1.0 };
            together.clear();
            for (ray, &(from, path)) in rays.iter().enumerate() {
                shape.put_ray(&mut together, ray, from, if ray % 9 == 8 { Vec3::ZERO } else { path }, most);
            }
            shape.cast_rays(&mut together);
            for ray in ones(together.rays()) {
                let (from, path) = rays[ray];
                let alone = shape.ray(from, path, most, false);
                let exactly = |hit: Option<(f32, u32)>| hit.map(|(t, index)| (t.to_bits(), index));
                assert_eq!(exactly(together.first(ray)), exactly(alone), "{from} {path}");
                hits[i % 2] += usize::from(alone.is_some());
            }
        }
        println!("{hits:?} hits");
        assert!(cfg!(miri) || hits.iter().all(|&hits| hits > 3000));
    }

    #[test]
    fn eight_triangles_have_the_bits_of_one_by_one() {
        let mesh = terrain(20);
        let mut random = Random(4);
        let mut hits = 0;
        for _ in 0..if cfg!(miri) { 20 } else { 20_000 } {
            let first = random.below(mesh.triangle_count() - 8) as u32;
            let mut corners = Corners::default();
            for lane in 0..8 {
                let triangle = mesh.triangle(first + lane);
                (0..3).for_each(|k| corners.put(lane as usize, k, triangle[k]));
            }
            let from = random.cube() * 10.0;
            let mut to = mesh.triangle(first + random.below(8) as u32)[random.below(3)];
            if random.below(2) == 0 {
                to += random.cube() * 0.3;
            }
            let Some(test) = SegmentTest::along(from, (to - from) * 1.5) else { continue };
            let all = [corners.corner(0), corners.corner(1), corners.corner(2)];
            let (hit, t) = test.hits::<f32x8>(all);
            for lane in 0..8 {
                let one = test.hit(mesh.triangle(first + lane as u32)).map(f32::to_bits);
                let eight = (hit.bits() >> lane & 1 != 0).then(|| t.to_array()[lane].to_bits());
                assert_eq!(one, eight);
                hits += usize::from(one.is_some());
            }
        }
        assert!(cfg!(miri) || hits > 10_000, "{hits}");
    }
}
