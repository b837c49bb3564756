//! Moving ground: a character moves with the point of the ground that it stood on.

use super::shape::Shape;
use super::slide::Slide;
use crate::error::Error;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::math::Quat;
use crate::query::QueryFilter;
use crate::world::World;
use glam::{DQuat, DVec3};

/// Where a character is on the body that it stands on. Poses rather than velocities give the body's actual
/// motion since then, with its rotation, whether the world was stepped before or after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Carrier {
    pub(super) body: BodyHandle,
    pub(super) position: DVec3,
    pub(super) rotation: Quat,
}

impl Carrier {
    pub(super) fn new(world: &World, body: BodyHandle) -> Result<Carrier, Error> {
        Ok(Carrier { body, position: world.position(body)?, rotation: world.rotation(body)?.into() })
    }

    /// Displacement of a point with the body, and its rotation about `up` [rad]. Zero if the body was
    /// removed.
    fn taken(&self, world: &World, at: DVec3, up: DVec3) -> (DVec3, f64) {
        let Ok(now) = Carrier::new(world, self.body) else { return (DVec3::ZERO, 0.0) };
        if now == *self {
            return (DVec3::ZERO, 0.0);
        }
        let unit = |q: Quat| q.as_dquat().normalize();
        let turn: DQuat = unit(now.rotation) * unit(self.rotation).conjugate();
        let taken = now.position + turn * (at - self.position) - at;
        let turn = if turn.w < 0.0 { -turn } else { turn };
        (taken, 2.0 * libm::atan2(turn.xyz().dot(up), turn.w))
    }
}

/// Carries a character along, as far as obstacles allow. Returns its new position and rotation [rad].
pub(super) fn carry(
    shape: &Shape<'_>,
    carrier: Option<Carrier>,
    from: DVec3,
    most: u32,
) -> Result<(DVec3, f64), Error> {
    let Some(carrier) = carrier else { return Ok((from, 0.0)) };
    let (way, turned) = carrier.taken(shape.world, shape.feet(from), shape.up);
    if way == DVec3::ZERO {
        return Ok((from, turned));
    }
    let own = shape.filter.predicate;
    let others =
        |body: BodyHandle, s: ShapeHandle| body != carrier.body && own.is_none_or(|says| says(body, s));
    let filter = QueryFilter { predicate: Some(&others), ..shape.filter };
    let (rise, across) = shape.split(way);
    let mut slide = Slide::new(from, across, rise);
    slide.run(&shape.among(&filter), most, 0.0, &mut |_| {})?;
    Ok((slide.at, turned))
}
