//! A body in the hand.

use super::first_hit;
use crate::Refusal;
use backstop::glam::DVec3;
use backstop::{BodyKind, Grab, GrabSettings, Ray, World};

/// The most that the hand pulls with, in weights of the body: it lifts what lies on the body, and a figure by
/// its arm, and does not tear joints.
const WEIGHTS: f32 = 100.0;

/// Seizes the dynamic body that a ray hits first, if it hits one.
pub(crate) fn seize(world: &mut World, ray: &Ray) -> Result<Option<Grab>, Refusal> {
    let Some(hit) = first_hit(world, ray)? else { return Ok(None) };
    if world.kind(hit.body)? != BodyKind::Dynamic {
        return Ok(None);
    }
    let settings = GrabSettings::default().with_max_force(WEIGHTS);
    Ok(Some(Grab::with_settings(world, hit.body, hit.point, &settings)?))
}

/// Moves what is held, unless it is gone.
pub(crate) fn drag(world: &mut World, grab: &Grab, to: DVec3) -> Result<(), Refusal> {
    if ends(world, grab).is_some() {
        grab.move_to(world, to)?;
    }
    Ok(())
}

/// Lets go: the body keeps its velocity.
pub(crate) fn release(world: &mut World, grab: Grab) -> Result<(), Refusal> {
    if grab.target(world).is_ok() {
        grab.release(world)?;
    }
    Ok(())
}

/// The point of the body, and where it is pulled to; none once the body is gone.
pub(crate) fn ends(world: &World, grab: &Grab) -> Option<[DVec3; 2]> {
    Some([grab.point(world).ok()?, grab.target(world).ok()?])
}
