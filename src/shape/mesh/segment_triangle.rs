//! A segment against a triangle of a mesh, such that nothing slips through where triangles meet.
//!
//! The triangle is sheared so that the path becomes an axis; then three edge functions tell on which side of
//! each edge it passes. Two triangles compute the function of the edge they share to the same bits but for
//! its sign, so no path passes outside of both (Woop, Benthin and Wald, *Watertight Ray/Triangle
//! Intersection*, JCGT 2013). A path within a relative 1e-6 of an edge counts as on it, so that a mesh lets
//! nothing through.

use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3};
use glam::Vec3;

// Rounding: of edges and of a path's end.
/// Share by which edges are widened, and the path's end is drawn out.
const WIDEN: f32 = 1e-6;

/// A path that is tested against many triangles.
#[derive(Clone, Copy, Debug, Default)]
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
        Self::along(from, to - from)
    }

    /// The same by start and displacement.
    pub(crate) fn along(from: Vec3, d: Vec3) -> Option<SegmentTest> {
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
    #[inline]
    pub(crate) fn hit(&self, triangle: [Vec3; 3]) -> Option<f32> {
        let (hit, t) = self.hits::<f32>(triangle.map(LaneVec3::splat));
        hit.then_some(t)
    }

    /// Which triangles the path meets, and where.
    #[inline(always)]
    pub(crate) fn hits<L: Lanes>(&self, triangle: [LaneVec3<L>; 3]) -> (L::Mask, L) {
        let [kx, ky, kz] = self.axes;
        let [sx, sy, sz] = self.shear.map(L::splat);
        let from = LaneVec3::<L>::splat(self.from);
        let along = |v: &LaneVec3<L>, k: usize| match k {
            0 => v.x,
            1 => v.y,
            _ => v.z,
        };
        let shear = |v: LaneVec3<L>| {
            let v = v - from;
            let z = along(&v, kz);
            (along(&v, kx) - sx * z, along(&v, ky) - sy * z, z)
        };
        let corner = [shear(triangle[0]), shear(triangle[1]), shear(triangle[2])];
        let edge = |i: usize, j: usize| {
            let (one, other) = (corner[i].0 * corner[j].1, corner[i].1 * corner[j].0);
            // Error of the sheared coordinates, on top of the products' own rounding.
            let reach = (corner[i].0.abs() + corner[i].1.abs() + corner[j].0.abs() + corner[j].1.abs())
                * (corner[i].2.abs() + corner[j].2.abs());
            let slack = L::splat(WIDEN) * (one.abs() + other.abs()) + L::splat(0.25 * WIDEN) * reach;
            (one - other, slack)
        };
        let [u, v, w] = [edge(1, 2), edge(2, 0), edge(0, 1)];
        let left = u.0.lt(-u.1) | v.0.lt(-v.1) | w.0.lt(-w.1);
        let right = u.0.gt(u.1) | v.0.gt(v.1) | w.0.gt(w.1);
        let through = !(left & right);
        if !through.any() {
            return (through, L::zero());
        }
        let (u, v, w) = (u.0, v.0, w.0);
        let determinant = u + v + w;
        // Edge-on: the neighbours have the same edges.
        let through = through & !determinant.eq(L::zero());
        // Weights within the triangle: on a widened edge they may be a little outside.
        let (zero, one) = (L::zero(), L::one());
        let weight = |x: L| {
            let x = x / determinant;
            let x = L::select(x.lt(zero), zero, x);
            L::select(x.gt(one), one, x)
        };
        let (u, v, w) = (weight(u), weight(v), weight(w));
        let along = (u * corner[0].2 + v * corner[1].2 + w * corner[2].2) / (u + v + w);
        let t = along * sz;
        let length = L::splat(self.length);
        let reach = corner[2].2.abs().max(corner[1].2.abs().max(corner[0].2.abs().max(length)));
        // A path that ends within rounding of the surface has met it: the next one starts there and may not.
        let drawn_out = one + L::splat(WIDEN) * reach / length;
        (through & t.ge(zero) & t.le(drawn_out), t.min(one))
    }

    /// Makes triangle `index` the nearest hit if it is. At the same fraction the lower index counts.
    #[inline]
    pub(crate) fn nearer(&self, index: u32, triangle: [Vec3; 3], nearest: &mut Option<(f32, u32)>) {
        if let Some(t) = self.hit(triangle)
            && nearest.is_none_or(|(best, other)| t < best || (t == best && index < other))
        {
            *nearest = Some((t, index));
        }
    }
}
