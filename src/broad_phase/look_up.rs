//! Look-ups from outside the step: colliders in a box, colliders on a path.
//!
//! They read the trees as the last update left them. After a step movers may be outside their boxes, because
//! the solver changed the predicted motion.

use super::{Aabb, BroadPhase, Path, Role};
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, f32x4};
use crate::shape::boxes_meet;
use glam::Vec3;

/// The colliders that a look-up searches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SearchSet {
    All,
    /// Only colliders inserted as static.
    Statics,
}

/// Most pairs that [`BroadPhase::places_of`] finds without a search of the list.
const MOST_PLACES: usize = 96;
/// Colliders that are looked at for each so many pairs of the list before it is searched instead: a look is a
/// search of the hash table, and costs as much as a few entries of the list (tests/world/reading.rs).
const PAIRS_A_LOOK: usize = 4;

/// Places in the list of pairs, in ascending order.
pub(crate) struct Places {
    places: [u32; MOST_PLACES],
    count: usize,
}

impl Places {
    pub(crate) fn into_iter(self) -> impl Iterator<Item = usize> {
        let Places { places, count } = self;
        (0..count).map(move |i| places[i] as usize)
    }
}

impl BroadPhase {
    /// Where the pairs with contacts of some colliders are in the list. None: they are many, or have no
    /// bounds, so a search of the list is as good. By the trees and the table of pairs: nothing is kept for
    /// it.
    pub(crate) fn places_of(&self, colliders: &[u32]) -> Option<Places> {
        let mut found = Places { places: [0; MOST_PLACES], count: 0 };
        let mut left = self.pairs.len() / PAIRS_A_LOOK;
        // Boxes that are newer than pairs don't lead to them.
        let fits = !self.refreshed && colliders.iter().all(|&c| self.add_places(c, &mut left, &mut found));
        if !fits {
            return None;
        }
        let places = &mut found.places[..found.count];
        places.sort_unstable();
        // A pair of two of them is found twice.
        let mut kept = 0;
        for i in 0..places.len() {
            if i == 0 || places[i] != places[kept - 1] {
                places[kept] = places[i];
                kept += 1;
            }
        }
        found.count = kept;
        Some(found)
    }

    /// Adds those of one collider; says no if that takes more than `left` looks or places.
    fn add_places(&self, collider: u32, left: &mut usize, found: &mut Places) -> bool {
        let role = self.roles[collider as usize];
        match role {
            Role::Endless => return false,
            Role::Absent | Role::New => return true,
            _ => {}
        }
        // A key above the limit is passed over, so a negative limit ends the walk.
        let (go_on, stop) = (0.0, -1.0);
        let mut look = |other: u32, _: f32| {
            let place = self.table.find(&self.pairs, collider, other);
            let place = place.filter(|&place| self.pairs[place].contact != u32::MAX);
            if *left == 0 || (place.is_some() && found.count == MOST_PLACES) {
                *left = 0;
                return stop;
            }
            *left -= 1;
            if let Some(place) = place {
                found.places[found.count] = place as u32;
                found.count += 1;
            }
            go_on
        };
        let bounds = &self.proxies[collider as usize].bounds;
        let own = (LaneVec3::splat(bounds.min), LaneVec3::splat(bounds.max));
        let key = |low: &LaneVec3<f32x4>, high: &LaneVec3<f32x4>, _: f32| {
            Lanes::select(boxes_meet((*low, *high), own), f32x4::splat(0.0), f32x4::splat(1.0))
        };
        let mut most = go_on;
        if role != Role::Static {
            for &other in &self.unbounded {
                most = look(other, most).min(most);
            }
            if most == go_on {
                most = self.statics.visit_keys(&key, most, &mut look);
            }
        }
        if most == go_on {
            most = self.movers.visit_keys(&key, most, &mut look);
        }
        most == go_on
    }

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

    /// Calls `f` with every static collider whose box is touched by a box (`extent`: half extents) that moves
    /// straight from one point to another. Planes come first, then in no order along the path.
    pub(crate) fn statics_on_path(
        &self,
        stack: &mut Vec<u32>,
        from: Vec3,
        to: Vec3,
        extent: Vec3,
        mut f: impl FnMut(u32),
    ) {
        self.unbounded_of(SearchSet::Statics).for_each(|&c| f(c));
        let path = Path::between(from, to, extent).lanes::<f32x4>();
        self.statics.visit(stack, |node: &super::bvh::Node| path.hits(node.min, node.max).bits(), f);
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
    use crate::config::ContinuousMode;
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
        let mover =
            Mover { collider: 300, aabb, motion: Vec3::ZERO, spin: 0.0, mode: ContinuousMode::Segment };
        broad.refresh(&[mover], 0.1);
        broad
    }

    #[test]
    fn a_path_finds_the_statics_on_it() {
        let (from, to) = (Vec3::new(-5.0, 0.0, 0.0), Vec3::new(1005.0, 0.0, 0.0));
        let mut found = Vec::new();
        scene().statics_on_path(&mut Vec::new(), from, to, Vec3::splat(0.4), |c| found.push(c));
        found.sort_unstable();
        assert_eq!(found, (0..100).step_by(7).chain([200]).collect::<Vec<u32>>());
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
            mode: ContinuousMode::Segment,
        };
        let mut removed = Vec::new();
        broad.update(&Workers::alone(), &[mover(0.0)], 0.1, &|_, _| true, &order, &mut removed);
        assert_eq!((broad.pairs.len(), removed.len()), (2, 0));
        broad.refresh(&[mover(5000.0)], 0.1);
        broad.remove(0, &mut removed);
        assert_eq!((broad.pairs.len(), removed.len()), (1, 1));
        broad.update(&Workers::alone(), &[mover(5000.0)], 0.1, &|_, _| true, &order, &mut removed);
        assert_eq!((broad.pairs.len(), removed.len()), (1, 1));
    }
}
