//! A segment against a triangle of a mesh, such that nothing slips through where triangles meet.
//!
//! The triangle is sheared so that the path becomes an axis; then three edge functions tell on which side of each edge
//! it passes. Two triangles compute the function of the edge they share to the same bits but for its sign, so no path
//! passes outside of both (Woop, Benthin and Wald, *Watertight Ray/Triangle Intersection*, JCGT 2013). A path within
//! a relative 1e-6 of an edge counts as on it: what a mesh is for here is to let nothing through.

use glam::Vec3;

/// Share by which edges are widened, and the path's end is drawn out.
const WIDEN: f32 = 1e-6;

/// A path that is tested against many triangles.
pub(crate) struct SegmentTest {
    from: Vec3,
    length: f32,
    /// The axis along which the path goes furthest, and the two that follow it.
    axes: [usize; 3],
    shear: [f32; 3],
}

impl SegmentTest {
    /// `None` if the path has no length.
    pub(crate) fn new(from: Vec3, to: Vec3) -> Option<SegmentTest> {
        let d = to - from;
        let size = d.abs();
        let z = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        if size[z] == 0.0 || !size[z].is_finite() {
            return None;
        }
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let shear = [d[x] / d[z], d[y] / d[z], 1.0 / d[z]];
        Some(SegmentTest { from, length: size[z], axes: [x, y, z], shear })
    }

    /// Where the path first meets the triangle, from either side, as a fraction in 0..=1.
    pub(crate) fn hit(&self, triangle: [Vec3; 3]) -> Option<f32> {
        let [kx, ky, kz] = self.axes;
        let [sx, sy, sz] = self.shear;
        let corner = triangle.map(|v| {
            let v = v - self.from;
            (v[kx] - sx * v[kz], v[ky] - sy * v[kz], v[kz])
        });
        let edge = |i: usize, j: usize| {
            let (one, other) = (corner[i].0 * corner[j].1, corner[i].1 * corner[j].0);
            // What the sheared coordinates may be off by, on top of the products' own rounding.
            let reach = (corner[i].0.abs() + corner[i].1.abs() + corner[j].0.abs() + corner[j].1.abs())
                * (corner[i].2.abs() + corner[j].2.abs());
            (one - other, WIDEN * (one.abs() + other.abs()) + 0.25 * WIDEN * reach)
        };
        let sides = [edge(1, 2), edge(2, 0), edge(0, 1)];
        let left = sides.iter().any(|(value, slack)| *value < -slack);
        let right = sides.iter().any(|(value, slack)| *value > *slack);
        if left && right {
            return None;
        }
        let [u, v, w] = sides.map(|s| s.0);
        let determinant = u + v + w;
        if determinant == 0.0 {
            // Edge-on: the neighbours have the same edges.
            return None;
        }
        // Weights within the triangle: on a widened edge they may be a little outside.
        let [u, v, w] = [u, v, w].map(|x| (x / determinant).clamp(0.0, 1.0));
        let along = (u * corner[0].2 + v * corner[1].2 + w * corner[2].2) / (u + v + w);
        let t = along * sz;
        let reach = corner.iter().map(|c| c.2.abs()).fold(self.length, f32::max);
        // A path that ends within rounding of the surface has met it: the next one starts there and may not.
        let drawn_out = 1.0 + WIDEN * reach / self.length;
        (t >= 0.0 && t <= drawn_out).then_some(t.min(1.0))
    }

    /// Makes triangle `index` the nearest hit if it is. Of two at the same fraction the lower index counts.
    #[inline]
    pub(crate) fn nearer(&self, index: u32, triangle: [Vec3; 3], nearest: &mut Option<(f32, u32)>) {
        if let Some(t) = self.hit(triangle)
            && nearest.is_none_or(|(best, other)| t < best || (t == best && index < other))
        {
            *nearest = Some((t, index));
        }
    }
}
