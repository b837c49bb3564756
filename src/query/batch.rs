//! Many rays at once.

use super::filter::QueryFilter;
use super::ray::{Ray, RayHit};
use crate::error::Error;
use crate::world::World;

impl World {
    /// [`World::cast_ray`] for many rays: the answer to `rays[i]` goes to `hits[i]`, the same bits as one by one.
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
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.first_on_ray(ray, filter);
        }
        Ok(())
    }
}
