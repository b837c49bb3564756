//! Where everything that moves is now, for queries between steps.
//!
//! The trees of the step are no help to them: a step moves bodies after its trees were made, boxes there are
//! fat or swept, and colliders that were added or moved by hand wait for the next step. So queries have a
//! tree of their own over tight boxes: of movable colliders, and of static colliders that have no place in
//! the static tree yet. It is made by the first query after a change and costs nothing without queries: about
//! 70 ns for each collider that can move after a step (benches/queries.rs), and the way of one leaf for each
//! that was added, moved or removed by hand.

use super::bvh::{NONE, Tree};
use super::{Aabb, BroadPhase, Population, look_up};
use crate::body::IDLE;
use crate::error::Error;
use crate::lanes::{Vec3, f32x4};
use crate::memory::{Buffer, buffers};
use crate::shape::{Near, Slabs};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// The view of the world that the tree needs.
pub(crate) trait WorldView {
    /// Calls `f` with every collider that can move.
    fn each_mover(&self, f: &mut dyn FnMut(u32));
    /// Whether a collider is there and can move, or is there and static; nothing if it isn't there.
    fn moves(&self, collider: u32) -> Option<bool>;
    /// Its box at its body's pose.
    fn bounds(&self, collider: u32) -> Aabb;
}

/// See the module.
#[derive(Debug, Default)]
pub(crate) struct QueryTree {
    pub(super) tree: Tree,
    /// By collider: the place in the tree, and the box there.
    place: Vec<u32>,
    bounds: Vec<Aabb>,
    /// Movable colliders without bounds.
    endless: Vec<u32>,
    /// Static ones that are in this tree for the time being.
    pub(super) late: Vec<u32>,
    /// Colliders that were added, moved or removed by hand.
    touched: Vec<u32>,
    /// Everything that can move may have.
    stepped: bool,
    /// Whether anybody asked.
    made: bool,
    /// Steps since somebody did.
    unasked: u32,
    new: Vec<u32>,
}

buffers! {
    QueryTree {
        /// For so many colliders, and `late` static ones that wait for their place in the static tree.
        each(n: Population, late: usize) {
            tree(n.moving + late),
            place(n.slots),
            bounds(n.slots),
            endless(n.endless),
            late(late),
            touched(2 * n.slots),
            new(n.moving + late),
        }
    }
}

impl QueryTree {
    /// A collider was added, moved or removed.
    pub(crate) fn touch(&mut self, collider: u32) {
        if self.touched.len() == self.touched.capacity() {
            // Without queries for long, the same are touched over and over.
            self.sort_touched();
            if 2 * self.touched.len() > self.touched.capacity() {
                self.touched.reserve(self.touched.capacity().max(4));
            }
        }
        self.touched.push(collider);
    }

    fn sort_touched(&mut self) {
        self.touched.sort_unstable();
        self.touched.dedup();
    }

    /// Any of so many colliders, or of those that were there before, may be another, elsewhere or gone.
    pub(crate) fn touch_all(&mut self, colliders: usize) {
        self.touched.clear();
        self.touched.extend(0..colliders.max(self.place.len()) as u32);
    }

    /// All that can move may have moved.
    fn step(&mut self) {
        self.stepped = true;
        self.unasked = self.unasked.saturating_add(1);
    }

    /// Makes it fit the world.
    fn refresh(&mut self, broad: &BroadPhase, world: &impl WorldView) {
        self.unasked = 0;
        if !self.made {
            // Colliders that are added from now on are reported.
            self.touched.clear();
            world.each_mover(&mut |c| self.touched.push(c));
            self.touched.extend(broad.waiting());
            self.made = true;
            self.stepped = false;
        }
        if self.stepped {
            self.sort_touched();
            self.follow(world);
            self.touched.append(&mut self.late);
        }
        self.sort_touched();
        let touched = std::mem::take(&mut self.touched);
        self.endless.retain(|c| touched.binary_search(c).is_err());
        self.late.retain(|c| touched.binary_search(c).is_err());
        for &c in &touched {
            self.grow(c);
            if self.place[c as usize] != NONE {
                self.tree.remove(self.place[c as usize]);
                self.place[c as usize] = NONE;
            }
            match world.moves(c) {
                Some(true) => self.enter(c, world.bounds(c)),
                Some(false) if broad.waits(c) => {
                    self.late.push(c);
                    self.enter(c, world.bounds(c));
                }
                _ => {}
            }
        }
        self.touched = touched;
        self.touched.clear();
        self.add_new(false);
    }

