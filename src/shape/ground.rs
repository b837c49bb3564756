//! Common interface of meshes and height fields: triangles, which are found by boxes, paths and points.

use super::forms::outline::{Triangle, Window};
use super::forms::{Form, Kind};
use super::height_field::HeightField;
use super::material::Material;
use super::mesh::TriangleMesh;
use super::mesh::edges::Edges;
use super::mesh::rays::TriangleRays;
use super::mesh::segment_triangle::SegmentTest;
use super::surfaces::Surfaces;
use crate::words::words;
use glam::{DVec3, Vec3};

/// A mesh or a height field.
#[derive(Clone, Copy)]
pub(crate) enum Ground<'a> {
    Mesh(&'a TriangleMesh),
    Field(&'a HeightField),
}

/// Does something with one or the other; it is compiled for both, so inner loops know which it is.
macro_rules! with_ground {
    ($ground:expr, $of:ident => $do:expr) => {
        match $ground {
            Ground::Mesh($of) => $do,
            Ground::Field($of) => $do,
        }
    };
}

impl Ground<'_> {
    /// Corners of the box around it [m].
    pub(crate) fn aabb(&self) -> (Vec3, Vec3) {
        with_ground!(self, of => of.aabb())
    }

    /// Corners of a triangle.
    #[inline]
    pub(crate) fn triangle(&self, i: u32) -> [Vec3; 3] {
        with_ground!(self, of => of.triangle(i))
    }

    pub(crate) fn edges(&self, i: u32) -> Edges {
        with_ground!(self, of => of.edges(i))
    }

    /// The material of a triangle, by its number.
    #[inline]
    pub(crate) fn material(&self, i: u32) -> u8 {
        with_ground!(self, of => of.material_of(i))
    }

    /// Calls `f` with every triangle whose bounding box meets a box.
    pub(crate) fn visit_box(&self, min: Vec3, max: Vec3, f: &mut (impl FnMut(u32, [Vec3; 3]) + ?Sized)) {
        with_ground!(self, of => of.visit_box(min, max, f));
    }

    /// Whether `f` says yes to any triangle whose bounding box meets a box.
    pub(crate) fn any_in_box(
        &self,
        min: Vec3,
        max: Vec3,
        f: &mut impl FnMut(u32, [Vec3; 3]) -> bool,
    ) -> bool {
        with_ground!(self, of => of.any_in_box(min, max, f))
    }

    /// Calls `f` with the triangles whose boxes, inflated by half extents, a path meets, with their corners
    /// and the largest fraction that still matters; nearer ones first, as far as boxes tell, in an order that
    /// depends on the mesh and the path alone. `f` returns the largest fraction that matters from then on.
    pub(crate) fn visit_segment(
        &self,
        from: Vec3,
        to: Vec3,
        inflate: Vec3,
        f: &mut (impl FnMut(u32, [Vec3; 3], f32) -> f32 + ?Sized),
    ) {
        with_ground!(self, of => of.visit_segment(from, to, inflate, f));
    }

    /// Calls `f` with the triangles whose boxes a box of half extents `half` meets that moves along a path,
    /// up to the fraction `most`, about the nearest first; it returns the new `most`.
    pub(crate) fn visit_path(
        &self,
        from: DVec3,
        path: Vec3,
        half: Vec3,
        most: f32,
        f: &mut impl FnMut(u32, [Vec3; 3], f32) -> f32,
    ) {
        with_ground!(self, of => of.visit_path(from, path, half, most, f));
    }

    /// Calls `f` with the triangles whose boxes may be within the squared distance `most` of a point [m²],
    /// about the nearest first; it returns the new `most`.
    pub(crate) fn visit_near(&self, at: DVec3, most: f32, f: &mut impl FnMut(u32, [Vec3; 3], f32) -> f32) {
        with_ground!(self, of => of.visit_near(at, most, f));
    }

    /// Whether any triangle may be within `reach` [m] of a segment, as far as boxes and planes tell.
    pub(crate) fn nears(&self, from: Vec3, to: Vec3, reach: f32) -> bool {
        with_ground!(self, of => of.nears(from, to, reach))
    }

    /// Where a path first meets a triangle, from either side: the fraction of it, and the triangle. Nothing
    /// slips through an edge or a vertex that triangles share.
    pub(crate) fn segment_hit(&self, from: Vec3, to: Vec3) -> Option<(f32, u32)> {
        let test = SegmentTest::new(from, to)?;
        let mut nearest: Option<(f32, u32)> = None;
        self.visit_segment(from, to, Vec3::ZERO, &mut |i, corners, _| {
            test.nearer(i, corners, &mut nearest);
            nearest.map_or(1.0, |n| n.0)
        });
        nearest
    }

    /// As [`Ground::segment_hit`] for queries: by start and displacement, up to the fraction `most`; the
    /// first hit, or if `any` will do, one of them. A hit counts from where the box of its leaf in the tree
    /// is entered, or that of the triangle in a height field: so it does not matter which is asked first
    /// where edges are widened beyond their boxes.
    pub(crate) fn ray(&self, from: Vec3, path: Vec3, most: f32, any: bool) -> Option<(f32, u32)> {
        let test = SegmentTest::along(from, path)?;
        let mut nearest = (most, u32::MAX);
        with_ground!(self, of => of.ray(&test, from, path, any, &mut nearest));
        (nearest.1 != u32::MAX).then_some(nearest)
    }

    /// Adds a ray by start and displacement [m], to be followed up to the fraction `most`.
    pub(crate) fn put_ray(&self, rays: &mut TriangleRays, ray: usize, from: Vec3, path: Vec3, most: f32) {
        // Without a length it meets no triangle.
        let Some(test) = SegmentTest::along(from, path) else { return };
        match self {
            Ground::Mesh(mesh) => rays.stream.put(ray, mesh.slabs(from, path), most),
            Ground::Field(field) => rays.paths[ray] = field.path(from, from + path, Vec3::ZERO),
        }
        (rays.tests[ray], rays.nearest[ray]) = (test, (most, u32::MAX));
        rays.rays |= 1 << ray;
    }

    /// Finds the triangles that they meet.
    pub(crate) fn cast_rays(&self, rays: &mut TriangleRays) {
        with_ground!(self, of => of.rays(rays));
    }

    /// Its content, for a fingerprint.
    fn words(&self, out: &mut Vec<u32>) {
        let count = with_ground!(self, of => of.triangle_count()) as u32;
        (0..count).for_each(|i| out.extend(words::<9>(self.triangle(i))));
        if let Ground::Field(field) = self {
            out.extend(field.holes());
        }
        out.extend(Surfaces::words(with_ground!(self, of => &of.surfaces)));
    }
}

macro_rules! forms_of_triangles {
    ($($of:ident $ground:ident $kind:ident $name:literal $code:literal,)*) => { $(
        impl<'a> Form<'a> for &'a $of {
            const KIND: Kind = Kind::$kind;
            const NAME: &'static str = $name;
            const CODE: u32 = $code;

            fn aabb(self) -> (Vec3, Vec3) {
                $of::aabb(self)
            }

            fn triangles(self, window: Window, triangle: &mut Triangle<'_>) {
                let (min, max) = window.unwrap_or(self.aabb());
                self.visit_box(min, max, &mut |_, corners| triangle(corners));
            }

            fn materials(self) -> &'a [Material] {
                $of::materials(self)
            }

            fn address(self) -> Option<usize> {
                Some(std::ptr::from_ref(self) as usize)
            }

            fn bytes(self) -> (usize, usize) {
                $of::bytes(self)
            }

            fn words(self, out: &mut Vec<u32>) {
                Ground::$ground(self).words(out);
            }
        }
    )* };
}

forms_of_triangles! {
    TriangleMesh Mesh Mesh "mesh" 6,
    HeightField Field HeightField "height field" 7,
}
