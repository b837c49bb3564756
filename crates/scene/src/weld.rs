//! One vertex per position. Viewers want a vertex per normal and texture coordinate, contacts want to know
//! which triangles share an edge.

use glam::Vec3;
use std::collections::BTreeMap;

/// Vertices and triangles under construction; equal positions become one vertex, in the order of first use.
#[derive(Default)]
pub(super) struct Welded {
    pub(super) vertices: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    places: BTreeMap<[u32; 3], u32>,
}

impl Welded {
    /// The index of the vertex at `p`.
    pub(super) fn vertex(&mut self, p: Vec3) -> u32 {
        let p = p + Vec3::ZERO; // -0 becomes 0
        let next = self.vertices.len() as u32;
        let index = *self.places.entry(p.to_array().map(f32::to_bits)).or_insert(next);
        if index == next {
            self.vertices.push(p);
        }
        index
    }

    /// Adds a triangle, unless two of its corners are the same: points and lines collide with nothing.
    pub(super) fn triangle(&mut self, corners: [Vec3; 3]) {
        let [a, b, c] = corners.map(|p| self.vertex(p));
        if a != b && b != c && c != a {
            self.triangles.push([a, b, c]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_places_become_one_vertex_and_slivers_vanish() {
        let mut welded = Welded::default();
        welded.triangle([Vec3::ZERO, Vec3::X, Vec3::Y]);
        welded.triangle([Vec3::X, Vec3::new(1.0, 1.0, -0.0), Vec3::Y]);
        welded.triangle([Vec3::X, Vec3::X, Vec3::Z]);
        assert_eq!(welded.triangles, [[0, 1, 2], [1, 3, 2]]);
    }
}
