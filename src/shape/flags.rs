//! Flags of a collider.

/// Bits of [`ColliderSummary::flags`](super::ColliderSummary::flags): a sensor; it has events; it has hooks;
/// as a sensor it notices static shapes, and surfaces.
pub(crate) const SENSOR: u8 = 1;
pub(crate) const EVENTS: u8 = 2;
pub(crate) const HOOKS: u8 = 4;
pub(crate) const STATICS: u8 = 32;
/// Its material resists rolling or spinning; its surface moves. See
/// [`RareMaterial`](super::RareMaterial).
pub(crate) const ROLLS: u8 = 8;
pub(crate) const BELT: u8 = 16;
/// Its material is soft; or it is not, but has a damping ratio that would count if it were.
pub(crate) const SOFT: u8 = 64;
pub(crate) const IDLE_DAMPING: u8 = 128;
/// Part of its material is in the column of rare ones.
pub(crate) const RARE: u8 = ROLLS | BELT | SOFT | IDLE_DAMPING;
