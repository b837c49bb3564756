//! Contacts of bodies, their places, and which of them move.

use crate::abi::pointers::{Buffer, Out};
use crate::abi::status::BsStatus;
use crate::abi::values::{BsAabb, BsBody, BsBool, BsDVec3, BsJoint, BsPose, BsShape, BsVec3};
use crate::world::{BsWorld, get_all, reading};
use backstop::{BodyContact, BodyMove, ContactPoint};

/// A point of a contact.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BsContactPoint {
    /// Midway between the two surfaces, where the bodies are now, in the world [m].
    pub position: BsDVec3,
    /// Distance of the surfaces along the normal, negative in overlap [m].
    pub separation: f32,
    /// Normal impulse of the last substep, at least zero [N s].
    pub impulse: f32,
}

/// A contact of two bodies: up to four points with one normal. Two shapes may have several, if one is a mesh
/// or a height field.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsContact {
    /// The shape of the body that was asked for, and the other one.
    pub shapes: [BsShape; 2],
    /// The body that was asked for, and the other one.
    pub bodies: [BsBody; 2],
    /// Unit, from the first shape to the second.
    pub normal: BsVec3,
    /// Number of points, 1..=4.
    pub point_count: u32,
    /// Its points; zeros beyond their number.
    pub points: [BsContactPoint; 4],
}

/// A body that moved in the last step: where it is and how fast.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsBodyMove {
    /// The body.
    pub body: BsBody,
    /// Its user data.
    pub user_data: u64,
    /// Pose of its origin in the world [m].
    pub pose: BsPose,
    /// Position of its centre of mass in the world [m].
    pub centre_of_mass: BsDVec3,
    /// Velocity of its centre of mass [m/s].
    pub linear_velocity: BsVec3,
    /// Angular velocity about the world's axes [rad/s].
    pub angular_velocity: BsVec3,
    /// Whether it fell asleep since the step began; it is not listed again until it wakes.
    pub fell_asleep: BsBool,
    /// Zero.
    pub reserved: [u8; 7],
}

impl From<BodyMove> for BsBodyMove {
    fn from(moved: BodyMove) -> BsBodyMove {
        BsBodyMove {
            body: moved.body.into(),
            user_data: moved.user_data,
            pose: BsPose { position: moved.position.into(), rotation: moved.rotation.into() },
            centre_of_mass: moved.centre_of_mass.into(),
            linear_velocity: moved.linear_velocity.into(),
            angular_velocity: moved.angular_velocity.into(),
            fell_asleep: moved.fell_asleep.into(),
            reserved: [0; 7],
        }
    }
}

impl From<&ContactPoint> for BsContactPoint {
    fn from(point: &ContactPoint) -> BsContactPoint {
        let ContactPoint { position, separation, impulse, .. } = *point;
        BsContactPoint { position: position.into(), separation, impulse }
    }
}

impl From<BodyContact> for BsContact {
    fn from(contact: BodyContact) -> BsContact {
        let mut points = [BsContactPoint::default(); 4];
        points.iter_mut().zip(contact.points()).for_each(|(own, point)| *own = point.into());
        BsContact {
            shapes: contact.shapes.map(Into::into),
            bodies: contact.bodies.map(Into::into),
            normal: contact.normal.into(),
            point_count: contact.points().len() as u32,
            points,
        }
    }
}

/// Contacts of a body in the last step, with shapes that it touched or that pushed it. Sensors have none.
/// `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_contacts(
    world: *const BsWorld,
    body: BsBody,
    contacts: *mut BsContact,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get_all(world, "contacts", (contacts, capacity, count), |w| Ok(w.contacts_of(body.into())?.collect()))
    }
}

/// All contacts of the last step, each once. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_contacts(
    world: *const BsWorld,
    contacts: *mut BsContact,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get_all(world, "contacts", (contacts, capacity, count), |w| Ok(w.contacts().collect())) }
}

/// Awake dynamic bodies. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_awake_bodies(
    world: *const BsWorld,
    bodies: *mut BsBody,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get_all(world, "bodies", (bodies, capacity, count), |w| Ok(w.awake_bodies().collect())) }
}

/// Bodies that the last step moved, with their poses and velocities: dynamic ones that are awake, then
/// kinematic ones with a velocity, then dynamic ones that fell asleep, once. To be called after a step, and
/// before other calls change bodies. Allocates nothing. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_body_moves(
    world: *const BsWorld,
    moves: *mut BsBodyMove,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    crate::abi::guard::call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Buffer::new("moves", moves, capacity, count)?) };
        out.fill_with(content.body_moves().count(), content.body_moves().map(Into::into))
    })
}

/// The joints of a body. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_joints(
    world: *const BsWorld,
    body: BsBody,
    joints: *mut BsJoint,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get_all(world, "joints", (joints, capacity, count), |w| Ok(w.joints_of(body.into())?.collect()))
    }
}

/// The box around all shapes of a body. `found` becomes whether it has shapes; if not, the box is as it was.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_aabb(
    world: *const BsWorld,
    body: BsBody,
    aabb: *mut BsAabb,
    found: *mut BsBool,
) -> BsStatus {
    crate::abi::guard::call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, aabb, found) = unsafe {
            let aabb = Out::new("the place for the box", aabb)?;
            (reading(world)?, aabb, Out::new("the place for the answer", found)?)
        };
        let around = content.aabb(body.into())?;
        found.set(around.is_some().into());
        if let Some(around) = around {
            aabb.set(around.into());
        }
        Ok(())
    })
}
