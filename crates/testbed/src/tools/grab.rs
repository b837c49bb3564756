//! A body in the hand: springs pull the point at which it was seized to where the hand is.

use super::first_hit;
use crate::Refusal;
use backstop::glam::{DVec3, Quat};
use backstop::{
    Axis, BodyDesc, BodyHandle, BodyKind, JointDesc, JointHandle, Motion, Motor, Ray, Spring, World,
};

/// How stiff the hand is: it catches up within some tenths of a second, and does not swing.
const PULL: Spring = Spring::Frequency { hertz: 5.0, ratio: 1.0 };
/// The most that it pulls with, in weights of the body under the earth's gravity: it lifts what lies on the
/// body too, and does not pull a figure apart.
const WEIGHTS: f32 = 100.0;
/// Acceleration that weighs bodies where gravity does not [m/s²].
const EARTH: f32 = 9.81;
/// Torque against spin, over force [m]: as of a hand of this size.
const PALM: f32 = 0.005;

/// What is held, and by what: a kinematic body where the hand is, joined to it by motors.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grab {
    hand: BodyHandle,
    joint: JointHandle,
    /// Where the hand goes [m].
    target: DVec3,
}

impl Grab {
    /// Seizes the dynamic body that a ray hits first, if it hits one.
    pub(crate) fn new(world: &mut World, ray: &Ray) -> Result<Option<Grab>, Refusal> {
        let Some(hit) = first_hit(world, ray)? else { return Ok(None) };
        if world.kind(hit.body)? != BodyKind::Dynamic {
            return Ok(None);
        }
        let hand = world.add_body(&BodyDesc::kinematic().with_position(hit.point))?;
        let grab = join(world, hand, hit.body, hit.point);
        if grab.is_err() {
            world.remove_body(hand)?;
        }
        grab.map(Some)
    }

    /// Where the hand is to go.
    pub(crate) fn drag(&mut self, world: &mut World, to: DVec3) -> Result<(), Refusal> {
        if !world.contains_joint(self.joint) {
            return Ok(());
        }
        if to.abs().max_element() > backstop::limits::MAX_POSITION {
            return Err(Refusal::told("the hand is too far away"));
        }
        self.target = to;
        let [_, body] = world.joint_bodies(self.joint)?;
        Ok(world.wake(body)?)
    }

    /// Before a step of this length [s].
    pub(crate) fn pull(&mut self, world: &mut World, dt: f32) -> Result<(), Refusal> {
        if !world.contains(self.hand) || world.position(self.hand)? == self.target {
            return Ok(());
        }
        Ok(world.move_kinematic_and_stop(self.hand, self.target, Quat::IDENTITY, dt)?)
    }

    /// Lets go: the body keeps its velocity.
    pub(crate) fn release(self, world: &mut World) -> Result<(), Refusal> {
        if world.contains(self.hand) {
            // The joint goes with it.
            world.remove_body(self.hand)?;
        }
        Ok(())
    }

    /// The point of the body, and where the hand goes; none once the body is gone.
    pub(crate) fn ends(&self, world: &World) -> Option<[DVec3; 2]> {
        let [_, on_body] = world.joint_frames(self.joint).ok()?;
        Some([on_body.0, self.target])
    }
}

fn join(world: &mut World, hand: BodyHandle, body: BodyHandle, at: DVec3) -> Result<Grab, Refusal> {
    let bodies = [hand, body];
    let mut desc = JointDesc::new(bodies, world.frames_at(bodies, at, Quat::IDENTITY)?);
    let gravity = world.settings().gravity.length().max(EARTH);
    let force = WEIGHTS * world.mass(body)? * gravity;
    for axis in [Axis::X, Axis::Y, Axis::Z] {
        desc = desc
            .with_motor(Motor::position(Motion::Linear, axis, 0.0, PULL).with_max_force(force))
            .with_motor(Motor::friction(Motion::Angular, axis, PALM * force));
    }
    Ok(Grab { hand, joint: world.add_joint(&desc)?, target: at })
}
