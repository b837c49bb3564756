//! Hulls, meshes and height fields: built once, shared by any number of shapes, counted.

mod materials;
mod more;

pub use materials::*;
pub use more::*;

use crate::abi::guard::{call, value_or};
use crate::abi::pointers::{Buffer, Out, slice};
use crate::abi::status::{BsStatus, Outcome, Refusal};
use crate::abi::values::BsVec3;
use backstop::glam::Vec2;
use backstop::{ConvexHull, HeightField, TriangleMesh};
use std::mem::ManuallyDrop;
use std::sync::Arc;

/// A convex hull. It has a count of references: `bs_hull_create` gives the first, and it is gone when all are
/// released and no shape uses it. All calls on it may come from any thread at any time.
pub struct BsHull {
    _opaque: [u8; 0],
}

/// A mesh of triangles. It has a count of references, as a `BsHull` has.
pub struct BsMesh {
    _opaque: [u8; 0],
}

/// A grid of heights. It has a count of references, as a `BsHull` has.
pub struct BsHeightField {
    _opaque: [u8; 0],
}

/// A type of the interface that stands for a shared one of the engine: its pointers are those of
/// `Arc::into_raw`.
pub(crate) trait Asset {
    type Engine;
    const NAME: &'static str;
}

impl Asset for BsHull {
    type Engine = ConvexHull;
    const NAME: &'static str = "the hull";
}

impl Asset for BsMesh {
    type Engine = TriangleMesh;
    const NAME: &'static str = "the mesh";
}

impl Asset for BsHeightField {
    type Engine = HeightField;
    const NAME: &'static str = "the height field";
}

/// A pointer for the caller, who has a reference then.
fn give<A: Asset>(asset: Arc<A::Engine>) -> *const A {
    Arc::into_raw(asset).cast()
}

/// A pointer for the caller to what somebody else holds: valid for as long as that one does.
pub(crate) fn lend<A: Asset>(asset: &Arc<A::Engine>) -> *const A {
    let at: *const A = give(asset.clone());
    // SAFETY: the reference that `give` has just made.
    drop(unsafe { Arc::from_raw(at.cast::<A::Engine>()) });
    at
}

/// A reference of the engine's own.
///
/// # Safety
/// The pointer is null or came from `give` or `lend` and is valid still.
pub(crate) unsafe fn share<A: Asset>(asset: *const A) -> Outcome<Arc<A::Engine>> {
    if asset.is_null() || !asset.cast::<A::Engine>().is_aligned() {
        return Err(Refusal::Null(A::NAME));
    }
    // SAFETY: it is valid, and the caller's reference is left to the caller.
    let held = ManuallyDrop::new(unsafe { Arc::from_raw(asset.cast::<A::Engine>()) });
    Ok(Arc::clone(&held))
}

/// # Safety
/// As `share`.
unsafe fn retain<A: Asset>(asset: *const A) -> BsStatus {
    call(|| {
        // SAFETY: as this function.
        std::mem::forget(unsafe { share(asset) }?);
        Ok(())
    })
}

/// # Safety
/// As `share`, and the caller has a reference, which ends here.
unsafe fn release<A: Asset>(asset: *const A) {
    value_or((), || {
        if !asset.is_null() {
            // SAFETY: as this function.
            drop(unsafe { Arc::from_raw(asset.cast::<A::Engine>()) });
        }
    });
}

/// The convex hull of `count` points [m], in any order and with duplicates; at most 256 of them are kept as
/// vertices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_hull_create(
    points: *const BsVec3,
    count: usize,
    hull: *mut *const BsHull,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (out, points) =
            unsafe { (Out::new("the place for the hull", hull)?, slice("the points", points, count)?) };
        let points: Vec<_> = points.iter().map(|&point| point.into()).collect();
        out.set(give(Arc::new(ConvexHull::new(&points)?)));
        Ok(())
    })
}

/// One more reference to a hull.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_hull_retain(hull: *const BsHull) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { retain(hull) }
}

/// One reference less. Null is no hull, and fine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_hull_release(hull: *const BsHull) {
    // SAFETY: the caller keeps to the header.
    unsafe { release(hull) }
}

