//! Bodies: added, looked up, moved, changed, removed.

pub mod bulk;

use crate::abi::guard::{call, value_or};
use crate::abi::pointers::{Buffer, Out, borrow, slice};
use crate::abi::sized::{described, read, read_all};
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::values::{BsBody, BsBool, BsDVec3, BsPose, BsQuat, BsVec3, codes};
use crate::mass::BsMassProperties;
use crate::settings::{
    BS_CONTINUOUS_SEGMENT, BS_ROWS_NONE, BsContinuous, BsRowGroup, read_continuous, read_place,
};
use crate::shape::BsShapeDesc;
use crate::world::{BsWorld, changing, reading};
use backstop::{BodyDesc, BodyHandle, BodyKind};
use std::ptr::null;

/// What moves a body, one of `BS_BODY_...`.
pub type BsBodyKind = u32;
/// Nothing: it has no velocity.
pub const BS_BODY_STATIC: BsBodyKind = 0;
/// Its velocity alone: it pushes and is not pushed.
pub const BS_BODY_KINEMATIC: BsBodyKind = 1;
/// Forces and contacts.
pub const BS_BODY_DYNAMIC: BsBodyKind = 2;

codes! { "kind of body", read_kind, write_kind, BodyKind {
    BS_BODY_STATIC = BodyKind::Static,
    BS_BODY_KINEMATIC = BodyKind::Kinematic,
    BS_BODY_DYNAMIC = BodyKind::Dynamic,
} }

/// Axes of the world that a body can't move along or turn about, as bits: x is 1, y is 2, z is 4.
pub type BsAxes = u8;
/// The x axis.
pub const BS_AXIS_BIT_X: BsAxes = 1;
/// The y axis.
pub const BS_AXIS_BIT_Y: BsAxes = 2;
/// The z axis.
pub const BS_AXIS_BIT_Z: BsAxes = 4;

/// A body to be added.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsBodyDesc {
    /// Size of this struct; `bs_body_desc_default` fills it in.
    pub size: u32,
    /// What moves it. Default dynamic.
    pub kind: BsBodyKind,
    /// Where its origin is [m].
    pub position: BsDVec3,
    /// How its axes are turned.
    pub rotation: BsQuat,
    /// Velocity of its centre of mass [m/s].
    pub linear_velocity: BsVec3,
    /// About the world's axes [rad/s].
    pub angular_velocity: BsVec3,
    /// Its shapes; several make a compound. Each has the size that the first says.
    pub shapes: *const BsShapeDesc,
    /// Number of shapes.
    pub shape_count: usize,
    /// Mass, centre and inertia; null: from the shapes and their densities.
    pub mass: *const BsMassProperties,
    /// Factor on gravity. Default 1.
    pub gravity_scale: f32,
    /// How it is kept from passing through others. Default `BS_CONTINUOUS_SEGMENT`.
    pub continuous: BsContinuous,
    /// Its rows are solved right after those of this group, if that is later. Default `BS_ROWS_NONE`.
    pub solved_after: BsRowGroup,
    /// World axes along which it can't move, as bits of `BS_AXIS_BIT_...`.
    pub lock_translation: BsAxes,
    /// World axes about which it can't turn.
    pub lock_rotation: BsAxes,
    /// Whether it may fall asleep. Default yes.
    pub can_sleep: BsBool,
    /// Zero.
    pub reserved: u8,
    /// Free for the caller.
    pub user_data: u64,
}

described! { BsBodyDesc, bs_body_desc_default(), [
    size, kind, position, rotation, linear_velocity, angular_velocity, shapes, shape_count, mass,
    gravity_scale, continuous, solved_after, lock_translation, lock_rotation, can_sleep, reserved, user_data,
] }

/// A dynamic body at the origin, at rest, without shapes.
#[unsafe(no_mangle)]
pub extern "C" fn bs_body_desc_default() -> BsBodyDesc {
    BsBodyDesc {
        size: size_of::<BsBodyDesc>() as u32,
        kind: BS_BODY_DYNAMIC,
        position: BsDVec3::default(),
        rotation: BsQuat::IDENTITY,
        linear_velocity: BsVec3::default(),
        angular_velocity: BsVec3::default(),
        shapes: null(),
        shape_count: 0,
        mass: null(),
        gravity_scale: 1.0,
        continuous: BS_CONTINUOUS_SEGMENT,
        solved_after: BS_ROWS_NONE,
        lock_translation: 0,
        lock_rotation: 0,
        can_sleep: 1,
        reserved: 0,
        user_data: 0,
    }
}

fn axes(bits: BsAxes) -> Outcome<[bool; 3]> {
    if bits > 7 {
        let what = "set of axes";
        return Err(crate::abi::status::Refusal::Constant { what, value: bits.into() });
    }
    Ok([0, 1, 2].map(|axis| bits >> axis & 1 == 1))
}

impl BsBodyDesc {
    /// # Safety
    /// Its pointers are null or valid, with those of its shapes.
    pub(crate) unsafe fn to_engine(self) -> Outcome<BodyDesc> {
        let mut desc = BodyDesc::new(read_kind(self.kind)?)
            .at(self.position)
            .rotated(backstop::glam::Quat::from(self.rotation))
            .moving(self.linear_velocity.into(), self.angular_velocity.into());
        // SAFETY: as this function.
        for shape in unsafe { read_all(self.shapes, self.shape_count) }? {
            // SAFETY: as this function.
            desc.shapes.push(unsafe { shape.to_engine() }?);
        }
        if !self.mass.is_null() {
            // SAFETY: as this function.
            desc.mass = Some(unsafe { borrow("the mass", self.mass) }?.to_engine());
        }
        desc.gravity_scale = self.gravity_scale;
        desc.continuous = read_continuous(self.continuous)?;
        desc.solved_after = read_place(self.solved_after)?;
        desc.lock_translation = axes(self.lock_translation)?;
        desc.lock_rotation = axes(self.lock_rotation)?;
        desc.can_sleep = self.can_sleep != 0;
        desc.user_data = self.user_data;
        Ok(desc)
    }
}

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
        out.set(write_kind(content.kind(body.into())?));
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
    mode: BsContinuous,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_continuous(body.into(), read_continuous(mode)?)?))
}

/// Has the rows of a body solved right after those of a group, or in their own place again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_solve_after(
    world: *mut BsWorld,
    body: BsBody,
    group: BsRowGroup,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.solve_body_after(body.into(), read_place(group)?)?))
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

/// Adds a force [N] at the centre of mass and a torque [N m] to a dynamic body, for the next step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_add_force(
    world: *mut BsWorld,
    body: BsBody,
    force: BsVec3,
    torque: BsVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.add_force(body.into(), force.into(), torque.into())?))
}

/// Changes the velocities of a dynamic body by an impulse [N s] at a point of the world [m].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_apply_impulse(
    world: *mut BsWorld,
    body: BsBody,
    impulse: BsVec3,
    point: BsDVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.apply_impulse(body.into(), impulse.into(), point.into())?))
}

/// Whether a body is asleep.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_is_asleep(
    world: *const BsWorld,
    body: BsBody,
    asleep: *mut BsBool,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the answer", asleep)?) };
        out.set(content.is_asleep(body.into())?.into());
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
pub unsafe extern "C" fn bs_body_send_to_sleep(world: *mut BsWorld, body: BsBody) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.send_to_sleep(body.into())?))
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
