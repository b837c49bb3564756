//! The trials: a scene under conditions, and the measures by which it is judged.

mod heaps;
mod jointed;
mod motor;
mod moving;
mod setup;
mod sliding;
mod standing;

pub use setup::Drive;
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
    /// A slab on a slope that is nearly too steep for it.
    Slope,
    /// A box and a ball that slide and roll over the seams of flush boxes.
    Tiles,
    /// Boxes on kinematic platforms: up and down, to and fro, round and round; the upper are the heavy ones.
    Platforms,
    /// A motor that presses a rod against a stop; with a ratio of masses it is so many times as strong.
    Motor,
    /// Balls and boxes that overlap at the start.
    Crammed,
    /// A heap of planks.
    Planks,
    /// A heap of compounds.
    Compounds,
    /// A figure thrown down stairs.
    Stairs,
}

impl Trial {
    /// All, in the order of the map.
    pub const ALL: [Trial; 22] = [
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
        Trial::Slope,
        Trial::Tiles,
        Trial::Platforms,
        Trial::Motor,
        Trial::Crammed,
        Trial::Planks,
        Trial::Compounds,
        Trial::Stairs,
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
            Trial::Slope => "slope",
            Trial::Tiles => "tiles",
            Trial::Platforms => "platforms",
            Trial::Motor => "motor",
            Trial::Crammed => "crammed",
            Trial::Planks => "planks",
            Trial::Compounds => "compounds",
            Trial::Stairs => "stairs",
        }
    }

    /// Whether an axis applies to it.
    pub fn has(self, axis: Axis) -> bool {
        use Trial::*;
        match axis {
            Axis::Ordinary | Axis::Rhythm | Axis::Size | Axis::Distance => true,
            Axis::MassRatio => {
                matches!(self, Stack | Pile | Chain | Ragdoll | Hinge | Cart | Plate)
                    || matches!(self, Platforms | Motor | Crammed | Planks | Compounds | Stairs)
            }
            Axis::Slenderness => matches!(self, Chain | Bullets | Hinge | Rotor | Tumbling | Motor),
            Axis::Speed => {
                matches!(self, Pile | Chain | Ragdoll | Bullets | Ball | Tumbling | Cart | Tiles | Stairs)
            }
            Axis::Spin => {
                matches!(self, Pile | Chain | Ragdoll | Bullets | Hinge | Rotor | Tumbling | Motor | Stairs)
            }
            Axis::Gravity => !matches!(self, Tumbling | Rotor | Crammed),
            Axis::Contacts => self == Plate,
            Axis::Flaw => self == Shards,
            Axis::Friction => {
                matches!(self, Stack | Pile | CardHouse | Arch | Ragdoll | Ball | Cart | Plate)
                    || matches!(self, Slope | Platforms | Planks | Compounds | Stairs)
            }
            Axis::Overlap => self == Crammed,
            Axis::Bodies => matches!(self, Pile | Planks | Compounds),
        }
    }

    /// Whether the conditions make sense for it.
    pub(super) fn allows(self, conditions: &Conditions) -> bool {
        match self {
            // Below that, walls would be half a micrometre thick.
            Trial::Bullets => conditions.size >= 0.01,
            // Without friction they fall, or stay behind.
            Trial::CardHouse | Trial::Arch | Trial::Platforms => conditions.friction != Some(0.0),
            _ => true,
        }
    }

    /// Velocities of the bodies that are driven, for the step about a time [s].
    pub(super) fn drives(self, conditions: &Conditions, time: f64) -> Vec<Drive> {
        match self {
            Trial::Platforms => sliding::platform_drives(conditions, time),
            _ => Vec::new(),
        }
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
            Trial::Slope => sliding::slope,
            Trial::Tiles => sliding::tiles,
            Trial::Platforms => sliding::platforms,
            Trial::Motor => motor::motor,
            Trial::Crammed => heaps::crammed,
            Trial::Planks => heaps::planks,
            Trial::Compounds => heaps::compounds,
            Trial::Stairs => heaps::stairs,
        };
        let mut setup = build(conditions);
        setup.scene.gravity *= conditions.gravity;
        if let Some(friction) = conditions.friction {
            let shapes = setup.scene.bodies.iter_mut().flat_map(|body| &mut body.desc.shapes);
            shapes.for_each(|shape| shape.material = shape.material.with_friction(friction));
        }
        // Whole metres, so that rounding of the shift moves no body relative to another.
        let away = DVec3::new(conditions.distance, 0.0, (0.7 * conditions.distance).round());
        setup.scene.bodies.iter_mut().for_each(|body| body.desc.position += away);
        setup.boundaries.iter_mut().for_each(|boundary| boundary.point += away);
        setup
    }
}
