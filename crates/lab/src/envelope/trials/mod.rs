//! The trials: a scene under conditions, and the measures by which it is judged.

mod jointed;
mod moving;
mod setup;
mod standing;

pub(super) use setup::Setup;

use super::conditions::{Axis, Conditions};
use backstop_scene::Scene;
use glam::DVec3;

/// Typical contents of games, each a small scene of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trial {
    /// Ten boxes on each other; with a ratio of masses the topmost is the heavy one.
    Stack,
    /// Sixty bodies of five shapes in a closed room.
    Pile,
    /// Three storeys of leaning cards.
    CardHouse,
    /// Eleven wedges without mortar.
    Arch,
    /// Ten links and a ball, which is the heavy one, let go level.
    Chain,
    /// A figure thrown at the floor, with a heavy pelvis.
    Ragdoll,
    /// Sixteen bullets of 5 mm in a room with walls of 1 mm.
    Bullets,
    /// A ball that rolls.
    Ball,
    /// A rod that swings on a hinge.
    Hinge,
    /// A disc that spins on a hinge.
    Rotor,
    /// A brick that tumbles freely.
    Tumbling,
    /// A cart that coasts on four wheels, with a heavy chassis.
    Cart,
    /// A plate that carries boxes, which are the heavy ones.
    Plate,
    /// Bodies on degenerate triangles, or degenerate hulls.
    Shards,
}

impl Trial {
    /// All, in the order of the map.
    pub const ALL: [Trial; 14] = [
        Trial::Stack,
        Trial::Pile,
        Trial::CardHouse,
        Trial::Arch,
        Trial::Chain,
        Trial::Ragdoll,
        Trial::Bullets,
        Trial::Ball,
        Trial::Hinge,
        Trial::Rotor,
        Trial::Tumbling,
        Trial::Cart,
        Trial::Plate,
        Trial::Shards,
    ];

    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Trial::Stack => "stack",
            Trial::Pile => "pile",
            Trial::CardHouse => "card-house",
            Trial::Arch => "arch",
            Trial::Chain => "chain",
            Trial::Ragdoll => "ragdoll",
            Trial::Bullets => "bullets",
            Trial::Ball => "ball",
            Trial::Hinge => "hinge",
            Trial::Rotor => "rotor",
            Trial::Tumbling => "tumbling",
            Trial::Cart => "cart",
            Trial::Plate => "plate",
            Trial::Shards => "shards",
        }
    }

    /// Whether an axis applies to it.
    pub fn has(self, axis: Axis) -> bool {
        use Trial::*;
        match axis {
            Axis::Ordinary | Axis::Rhythm | Axis::Size | Axis::Distance => true,
            Axis::MassRatio => matches!(self, Stack | Pile | Chain | Ragdoll | Hinge | Cart | Plate),
            Axis::Slenderness => matches!(self, Chain | Bullets | Hinge | Rotor | Tumbling),
            Axis::Speed => matches!(self, Pile | Chain | Ragdoll | Bullets | Ball | Tumbling | Cart),
            Axis::Spin => matches!(self, Pile | Chain | Ragdoll | Bullets | Hinge | Rotor | Tumbling),
            Axis::Gravity => !matches!(self, Tumbling | Rotor),
            Axis::Contacts => self == Plate,
            Axis::Flaw => self == Shards,
        }
    }

    /// Whether all of its lengths are within [`crate::limits`].
    pub(super) fn allows(self, conditions: &Conditions) -> bool {
        // Below that, walls would be half a micrometre thick.
        self != Trial::Bullets || conditions.size >= 0.01
    }

    /// The scene under some conditions.
    pub fn scene(self, conditions: &Conditions) -> Scene {
        self.setup(conditions).scene
    }

    /// The scene and its measures.
    pub(super) fn setup(self, conditions: &Conditions) -> Setup {
        let build = match self {
            Trial::Stack => standing::stack,
            Trial::Pile => moving::pile,
            Trial::CardHouse => standing::card_house,
            Trial::Arch => standing::arch,
            Trial::Chain => jointed::chain,
            Trial::Ragdoll => jointed::ragdoll,
            Trial::Bullets => moving::bullets,
            Trial::Ball => moving::ball,
            Trial::Hinge => jointed::hinge,
            Trial::Rotor => jointed::rotor,
            Trial::Tumbling => moving::tumbling,
            Trial::Cart => jointed::cart,
            Trial::Plate => standing::plate,
            Trial::Shards => moving::shards,
        };
        let mut setup = build(conditions);
        setup.scene.gravity *= conditions.gravity;
        // Whole metres, so that rounding of the shift moves no body relative to another.
        let away = DVec3::new(conditions.distance, 0.0, (0.7 * conditions.distance).round());
        setup.scene.bodies.iter_mut().for_each(|body| body.desc.position += away);
        setup.boundaries.iter_mut().for_each(|boundary| boundary.point += away);
        setup
    }
}
