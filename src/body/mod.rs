//! Bodies: what the caller describes, and the columns that the stages work on.

mod colliders;
mod desc;
mod free;
mod motion;
mod store;

pub(crate) use colliders::Colliders;
pub use desc::{BodyDesc, BodyKind};
pub(crate) use free::{FREE, FreeTurn};
pub(crate) use motion::{carry_spin, exp_map};
pub(crate) use store::{Bodies, BodyDetails, ColliderList, IDLE, Mass, NewBody, Pose, Traits, is_uneven};
