//! Bodies joined to chains and loops.

pub(super) mod bricard;
pub(super) mod capstan;
pub(super) mod four_bars;
pub(super) mod modes;
pub(super) mod squeezer;

use super::rig::Rig;
use backstop::BodyHandle;
use backstop::Error;
use backstop::JointDesc;
use glam::{DVec3, Vec3};

/// A hinge about an axis through a point of the world.
fn hinge(rig: &mut Rig, bodies: [BodyHandle; 2], at: DVec3, axis: Vec3) -> Result<(), Error> {
    let frames = rig.world.frames_about(bodies, at, axis)?;
    rig.world.add_joint(&JointDesc::hinge(bodies, frames)).map(drop)
}