    /// All that can move is where it is now.
    fn follow(&mut self, world: &impl WorldView) {
        self.stepped = false;
        self.endless.clear();
        let mut moved = std::mem::take(&mut self.new);
        world.each_mover(&mut |c| moved.push(c));
        let mut wait = std::mem::take(&mut self.touched);
        moved.retain(|&c| {
            self.grow(c);
            let bounds = world.bounds(c);
            self.bounds[c as usize] = bounds;
            let stays = self.place[c as usize] != NONE && bounds.is_bounded();
            if !stays {
                wait.push(c);
            }
            stays
        });
        self.touched = wait;
        let at = moved.iter().map(|&c| (self.place[c as usize], self.bounds[c as usize]));
        let bad = self.tree.refit(at);
        moved.clear();
        self.new = moved;
        if bad {
            self.add_new(true);
        }
    }

    fn grow(&mut self, c: u32) {
        if c as usize >= self.place.len() {
            self.place.resize(c as usize + 1, NONE);
            self.bounds.resize(c as usize + 1, Aabb::EMPTY);
        }
    }

    fn enter(&mut self, c: u32, bounds: Aabb) {
        self.bounds[c as usize] = bounds;
        let list = if bounds.is_bounded() { &mut self.new } else { &mut self.endless };
        list.push(c);
    }

    fn add_new(&mut self, bad: bool) {
        let QueryTree { tree, place, bounds, new, .. } = self;
        let bounds = |c: u32| bounds[c as usize];
        let place = |c: u32, at: u32| place[c as usize] = at;
        if bad {
            tree.rebuild(new, bounds, place);
        } else if !new.is_empty() {
            tree.add(new, bounds, place);
        }
        new.clear();
    }

    /// Calls `f` with each buffer and the place that it needs to be made anew.
    fn each_wanted(&mut self, broad: &BroadPhase, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        self.each(broad.population(), broad.waiting().count(), f);
    }

    /// Bytes that it lacks to be made anew.
    fn lacking(&mut self, broad: &BroadPhase) -> usize {
        let mut bytes = 0;
        self.each_wanted(broad, &mut |buffer, len| bytes += buffer.missing(len));
        bytes
    }
}

/// A [`QueryTree`] that is made on demand, once, also if several threads ask.
#[derive(Debug, Default)]
pub(crate) struct QueryIndex {
    fresh: OnceLock<QueryTree>,
    /// The last one, while it isn't fresh: its memory, and the changes since.
    stale: Mutex<QueryTree>,
}

impl QueryIndex {
    /// Something is about to change. None: there was no query yet, so there is nothing to be told.
    pub(crate) fn change(&mut self) -> Option<&mut QueryTree> {
        let stale = self.stale.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Some(current) = self.fresh.take() {
            *stale = current;
        }
        stale.made.then_some(stale)
    }

    /// All that can move may have moved. After some steps without queries it is dropped, if it may.
    pub(crate) fn step(&mut self, may_go: bool) {
        if let Some(current) = self.change() {
            current.step();
            if may_go && current.unasked > IDLE {
                *current = QueryTree::default();
            }
        }
    }

    /// Whether somebody asked, lately.
    pub(crate) fn is_kept(&self) -> bool {
        self.fresh.get().map_or_else(|| self.stale().made, |current| current.made)
    }

    /// Whether it was asked since the last change.
    #[cfg(feature = "replay")]
    pub(crate) fn is_fresh(&self) -> bool {
        self.fresh.get().is_some()
    }

    /// As the world is now. `grant`: whether so many bytes may be taken that it lacks, asked if there is a
    /// budget.
    ///
    /// # Errors
    /// If they may not.
    #[inline]
    pub(crate) fn get(
        &self,
        broad: &BroadPhase,
        world: &impl WorldView,
        grant: Option<&dyn Fn(usize) -> Result<(), Error>>,
    ) -> Result<&QueryTree, Error> {
        match self.fresh.get() {
            Some(current) => Ok(current),
            None => self.make(broad, world, grant),
        }
    }

