//! What the plugin knows of what it added to the world.

use crate::convert::{ToBevy, ToEngine};
use crate::{PhysicsPose, Velocity};
use backstop::{
    BodyHandle, CharacterHandle, CouplingDesc, CouplingHandle, JointDesc, JointHandle, MassProperties,
    ShapeHandle, glam,
};
use bevy_ecs::change_detection::Tick;
use bevy_ecs::entity::Entity;
use bevy_math::{Quat, Vec3, Vec3A};
use bevy_transform::components::Transform;

/// A pose relative to the origin that transforms have, in two registers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LocalPose {
    pub(crate) position: Vec3A,
    pub(crate) rotation: Quat,
}

impl LocalPose {
    #[inline]
    pub(crate) fn of(pose: &PhysicsPose, origin: glam::DVec3) -> Self {
        let position = (pose.position.to_engine() - origin).as_vec3().to_bevy();
        LocalPose { position: position.into(), rotation: pose.rotation }
    }
    #[inline]
    pub(crate) fn of_transform(transform: &Transform) -> Self {
        LocalPose { position: transform.translation.into(), rotation: transform.rotation }
    }
}

/// What each frame reads of a body, apart from the rest: little memory, in one pass over all of them.
#[derive(Debug)]
pub(crate) struct DrawnState {
    /// After the step before the last.
    pub(crate) previous: LocalPose,
    /// After the last step.
    pub(crate) last: LocalPose,
    /// As the transform was last written or taken over: what differs was written by somebody else.
    pub(crate) written: LocalPose,
    /// The tick of the last change that was the plugin's.
    pub(crate) shown_at: Tick,
    /// The last list of bodies that move which it is on.
    pub(crate) listed_in: u32,
}

impl DrawnState {
    /// At rest at a pose, with a transform that says so.
    pub(crate) fn at_rest(pose: LocalPose, written: &Transform) -> Self {
        let written = LocalPose::of_transform(written);
        DrawnState { previous: pose, last: pose, written, shown_at: Tick::new(0), listed_in: 0 }
    }
}

/// What the plugin knows of a body beside that.
#[derive(Debug)]
pub(crate) struct BodyState {
    pub(crate) handle: BodyHandle,
    /// The last step that moved it.
    pub(crate) moved_in: u64,
    pub(crate) velocity: Velocity,
    /// Scale of the transform, as it was last read.
    pub(crate) scale: Vec3,
    pub(crate) asleep: bool,
    /// The mass is given to the engine, and still that of the shapes.
    pub(crate) follows_shapes: bool,
    /// The component's.
    pub(crate) mass: Option<Box<MassProperties>>,
    /// After the last step.
    pub(crate) pose: PhysicsPose,
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
