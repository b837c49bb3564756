//! What the plugin knows of what it added to the world.

use crate::{PhysicsPose, Velocity};
use backstop::{
    BodyHandle, CharacterHandle, CouplingDesc, CouplingHandle, JointDesc, JointHandle, MassProperties,
    ShapeHandle,
};
use bevy_ecs::entity::Entity;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;

/// What the plugin knows of a body: what each step and frame reads, and apart from it what is seldom asked
/// for.
#[derive(Debug)]
pub(crate) struct BodyState {
    pub(crate) handle: BodyHandle,
    /// The last step that moved it.
    pub(crate) moved_in: u64,
    /// The last list of what moves that it is on.
    pub(crate) listed_in: u64,
    pub(crate) velocity: Velocity,
    pub(crate) asleep: bool,
    /// The mass is given to the engine, and still that of the shapes.
    pub(crate) follows_shapes: bool,
    /// The component's.
    pub(crate) mass: Option<Box<MassProperties>>,
    /// After the step before the last.
    pub(crate) previous: PhysicsPose,
    /// After the last step.
    pub(crate) pose: PhysicsPose,
    /// As they were last written or taken over: what differs was written by somebody else.
    pub(crate) written: Transform,
}

#[derive(Debug)]
pub(crate) struct ShapeState {
    pub(crate) handle: ShapeHandle,
    pub(crate) body: Entity,
    pub(crate) place: Place,
}

/// Where a shape is in its body's frame, with all scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub(crate) position: Vec3,
    pub(crate) rotation: Quat,
    pub(crate) scale: Vec3,
}

#[derive(Debug)]
pub(crate) struct JointState {
    pub(crate) handle: JointHandle,
    pub(crate) bodies: [Entity; 2],
    pub(crate) desc: JointDesc,
    pub(crate) anchor: Option<(Vec3, Quat)>,
}

#[derive(Debug)]
pub(crate) struct CouplingState {
    pub(crate) handle: CouplingHandle,
    pub(crate) joints: [Entity; 2],
    /// With the joints' handles.
    pub(crate) desc: CouplingDesc,
}

/// What the plugin knows of a character.
#[derive(Debug)]
pub(crate) struct WalkerState {
    pub(crate) handle: CharacterHandle,
    /// After the walk before the last.
    pub(crate) previous: PhysicsPose,
    /// After the last walk.
    pub(crate) pose: PhysicsPose,
    /// As it was last written or taken over: what differs was written by somebody else.
    pub(crate) written: Transform,
    /// It has a shape of its own, which turns with it.
    pub(crate) shaped: bool,
    /// Its rotation is that of a snapshot, and not shown yet.
    pub(crate) turned_back: bool,
    /// Why it was last refused something before and after the step, until that is over.
    pub(crate) problems: [Option<String>; 2],
}

impl WalkerState {
    pub(crate) fn new(handle: CharacterHandle, pose: PhysicsPose, written: Transform, shaped: bool) -> Self {
        let problems = [None, None];
        WalkerState { handle, previous: pose, pose, written, shaped, turned_back: false, problems }
    }
}
