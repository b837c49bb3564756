//! Shared geometry at another scale, as geometry of its own ([why](../../docs/decisions/scaled-shapes.md)).

use super::mesh::VERTEX_MASK;
use super::{ConvexHull, Geometry, HeightField, TriangleMesh};
use crate::error::{Error, finite3, positive};
use glam::{Vec2, Vec3};

/// A scale that flattens nothing.
fn factors(scale: Vec3) -> Result<Vec3, Error> {
    finite3("scale", scale)?;
    positive("size of a factor of the scale", scale.abs().min_element())?;
    Ok(scale)
}

impl ConvexHull {
    /// The hull of the vertices, each times the scale component by component; negative factors mirror.
    ///
    /// # Errors
    /// A factor is zero or not finite, or the scaled vertices make no hull ([`ConvexHull::new`]).
    pub fn scaled(&self, scale: Vec3) -> Result<ConvexHull, Error> {
        let scale = factors(scale)?;
        let vertices: Vec<Vec3> = self.vertices.iter().map(|v| *v * scale).collect();
        let mut hull = ConvexHull::new(&vertices)?;
        hull.left_out = hull.left_out.max(self.left_out * scale.abs().max_element());
        Ok(hull)
    }
}

impl TriangleMesh {
    /// A mesh of its own with each vertex times the scale, component by component. Where negative factors
    /// mirror it triangles are wound the other way round, so that fronts stay fronts. It is built as others
    /// are: triangles have indices of their own, and those that lose their area are dropped. Materials stay.
    ///
    /// # Errors
    /// A factor is zero or not finite, or the scaled triangles make no mesh ([`TriangleMesh::new`]).
    pub fn scaled(&self, scale: Vec3) -> Result<TriangleMesh, Error> {
        let scale = factors(scale)?;
        let vertices = self.vertices.iter().map(|v| *v * scale).collect();
        let mirrored = scale.to_array().iter().filter(|factor| **factor < 0.0).count() % 2 == 1;
        let wound = |&[a, b, c]: &[u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
        let triangles = self.triangles.iter().map(|t| wound(t).map(|v| v & VERTEX_MASK));
        match &self.surfaces {
            None => TriangleMesh::new(vertices, triangles.collect()),
            Some(own) => TriangleMesh::with_materials(vertices, triangles.collect(), &own.parts, &own.table),
        }
    }
}

impl HeightField {
    /// A field of its own with cells times the scale's x and z, and heights times its y, which may be
    /// negative; holes and materials stay. To mirror x or z takes a mesh: the diagonals of its cells would
    /// run the other way.
    ///
    /// # Errors
    /// A factor is zero or not finite, x or z is negative, or the scaled samples make no field
    /// ([`HeightField::new`]).
    pub fn scaled(&self, scale: Vec3) -> Result<HeightField, Error> {
        let scale = factors(scale)?;
        positive("scale of a height field along x", scale.x)?;
        positive("scale of a height field along z", scale.z)?;
        let heights = self.heights.iter().map(|height| height * scale.y).collect();
        let cell = self.cell * Vec2::new(scale.x, scale.z);
        let cells = self.columns - 1;
        let holes = self.holes().map(|cell| cell as usize).map(|cell| [cell % cells, cell / cells]);
        let mut field = HeightField::new(self.columns, self.rows, cell, heights)?.with_holes(holes)?;
        field.surfaces.clone_from(&self.surfaces);
        Ok(field)
    }
}

// Rounding: of a product of rotations and scales down a hierarchy.
/// Factors that differ by less are one.
const SAME_SCALE: f32 = 1e-4;

impl Geometry {
    /// The same form, larger or smaller, about its own origin: a box, a hull or a mesh by three factors, a
    /// round shape by one, which must be positive. Hulls, meshes and height fields are built anew.
    ///
    /// # Errors
    /// A factor is zero or not finite; it would be another form; or as for [`ConvexHull::scaled`],
    /// [`TriangleMesh::scaled`] and [`HeightField::scaled`].
    pub fn scaled(&self, scale: Vec3) -> Result<Geometry, Error> {
        Ok(match self {
            Geometry::Box { half_extents } => {
                Geometry::Box { half_extents: factors(scale)?.abs() * half_extents }
            }
            Geometry::Hull(hull) => Geometry::hull(hull.scaled(scale)?),
            Geometry::Mesh(mesh) => Geometry::mesh(mesh.scaled(scale)?),
            Geometry::HeightField(field) => Geometry::height_field(field.scaled(scale)?),
            _ => {
                let (least, most) = (factors(scale)?.min_element(), scale.max_element());
                positive("scale of a shape that has one", least)?;
                let uneven = || Error::Degenerate(format!("a {} has one scale", self.kind_name()));
                let even = most - least <= SAME_SCALE * most || matches!(self, Geometry::Plane);
                let numbers = self.size().map(|length| scale.x * length);
                Geometry::of_numbers(self.code(), numbers).filter(|_| even).ok_or_else(uneven)?
            }
        })
    }
}
