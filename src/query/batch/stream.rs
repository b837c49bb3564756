//! The rays of a stream and the shapes that they meet.

use crate::error::Error;
use crate::lanes::{f32x4, ones};
use crate::query::candidates::{Candidate, turn_back};
use crate::query::filter::{QueryFilter, Sees};
use crate::query::ray::{Ray, RayHit};
use crate::query::ray_shape::{Met, Way, meet};
use crate::shape::{Ground, RAYS, Slabs, Stream, TriangleRays, Walk};
use crate::world::World;
use glam::{DVec3, Vec3};

/// Up to this many rays are tested against triangles one by one.
const FEW: u32 = 2;

/// Up to [`RAYS`] rays on their way. It is set up once for all of a batch.
pub(super) struct RayStream {
    stream: Stream,
    walk: Walk,
    first: First,
    among: Among,
}

/// The first hit of each ray so far: the collider, and how.
struct First([Option<(u32, Met)>; RAYS]);

/// The rays that are tested against the triangles of one shape, in its frame.
struct Among {
    rays: TriangleRays,
    ways: [(Way, DVec3, DVec3); RAYS],
}

impl RayStream {
    pub(super) fn new() -> RayStream {
        RayStream {
            stream: Stream::new(),
            walk: Walk::new(),
            first: First([None; RAYS]),
            among: Among {
                rays: TriangleRays::new(),
                ways: [(Way::default(), DVec3::ZERO, DVec3::ZERO); RAYS],
            },
        }
    }

    /// Answers to as many rays as fit in.
    pub(super) fn cast(
        &mut self,
        world: &World,
        rays: &[Ray],
        filter: &QueryFilter<'_>,
        hits: &mut [Option<RayHit>],
    ) -> Result<(), Error> {
        let sees = Sees::new(world, filter);
        let RayStream { stream, walk, first, among } = self;
        for (i, ray) in rays.iter().enumerate() {
            stream.put(i, Slabs::<f32x4>::new(ray.from, ray.path, Vec3::ZERO), 1.0);
            first.0[i] = None;
        }
        let all = u64::MAX >> (RAYS - rays.len());
        let skip = filter.skip_inside;
        world.broad.together(world.current()?, filter.sorts(), stream, walk, all, |index, here, stream| {
            let shape = &world.colliders.all[index as usize];
            if !sees.sees(index, shape) {
                return;
            }
            let candidate = world.candidate(index);
            match shape.geometry.ground() {
                Some(ground) if here.count_ones() > FEW => {
                    among.meet(ground, &candidate, rays, here, stream, first);
                }
                _ => {
                    for i in ones(here) {
                        if let Some(met) = meet(&candidate, &rays[i], stream.most[i], false)
                            && !(met.inside && skip)
                        {
                            first.take(i, index, &met, stream);
                        }
                    }
                }
            }
        });
        for (i, (ray, hit)) in rays.iter().zip(hits).enumerate() {
            *hit = first.0[i].map(|(index, met)| world.ray_hit(ray, &world.candidate(index), &met));
        }
        Ok(())
    }
}

impl First {
    /// Among shapes at the same fraction the lower index is the first.
    #[inline]
    fn take(&mut self, i: usize, index: u32, met: &Met, stream: &mut Stream) {
        let first = &mut self.0[i];
        if met.fraction <= stream.most[i]
            && first.as_ref().is_none_or(|(other, m)| (met.fraction, index) < (m.fraction, *other))
        {
            *first = Some((index, *met));
            stream.most[i] = met.fraction;
        }
    }
}

impl Among {
    fn meet(
        &mut self,
        ground: Ground<'_>,
        candidate: &Candidate<'_>,
        rays: &[Ray],
        here: u64,
        stream: &mut Stream,
        first: &mut First,
    ) {
        self.rays.clear();
        for i in ones(here) {
            let start = candidate.local(rays[i].from);
            let path = turn_back(candidate.place.rotation, rays[i].path.as_dvec3());
            if let Some(way) = Way::new(ground, start, path, stream.most[i]) {
                ground.put_ray(&mut self.rays, i, way.from, way.path, way.most);
                self.ways[i] = (way, start, path);
            }
        }
        ground.cast_rays(&mut self.rays);
        for i in ones(self.rays.rays()) {
            if let Some((t, index)) = self.rays.first(i) {
                let (way, start, path) = &self.ways[i];
                let met = way.met(ground, *start, *path, t, index);
                first.take(i, candidate.index, &met, stream);
            }
        }
    }
}
