//! Many rays at once.
//!
//! They go through the trees in streams of up to 64 ([`crate::shape::Stream`]), as they come. What it is to meet a shape is
//! computed as for one ray, so a batch has the bits of one by one: what comes first does not depend on the way there.

mod stream;

use super::filter::QueryFilter;
use super::ray::{Ray, RayHit};
use crate::error::Error;
use crate::shape::RAYS;
use crate::world::World;
use stream::RayStream;

/// Fewer go one by one: a stream has to be set up.
const FEWEST: usize = 8;

impl World {
    /// [`World::cast_ray`] for many rays: the answer to `rays[i]` goes to `hits[i]`, the same bits as one by one.
    ///
    /// Rays that lie next to each other in the slice share work where they go the same way: let neighbours be neighbours.
    ///
    /// # Errors
    /// There are not as many places for hits as rays, or a number of any ray is not finite or beyond 1e15; then `hits` is
    /// as it was.
    pub fn cast_rays(
        &self,
        rays: &[Ray],
        filter: &QueryFilter<'_>,
        hits: &mut [Option<RayHit>],
    ) -> Result<(), Error> {
        if rays.len() != hits.len() {
            let expected = "one for each ray";
            return Err(Error::OutOfRange { what: "places for hits", expected, value: hits.len() as f64 });
        }
        rays.iter().try_for_each(Ray::validate)?;
        if rays.len() < FEWEST {
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = self.first_on_ray(ray, filter);
            }
            return Ok(());
        }
        let mut stream = RayStream::new();
        for (rays, hits) in rays.chunks(RAYS).zip(hits.chunks_mut(RAYS)) {
            stream.cast(self, rays, filter, hits);
        }
        Ok(())
    }
}
