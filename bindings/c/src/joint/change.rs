//! Limits, motors and greatest loads of joints, read and changed one by one.

use super::desc::{BsFrame, BsJointAxes, BsLimitDesc, BsMotion, BsMotorDesc};
use crate::abi::guard::call;
use crate::abi::pointers::{Buffer, Out, slice};
use crate::abi::sized::read;
use crate::abi::status::BsStatus;
use crate::abi::twin::Twin;
use crate::abi::values::{BsBool, BsJoint, BsVec3};
use crate::world::{BsWorld, change, changing, get, get_two, reading};
use backstop::JointEvent;

/// Replaces the motor of a joint with the same motion and axis, or adds it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_set_motor(
    world: *mut BsWorld,
    joint: BsJoint,
    motor: *const BsMotorDesc,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, motor) = unsafe { (changing(world)?, read(motor)?.to_engine()?) };
        Ok(content.set_joint_motor(joint.into(), motor)?)
    })
}

/// Removes the motor of a joint with a motion and an axis. `removed` becomes whether there was one; it may be
/// null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_remove_motor(
    world: *mut BsWorld,
    joint: BsJoint,
    motion: BsMotion,
    axis: BsJointAxes,
    removed: *mut BsBool,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, out) =
            unsafe { (changing(world)?, Out::optional("the place for the answer", removed)?) };
        let had = content.remove_joint_motor(joint.into(), Twin::read(motion)?, Twin::read(axis)?)?;
        if let Some(out) = out {
            out.set(had.into());
        }
        Ok(())
    })
}

/// Sets the targets of a motor: a position [m] or [rad] and a velocity [m/s] or [rad/s]. Meant for every
/// step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_set_target(
    world: *mut BsWorld,
    joint: BsJoint,
    motion: BsMotion,
    axis: BsJointAxes,
    position: f32,
    velocity: f32,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut content = unsafe { changing(world) }?;
        let (motion, axis) = (Twin::read(motion)?, Twin::read(axis)?);
        Ok(content.set_joint_target(joint.into(), motion, axis, position, velocity)?)
    })
}

/// Replaces the limit of a joint with the same motion and axes, or adds it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_set_limit(
    world: *mut BsWorld,
    joint: BsJoint,
    limit: *const BsLimitDesc,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, limit) = unsafe { (changing(world)?, read(limit)?.to_engine()?) };
        Ok(content.set_joint_limit(joint.into(), limit)?)
    })
}

/// Removes the limit of a joint with a motion and axes. `removed` becomes whether there was one; it may be
/// null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_remove_limit(
    world: *mut BsWorld,
    joint: BsJoint,
    motion: BsMotion,
    axes: BsJointAxes,
    removed: *mut BsBool,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, out) =
            unsafe { (changing(world)?, Out::optional("the place for the answer", removed)?) };
        let had = content.remove_joint_limit(joint.into(), Twin::read(motion)?, Twin::read(axes)?)?;
        if let Some(out) = out {
            out.set(had.into());
        }
        Ok(())
    })
}

/// The limits of a joint, those of its kind among them. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_limits(
    world: *const BsWorld,
    joint: BsJoint,
    limits: *mut BsLimitDesc,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Buffer::new("limits", limits, capacity, count)?) };
        let found: Vec<_> = content.joint_limits(joint.into())?.collect();
        out.fill(found.iter().map(BsLimitDesc::of_engine))
    })
}

/// The motors of a joint. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_motors(
    world: *const BsWorld,
    joint: BsJoint,
    motors: *mut BsMotorDesc,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Buffer::new("motors", motors, capacity, count)?) };
        let found: Vec<_> = content.joint_motors(joint.into())?.collect();
        out.fill(found.iter().map(BsMotorDesc::of_engine))
    })
}

/// Displacement of a joint along or about axes [m] or [rad], as its limits measure it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_position(
    world: *const BsWorld,
    joint: BsJoint,
    motion: BsMotion,
    axes: BsJointAxes,
    displacement: *mut f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get(world, "the place for the displacement", displacement, |w| {
            Ok(w.joint_position(joint.into(), Twin::read(motion)?, Twin::read(axes)?)?)
        })
    }
}

