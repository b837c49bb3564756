//! The rays of a stream through a height field: down its pyramid together, as `stream.rs` does it in trees.

use super::{SIDE, STACK, Square};
use crate::lanes::{Lanes, Mask, f32x4, ones};
use crate::shape::HeightField;
use crate::shape::mesh::rays::{TriangleRays, take};
use crate::shape::stream::spread;

impl HeightField {
    /// [`HeightField::ray`] for rays together, each to the same bits.
    pub(crate) fn rays(&self, rays: &mut TriangleRays) {
        let mut stack = [(Square::default(), 0u64); STACK];
        stack[0] = (self.root(), rays.rays);
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (square, all) = stack[waiting];
            let mut here = 0;
            for ray in ones(all) {
                here |= u64::from(square.entry <= rays.nearest[ray].0) << ray;
            }
            if square.level == 0 {
                self.cell_rays(&square, here, rays);
                continue;
            }
            let base = waiting;
            for row in 0..SIDE as u32 {
                let (low, high, there) = self.row_of_four(&square, row);
                if there == 0 || here == 0 {
                    break;
                }
                let (mut into, mut first) = ([0u64; 4], f32x4::splat(f32::INFINITY));
                for ray in ones(here) {
                    let (meets, entry) = rays.paths[ray].meets::<f32x4>(low, high);
                    let meets = meets & Lanes::le(entry, f32x4::splat(rays.nearest[ray].0));
                    first = Lanes::min(<f32x4 as Lanes>::select(meets, entry, first), first);
                    spread(&mut into, meets.bits() & there, ray);
                }
                for (i, (into, entry)) in into.into_iter().zip(first.to_array()).enumerate() {
                    if into == 0 || waiting == STACK {
                        continue;
                    }
                    // The nearest on top.
                    let mut at = waiting;
                    while at > base && stack[at - 1].0.entry < entry {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = (square.child(i as u32, row, entry), into);
                    waiting += 1;
                }
            }
        }
    }

    /// Rays against the two triangles of a cell.
    fn cell_rays(&self, square: &Square, here: u64, rays: &mut TriangleRays) {
        let TriangleRays { paths, tests, nearest, .. } = rays;
        for index in self.triangles_of(square) {
            let corners = self.triangle(index);
            let [a, b, c] = corners;
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            for ray in ones(here) {
                if let Some(entry) = paths[ray].meets_one(low, high)
                    && entry <= nearest[ray].0
                    && let Some(t) = tests[ray].hit(corners)
                {
                    take(&mut nearest[ray], Lanes::max(t, entry), index);
                }
            }
        }
    }
}
