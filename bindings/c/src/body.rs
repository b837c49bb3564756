//! Bodies: added, looked up, moved, changed, removed.

mod bulk;
mod change;
mod contacts;
mod desc;

pub use bulk::*;
pub use change::*;
pub use contacts::*;
pub use desc::*;

use crate::abi::guard::{call, value_or};
use crate::abi::pointers::{Buffer, Out, slice};
use crate::abi::sized::{read, read_all};
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::twin::Twin;
use crate::abi::values::{BsBody, BsBool, BsDVec3, BsPose, BsVec3};
use crate::settings::{BsContinuousMode, BsRowGroup};
use crate::world::{BsWorld, changing, reading};
use backstop::BodyHandle;

/// Adds a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_add_body(
    world: *mut BsWorld,
    desc: *const BsBodyDesc,
    body: *mut BsBody,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, out, desc) = unsafe {
            (changing(world)?, Out::new("the place for the body", body)?, read(desc)?.to_engine()?)
        };
        out.set(content.add_body(&desc)?.into());
        Ok(())
    })
}

/// Adds many bodies: all of them, or none. `bodies` has `count` places, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_add_bodies(
    world: *mut BsWorld,
    descs: *const BsBodyDesc,
    count: usize,
    bodies: *mut BsBody,
) -> BsStatus {
    call(|| {
        let mut added = 0;
        // SAFETY: the caller keeps to the header.
        let (mut content, descs) = unsafe { (changing(world)?, read_all(descs, count)?) };
        let capacity = if bodies.is_null() { 0 } else { count };
        // SAFETY: the caller keeps to the header.
        let out = unsafe { Buffer::new("bodies", bodies, capacity, &mut added) }?;
        // SAFETY: the caller keeps to the header.
        let descs = descs.into_iter().map(|desc| unsafe { desc.to_engine() }).collect::<Outcome<Vec<_>>>()?;
        let handles = content.add_bodies(&descs)?;
        if capacity > 0 { out.fill(handles.into_iter().map(Into::into)) } else { Ok(()) }
    })
}

/// Removes a body with its shapes and joints.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_remove_body(world: *mut BsWorld, body: BsBody) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.remove_body(body.into())?))
}

/// Removes many bodies: all of them, or none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_remove_bodies(
    world: *mut BsWorld,
    bodies: *const BsBody,
    count: usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, bodies) = unsafe { (changing(world)?, slice("the bodies", bodies, count)?) };
        let bodies: Vec<BodyHandle> = bodies.iter().map(|&body| body.into()).collect();
        Ok(content.remove_bodies(&bodies)?)
    })
}

/// All bodies: first dynamic ones, then kinematic ones, then those that sleep or are disabled, then static
/// ones. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_bodies(
    world: *const BsWorld,
    bodies: *mut BsBody,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Buffer::new("bodies", bodies, capacity, count)?) };
        out.reserve(content.body_count())?;
        let bodies: Vec<_> = content.bodies().collect();
        out.fill(bodies.into_iter().map(Into::into))
    })
}

/// Whether a handle is that of a body of the world; no if there is no such world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_contains_body(world: *const BsWorld, body: BsBody) -> BsBool {
    // SAFETY: the caller keeps to the header.
    value_or(0, || unsafe { reading(world) }.is_ok_and(|content| content.contains(body.into())).into())
}

/// What moves a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_kind(
    world: *const BsWorld,
    body: BsBody,
    kind: *mut BsBodyKind,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the kind", kind)?) };
        out.set(Twin::write(&content.kind(body.into())?));
        Ok(())
    })
}

/// The caller's number of a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_user_data(
    world: *const BsWorld,
    body: BsBody,
    user_data: *mut u64,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the number", user_data)?) };
        out.set(content.user_data(body.into())?);
        Ok(())
    })
}

/// Disables a body, or enables it again, with its shapes and joints. A disabled body does not move, touches
/// nothing and is invisible to queries.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_enabled(world: *mut BsWorld, body: BsBody, enabled: BsBool) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_enabled(body.into(), enabled != 0)?))
}

/// Whether a body takes part in the world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_is_enabled(
    world: *const BsWorld,
    body: BsBody,
    enabled: *mut BsBool,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the answer", enabled)?) };
        out.set(content.is_enabled(body.into())?.into());
        Ok(())
    })
}

/// Sets the factor on gravity, within 1e6.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_gravity_scale(
    world: *mut BsWorld,
    body: BsBody,
    scale: f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_gravity_scale(body.into(), scale)?))
}

/// Sets how a body is kept from passing through others.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_continuous(
    world: *mut BsWorld,
    body: BsBody,
    mode: BsContinuousMode,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_continuous(body.into(), Twin::read(mode)?)?))
}

/// Has the rows of a body solved right after those of a group, or in their own place again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_solved_after(
    world: *mut BsWorld,
    body: BsBody,
    group: BsRowGroup,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_body_solved_after(body.into(), Twin::read(group)?)?))
}

