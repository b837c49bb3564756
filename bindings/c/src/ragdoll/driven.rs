//! Ragdolls that are driven to poses.

use super::{BsSkeletonDesc, skeleton_of};
use crate::abi::guard::{call, value_or};
use crate::abi::pointers::{Buffer, Out, borrow, slice};
use crate::abi::status::BsStatus;
use crate::abi::values::{BsBody, BsJoint, BsPose, BsQuat, BsVec3};
use crate::joint::BsSpring;
use crate::world::{BsWorld, changing};
use backstop::Ragdoll;
use backstop::glam::Quat;

/// What a ragdoll is made of: its bodies and joints, and which bones they are. It never changes, and may be
/// used by any number of threads. The bodies and joints are the world's; they stay when this is destroyed.
pub struct BsRagdoll {
    ragdoll: Ragdoll,
}

/// Adds a skeleton as `bs_world_add_ragdoll` does, and keeps what `bs_ragdoll_drive_to` needs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_ragdoll_create(
    world: *mut BsWorld,
    desc: *const BsSkeletonDesc,
    pose: BsPose,
    velocity: BsVec3,
    ragdoll: *mut *mut BsRagdoll,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, skeleton, out) = unsafe {
            let out = Out::new("the place for the ragdoll", ragdoll)?;
            (changing(world)?, skeleton_of(desc)?, out)
        };
        let (position, rotation) = (pose.position.into(), Quat::from(pose.rotation));
        let ragdoll = skeleton.add_to(&mut content.world, position, rotation, velocity.into())?;
        out.set(Box::into_raw(Box::new(BsRagdoll { ragdoll })));
        Ok(())
    })
}

/// Destroys what `bs_ragdoll_create` keeps. Null is none, and fine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_ragdoll_destroy(ragdoll: *mut BsRagdoll) {
    value_or((), || {
        if !ragdoll.is_null() {
            // SAFETY: it came from `bs_ragdoll_create`, and nobody else has it.
            drop(unsafe { Box::from_raw(ragdoll) });
        }
    });
}

/// The bodies of a ragdoll, one a bone. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_ragdoll_bodies(
    ragdoll: *const BsRagdoll,
    bodies: *mut BsBody,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (ragdoll, out) =
            unsafe { (borrow("the ragdoll", ragdoll)?, Buffer::new("bodies", bodies, capacity, count)?) };
        out.fill(ragdoll.ragdoll.bodies.iter().map(|&body| body.into()))
    })
}

/// The joints of a ragdoll, one for each bone but the roots. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_ragdoll_joints(
    ragdoll: *const BsRagdoll,
    joints: *mut BsJoint,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (ragdoll, out) =
            unsafe { (borrow("the ragdoll", ragdoll)?, Buffer::new("joints", joints, capacity, count)?) };
        out.fill(ragdoll.ragdoll.joints.iter().map(|&joint| joint.into()))
    })
}

/// Drives the joints of a ragdoll to a pose, by a spring about each axis that a joint turns about with at
/// most so much torque [N m], in the place of the friction there: with each frame of an animation.
/// `rotations` has `count` of them, for each bone from where it is in the skeleton, in the skeleton's axes.
/// Nothing holds the figure as a whole. Joints that broke are left out.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_ragdoll_drive_to(
    ragdoll: *const BsRagdoll,
    world: *mut BsWorld,
    rotations: *const BsQuat,
    count: usize,
    spring: BsSpring,
    max_torque: f32,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (ragdoll, mut content, rotations) = unsafe {
            let ragdoll = borrow("the ragdoll", ragdoll)?;
            (ragdoll, changing(world)?, slice("the rotations", rotations, count)?)
        };
        let rotations: Vec<_> = rotations.iter().map(|&rotation| rotation.into()).collect();
        let spring = spring.needed()?;
        Ok(ragdoll.ragdoll.drive_to(&mut content.world, &rotations, spring, max_torque)?)
    })
}

/// Takes the springs of `bs_ragdoll_drive_to` away: the figure is limp again, with the friction of its
/// skeleton.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_ragdoll_relax(ragdoll: *const BsRagdoll, world: *mut BsWorld) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (ragdoll, mut content) = unsafe { (borrow("the ragdoll", ragdoll)?, changing(world)?) };
        Ok(ragdoll.ragdoll.relax(&mut content.world)?)
    })
}
