//! Shapes that overlap a shape or a box.

use super::{BsQueryFilter, ask, ask_all, geometry};
use crate::abi::status::BsStatus;
use crate::abi::values::{BsAabb, BsBody, BsBool, BsPose, BsShape};
use crate::shape::BsGeometry;
use crate::world::BsWorld;
use backstop::Overlap;

/// A shape that a query's shape overlaps.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BsOverlap {
    /// Whose shape it is.
    pub body: BsBody,
    /// Which shape.
    pub shape: BsShape,
}

fn own(overlap: &Overlap) -> BsOverlap {
    BsOverlap { body: overlap.body.into(), shape: overlap.shape.into() }
}

/// All shapes that a convex one at a pose overlaps or touches, by handle. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_overlap(
    world: *const BsWorld,
    shape: *const BsGeometry,
    pose: BsPose,
    filter: *const BsQueryFilter,
    overlaps: *mut BsOverlap,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask_all(world, filter, (overlaps, capacity, count), own, |world, filter, found| {
            let (shape, rotation) = (geometry(shape)?, pose.rotation.into());
            Ok(world.overlap(&shape, pose.position.into(), rotation, filter, found)?)
        })
    }
}

/// All shapes whose boxes meet a box along the axes of the world, by their handles: a cheap first choice of
/// what may be there. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_overlap_aabb(
    world: *const BsWorld,
    area: BsAabb,
    filter: *const BsQueryFilter,
    overlaps: *mut BsOverlap,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask_all(world, filter, (overlaps, capacity, count), own, |world, filter, found| {
            Ok(world.overlap_aabb(&area.into(), filter, found)?)
        })
    }
}

/// Whether a convex shape at a pose overlaps or touches anything.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_overlap_any(
    world: *const BsWorld,
    shape: *const BsGeometry,
    pose: BsPose,
    filter: *const BsQueryFilter,
    any: *mut BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask(world, filter, any, |world, filter| {
            let (shape, rotation) = (geometry(shape)?, pose.rotation.into());
            Ok(world.overlap_any(&shape, pose.position.into(), rotation, filter)?.into())
        })
    }
}