/// The vertices of a hull [m]. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_hull_vertices(
    hull: *const BsHull,
    vertices: *mut BsVec3,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (hull, out) = unsafe { (share(hull)?, Buffer::new("vertices", vertices, capacity, count)?) };
        out.fill(hull.vertices().iter().map(|&vertex| vertex.into()))
    })
}

/// A mesh of `triangle_count` triangles, three indices of vertices each, counter-clockwise seen from the
/// front. Equal vertices become one; triangles without area, or given twice, are dropped.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_create(
    vertices: *const BsVec3,
    vertex_count: usize,
    indices: *const u32,
    triangle_count: usize,
    mesh: *mut *const BsMesh,
) -> BsStatus {
    call(|| {
        let index_count = triangle_count.saturating_mul(3);
        // SAFETY: the caller keeps to the header.
        let (out, vertices, indices) = unsafe {
            let vertices = slice("the vertices", vertices, vertex_count)?;
            let out = Out::new("the place for the mesh", mesh)?;
            (out, vertices, slice("the indices", indices, index_count)?)
        };
        let vertices = vertices.iter().map(|&vertex| vertex.into()).collect();
        let triangles = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        out.set(give(Arc::new(TriangleMesh::new(vertices, triangles)?)));
        Ok(())
    })
}

/// One more reference to a mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_retain(mesh: *const BsMesh) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { retain(mesh) }
}

/// One reference less. Null is no mesh, and fine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_release(mesh: *const BsMesh) {
    // SAFETY: the caller keeps to the header.
    unsafe { release(mesh) }
}

/// Number of triangles of a mesh: what is left of those that were given.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_triangle_count(mesh: *const BsMesh, count: *mut usize) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mesh, out) = unsafe { (share(mesh)?, Out::new("the count", count)?) };
        out.set(mesh.triangle_count());
        Ok(())
    })
}

/// The three corners of a triangle of a mesh [m], by the index that queries report.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_corners(
    mesh: *const BsMesh,
    triangle: u32,
    corners: *mut BsVec3,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mesh, out) = unsafe { (share(mesh)?, Out::new("the corners", corners.cast::<[BsVec3; 3]>())?) };
        out.set(corners_of(mesh.corners(triangle), triangle)?);
        Ok(())
    })
}

fn corners_of(corners: Option<[backstop::glam::Vec3; 3]>, triangle: u32) -> Outcome<[BsVec3; 3]> {
    let none = Refusal::Constant { what: "triangle of it", value: triangle };
    corners.map(|corners| corners.map(Into::into)).ok_or(none)
}

/// A field of `columns` times `rows` heights [m], row by row, with cells of `cell_x` along x and `cell_z`
/// along z [m]. Its first sample is at its origin.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_create(
    columns: usize,
    rows: usize,
    cell_x: f32,
    cell_z: f32,
    heights: *const f32,
    field: *mut *const BsHeightField,
) -> BsStatus {
    call(|| {
        // A pointer that does not fit is null or too long to be a slice.
        let count = columns.saturating_mul(rows);
        // SAFETY: the caller keeps to the header.
        let (out, heights) =
            unsafe { (Out::new("the place for the field", field)?, slice("the heights", heights, count)?) };
        let field = HeightField::new(columns, rows, Vec2::new(cell_x, cell_z), heights.to_vec())?;
        out.set(give(Arc::new(field)));
        Ok(())
    })
}

/// One more reference to a height field.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_retain(field: *const BsHeightField) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { retain(field) }
}

/// One reference less. Null is no height field, and fine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_release(field: *const BsHeightField) {
    // SAFETY: the caller keeps to the header.
    unsafe { release(field) }
}

/// Number of triangles of a height field.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_triangle_count(
    field: *const BsHeightField,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (field, out) = unsafe { (share(field)?, Out::new("the count", count)?) };
        out.set(field.triangle_count());
        Ok(())
    })
}

/// The three corners of a triangle of a height field [m], by the index that queries report.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_corners(
    field: *const BsHeightField,
    triangle: u32,
    corners: *mut BsVec3,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (field, out) =
            unsafe { (share(field)?, Out::new("the corners", corners.cast::<[BsVec3; 3]>())?) };
        out.set(corners_of(field.corners(triangle), triangle)?);
        Ok(())
    })
}
