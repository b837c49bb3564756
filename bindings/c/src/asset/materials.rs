//! Materials of the triangles of a mesh and of the cells of a height field.

use super::{BsHeightField, BsMesh, give, share};
use crate::abi::guard::call;
use crate::abi::pointers::{Out, slice};
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::values::BsVec3;
use crate::shape::{BsMaterial, BsSurface};
use backstop::{HeightField, Material, TriangleMesh};
use std::sync::Arc;

/// # Safety
/// Each is null or has so many entries.
unsafe fn table(
    materials: *const BsMaterial,
    surfaces: *const BsSurface,
    count: usize,
) -> Outcome<Vec<Material>> {
    // SAFETY: as this function.
    let materials = unsafe { slice("the materials", materials, count) }?;
    let surfaces = match surfaces.is_null() {
        true => vec![BsSurface::NONE; count],
        // SAFETY: as this function.
        false => unsafe { slice("the surfaces", surfaces, count) }?.to_vec(),
    };
    materials.iter().zip(surfaces).map(|(&material, surface)| Ok(surface.on(material.to_engine()?))).collect()
}

/// A mesh as by `bs_mesh_create`, with materials of its own: for each triangle zero for the material of the
/// shape, or `i` for the table's entry `i - 1`, of at most 255. `surfaces` is what few materials have, or
/// null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_create_with_materials(
    vertices: *const BsVec3,
    vertex_count: usize,
    indices: *const u32,
    numbers: *const u8,
    triangle_count: usize,
    materials: *const BsMaterial,
    surfaces: *const BsSurface,
    material_count: usize,
    mesh: *mut *const BsMesh,
) -> BsStatus {
    call(|| {
        let index_count = triangle_count.saturating_mul(3);
        // SAFETY: the caller keeps to the header.
        let (out, vertices, indices, numbers, table) = unsafe {
            let vertices = slice("the vertices", vertices, vertex_count)?;
            let out = Out::new("the place for the mesh", mesh)?;
            let indices = slice("the indices", indices, index_count)?;
            let numbers = slice("the numbers", numbers, triangle_count)?;
            (out, vertices, indices, numbers, table(materials, surfaces, material_count)?)
        };
        let vertices = vertices.iter().map(|&vertex| vertex.into()).collect();
        let triangles = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        out.set(give(Arc::new(TriangleMesh::with_materials(vertices, triangles, numbers, &table)?)));
        Ok(())
    })
}

/// A height field with materials of its cells, row by row, numbered as those of a mesh. The caller has a
/// reference to the result.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_with_materials(
    field: *const BsHeightField,
    numbers: *const u8,
    cell_count: usize,
    materials: *const BsMaterial,
    surfaces: *const BsSurface,
    material_count: usize,
    changed: *mut *const BsHeightField,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (out, field, numbers, table) = unsafe {
            let out = Out::new("the place for the result", changed)?;
            let numbers = slice("the numbers", numbers, cell_count)?;
            (out, share(field)?, numbers, table(materials, surfaces, material_count)?)
        };
        out.set(give(Arc::new(HeightField::clone(&field).with_materials(numbers, &table)?)));
        Ok(())
    })
}

/// The number of the material of a triangle, by the index that queries report; zero for that of the shape.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_material_of(
    mesh: *const BsMesh,
    triangle: u32,
    number: *mut u8,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mesh, out) = unsafe { (share(mesh)?, Out::new("the place for the number", number)?) };
        out.set(mesh.material_of(triangle));
        Ok(())
    })
}

/// The number of the material of a triangle, by the index that queries report; zero for that of the shape.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_material_of(
    field: *const BsHeightField,
    triangle: u32,
    number: *mut u8,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (field, out) = unsafe { (share(field)?, Out::new("the place for the number", number)?) };
        out.set(field.material_of(triangle));
        Ok(())
    })
}
