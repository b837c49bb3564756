//! The component of couplings.

use crate::world::PhysicsWorld;
use backstop::{CouplingDesc, JointHandle};
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;

/// A coupling of the motions of two joints: gears, a rack, a screw, a rope over pulleys; on an entity of its
/// own or on any other. Removing it removes the coupling; a change of it changes the coupling. While one of
/// the joints is not there, the coupling waits for it. One that breaks is gone until the component changes:
/// [`CouplingBroke`](crate::CouplingBroke).
#[derive(Component, Clone, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::TypePath, serde::Serialize, serde::Deserialize))]
#[component(on_remove = coupling_removed)]
pub struct Coupling {
    /// Entities of the joints of the two motions; twice the same for a screw.
    #[entities]
    pub joints: [Entity; 2],
    /// Motions, range and strength; its joints and user data are not looked at.
    pub desc: CouplingDesc,
}

/// Stands for the joints of a description until they are known.
const NO_JOINT: JointHandle = JointHandle::from_bits(0);

impl Coupling {
    /// A coupling of a description.
    pub fn new(joints: [Entity; 2], desc: CouplingDesc) -> Self {
        Coupling { joints, desc }
    }
    /// Two meshing gears on hinges, by their numbers of teeth: [`CouplingDesc::gear`].
    pub fn gear(hinges: [Entity; 2], teeth: [f64; 2]) -> Self {
        Coupling::new(hinges, CouplingDesc::gear([NO_JOINT; 2], teeth))
    }
    /// A pinion on a hinge and a rack on a slider: [`CouplingDesc::rack`].
    pub fn rack(hinge: Entity, slider: Entity, radius: f64) -> Self {
        Coupling::new([hinge, slider], CouplingDesc::rack(NO_JOINT, NO_JOINT, radius))
    }
    /// A screw of one joint, by its travel in a turn [m]: [`CouplingDesc::screw`].
    pub fn screw(joint: Entity, lead: f64) -> Self {
        Coupling::new([joint; 2], CouplingDesc::screw(NO_JOINT, lead))
    }
    /// A rope over two pulleys: [`CouplingDesc::pulley`].
    pub fn pulley(ropes: [Entity; 2], ratio: f64, length: f64) -> Self {
        Coupling::new(ropes, CouplingDesc::pulley([NO_JOINT; 2], ratio, length))
    }
    /// Breaks above this force or torque on either motion [N] or [N m].
    #[must_use]
    pub fn with_break_force(mut self, break_force: [f32; 2]) -> Self {
        self.desc = self.desc.with_break_force(break_force);
        self
    }
}

fn coupling_removed(mut world: DeferredWorld, context: HookContext) {
    if let Some(mut physics) = world.get_resource_mut::<PhysicsWorld>() {
        physics.remove_coupling_of(context.entity);
    }
}
