//! The rays of a stream that look for the first triangle of one mesh.

use super::TriangleMesh;
use super::segment_triangle::SegmentTest;
use super::stream::{RAYS, Stream, Walk};
use glam::Vec3;

/// Up to [`RAYS`] rays in the frame of a mesh, and what each met first.
#[derive(Debug)]
pub(crate) struct TriangleRays {
    pub(super) stream: Stream,
    pub(super) walk: Walk,
    pub(super) tests: [SegmentTest; RAYS],
    /// The fraction and the triangle; before it meets one, how far a ray looks and `u32::MAX`.
    pub(super) nearest: [(f32, u32); RAYS],
    pub(super) rays: u64,
}

impl TriangleRays {
    pub(crate) fn new() -> TriangleRays {
        TriangleRays {
            stream: Stream::new(),
            walk: Walk::new(),
            tests: [SegmentTest::default(); RAYS],
            nearest: [(0.0, u32::MAX); RAYS],
            rays: 0,
        }
    }

    /// Without rays, for the next mesh.
    pub(crate) fn clear(&mut self) {
        self.rays = 0;
    }

    /// Adds a ray by start and displacement [m], to be followed up to the fraction `most`.
    pub(crate) fn put(&mut self, ray: usize, mesh: &TriangleMesh, from: Vec3, path: Vec3, most: f32) {
        self.nearest[ray] = (most, u32::MAX);
        // Without a length it meets no triangle.
        if let Some(test) = SegmentTest::along(from, path) {
            self.tests[ray] = test;
            self.stream.put(ray, mesh.slabs(from, path), most);
            self.rays |= 1 << ray;
        }
    }

    /// Those that were put in and have a length, a bit each.
    pub(crate) fn rays(&self) -> u64 {
        self.rays
    }

    /// What [`TriangleMesh::ray`] answers to a ray of a mesh that they went through.
    pub(crate) fn first(&self, ray: usize) -> Option<(f32, u32)> {
        let nearest = self.nearest[ray];
        (nearest.1 != u32::MAX).then_some(nearest)
    }
}