    #[cold]
    fn make(
        &self,
        broad: &BroadPhase,
        world: &impl WorldView,
        grant: Option<&dyn Fn(usize) -> Result<(), Error>>,
    ) -> Result<&QueryTree, Error> {
        if let Some(grant) = grant {
            // Not under the lock: a count of held memory includes this too.
            let lacking = self.stale().lacking(broad);
            if lacking > 0 {
                grant(lacking)?;
            }
        }
        let mut stale = self.stale();
        Ok(self.fresh.get_or_init(|| {
            let mut current = std::mem::take(&mut *stale);
            if grant.is_some() {
                current.each_wanted(broad, &mut |buffer, len| buffer.reserve_total(len));
            }
            current.refresh(broad, world);
            current
        }))
    }

    fn stale(&self) -> MutexGuard<'_, QueryTree> {
        self.stale.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Calls `f` with each buffer that has an entry for each collider, and the place that it needs, once
    /// somebody asked.
    pub(crate) fn each(&mut self, n: Population, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        // It stays as fresh as it is.
        let current = match self.fresh.get_mut() {
            Some(current) => current,
            None => self.stale.get_mut().unwrap_or_else(PoisonError::into_inner),
        };
        if current.made {
            current.each(n, 0, f);
        }
    }

    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        // It may be made just now.
        let made = || {
            let stale = self.stale();
            self.fresh.get().map_or_else(|| stale.bytes(), QueryTree::bytes)
        };
        self.fresh.get().map_or_else(made, QueryTree::bytes)
    }
}

/// Which trees a query looks into.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sorts {
    pub(crate) statics: bool,
    pub(crate) movers: bool,
}

impl BroadPhase {
    /// Calls `leaf(collider, most)` with every collider whose box the path of a box meets before the fraction
    /// `most`, about the nearest first after colliders without bounds; it returns the new `most`.
    #[inline(always)]
    pub(crate) fn ordered_path(
        &self,
        current: &QueryTree,
        sorts: Sorts,
        slabs: &Slabs<f32x4>,
        mut most: f32,
        mut leaf: impl FnMut(u32, f32) -> f32,
    ) {
        self.endless(current, sorts, |c| most = leaf(c, most));
        let key = |min: &Vec3<f32x4>, max: &Vec3<f32x4>, most: f32| slabs.enter(min, max, most);
        self.ordered(current, sorts, &key, most, &mut leaf);
    }

    /// The same for a point: keys are squared distances [m²].
    pub(crate) fn ordered_near(
        &self,
        current: &QueryTree,
        sorts: Sorts,
        near: &Near<f32x4>,
        mut most: f32,
        mut leaf: impl FnMut(u32, f32) -> f32,
    ) {
        self.endless(current, sorts, |c| most = leaf(c, most));
        let key = |min: &Vec3<f32x4>, max: &Vec3<f32x4>, _most: f32| near.squared(min, max);
        self.ordered(current, sorts, &key, most, &mut leaf);
    }

    /// Calls `f` with colliders without bounds.
    #[inline(always)]
    pub(super) fn endless(&self, current: &QueryTree, sorts: Sorts, mut f: impl FnMut(u32)) {
        if sorts.statics {
            for &c in &self.unbounded {
                if self.proxies[c as usize].path == look_up::ENDLESS_STATIC {
                    f(c);
                }
            }
        }
        if sorts.movers {
            current.endless.iter().for_each(|&c| f(c));
        }
    }

    #[inline(always)]
    fn ordered(
        &self,
        current: &QueryTree,
        sorts: Sorts,
        key: &impl Fn(&Vec3<f32x4>, &Vec3<f32x4>, f32) -> f32x4,
        mut most: f32,
        leaf: &mut impl FnMut(u32, f32) -> f32,
    ) {
        if sorts.statics {
            most = self.statics.visit_keys(key, most, leaf);
        }
        if sorts.movers || !current.late.is_empty() {
            current.tree.visit_keys(key, most, leaf);
        }
    }

    /// Static colliders that wait for their place in the static tree; some may have been removed since.
    fn waiting(&self) -> impl Iterator<Item = u32> + '_ {
        self.new_statics.iter().copied().filter(|&c| self.waits(c))
    }

    fn waits(&self, c: u32) -> bool {
        self.roles[c as usize] == super::Role::Static && self.proxies[c as usize].place == NONE
    }
}
