//! The component of joints.

use crate::world::PhysicsWorld;
use backstop::{BodyHandle, Frame, JointDesc, Limit, Motor, Spring};
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;
use bevy_math::{Quat, Vec3};
/// A joint between two bodies, on an entity of its own or on any other. Removing it removes the joint; a
/// change of it changes the joint. If a body is not there yet, the joint waits for it, and
/// [`PhysicsError`](crate::PhysicsError) says so once. A joint that breaks is gone until the component
/// changes: [`JointBroke`](crate::JointBroke).
#[derive(Component, Clone, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::TypePath, serde::Serialize, serde::Deserialize))]
#[component(on_remove = joint_removed)]
pub struct Joint {
    /// Entities of the two bodies; the motion is that of the second as seen from the first.
    #[entities]
    pub bodies: [Entity; 2],
    /// Limits, drives and all else; its bodies and user data are not looked at.
    pub desc: JointDesc,
    /// Where both frames are when the joint is made, if not where `desc` says: a point where transforms are
    /// [m], and the joint's x, y and z there.
    pub anchor: Option<(Vec3, Quat)>,
}

/// Stands for the bodies of a description until they are known.
const NOBODY: [BodyHandle; 2] = [BodyHandle::from_bits(0); 2];

impl Joint {
    /// A joint of a description.
    pub fn new(bodies: [Entity; 2], desc: JointDesc) -> Self {
        Joint { bodies, desc, anchor: None }
    }
    /// No relative motion.
    pub fn fixed(bodies: [Entity; 2]) -> Self {
        Joint::new(bodies, JointDesc::fixed(NOBODY, Default::default()))
    }
    /// The two frames' origins stay together.
    pub fn ball(bodies: [Entity; 2]) -> Self {
        Joint::new(bodies, JointDesc::ball(NOBODY, Default::default()))
    }
    /// Turns about the frames' x only.
    pub fn hinge(bodies: [Entity; 2]) -> Self {
        Joint::new(bodies, JointDesc::hinge(NOBODY, Default::default()))
    }
    /// Slides along the frames' x only.
    pub fn slider(bodies: [Entity; 2]) -> Self {
        Joint::new(bodies, JointDesc::slider(NOBODY, Default::default()))
    }
    /// The frames' origins stay at a distance between `min` and `max` [m].
    pub fn distance(bodies: [Entity; 2], min: f32, max: f32) -> Self {
        Joint::new(bodies, JointDesc::distance(NOBODY, Default::default(), min, max))
    }
    /// A wheel (second body) on a car (first): [`JointDesc::wheel`].
    pub fn wheel(bodies: [Entity; 2], travel: f32, spring: Spring) -> Self {
        Joint::new(bodies, JointDesc::wheel(NOBODY, Default::default(), travel, spring))
    }

    /// Both frames at a point where transforms are when the joint is made [m].
    #[must_use]
    pub fn at(mut self, point: Vec3) -> Self {
        self.anchor = Some((point, self.anchor.map_or(Quat::IDENTITY, |(_, rotation)| rotation)));
        self
    }
    /// Both frames with their x along this axis of the world, which must have a length.
    #[must_use]
    pub fn about(mut self, axis: Vec3) -> Self {
        let rotation = Quat::from_rotation_arc(Vec3::X, axis.normalize_or(Vec3::X));
        self.anchor = Some((self.anchor.map_or(Vec3::ZERO, |(point, _)| point), rotation));
        self
    }
    /// Frames on the two bodies, in their own axes.
    #[must_use]
    pub fn with_frames(mut self, frames: [Frame; 2]) -> Self {
        (self.desc.frames, self.anchor) = (frames, None);
        self
    }
    /// With a further limit.
    #[must_use]
    pub fn with_limit(self, limit: Limit) -> Self {
        self.with(|desc| desc.with_limit(limit))
    }
    /// With a further drive.
    #[must_use]
    pub fn with_motor(self, motor: Motor) -> Self {
        self.with(|desc| desc.with_motor(motor))
    }
    /// Breaks above this force [N] and this torque [N m].
    #[must_use]
    pub fn with_break_force(self, force: f32, torque: f32) -> Self {
        self.with(|desc| desc.with_break_force(force, torque))
    }
    /// Is reported above this force [N] and this torque [N m]: [`JointStrained`](crate::JointStrained).
    #[must_use]
    pub fn with_thresholds(self, force: f32, torque: f32) -> Self {
        self.with(|desc| desc.with_thresholds(force, torque))
    }
    /// With a changed description.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(JointDesc) -> JointDesc) -> Self {
        self.desc = change(self.desc);
        self
    }
}

fn joint_removed(mut world: DeferredWorld, context: HookContext) {
    if let Some(mut physics) = world.get_resource_mut::<PhysicsWorld>() {
        physics.remove_joint_of(context.entity);
    }
}
