//! Traits and motion of a body, read and changed one by one.

use super::desc::{BsAxes, BsBodyKind};
use crate::abi::guard::call;
use crate::abi::status::BsStatus;
use crate::abi::twin::Twin;
use crate::abi::values::{BsBody, BsBool, BsDVec3, BsVec3};
use crate::mass::BsMassProperties;
use crate::settings::{BsContinuousMode, BsRowGroup};
use crate::world::{BsWorld, change, changing, get, get_two};

/// Makes a body static, kinematic or dynamic; it keeps its handle, pose, shapes and joints.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_kind(world: *mut BsWorld, body: BsBody, kind: BsBodyKind) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_kind(body.into(), Twin::read(kind)?)?))
}

/// Sets the caller's number of a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_user_data(
    world: *mut BsWorld,
    body: BsBody,
    user_data: u64,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_user_data(body.into(), user_data)) }
}

/// Factor on gravity.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_gravity_scale(
    world: *const BsWorld,
    body: BsBody,
    scale: *mut f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the scale", scale, |w| Ok(w.gravity_scale(body.into())?)) }
}

/// Linear and angular damping [1/s]; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_damping(
    world: *const BsWorld,
    body: BsBody,
    linear: *mut f32,
    angular: *mut f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get_two(world, (linear, angular), |w| Ok(w.damping(body.into())?)) }
}

/// Sets linear and angular damping, at least zero [1/s]: velocity decays as exp(-c t).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_damping(
    world: *mut BsWorld,
    body: BsBody,
    linear: f32,
    angular: f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_damping(body.into(), linear, angular)) }
}

/// Caps on linear [m/s] and angular speed [rad/s], infinity for none; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_max_speeds(
    world: *const BsWorld,
    body: BsBody,
    linear: *mut f32,
    angular: *mut f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get_two(world, (linear, angular), |w| {
            Ok(w.max_speeds(body.into())?.map(|cap| cap.unwrap_or(f32::INFINITY)).into())
        })
    }
}

/// Caps linear [m/s] and angular speed [rad/s], above zero; infinity for no cap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_max_speeds(
    world: *mut BsWorld,
    body: BsBody,
    linear: f32,
    angular: f32,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut content = unsafe { changing(world) }?;
        Ok(content.set_max_speeds(body.into(), Twin::read(linear)?, Twin::read(angular)?)?)
    })
}

fn bits(axes: [bool; 3]) -> BsAxes {
    axes.into_iter().zip([1, 2, 4]).map(|(locked, bit)| BsAxes::from(locked) * bit).sum()
}

/// World axes along which a body can't move, and about which it can't turn, as bits of `BS_AXIS_BIT_...`;
/// each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_locked_axes(
    world: *const BsWorld,
    body: BsBody,
    translation: *mut BsAxes,
    rotation: *mut BsAxes,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get_two(world, (translation, rotation), |w| {
            w.locked_axes(body.into()).map(|(t, r)| (bits(t), bits(r))).map_err(Into::into)
        })
    }
}

/// Locks world axes, as bits of `BS_AXIS_BIT_...`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_locked_axes(
    world: *mut BsWorld,
    body: BsBody,
    translation: BsAxes,
    rotation: BsAxes,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut content = unsafe { changing(world) }?;
        Ok(content.set_locked_axes(body.into(), Twin::read(translation)?, Twin::read(rotation)?)?)
    })
}

/// How a body is kept from passing through others.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_continuous(
    world: *const BsWorld,
    body: BsBody,
    mode: *mut BsContinuousMode,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the mode", mode, |w| Ok(Twin::write(&w.continuous(body.into())?))) }
}

/// The group after which the rows of a body are solved, or `BS_ROWS_NONE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_solved_after(
    world: *const BsWorld,
    body: BsBody,
    group: *mut BsRowGroup,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get(world, "the place for the group", group, |w| Ok(Twin::write(&w.body_solved_after(body.into())?)))
    }
}

/// Whether a body may fall asleep.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_can_sleep(
    world: *const BsWorld,
    body: BsBody,
    can_sleep: *mut BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the answer", can_sleep, |w| Ok(w.can_sleep(body.into())?.into())) }
}

/// Sets the linear velocity alone [m/s].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_linear_velocity(
    world: *mut BsWorld,
    body: BsBody,
    linear: BsVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_linear_velocity(body.into(), linear.into())) }
}

/// Sets the angular velocity alone [rad/s].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_set_angular_velocity(
    world: *mut BsWorld,
    body: BsBody,
    angular: BsVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_angular_velocity(body.into(), angular.into())) }
}

/// Velocity of a body at a point of the world [m], as if the point were fixed to it [m/s].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_velocity_at(
    world: *const BsWorld,
    body: BsBody,
    point: BsDVec3,
    velocity: *mut BsVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get(world, "the place for the velocity", velocity, |w| {
            Ok(w.velocity_at(body.into(), point.into())?.into())
        })
    }
}

/// Adds a force [N] at a point of the world [m] to a dynamic body, for the next step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_add_force_at(
    world: *mut BsWorld,
    body: BsBody,
    force: BsVec3,
    point: BsDVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.add_force_at(body.into(), force.into(), point.into())) }
}

/// Changes the angular velocity of a dynamic body by an angular impulse [N m s].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_apply_angular_impulse(
    world: *mut BsWorld,
    body: BsBody,
    impulse: BsVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.apply_angular_impulse(body.into(), impulse.into())) }
}

/// Mass, centre and inertia of a body; without mass for static and kinematic bodies.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_mass_properties(
    world: *const BsWorld,
    body: BsBody,
    mass: *mut BsMassProperties,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get(world, "the place for the mass", mass, |w| {
            Ok(BsMassProperties::of_engine(w.mass_properties(body.into())?))
        })
    }
}

/// Whether the mass of a body follows from its shapes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_has_mass_from_shapes(
    world: *const BsWorld,
    body: BsBody,
    from_shapes: *mut BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get(world, "the place for the answer", from_shapes, |w| {
            Ok(w.has_mass_from_shapes(body.into())?.into())
        })
    }
}
