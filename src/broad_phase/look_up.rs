//! Look-ups from outside the step: who is in a box, who is on a path.
//!
//! They read the trees as the last [`BroadPhase::update`] or [`BroadPhase::refresh`] left them. After a step
//! movers may be outside their boxes, because the solver changed what was predicted: refresh first, unless
//! only statics matter.

use super::{Aabb, BroadPhase, Path};
use crate::lanes::{Mask, f32x4};
use glam::Vec3;
use std::cell::Cell;

/// The colliders that a look-up searches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SearchSet {
    All,
    /// Only what was inserted as static.
    Statics,
}

impl BroadPhase {
    /// Calls `f` with every collider whose box touches this one.
    pub(crate) fn in_box(
        &self,
        stack: &mut Vec<u32>,
        whom: SearchSet,
        bounds: &Aabb,
        mut f: impl FnMut(u32),
    ) {
        for &c in self.unbounded_of(whom) {
            if self.proxies[c as usize].bounds.overlaps(bounds) {
                f(c);
            }
        }
        self.statics.visit_box(stack, bounds, &mut f);
        if whom == SearchSet::All {
            self.movers.visit_box(stack, bounds, f);
        }
    }

    /// Calls `f` with every collider whose box is touched by a box (`extent`: half extents) that moves
    /// straight from one point to another. `f` returns the largest fraction of the path that is still of
    /// interest; what lies beyond is left out from then on. Planes come first, then in no order along the
    /// path.
    pub(crate) fn on_path(
        &self,
        stack: &mut Vec<u32>,
        whom: SearchSet,
        (from, to): (Vec3, Vec3),
        extent: Vec3,
        mut f: impl FnMut(u32) -> f32,
    ) {
        let path =
            |fraction: f32| Path::between(from, from + (to - from) * fraction, extent).lanes::<f32x4>();
        let (mut fraction, lanes) = (1.0f32, Cell::new(Path::between(from, to, extent).lanes::<f32x4>()));
        let mut found = |c: u32| {
            let new = f(c);
            if new < fraction {
                fraction = new.max(0.0);
                lanes.set(path(fraction));
            }
        };
        self.unbounded_of(whom).for_each(|&c| found(c));
        let test = |node: &super::bvh::Node| lanes.get().hits(node.min, node.max).bits();
        self.statics.visit(stack, test, &mut found);
        if whom == SearchSet::All {
            self.movers.visit(stack, test, found);
        }
    }

    /// [`BroadPhase::on_path`] for statics and the whole path.
    pub(crate) fn statics_on_path(
        &self,
        stack: &mut Vec<u32>,
        from: Vec3,
        to: Vec3,
        extent: Vec3,
        mut f: impl FnMut(u32),
    ) {
        self.on_path(stack, SearchSet::Statics, (from, to), extent, |c| {
            f(c);
            1.0
        });
    }

    fn unbounded_of(&self, whom: SearchSet) -> impl Iterator<Item = &u32> {
        let is_static = |c: u32| self.proxies[c as usize].path == ENDLESS_STATIC;
        self.unbounded.iter().filter(move |&&c| whom == SearchSet::All || is_static(c))
    }
}

/// In the place of a path's index: this endless collider was inserted as static.
pub(super) const ENDLESS_STATIC: u32 = u32::MAX - 1;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::broad_phase::Mover;
    use crate::config::Continuous;
    use crate::threads::Workers;

    fn scene() -> BroadPhase {
        let mut broad = BroadPhase::default();
        for c in 0..100u32 {
            let at = Vec3::new(c as f32 * 10.0, (c % 7) as f32, 0.0);
            broad.insert_static(c, Aabb { min: at - 0.5, max: at + 0.5 });
        }
        broad.insert_static(200, Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY });
        broad.insert_mover(300);
        let aabb = Aabb { min: Vec3::new(4.0, 0.0, 0.0), max: Vec3::new(5.0, 1.0, 1.0) };
        let mover = Mover { collider: 300, aabb, motion: Vec3::ZERO, spin: 0.0, mode: Continuous::Segment };
        broad.refresh(&[mover], 0.1);
        broad
    }

    #[test]
    fn a_path_finds_all_on_it_or_only_statics() {
        let broad = scene();
        let look_up = |whom| {
            let mut found = Vec::new();
            let ends = (Vec3::new(-5.0, 0.0, 0.0), Vec3::new(1005.0, 0.0, 0.0));
            broad.on_path(&mut Vec::new(), whom, ends, Vec3::splat(0.4), |c| {
                found.push(c);
                1.0
            });
            found.sort_unstable();
            found
        };
        let statics: Vec<u32> = (0..100).step_by(7).chain([200]).collect();
        assert_eq!(look_up(SearchSet::Statics), statics);
        assert_eq!(look_up(SearchSet::All), [statics, vec![300]].concat());
    }

    #[test]
    fn a_path_that_was_cut_finds_nothing_beyond() {
        let broad = scene();
        let ends = (Vec3::ZERO, Vec3::new(1000.0, 0.0, 0.0));
        let mut found = Vec::new();
        broad.on_path(&mut Vec::new(), SearchSet::All, ends, Vec3::ZERO, |c| {
            found.push(c);
            if c == 200 { 0.1 } else { 1.0 }
        });
        found.sort_unstable();
        assert_eq!(found, [0, 7, 200, 300]);
    }

    #[test]
    fn a_box_finds_what_is_in_it() {
        let broad = scene();
        let bounds = Aabb { min: Vec3::splat(-1.0), max: Vec3::new(12.0, 2.0, 1.0) };
        let mut found = Vec::new();
        broad.in_box(&mut Vec::new(), SearchSet::All, &bounds, |c| found.push(c));
        found.sort_unstable();
        assert_eq!(found, [0, 1, 200, 300]);
    }

    #[test]
    fn what_is_removed_after_a_refresh_takes_its_pairs_along() {
        let mut broad = scene();
        let order = |i: u32, j: u32| (i, j);
        let mover = |x: f32| Mover {
            collider: 300,
            aabb: Aabb { min: Vec3::new(x, 0.0, 0.0), max: Vec3::new(x + 1.0, 1.0, 1.0) },
            motion: Vec3::ZERO,
            spin: 0.0,
            mode: Continuous::Segment,
        };
        let mut removed = Vec::new();
        broad.update(&Workers::alone(), &[mover(0.0)], 0.1, &|_, _| true, &order, &mut removed);
        assert_eq!((broad.pairs.len(), removed.len()), (2, 0));
        broad.refresh(&[mover(5000.0)], 0.1);
        broad.remove(0, false, &mut removed);
        assert_eq!((broad.pairs.len(), removed.len()), (1, 1));
        broad.update(&Workers::alone(), &[mover(5000.0)], 0.1, &|_, _| true, &order, &mut removed);
        assert_eq!((broad.pairs.len(), removed.len()), (1, 1));
    }
}