/// Speed of a joint along or about an axis [m/s] or [rad/s].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_velocity(
    world: *const BsWorld,
    joint: BsJoint,
    motion: BsMotion,
    axis: BsJointAxes,
    speed: *mut f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get(world, "the place for the speed", speed, |w| {
            Ok(w.joint_velocity(joint.into(), Twin::read(motion)?, Twin::read(axis)?)?)
        })
    }
}

/// Where a joint sits on its two bodies, in their axes. `frames` has two places.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_local_frames(
    world: *const BsWorld,
    joint: BsJoint,
    frames: *mut BsFrame,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get(world, "the frames", frames.cast::<[BsFrame; 2]>(), |w| {
            Ok(w.joint_local_frames(joint.into())?.map(BsFrame::of_engine))
        })
    }
}

/// Moves a joint on its two bodies. `frames` has two elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_set_frames(
    world: *mut BsWorld,
    joint: BsJoint,
    frames: *const BsFrame,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, frames) = unsafe { (changing(world)?, slice("the frames", frames, 2)?) };
        Ok(content.set_joint_frames(joint.into(), [frames[0], frames[1]].map(BsFrame::to_engine))?)
    })
}

/// Whether the two bodies of a joint collide with each other.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_collide(
    world: *const BsWorld,
    joint: BsJoint,
    collide: *mut BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the answer", collide, |w| Ok(w.joint_collide(joint.into())?.into())) }
}

/// Sets whether the two bodies of a joint collide with each other.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_set_collide(
    world: *mut BsWorld,
    joint: BsJoint,
    collide: BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_joint_collide(joint.into(), collide != 0)) }
}

/// Force [N] and torque [N m] above which a joint breaks; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_break_force(
    world: *const BsWorld,
    joint: BsJoint,
    force: *mut f32,
    torque: *mut f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get_two(world, (force, torque), |w| Ok(w.joint_break_force(joint.into())?)) }
}

/// Sets force [N] and torque [N m] above which a joint breaks; infinity for never.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_set_break_force(
    world: *mut BsWorld,
    joint: BsJoint,
    force: f32,
    torque: f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_joint_break_force(joint.into(), force, torque)) }
}

/// Force [N] and torque [N m] above which a joint is in `bs_world_strained_joints`; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_thresholds(
    world: *const BsWorld,
    joint: BsJoint,
    force: *mut f32,
    torque: *mut f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get_two(world, (force, torque), |w| Ok(w.joint_thresholds(joint.into())?)) }
}

/// Sets force [N] and torque [N m] above which a joint is in `bs_world_strained_joints`; infinity for never.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_set_thresholds(
    world: *mut BsWorld,
    joint: BsJoint,
    force: f32,
    torque: f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_joint_thresholds(joint.into(), force, torque)) }
}

/// Sets the caller's number of a joint.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_set_user_data(
    world: *mut BsWorld,
    joint: BsJoint,
    user_data: u64,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_joint_user_data(joint.into(), user_data)) }
}

/// A joint that bore more than one of its thresholds.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsStrainedJoint {
    /// The joint.
    pub joint: BsJoint,
    /// Its force on the second body in the last substep, in world axes [N].
    pub force: BsVec3,
    /// Its torque on the second body about the joint [N m].
    pub torque: BsVec3,
}

impl From<&JointEvent> for BsStrainedJoint {
    fn from(event: &JointEvent) -> BsStrainedJoint {
        let JointEvent { joint, force, torque, .. } = *event;
        BsStrainedJoint { joint: joint.into(), force: force.into(), torque: torque.into() }
    }
}

/// Joints that bore more than one of their thresholds in the last step, in the order of their slots. `count`
/// becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_strained_joints(
    world: *const BsWorld,
    joints: *mut BsStrainedJoint,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Buffer::new("joints", joints, capacity, count)?) };
        out.fill(content.strained_joints().iter().map(Into::into))
    })
}
