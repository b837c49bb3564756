//! Hulls, meshes and height fields scaled, with holes, measured, and as baked bytes.

use super::{Asset, BsHeightField, BsHull, BsMesh, give, share};
use crate::abi::guard::call;
use crate::abi::pointers::{Buffer, Out, slice};
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::values::{BsBool, BsVec3};
use backstop::glam::Vec3;
use backstop::{ConvexHull, Error, HeightField, TriangleMesh};
use std::sync::Arc;

/// # Safety
/// As `share` and `Out::new`.
unsafe fn make<A: Asset>(
    from: *const A,
    to: *mut *const A,
    work: impl FnOnce(&A::Engine) -> Result<A::Engine, Error>,
) -> BsStatus {
    call(|| {
        // SAFETY: as this function.
        let (out, from) = unsafe { (Out::new("the place for the result", to)?, share(from)?) };
        out.set(give(Arc::new(work(&from)?)));
        Ok(())
    })
}

/// # Safety
/// As `share` and `Buffer::new`.
unsafe fn bake<A: Asset>(
    from: *const A,
    (bytes, capacity, count): (*mut u8, usize, *mut usize),
    work: impl FnOnce(&A::Engine) -> Vec<u8>,
) -> BsStatus {
    call(|| {
        // SAFETY: as this function.
        let (out, from) = unsafe { (Buffer::new("bytes", bytes, capacity, count)?, share(from)?) };
        out.fill(work(&from).into_iter())
    })
}

/// # Safety
/// As `slice` and `Out::new`.
unsafe fn load<A: Asset>(
    bytes: *const u8,
    count: usize,
    to: *mut *const A,
    work: impl FnOnce(&[u8]) -> Result<A::Engine, Error>,
) -> BsStatus {
    call(|| {
        // SAFETY: as this function.
        let (out, bytes) =
            unsafe { (Out::new("the place for the result", to)?, slice("the bytes", bytes, count)?) };
        out.set(give(Arc::new(work(bytes)?)));
        Ok(())
    })
}

/// # Safety
/// As `share` and `Out::new`.
unsafe fn bounds<A: Asset>(
    of: *const A,
    (low, high): (*mut BsVec3, *mut BsVec3),
    work: impl FnOnce(&A::Engine) -> (Vec3, Vec3),
) -> BsStatus {
    call(|| {
        // SAFETY: as this function.
        let (of, low, high) = unsafe {
            let low = Out::new("the place for the low corner", low)?;
            (share(of)?, low, Out::new("the place for the high corner", high)?)
        };
        let (min, max) = work(&of);
        low.set(min.into());
        high.set(max.into());
        Ok(())
    })
}

/// A hull in another size, by a factor along each axis. The caller has a reference to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_hull_scaled(
    hull: *const BsHull,
    scale: BsVec3,
    scaled: *mut *const BsHull,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { make(hull, scaled, |hull| hull.scaled(scale.into())) }
}

/// A hull as bytes, which `bs_hull_from_bytes` reads without building it again. `count` becomes the number
/// of bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_hull_to_bytes(
    hull: *const BsHull,
    bytes: *mut u8,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { bake(hull, (bytes, capacity, count), ConvexHull::to_bytes) }
}

/// A hull from bytes of `bs_hull_to_bytes`, which are checked. The caller has a reference to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_hull_from_bytes(
    bytes: *const u8,
    count: usize,
    hull: *mut *const BsHull,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { load(bytes, count, hull, ConvexHull::from_bytes) }
}

/// A mesh in another size, by a factor along each axis. The caller has a reference to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_scaled(
    mesh: *const BsMesh,
    scale: BsVec3,
    scaled: *mut *const BsMesh,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { make(mesh, scaled, |mesh| mesh.scaled(scale.into())) }
}

/// A mesh as bytes, which `bs_mesh_from_bytes` reads without building it again. `count` becomes the number
/// of bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_to_bytes(
    mesh: *const BsMesh,
    bytes: *mut u8,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { bake(mesh, (bytes, capacity, count), TriangleMesh::to_bytes) }
}

/// A mesh from bytes of `bs_mesh_to_bytes`, which are checked. The caller has a reference to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_from_bytes(
    bytes: *const u8,
    count: usize,
    mesh: *mut *const BsMesh,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { load(bytes, count, mesh, TriangleMesh::from_bytes) }
}

/// The low and the high corner of a mesh [m].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_bounds(
    mesh: *const BsMesh,
    low: *mut BsVec3,
    high: *mut BsVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { bounds(mesh, (low, high), TriangleMesh::aabb) }
}

