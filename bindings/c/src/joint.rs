//! Joints: added, looked up, changed, removed.

mod change;
mod coupling;
mod desc;

pub use change::*;
pub use coupling::*;
pub use desc::*;

use crate::abi::guard::{call, value_or};
use crate::abi::pointers::{Buffer, Out};
use crate::abi::sized::{read, read_all};
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::twin::Twin;
use crate::abi::values::{BsBody, BsBool, BsDVec3, BsJoint, BsPose, BsQuat, BsVec3};
use crate::settings::BsRowGroup;
use crate::world::{BsWorld, changing, reading};

/// Adds a joint. `joint` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_add_joint(
    world: *mut BsWorld,
    desc: *const BsJointDesc,
    joint: *mut BsJoint,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, out, desc) = unsafe {
            let out = Out::optional("the place for the joint", joint)?;
            (changing(world)?, out, read(desc)?.to_engine()?)
        };
        let joint = content.add_joint(&desc)?;
        if let Some(out) = out {
            out.set(joint.into());
        }
        Ok(())
    })
}

/// Adds many joints: all of them, or none. `joints` has `count` places, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_add_joints(
    world: *mut BsWorld,
    descs: *const BsJointDesc,
    count: usize,
    joints: *mut BsJoint,
) -> BsStatus {
    call(|| {
        let mut added = 0;
        // SAFETY: the caller keeps to the header.
        let (mut content, descs) = unsafe { (changing(world)?, read_all(descs, count)?) };
        let capacity = if joints.is_null() { 0 } else { count };
        // SAFETY: the caller keeps to the header.
        let out = unsafe { Buffer::new("joints", joints, capacity, &mut added) }?;
        // SAFETY: the caller keeps to the header.
        let descs = descs.into_iter().map(|desc| unsafe { desc.to_engine() }).collect::<Outcome<Vec<_>>>()?;
        let handles = content.add_joints(&descs)?;
        if capacity > 0 { out.fill(handles.into_iter().map(Into::into)) } else { Ok(()) }
    })
}

/// Removes a joint.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_remove_joint(world: *mut BsWorld, joint: BsJoint) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.remove_joint(joint.into())?))
}

/// Whether a handle is that of a joint of the world; no if there is no such world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_contains_joint(world: *const BsWorld, joint: BsJoint) -> BsBool {
    // SAFETY: the caller keeps to the header.
    value_or(0, || unsafe { reading(world) }.is_ok_and(|content| content.contains_joint(joint.into())).into())
}

/// Replaces the limits and motors of a joint by those of a description: its kind with `range_min`,
/// `range_max` and `spring`, its limits and its motors. Nothing else of the description is read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_set(
    world: *mut BsWorld,
    joint: BsJoint,
    desc: *const BsJointDesc,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, mut desc) = unsafe { (changing(world)?, read(desc)?.to_engine()?) };
        // All is checked before anything changes, as of the joint that there is.
        desc.bodies = content.joint_bodies(joint.into())?;
        desc.validate()?;
        content.set_joint_limits(joint.into(), &desc.limits)?;
        Ok(content.set_joint_motors(joint.into(), &desc.motors)?)
    })
}

/// Frames on two bodies that coincide at the bodies' current poses, at a point of the world [m], with the
/// axes that a rotation gives x, y and z. `frames` has two places.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_frames_at(
    world: *const BsWorld,
    a: BsBody,
    b: BsBody,
    point: BsDVec3,
    rotation: BsQuat,
    frames: *mut BsFrame,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) =
            unsafe { (reading(world)?, Out::new("the frames", frames.cast::<[BsFrame; 2]>())?) };
        let found = content.frames_at([a.into(), b.into()], point.into(), rotation.into())?;
        out.set(found.map(BsFrame::of_engine));
        Ok(())
    })
}

/// Frames on two bodies that coincide at the bodies' current poses, at a point of the world [m], whose x axes
/// are along an axis of the world of any length: a hinge turns about it. `frames` has two places.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_frames_about(
    world: *const BsWorld,
    a: BsBody,
    b: BsBody,
    point: BsDVec3,
    axis: BsVec3,
    frames: *mut BsFrame,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) =
            unsafe { (reading(world)?, Out::new("the frames", frames.cast::<[BsFrame; 2]>())?) };
        let found = content.frames_about([a.into(), b.into()], point.into(), axis.into())?;
        out.set(found.map(BsFrame::of_engine));
        Ok(())
    })
}

/// Poses of a joint's two frames in the world. `poses` has two places.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_frames(
    world: *const BsWorld,
    joint: BsJoint,
    poses: *mut BsPose,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) =
            unsafe { (reading(world)?, Out::new("the poses", poses.cast::<[BsPose; 2]>())?) };
        let found = content.joint_frames(joint.into())?;
        out.set(found.map(Into::into));
        Ok(())
    })
}

/// The two bodies of a joint. `bodies` has two places.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_bodies(
    world: *const BsWorld,
    joint: BsJoint,
    bodies: *mut BsBody,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) =
            unsafe { (reading(world)?, Out::new("the bodies", bodies.cast::<[BsBody; 2]>())?) };
        out.set(content.joint_bodies(joint.into())?.map(Into::into));
        Ok(())
    })
}

/// Force [N] and torque [N m] of a joint on its second body in the last substep, in world axes; the first
/// body gets the opposite. Each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_force(
    world: *const BsWorld,
    joint: BsJoint,
    force: *mut BsVec3,
    torque: *mut BsVec3,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, force, torque) = unsafe {
            let force = Out::optional("the place for the force", force)?;
            (reading(world)?, force, Out::optional("the place for the torque", torque)?)
        };
        let found = content.joint_force(joint.into())?;
        if let Some(out) = force {
            out.set(found.0.into());
        }
        if let Some(out) = torque {
            out.set(found.1.into());
        }
        Ok(())
    })
}

/// Has the rows of a joint solved right after those of a group, or in their own place again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_set_solved_after(
    world: *mut BsWorld,
    joint: BsJoint,
    group: BsRowGroup,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_joint_solved_after(joint.into(), Twin::read(group)?)?))
}

/// The caller's number of a joint.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_user_data(
    world: *const BsWorld,
    joint: BsJoint,
    user_data: *mut u64,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the number", user_data)?) };
        out.set(content.joint_user_data(joint.into())?);
        Ok(())
    })
}
