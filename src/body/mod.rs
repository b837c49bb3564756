//! Bodies: what the caller describes, and the columns that the stages work on.

mod desc;
mod motion;
mod store;

pub use desc::{BodyDesc, BodyKind};
pub(crate) use motion::{carry_spin, exp_map, turn_freely};
pub(crate) use store::{Bodies, Cold, Colliders, IDLE, Mass, NewBody, Pose, Traits};
