//! The colliders of all bodies.

use super::{Odometer, Pose};
use crate::handle::{ShapeHandle, Slots};
use crate::memory::{Allowance, buffers, bytes_of};
use crate::shape::{Collider, ColliderSummary, Material, RareMaterial};

/// Colliders by stable index, with their world poses.
#[derive(Debug, Default)]
pub(crate) struct Colliders {
    pub(crate) all: Vec<Collider>,
    pub(crate) summaries: Vec<ColliderSummary>,
    pub(crate) poses: Vec<Pose>,
    /// The furthest that predicted rotation moves points of a shape within the step, if its body can move
    /// [m]. Of no meaning between steps.
    pub(crate) swings: Vec<f32>,
    pub(crate) odometers: Vec<Odometer>,
    pub(crate) slots: Slots,
    /// The part of materials that few shapes have, by index as far as it goes; empty while none has it.
    pub(crate) rare: Vec<RareMaterial>,
}

buffers! {
    Colliders {
        /// For so many colliders, and so many that have a place in the column of rare materials.
        each(n: usize, rare: usize) {
            all(n), summaries(n), poses(n), swings(n), odometers(n), slots(n), rare(rare)
        }
    }
}

impl Colliders {
    /// Makes place for so many more, beside the places that are free.
    pub(crate) fn reserve(&mut self, more: usize) {
        let (mut allowance, len) =
            (Allowance::ENDLESS, self.all.len() + more.saturating_sub(self.slots.spare()));
        allowance.fit(&mut self.all, len);
        allowance.fit(&mut self.summaries, len);
        allowance.fit(&mut self.poses, len);
        allowance.fit(&mut self.swings, len);
        allowance.fit(&mut self.odometers, len);
    }

    /// Rare fields of materials.
    pub(crate) fn rare(&self, collider: u32) -> RareMaterial {
        self.rare.get(collider as usize).copied().unwrap_or_default()
    }

    pub(crate) fn set_rare(&mut self, collider: u32, rare: RareMaterial) {
        let index = collider as usize;
        if index >= self.rare.len() {
            if rare == RareMaterial::default() {
                return;
            }
            let len = self.all.len().max(index + 1);
            Allowance::ENDLESS.clone().fit(&mut self.rare, len);
            self.rare.resize(len, RareMaterial::default());
        }
        self.rare[index] = rare;
    }

    /// The material of a collider as the caller gave it.
    pub(crate) fn material(&self, collider: u32) -> Material {
        Material::of(self.all[collider as usize].material, self.rare(collider))
    }

    pub(crate) fn handle(&self, collider: u32) -> ShapeHandle {
        ShapeHandle { slot: collider, generation: self.slots.generation(collider) }
    }

    /// The colliders of a body whose index is new.
    pub(super) fn follow_all(&mut self, own: &ColliderList, body: u32) {
        for &collider in own.as_slice() {
            self.all[collider as usize].body = body;
            self.summaries[collider as usize].body = body;
        }
    }

    /// Sets the world pose of a collider from that of its body, outside of the stage that does so in a step.
    pub(crate) fn place(&mut self, collider: u32, body: &Pose) {
        self.odometers[collider as usize].jump();
        let own = &self.all[collider as usize];
        self.poses[collider as usize] = body.of_part(own.position, own.rotation);
    }
}

/// The colliders of a body: most have one.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) enum ColliderList {
    #[default]
    None,
    One(u32),
    Many(Vec<u32>),
}

impl ColliderList {
    pub(crate) fn as_slice(&self) -> &[u32] {
        match self {
            ColliderList::None => &[],
            ColliderList::One(one) => std::slice::from_ref(one),
            ColliderList::Many(many) => many,
        }
    }
    pub(super) fn is_many(&self) -> bool {
        matches!(self, ColliderList::Many(_))
    }
    pub(super) fn bytes(&self) -> (usize, usize) {
        if let ColliderList::Many(many) = self { bytes_of(many) } else { (0, 0) }
    }
    pub(super) fn push(&mut self, collider: u32) {
        match self {
            ColliderList::None => *self = ColliderList::One(collider),
            ColliderList::One(one) => *self = ColliderList::Many(vec![*one, collider]),
            ColliderList::Many(many) => many.push(collider),
        }
    }
    /// The last takes the place: a body may have a hundred thousand.
    pub(super) fn remove(&mut self, place: usize) {
        match self {
            ColliderList::Many(many) => {
                many.swap_remove(place);
                if let [last] = many[..] {
                    *self = ColliderList::One(last);
                }
            }
            _ => *self = ColliderList::None,
        }
    }
}
