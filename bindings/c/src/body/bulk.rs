//! Poses and velocities of many bodies into buffers of the caller.

use crate::abi::guard::call;
use crate::abi::pointers::slice;
use crate::abi::sized::read;
use crate::abi::status::{BsStatus, Outcome, Refusal};
use crate::abi::twin::record;
use crate::abi::values::BsBody;
use crate::world::{BsWorld, Content, reading};
use backstop::{BodyHandle, Error};
use std::ffi::c_void;
use std::ptr::null_mut;

/// What positions are written as, one of `BS_POSITIONS_...`.
pub type BsPositionType = u32;
/// Three `double`s: in the world [m].
pub const BS_POSITIONS_F64: BsPositionType = 0;
/// Three `float`s: relative to the world's origin [m].
pub const BS_POSITIONS_F32: BsPositionType = 1;

record! {
    /// Where poses and velocities of many bodies go: four columns, each with the bytes from one body to the
    /// next. A column that is null is left out. Buffers need no alignment; a stride may not be shorter than
    /// what is written, and zero is exactly that.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsColumns {
        /// Size of this struct; `bs_columns_default` fills it in.
        pub size: u32,
        /// What positions are written as. Default `BS_POSITIONS_F64`.
        pub position_type: BsPositionType,
        /// Positions of origins: three numbers each.
        pub positions: *mut c_void,
        /// Rotations: four `float`s each, x, y, z, w.
        pub rotations: *mut c_void,
        /// Linear velocities: three `float`s each [m/s].
        pub linear_velocities: *mut c_void,
        /// Angular velocities: three `float`s each [rad/s].
        pub angular_velocities: *mut c_void,
        /// Bytes from one to the next.
        pub position_stride: u32,
        /// Bytes from one to the next.
        pub rotation_stride: u32,
        /// Bytes from one to the next.
        pub linear_stride: u32,
        /// Bytes from one to the next.
        pub angular_stride: u32,
    }
    default bs_columns_default()
}

/// No columns.
#[unsafe(no_mangle)]
pub extern "C" fn bs_columns_default() -> BsColumns {
    BsColumns {
        size: size_of::<BsColumns>() as u32,
        position_type: BS_POSITIONS_F64,
        positions: null_mut(),
        rotations: null_mut(),
        linear_velocities: null_mut(),
        angular_velocities: null_mut(),
        position_stride: 0,
        rotation_stride: 0,
        linear_stride: 0,
        angular_stride: 0,
    }
}

/// A column to be written: where, and how far apart.
#[derive(Clone, Copy)]
struct Column {
    at: *mut u8,
    stride: usize,
}

impl Column {
    /// None if the caller leaves it out.
    fn new(what: &'static str, at: *mut c_void, stride: u32, bytes: u32) -> Outcome<Option<Column>> {
        let stride = if stride == 0 { bytes } else { stride };
        if stride < bytes {
            return Err(Refusal::Size { what, given: stride, own: bytes as usize });
        }
        let column = Column { at: at.cast(), stride: stride as usize };
        Ok((!at.is_null()).then_some(column))
    }

    /// # Safety
    /// The caller has place for the element, and `T` is no larger than what `new` was told.
    unsafe fn write<T>(self, index: usize, value: T) {
        // SAFETY: as this function; no alignment is asked for.
        unsafe { self.at.add(index * self.stride).cast::<T>().write_unaligned(value) }
    }
}

/// Writes poses and velocities of `count` bodies into columns, in their order; `bodies` null: of all bodies,
/// in the order of `bs_world_bodies`, of which there must be `count`. If a handle is stale nothing is
/// written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_read_bodies(
    world: *const BsWorld,
    bodies: *const BsBody,
    count: usize,
    into: *const BsColumns,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, into) = unsafe { (reading(world)?, read(into)?) };
        if bodies.is_null() {
            let needed = content.body_count();
            if needed != count {
                return Err(Refusal::Buffer { what: "all bodies", capacity: count, needed });
            }
            // SAFETY: the caller keeps to the header.
            return unsafe { write_all(&content, content.bodies(), &into) };
        }
        // SAFETY: the caller keeps to the header.
        let bodies = unsafe { slice("the bodies", bodies, count) }?;
        if !bodies.iter().all(|&body| content.contains(body.into())) {
            return Err(Error::StaleBody.into());
        }
        // SAFETY: the caller keeps to the header.
        unsafe { write_all(&content, bodies.iter().map(|&body| body.into()), &into) }
    })
}

/// # Safety
/// The columns have place for all of them.
unsafe fn write_all(
    content: &Content,
    bodies: impl Iterator<Item = BodyHandle>,
    into: &BsColumns,
) -> Outcome {
    let (single, bytes) = match into.position_type {
        BS_POSITIONS_F64 => (false, 24),
        BS_POSITIONS_F32 => (true, 12),
        value => return Err(Refusal::Constant { what: "type of positions", value }),
    };
    let positions = Column::new("stride of positions", into.positions, into.position_stride, bytes)?;
    let rotations = Column::new("stride of rotations", into.rotations, into.rotation_stride, 16)?;
    let linear = Column::new("stride of velocities", into.linear_velocities, into.linear_stride, 12)?;
    let angular = Column::new("stride of spins", into.angular_velocities, into.angular_stride, 12)?;
    for (i, body) in bodies.enumerate() {
        // SAFETY: as this function; each type has the bytes that its column was made for.
        unsafe {
            match positions {
                Some(column) if single => column.write(i, content.local_position(body)?.to_array()),
                Some(column) => column.write(i, content.position(body)?.to_array()),
                None => {}
            }
            if let Some(column) = rotations {
                column.write(i, content.rotation(body)?.to_array());
            }
            if let Some(column) = linear {
                column.write(i, content.linear_velocity(body)?.to_array());
            }
            if let Some(column) = angular {
                column.write(i, content.angular_velocity(body)?.to_array());
            }
        }
    }
    Ok(())
}
