//! Many rays at once.
//!
//! Rays that are next to each other in the batch go through the trees together, up to 64 in a stream
//! (`shape/stream.rs`); where neighbours have nothing in common, each is cast alone. Hits are computed as for
//! a single ray, and the first hit does not depend on the order of the search, so a batch has the bits of
//! single casts.
//!
//! Sorting the rays of a batch into streams, by octant and by place on a Morton curve (256 at a time), gained
//! nothing above the noise: many rays usually come in some order, and unordered ones diverge after a few
//! levels.

mod stream;
#[cfg(test)]
mod tests;

use super::filter::QueryFilter;
use super::ray::{Ray, RayHit};
use crate::config::tuning::STREAM_SPREAD;
use crate::error::{Error, count, each};
use crate::shape::RAYS;
use crate::world::World;
use stream::RayStream;

/// Smaller batches are cast one by one: setting up streams takes some microseconds, and in calls of 16 that
/// costs more than it gains.
const FEWEST: usize = 32;

/// # Queries: many rays
impl World {
    /// [`World::cast_ray`] for many rays: the answer to `rays[i]` goes to `hits[i]`, the same bits as one by
    /// one.
    ///
    /// Faster than one by one where neighbours in the slice go about the same way, as those of a camera or a
    /// sensor do; others are cast one by one. Uses about 64 kB of the stack.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let rays = [-2.0, 0.0, 2.0].map(|x| Ray::new(DVec3::new(x, 5.0, 0.0), Vec3::NEG_Y * 10.0));
    /// let mut hits = [None; 3];
    /// world.cast_rays(&rays, &QueryFilter::default(), &mut hits)?;
    /// assert_eq!(hits.map(|hit| hit.map(|hit| hit.body)), [Some(ground), Some(body), Some(ground)]);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// There are not as many places for hits as rays, or a number of any ray is not finite or beyond 1e15, or
    /// the budget does not allow the tree of movable bodies (see [`World::cast_ray`]); then `hits` is as it
    /// was.
    pub fn cast_rays(
        &self,
        rays: &[Ray],
        filter: &QueryFilter<'_>,
        hits: &mut [Option<RayHit>],
    ) -> Result<(), Error> {
        count("places for hits", "one for each ray", rays.len(), hits.len())?;
        each("ray", rays, Ray::validate)?;
        self.ready(filter)?;
        // The streams are large, so they are set up once, in place, and only if they are needed.
        let alike = |rays: &[Ray]| filter.only.is_none() && rays.len() >= FEWEST && are_alike(rays);
        if rays.chunks(RAYS).any(alike) {
            let mut stream = RayStream::new();
            for (rays, hits) in rays.chunks(RAYS).zip(hits.chunks_mut(RAYS)) {
                if alike(rays) {
                    stream.cast(self, rays, filter, hits)?;
                } else {
                    self.one_by_one(rays, filter, hits)?;
                }
            }
        } else {
            self.one_by_one(rays, filter, hits)?;
        }
        Ok(())
    }

    fn one_by_one(
        &self,
        rays: &[Ray],
        filter: &QueryFilter<'_>,
        hits: &mut [Option<RayHit>],
    ) -> Result<(), Error> {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.first_on_ray(ray, filter)?;
        }
        Ok(())
    }
}

/// Whether rays stay near enough to their neighbours to be faster together, judged by a fourth of them.
fn are_alike(rays: &[Ray]) -> bool {
    let (mut apart, mut long) = (0.0, 0.0);
    for pair in rays.windows(2).step_by(4) {
        let from = (pair[1].from - pair[0].from).as_vec3();
        let to = from + (pair[1].path - pair[0].path);
        apart += from.abs().element_sum() + to.abs().element_sum();
        long += pair[1].path.abs().element_sum();
    }
    apart <= STREAM_SPREAD * long
}
