//! Pushes a character out of bodies that moved into it.

use super::shape::Shape;
use crate::error::Error;
use crate::handle::ShapeHandle;
use glam::DVec3;

/// Overlaps that are resolved at once; if there are more, the deepest.
const MAX_OVERLAPS: usize = 16;
/// Rounds of detection and motion. Each sees only the deepest triangle of a mesh.
const ROUNDS: usize = 8;
/// Sweeps over all overlaps of a round.
const SWEEPS: usize = 16;

#[derive(Clone, Copy)]
struct Overlap {
    depth: f64,
    normal: DVec3,
    shape: ShapeHandle,
}

/// Overlaps of the shape with its skin, deepest first.
#[derive(Default)]
struct Overlaps {
    all: [Option<Overlap>; MAX_OVERLAPS],
}

impl Overlaps {
    fn of(shape: &Shape<'_>, at: DVec3) -> Result<Overlaps, Error> {
        let mut found = Overlaps::default();
        shape.world.each_overlap(&shape.probe(at)?, &shape.filter, |hit| {
            let depth = f64::from(hit.depth);
            if depth > shape.tiny {
                found.insert(Overlap { depth, normal: hit.normal.as_dvec3(), shape: hit.shape });
            }
        })?;
        Ok(found)
    }

    /// By depth, then by handle, so that the order of insertion does not matter.
    fn insert(&mut self, mut new: Overlap) {
        for place in &mut self.all {
            let Some(old) = place else {
                *place = Some(new);
                return;
            };
            if (new.depth, old.shape) > (old.depth, new.shape) {
                std::mem::swap(old, &mut new);
            }
        }
    }

    fn deepest(&self) -> f64 {
        self.all[0].map_or(0.0, |o| o.depth)
    }

    /// Approximately the shortest way out of all overlaps, if there is one.
    fn way_out(&self, gap: f64) -> DVec3 {
        let mut way = DVec3::ZERO;
        for _ in 0..SWEEPS {
            for o in self.all.iter().flatten() {
                way += o.normal * (o.depth + gap - o.normal.dot(way)).max(0.0);
            }
        }
        way
    }
}

/// Moves a character out of overlapping shapes; returns its new position, and the remaining depth [m].
pub(super) fn push_out(shape: &Shape<'_>, from: DVec3) -> Result<(DVec3, f64), Error> {
    let mut at = from;
    let mut best = (from, f64::INFINITY);
    for round in 0..=ROUNDS {
        let overlaps = Overlaps::of(shape, at)?;
        let deepest = overlaps.deepest();
        if deepest < best.1 {
            best = (at, deepest);
        }
        if deepest == 0.0 || round == ROUNDS {
            break;
        }
        let way = overlaps.way_out(0.25 * shape.tiny);
        let free = shape.cast_core(at, way)?.map_or(1.0, |hit| f64::from(hit.fraction));
        at += way * free;
    }
    Ok(best)
}
