//! Steps: up, forward and down again, if that ends on ground.

use super::shape::Shape;
use super::slide::Slide;
use crate::error::Error;
use glam::DVec3;

/// The most obstacles to slide along above a step.
const MAX_SLIDES: u32 = 4;

/// Takes the rest of a walk over the obstacle with the upright normal `wall`, up by no more than `height`
/// [m]; or leaves it unchanged.
pub(super) fn step_up(shape: &Shape<'_>, walk: &mut Slide, wall: DVec3, height: f64) -> Result<(), Error> {
    let from = walk.at;
    let up = shape.up * height;
    let allowance = shape.cast(from, up)?.map_or(1.0, |hit| f64::from(hit.fraction));
    let risen = height * allowance;
    let mut above = Slide::new(from + up * allowance, walk.across, 0.0).on(shape.up, from);
    above.run(shape, MAX_SLIDES, 0.0, &mut |_| {})?;
    // It must get beyond the obstacle.
    if (above.at - from).dot(wall) > -shape.tiny {
        return Ok(());
    }
    let down = shape.up * -(risen + height);
    let Some(hit) = shape.cast(above.at, down)? else { return Ok(()) };
    let at = above.at + down * f64::from(hit.fraction);
    // The height of the edge counts, not how far the round bottom has risen so far.
    let feet = shape.feet(from);
    let edge = shape.up.dot(hit.point - feet) - shape.up.dot(walk.foot - feet).max(0.0);
    if edge > height + shape.tiny || hit.depth > 0.0 {
        return Ok(());
    }
    // The bottom may touch the edge only: the ground behind it decides.
    let behind = || {
        let ahead = hit.point - wall * (0.05 * shape.radius);
        let lift = 0.25 * shape.radius;
        shape.floor_on_ray(ahead + shape.up * lift, 2.0 * lift)
    };
    if !shape.is_floor(hit.normal) && behind()?.is_none() {
        return Ok(());
    }
    walk.stepped += shape.up.dot(at - from).max(0.0);
    walk.move_to(at, above.across, shape.up, hit.point);
    Ok(())
}
