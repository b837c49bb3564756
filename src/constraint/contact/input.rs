//! Input for the preparation of rows.

use super::step_lengths::StepLengths;
use crate::body::{Bodies, Colliders};
use crate::broad_phase::Pair;
use crate::config::{Measures, Order};
use crate::constraint::Tweak;
use crate::constraint::articulation::slots::TreeSlots;
use crate::forces::Forces;
use crate::joint::Joints;
use crate::narrow_phase::{Contacts, Scale};
use crate::shape::{Material, RareMaterial};

/// Input of preparation.
pub(crate) struct PrepareInput<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) colliders: &'a Colliders,
    pub(crate) contacts: &'a Contacts,
    pub(crate) pairs: &'a [Pair],
    pub(crate) forces: &'a Forces,
    pub(crate) measures: Measures,
    /// Maximum bytes of contacts further apart than discrete collision detection looks, with their rows.
    pub(crate) ahead: usize,
    /// The substeps of this step and the last, by which impulses are scaled.
    pub(crate) lengths: StepLengths,
    /// The order in which groups of rows are solved.
    pub(crate) order: Order,
    /// Bodies whose contacts with static geometry are solved along with their trees of joints.
    pub(crate) tree_slots: &'a TreeSlots,
    /// Changes of each contact by hooks; empty if there are none.
    pub(crate) tweaks: &'a [Tweak],
    /// Friction at every point: each point then is a manifold of its own.
    pub(crate) per_point: bool,
    /// Whether anything may have friction.
    pub(crate) friction: bool,
    pub(crate) beside: Beside,
    pub(crate) joints: &'a Joints,
    /// Marks of the contacts and joints that hold dynamic bodies, for soft contacts; empty before they are
    /// made.
    pub(crate) marks: &'a [u8],
    /// Weights of contacts, in case memory does not suffice for all.
    pub(crate) scale: Scale<'a>,
}

impl PrepareInput<'_> {
    /// Rare properties of the material of a part of a shape: zero for the shape's own.
    pub(super) fn rare_of(&self, collider: u32, part: u8) -> RareMaterial {
        let of_part = self.colliders.all[collider as usize].part_material(part).map(Material::rare);
        of_part.unwrap_or_else(|| self.colliders.rare(collider))
    }
}

/// Data of each batch of the schedule besides its rows and friction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beside {
    /// Whether any surface moves, by its material or by a hook.
    pub(crate) surfaces: bool,
    /// Whether any shape resists rolling or spinning.
    pub(crate) rolling: bool,
    /// Whether springs act at any shape.
    pub(crate) soft: bool,
}
