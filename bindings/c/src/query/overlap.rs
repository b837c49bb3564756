//! What a shape or a box overlaps.

use super::{BsQueryFilter, geometry, with_filter};
use crate::abi::guard::call;
use crate::abi::pointers::{Buffer, Out};
use crate::abi::status::BsStatus;
use crate::abi::values::{BsAabb, BsBody, BsBool, BsPose, BsShape};
use crate::shape::BsGeometry;
use crate::world::{BsWorld, reading};
use backstop::{Overlap, QueryFilter};

/// A shape that a query's shape overlaps.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BsOverlap {
    /// Whose shape it is.
    pub body: BsBody,
    /// Which shape.
    pub shape: BsShape,
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
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, shape, out) = unsafe {
            (reading(world)?, geometry(shape)?, Buffer::new("overlaps", overlaps, capacity, count)?)
        };
        let ask = |filter: &QueryFilter<'_>| {
            let mut found = Vec::new();
            content.overlap(&shape, pose.position.into(), pose.rotation.into(), filter, &mut found)?;
            let own = |o: Overlap| BsOverlap { body: o.body.into(), shape: o.shape.into() };
            out.fill(found.into_iter().map(own))
        };
        // SAFETY: the caller keeps to the header.
        unsafe { with_filter(filter, ask) }
    })
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
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) =
            unsafe { (reading(world)?, Buffer::new("overlaps", overlaps, capacity, count)?) };
        let ask = |filter: &QueryFilter<'_>| {
            let mut found = Vec::new();
            content.overlap_aabb(&area.into(), filter, &mut found)?;
            let own = |o: Overlap| BsOverlap { body: o.body.into(), shape: o.shape.into() };
            out.fill(found.into_iter().map(own))
        };
        // SAFETY: the caller keeps to the header.
        unsafe { with_filter(filter, ask) }
    })
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
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, shape, out) =
            unsafe { (reading(world)?, geometry(shape)?, Out::new("the place for the answer", any)?) };
        let ask = |filter: &QueryFilter<'_>| {
            let (position, rotation) = (pose.position.into(), pose.rotation.into());
            out.set(content.overlap_any(&shape, position, rotation, filter)?.into());
            Ok(())
        };
        // SAFETY: the caller keeps to the header.
        unsafe { with_filter(filter, ask) }
    })
}