/// A height field in another size, by a factor along each axis. The caller has a reference to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_scaled(
    field: *const BsHeightField,
    scale: BsVec3,
    scaled: *mut *const BsHeightField,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { make(field, scaled, |field| field.scaled(scale.into())) }
}

/// A height field as bytes, which `bs_height_field_from_bytes` reads without building it again. `count`
/// becomes the number of bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_to_bytes(
    field: *const BsHeightField,
    bytes: *mut u8,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { bake(field, (bytes, capacity, count), HeightField::to_bytes) }
}

/// A height field from bytes of `bs_height_field_to_bytes`, which are checked. The caller has a reference to
/// it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_from_bytes(
    bytes: *const u8,
    count: usize,
    field: *mut *const BsHeightField,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { load(bytes, count, field, HeightField::from_bytes) }
}

/// The low and the high corner of a height field [m].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_bounds(
    field: *const BsHeightField,
    low: *mut BsVec3,
    high: *mut BsVec3,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { bounds(field, (low, high), HeightField::aabb) }
}

/// How far the furthest given point is outside of a hull [m]: within rounding, unless its vertices were too
/// many.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_hull_left_out(hull: *const BsHull, distance: *mut f32) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (hull, out) = unsafe { (share(hull)?, Out::new("the place for the distance", distance)?) };
        out.set(hull.left_out());
        Ok(())
    })
}

/// The faces of a hull: for each the number of its vertices, in `sizes`, and their indices one after another
/// in `indices`, counter-clockwise seen from outside. The counts become the numbers of both.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_hull_faces(
    hull: *const BsHull,
    sizes: *mut u16,
    size_capacity: usize,
    size_count: *mut usize,
    indices: *mut u16,
    index_capacity: usize,
    index_count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (hull, sizes, indices) = unsafe {
            let sizes = Buffer::new("sizes", sizes, size_capacity, size_count)?;
            (share(hull)?, sizes, Buffer::new("indices", indices, index_capacity, index_count)?)
        };
        let all: Vec<u16> = hull.faces().flatten().copied().collect();
        // Both numbers are told before one is refused.
        let fits = sizes.reserve(hull.faces().len());
        indices.reserve(all.len())?;
        fits?;
        sizes.fill(hull.faces().map(|face| face.len() as u16))?;
        indices.fill(all.into_iter())
    })
}

/// A height field without `count` of its cells: what falls there falls through. `cells` has a column and a
/// row for each, two numbers. The caller has a reference to the result.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_with_holes(
    field: *const BsHeightField,
    cells: *const usize,
    count: usize,
    holed: *mut *const BsHeightField,
) -> BsStatus {
    let cells = || -> Outcome<Vec<[usize; 2]>> {
        // SAFETY: the caller keeps to the header.
        let cells = unsafe { slice("the cells", cells, count.saturating_mul(2)) }?;
        Ok(cells.chunks_exact(2).map(|cell| [cell[0], cell[1]]).collect())
    };
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (out, field) = unsafe { (Out::new("the place for the result", holed)?, share(field)?) };
        out.set(give(Arc::new(HeightField::clone(&field).with_holes(cells()?)?)));
        Ok(())
    })
}

/// Whether a cell of a height field is a hole; no beyond the last.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_is_hole(
    field: *const BsHeightField,
    column: usize,
    row: usize,
    hole: *mut BsBool,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (field, out) = unsafe { (share(field)?, Out::new("the place for the answer", hole)?) };
        out.set(field.is_hole_at(column, row).into());
        Ok(())
    })
}

/// A height field with other heights [m]: `columns` times `rows` samples from column `first_column` and row
/// `first_row` on, row by row. The caller has a reference to the result; `bs_shape_set_heights` changes the
/// field of a shape in place.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_with_heights(
    field: *const BsHeightField,
    first_column: usize,
    first_row: usize,
    columns: usize,
    rows: usize,
    heights: *const f32,
    changed: *mut *const BsHeightField,
) -> BsStatus {
    call(|| {
        let count = columns.saturating_mul(rows);
        // SAFETY: the caller keeps to the header.
        let (out, field, heights) = unsafe {
            let out = Out::new("the place for the result", changed)?;
            (out, share(field)?, slice("the heights", heights, count)?)
        };
        let mut field = HeightField::clone(&field);
        field.set_heights([first_column, first_row], [columns, rows], heights)?;
        out.set(give(Arc::new(field)));
        Ok(())
    })
}