/// Pose of a body's origin in the world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_pose(world: *const BsWorld, body: BsBody, pose: *mut BsPose) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the pose", pose)?) };
        let (position, rotation) = (content.position(body.into())?, content.rotation(body.into())?);
        out.set(BsPose { position: position.into(), rotation: rotation.into() });
        Ok(())
    })
}

/// Position of a body's origin relative to the world's origin [m], in single precision.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_local_position(
    world: *const BsWorld,
    body: BsBody,
    position: *mut BsVec3,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the position", position)?) };
        out.set(content.local_position(body.into())?.into());
        Ok(())
    })
}

/// Moves a body to a pose at once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_pose(world: *mut BsWorld, body: BsBody, pose: BsPose) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut content = unsafe { changing(world) }?;
        Ok(content.set_pose(body.into(), pose.position.into(), pose.rotation.into())?)
    })
}

/// Velocity of a body's centre of mass [m/s] and about the world's axes [rad/s]; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_velocity(
    world: *const BsWorld,
    body: BsBody,
    linear: *mut BsVec3,
    angular: *mut BsVec3,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, linear, angular) = unsafe {
            let linear = Out::optional("the place for the velocity", linear)?;
            (reading(world)?, linear, Out::optional("the place for the spin", angular)?)
        };
        let found = (content.linear_velocity(body.into())?, content.angular_velocity(body.into())?);
        if let Some(out) = linear {
            out.set(found.0.into());
        }
        if let Some(out) = angular {
            out.set(found.1.into());
        }
        Ok(())
    })
}

/// Sets linear [m/s] and angular [rad/s] velocity. Has no effect on a static body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_velocity(
    world: *mut BsWorld,
    body: BsBody,
    linear: BsVec3,
    angular: BsVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_velocity(body.into(), linear.into(), angular.into())?))
}

/// Gives a kinematic body the velocity that takes its origin to a pose within the next step of `dt` seconds.
/// In the steps after it moves on with that velocity: call it before each step, or
/// `bs_body_move_kinematic_and_stop`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_move_kinematic(
    world: *mut BsWorld,
    body: BsBody,
    pose: BsPose,
    dt: f32,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut content = unsafe { changing(world) }?;
        Ok(content.move_kinematic(body.into(), pose.position.into(), pose.rotation.into(), dt)?)
    })
}

/// The same, but in the steps after the body stands where it was told to be, until it is moved again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_move_kinematic_and_stop(
    world: *mut BsWorld,
    body: BsBody,
    pose: BsPose,
    dt: f32,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut content = unsafe { changing(world) }?;
        Ok(content.move_kinematic_and_stop(body.into(), pose.position.into(), pose.rotation.into(), dt)?)
    })
}

/// Adds a force [N] at the centre of mass and a torque [N m] to a dynamic body, for the next step. Forces and
/// impulses on other bodies have no effect.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_add_force_and_torque(
    world: *mut BsWorld,
    body: BsBody,
    force: BsVec3,
    torque: BsVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.add_force_and_torque(body.into(), force.into(), torque.into())?))
}

/// Adds a force [N] at the centre of mass of a dynamic body, for the next step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_add_force(world: *mut BsWorld, body: BsBody, force: BsVec3) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.add_force(body.into(), force.into())?))
}

/// Adds a torque [N m] to a dynamic body, for the next step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_add_torque(world: *mut BsWorld, body: BsBody, torque: BsVec3) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.add_torque(body.into(), torque.into())?))
}

/// Changes the linear velocity of a dynamic body by an impulse [N s] at its centre of mass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_apply_impulse(
    world: *mut BsWorld,
    body: BsBody,
    impulse: BsVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.apply_impulse(body.into(), impulse.into())?))
}

/// Changes the velocities of a dynamic body by an impulse [N s] at a point of the world [m].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_apply_impulse_at(
    world: *mut BsWorld,
    body: BsBody,
    impulse: BsVec3,
    point: BsDVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.apply_impulse_at(body.into(), impulse.into(), point.into())?))
}

/// Whether a body is asleep.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_is_sleeping(
    world: *const BsWorld,
    body: BsBody,
    asleep: *mut BsBool,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the answer", asleep)?) };
        out.set(content.is_sleeping(body.into())?.into());
        Ok(())
    })
}

/// Wakes a body and its island.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_wake(world: *mut BsWorld, body: BsBody) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.wake(body.into())?))
}

/// Puts a dynamic body to sleep with all that it touches or is joined to. Does nothing if sleeping is off.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_sleep(world: *mut BsWorld, body: BsBody) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.sleep(body.into())?))
}

/// Sets whether a body may fall asleep.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_can_sleep(
    world: *mut BsWorld,
    body: BsBody,
    can_sleep: BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_can_sleep(body.into(), can_sleep != 0)?))
}
