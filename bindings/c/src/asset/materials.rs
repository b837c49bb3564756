//! Materials of the triangles of a mesh and of the cells of a height field.

use super::{Asset, BsHeightField, BsMesh, give, share};
use crate::abi::guard::call;
use crate::abi::pointers::{Out, slice};
use crate::abi::status::{BsStatus, Outcome, Refusal};
use crate::abi::values::{BsBool, BsVec3};
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
    materials.iter().zip(surfaces).map(|(&material, surface)| surface.with(material)).collect()
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

/// # Safety
/// As `share` and `Out::new`.
unsafe fn tell_count<A: Asset>(
    of: *const A,
    count: *mut usize,
    table: impl FnOnce(&A::Engine) -> &[Material],
) -> BsStatus {
    call(|| {
        // SAFETY: as this function.
        let (of, out) = unsafe { (share(of)?, Out::new("the count", count)?) };
        out.set(table(&of).len());
        Ok(())
    })
}

/// # Safety
/// As `share` and `Out::optional`.
unsafe fn tell_material<A: Asset>(
    of: *const A,
    number: u8,
    (material, surface): (*mut BsMaterial, *mut BsSurface),
    table: impl FnOnce(&A::Engine) -> &[Material],
) -> BsStatus {
    call(|| {
        // SAFETY: as this function.
        let (of, material, surface) = unsafe {
            let material = Out::optional("the place for the material", material)?;
            (share(of)?, material, Out::optional("the place for the surface", surface)?)
        };
        let none = Refusal::Constant { what: "material of it", value: number.into() };
        let found = *usize::from(number).checked_sub(1).and_then(|at| table(&of).get(at)).ok_or(none)?;
        if let Some(out) = material {
            out.set(BsMaterial::of_engine(&found));
        }
        if let Some(out) = surface {
            out.set(BsSurface::of_engine(&found));
        }
        Ok(())
    })
}

/// How many materials the table of a mesh has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_material_count(mesh: *const BsMesh, count: *mut usize) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { tell_count(mesh, count, TriangleMesh::materials) }
}

/// A material of the table of a mesh by its number, from one on; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_mesh_material(
    mesh: *const BsMesh,
    number: u8,
    material: *mut BsMaterial,
    surface: *mut BsSurface,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { tell_material(mesh, number, (material, surface), TriangleMesh::materials) }
}

/// How many materials the table of a height field has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_material_count(
    field: *const BsHeightField,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { tell_count(field, count, HeightField::materials) }
}

/// A material of the table of a height field by its number, from one on; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_material(
    field: *const BsHeightField,
    number: u8,
    material: *mut BsMaterial,
    surface: *mut BsSurface,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { tell_material(field, number, (material, surface), HeightField::materials) }
}

/// A height field with other holes: `columns` times `rows` cells from column `first_column` and row
/// `first_row` on, row by row, each a hole or not. The caller has a reference to the result;
/// `bs_shape_set_holes` changes the field of a shape in place.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_height_field_with_hole_map(
    field: *const BsHeightField,
    first_column: usize,
    first_row: usize,
    columns: usize,
    rows: usize,
    holes: *const BsBool,
    changed: *mut *const BsHeightField,
) -> BsStatus {
    call(|| {
        let count = columns.saturating_mul(rows);
        // SAFETY: the caller keeps to the header.
        let (out, field, holes) = unsafe {
            let out = Out::new("the place for the result", changed)?;
            (out, share(field)?, slice("the holes", holes, count)?)
        };
        let holes: Vec<bool> = holes.iter().map(|&hole| hole != 0).collect();
        let mut field = HeightField::clone(&field);
        field.set_holes([first_column, first_row], [columns, rows], &holes)?;
        out.set(give(Arc::new(field)));
        Ok(())
    })
}
