//! Bodies: the caller's descriptions, and the columns that the stages work on.

mod colliders;
mod desc;
mod force_column;
mod free;
mod motion;
mod odometer;
mod pose;
mod rare;
mod store;
mod targets;

pub(crate) use colliders::{ColliderList, Colliders};
pub use desc::{BodyDesc, BodyKind};
pub(crate) use free::{FREE, FreeTurn};
pub(crate) use motion::{carry_spin, exp_map};
pub(crate) use odometer::{Odometer, out_of_reach, reading};
pub(crate) use pose::Pose;
pub(crate) use rare::{BySlot, Damping, KeptMass, RareCounts, SpeedCap};
pub(crate) use store::{Bodies, BodyDetails, IDLE, Mass, NewBody, Traits, is_uneven};
pub(crate) use targets::{AfterTarget, Target};
