//! Everything of a shape, read and changed one by one.

use super::{BsFilter, BsGeometry, BsSurface};
use crate::abi::guard::call;
use crate::abi::pointers::{borrow, slice};
use crate::abi::status::BsStatus;
use crate::abi::values::{BsAabb, BsBody, BsBool, BsPose, BsQuat, BsShape, BsVec3};
use crate::world::{BsWorld, change, changing, get, get_two};

/// The body of a shape.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_body(world: *const BsWorld, shape: BsShape, body: *mut BsBody) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the body", body, |w| Ok(w.body_of(shape.into())?.into())) }
}

/// Which shapes a shape collides with.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_filter(
    world: *const BsWorld,
    shape: BsShape,
    filter: *mut BsFilter,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get(world, "the place for the filter", filter, |w| Ok(BsFilter::of_engine(&w.filter(shape.into())?)))
    }
}

/// Whether contacts of a shape are reported as events.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_has_events(
    world: *const BsWorld,
    shape: BsShape,
    events: *mut BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the answer", events, |w| Ok(w.has_events(shape.into())?.into())) }
}

/// Whether a shape is a sensor.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_is_sensor(
    world: *const BsWorld,
    shape: BsShape,
    sensor: *mut BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the answer", sensor, |w| Ok(w.is_sensor(shape.into())?.into())) }
}

/// Whether a shape as a sensor also notices what is static.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_senses_static(
    world: *const BsWorld,
    shape: BsShape,
    senses_static: *mut BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get(world, "the place for the answer", senses_static, |w| Ok(w.senses_static(shape.into())?.into()))
    }
}

/// Whether a shape as a sensor also notices static shapes, and surfaces of meshes and height fields.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_senses_static(
    world: *mut BsWorld,
    shape: BsShape,
    senses_static: BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_senses_static(shape.into(), senses_static != 0)) }
}

/// Sets the caller's number of a shape.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_user_data(
    world: *mut BsWorld,
    shape: BsShape,
    user_data: u64,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_shape_user_data(shape.into(), user_data)) }
}

/// Friction of a shape against rolling and spinning, its belt and its spring.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_surface(
    world: *const BsWorld,
    shape: BsShape,
    surface: *mut BsSurface,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get(world, "the place for the surface", surface, |w| {
            Ok(BsSurface::of_engine(&w.material(shape.into())?))
        })
    }
}

/// Replaces friction of a shape against rolling and spinning, its belt and its spring; the rest of its
/// material stays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_surface(
    world: *mut BsWorld,
    shape: BsShape,
    surface: BsSurface,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut content = unsafe { changing(world) }?;
        let material = surface.over(content.material(shape.into())?)?;
        Ok(content.set_material(shape.into(), material)?)
    })
}

/// Replaces the form of a shape. Mass follows if it is that of the shapes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_geometry(
    world: *mut BsWorld,
    shape: BsShape,
    geometry: *const BsGeometry,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, geometry) =
            unsafe { (changing(world)?, borrow("the geometry", geometry)?.to_engine()?) };
        Ok(content.set_geometry(shape.into(), geometry)?)
    })
}

/// Where the frame of a shape is in its body's [m], and how it is turned; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_pose(
    world: *const BsWorld,
    shape: BsShape,
    position: *mut BsVec3,
    rotation: *mut BsQuat,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get_two(world, (position, rotation), |w| {
            w.shape_pose(shape.into()).map(|(p, r)| (p.into(), r.into())).map_err(Into::into)
        })
    }
}

/// Moves a shape on its body [m]. Mass follows if it is that of the shapes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_pose(
    world: *mut BsWorld,
    shape: BsShape,
    position: BsVec3,
    rotation: BsQuat,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_shape_pose(shape.into(), position.into(), rotation.into())) }
}

/// Where the frame of a shape is in the world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_world_pose(
    world: *const BsWorld,
    shape: BsShape,
    pose: *mut BsPose,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the pose", pose, |w| Ok(w.shape_world_pose(shape.into())?.into())) }
}

/// Density of a shape [kg/m³].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_density(
    world: *const BsWorld,
    shape: BsShape,
    density: *mut f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the density", density, |w| Ok(w.density(shape.into())?)) }
}

/// Replaces the density of a shape [kg/m³]. Mass follows if it is that of the shapes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_density(world: *mut BsWorld, shape: BsShape, density: f32) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_density(shape.into(), density)) }
}

/// The box around a shape, along the axes of the world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_aabb(world: *const BsWorld, shape: BsShape, aabb: *mut BsAabb) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the box", aabb, |w| Ok(w.shape_aabb(shape.into())?.into())) }
}

/// Changes heights of a height field [m]: `columns` times `rows` samples from column `first_column` and row
/// `first_row` on, row by row. What is near wakes; what would be below the surface is lifted above it. Other
/// shapes that share the field keep theirs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_heights(
    world: *mut BsWorld,
    shape: BsShape,
    first_column: usize,
    first_row: usize,
    columns: usize,
    rows: usize,
    heights: *const f32,
) -> BsStatus {
    call(|| {
        // A pointer that does not fit is null or too long to be a slice.
        let count = columns.saturating_mul(rows);
        // SAFETY: the caller keeps to the header.
        let (mut content, heights) = unsafe { (changing(world)?, slice("the heights", heights, count)?) };
        Ok(content.set_heights(shape.into(), [first_column, first_row], [columns, rows], heights)?)
    })
}

/// Cuts cells out of a height field, or fills them: `columns` times `rows` cells from column `first_column`
/// and row `first_row` on, row by row, each a hole or not. What is near wakes; what is in a cell that is
/// filled, and has its centre above the surface, is lifted. Other shapes that share the field keep theirs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_holes(
    world: *mut BsWorld,
    shape: BsShape,
    first_column: usize,
    first_row: usize,
    columns: usize,
    rows: usize,
    holes: *const BsBool,
) -> BsStatus {
    call(|| {
        let count = columns.saturating_mul(rows);
        // SAFETY: the caller keeps to the header.
        let (mut content, holes) = unsafe { (changing(world)?, slice("the holes", holes, count)?) };
        let holes: Vec<bool> = holes.iter().map(|&hole| hole != 0).collect();
        Ok(content.set_holes(shape.into(), [first_column, first_row], [columns, rows], &holes)?)
    })
}
