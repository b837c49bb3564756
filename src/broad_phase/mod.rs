//! Predicted motion in, pairs out.
//!
//! A *slow* mover keeps a fat box, and while it stays inside, it costs only that check; its pairs last as
//! long as fat boxes overlap. A *fast* one, which outruns its margin within the step, is swept: the tree
//! holds its box from start to end, and colliders that touch it are tested exactly, by the segment of
//! relative motion against the inflated box (`segment.rs`); so two fast ones aren't missed, nor do long boxes
//! that merely cross make pairs by the thousand. Static colliders are in a tree of their own; endless ones
//! (planes) are in a list.
//!
//! Same pairs in the same order with any number of threads: searches run in blocks, and blocks are merged in
//! order.

mod aabb;
mod bounds;
mod build;
mod bvh;
mod find;
mod look_up;
mod mover;
mod pairs;
mod proxy;
mod query_tree;
mod save;
mod segment;
mod stream;
#[cfg(test)]
mod tests;

pub(crate) use aabb::Aabb;
use aabb::LARGEST;
pub(crate) use bounds::aabb_of;

use crate::config::ContinuousMode;
use crate::memory::{Allowance, Buffer, Category, buffers, bytes_of};
use crate::threads::Workers;
pub(crate) use bvh::STACK;
use bvh::{NONE, Tree};
use find::{Block, Blocks, Change};
pub(crate) use find::{PairMemory, Rules};
use glam::Vec3;
pub(crate) use look_up::{Places, SearchSet};
pub(crate) use mover::Mover;
pub(crate) use pairs::Pair;
use pairs::PairTable;
use proxy::{Proxy, Role};
pub(crate) use query_tree::{QueryIndex, QueryTree, Sorts, WorldView};
pub(crate) use save::{Lists, PairLists, SavedBroad, tree_words};
use segment::Path;

/// Exports for `bench`, beside those for other stages.
#[cfg(feature = "internals")]
pub(crate) mod kernels {
    pub(crate) use super::bvh::{Node, Tree};
    pub(crate) use super::segment::Path;
}

/// Counts of one update.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct BroadStats {
    /// Movers that left their fat box, are fast, or are new.
    pub(crate) moved: u32,
    /// How many of them were swept.
    pub(crate) fast: u32,
    /// Pairs that began.
    pub(crate) added: u32,
    /// Pairs that ended.
    pub(crate) removed: u32,
    /// Trees that were built anew.
    pub(crate) built: u32,
    /// Pairs that there was no room for; they are looked for again in the next step.
    pub(crate) shed: u32,
}

/// How many colliders there are of each sort.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Population {
    /// The highest index of any, and one.
    pub(crate) slots: usize,
    pub(crate) moving: usize,
    pub(crate) still: usize,
    pub(crate) endless: usize,
}

/// Whether two colliders may collide at all: their filters, not of one body, not both static.
pub(crate) type MayCollide<'a> = &'a (dyn Fn(u32, u32) -> bool + Sync);
/// Which of two colliders is `a`.
pub(crate) type Order<'a> = &'a (dyn Fn(u32, u32) -> (u32, u32) + Sync);

/// Its bounds, the filter, or both may have changed since pairs were last looked up.
const MOVED: u8 = 1;
const FILTER: u8 = 2;

/// The broad phase: pairs of colliders that may touch.
#[derive(Debug, Default)]
pub(crate) struct BroadPhase {
    /// The pairs, in an order that depends only on the history of the world. The owner may write `contact`,
    /// nothing else.
    pub(crate) pairs: Vec<Pair>,
    table: PairTable,
    /// Pairs that were taken out and may come back.
    away: usize,
    /// By collider: its role here, its box in the tree, and its changes.
    roles: Vec<Role>,
    proxies: Vec<Proxy>,
    marks: Vec<u8>,
    /// Colliders whose mark is set, in order.
    changed: Vec<u32>,
    statics: Tree,
    movers: Tree,
    /// Colliders without bounds.
    unbounded: Vec<u32>,
    /// Colliders that wait for a place in their tree.
    new_statics: Vec<u32>,
    new_movers: Vec<u32>,
    /// The fast movers of this step.
    paths: Vec<Path>,
    /// For each 64 pairs: which end, and which become fast or slow.
    changes: Vec<Change>,
    blocks: Blocks,
    block: Block,
    /// Colliders that move and that don't, endless ones included.
    counts: Population,
    /// Set while boxes are newer than pairs, or than some of them.
    refreshed: bool,
    /// Goes up when the tree of static colliders changes.
    statics_changes: u64,
    /// In which order blocks run, where a test wants to choose.
    #[cfg(test)]
    shuffle: Option<fn(usize) -> Vec<usize>>,
}

buffers! {
    BroadPhase {
        /// For so many colliders; without swept paths.
        each(n: Population) {
            roles(n.slots),
            proxies(n.slots),
            marks(n.slots),
            changed(n.slots),
            unbounded(n.endless),
            new_statics(n.still),
            new_movers(n.moving),
            blocks(n.slots.div_ceil(find::BLOCK)),
            statics(n.still),
            movers(n.moving),
        }
        missing(pairs: usize) { pairs(pairs), table(pairs), changes(find::words_of(pairs)) }
        bytes { block }
    }
}

impl BroadPhase {
    /// Adds a collider that doesn't move. Its tree is only made with the next update or search, for all at
    /// once.
    pub(crate) fn insert_static(&mut self, collider: u32, aabb: Aabb) {
        let bounded = aabb.is_bounded();
        self.counts.still += 1;
        let role = if bounded { Role::Static } else { Role::Endless };
        self.grow(collider, role, aabb);
        let list = if bounded { &mut self.new_statics } else { &mut self.unbounded };
        list.push(collider);
        if !bounded {
            self.proxies[collider as usize].path = look_up::ENDLESS_STATIC;
            self.mark(collider, MOVED);
        }
    }

    /// Adds a collider that may move; it is found from the first update on that lists it.
    pub(crate) fn insert_mover(&mut self, collider: u32) {
        self.counts.moving += 1;
        self.grow(collider, Role::New, Aabb::EMPTY);
    }

    /// Releases the lists of look-ups between steps.
    pub(crate) fn release_look_ups(&mut self) {
        self.block = Block::default();
    }

    /// Takes a collider out. Its pairs go to `removed`: the owner frees their contacts.
    pub(crate) fn remove(&mut self, collider: u32, removed: &mut Vec<Pair>) {
        let c = collider as usize;
        let Some(&role) = self.roles.get(c) else { return };
        let mut block = std::mem::take(&mut self.block);
        if role >= Role::Static && !self.refreshed {
            // All partners' boxes touch its box, so the trees lead to its pairs: also of two that don't move,
            // which may have been a pair up to now, and of one that doesn't with an endless one that does.
            self.partners(collider, None, true, &mut block);
        } else {
            let others = self.pairs.iter().filter(|p| p.a == collider || p.b == collider);
            block.partners.clear();
            block.partners.extend(others.map(|p| if p.a == collider { p.b } else { p.a }));
        }
        for &other in &block.partners {
            if let Some(place) = self.table.find(&self.pairs, collider, other) {
                removed.push(self.table.swap_remove(&mut self.pairs, place));
            }
        }
        self.block = block;
        let Proxy { place, path, .. } = self.proxies[c];
        match role {
            Role::Absent => {}
            Role::Static => self.counts.still -= 1,
            Role::Endless if path == look_up::ENDLESS_STATIC => self.counts.still -= 1,
            _ => self.counts.moving -= 1,
        }
        match role {
            Role::Static if place != NONE => self.statics.remove(place),
            Role::Slow | Role::Fast | Role::Volume if place != NONE => self.movers.remove(place),
            Role::Endless => self.unbounded.retain(|&u| u != collider),
            _ => {}
        }
        self.proxies[c] = Proxy::NONE;
        self.roles[c] = Role::Absent;
    }

    /// Says that a collider's filter changed: its pairs are looked up again in the next update.
    pub(crate) fn touch(&mut self, collider: u32) {
        if self.roles.get(collider as usize).is_some_and(|&role| role != Role::Absent) {
            self.mark(collider, MOVED | FILTER);
        }
    }

    /// Takes pairs out of the list: `leaves` says which, and whether they will be put back.
    pub(crate) fn take_pairs(&mut self, mut leaves: impl FnMut(&Pair) -> Option<bool>) {
        // From the end: the entry that moves to a freed place is one that stays.
        for place in (0..self.pairs.len()).rev() {
            if let Some(comes_back) = leaves(&self.pairs[place]) {
                self.table.swap_remove(&mut self.pairs, place);
                self.away += usize::from(comes_back);
            }
        }
    }

    /// Puts a pair back that was taken out.
    pub(crate) fn put_back(&mut self, pair: Pair) {
        self.away -= 1;
        // Trees that lack a static don't lead to this pair.
        self.refreshed |= !self.new_statics.is_empty();
        self.table.push(&mut self.pairs, Pair { apart: 0, ..pair });
    }

    /// Has the pairs of a mover looked up in the next update.
    pub(crate) fn look_again(&mut self, collider: u32) {
        if self.roles[collider as usize] >= Role::Slow {
            self.mark(collider, MOVED);
        }
    }

    /// Finds the pairs of a step.
    #[cfg(test)]
    pub(crate) fn update(
        &mut self,
        workers: &Workers,
        movers: &[Mover],
        margin: f32,
        may_collide: MayCollide,
        order: Order,
        removed: &mut Vec<Pair>,
    ) -> BroadStats {
        let rules = Rules { may_collide, order, missing: &|_| 0, still: false };
        self.start_movers();
        self.place_movers(movers, margin);
        let allowances = &mut crate::memory::Allowances::ENDLESS.clone();
        self.update_within(workers, &rules, removed, &mut PairMemory { allowances, give_up: &mut |_| 0 })
    }

    /// Finds the pairs of a step once its movers are placed (see [`BroadPhase::start_movers`]), as far as
    /// there is room for them: pairs of movers among themselves are the first to be left out. Pairs that end
    /// go to `removed`, in an order that doesn't depend on threads.
    pub(crate) fn update_within(
        &mut self,
        workers: &Workers,
        rules: &Rules,
        removed: &mut Vec<Pair>,
        memory: &mut PairMemory<'_>,
    ) -> BroadStats {
        let built = self.fit_trees(rules.still);
        let (moved, fast) = (self.changed.len() as u32, self.paths.len() as u32);
        let mut stats = BroadStats { moved, fast, built, ..BroadStats::default() };
        self.refreshed = false;
        if moved == 0 {
            return stats;
        }
        let before = removed.len();
        let late = memory.allowances.within(Category::BroadPhase, |allowance| {
            self.keep_pairs(workers, rules.may_collide, removed, allowance)
        });
        stats.removed = (removed.len() - before) as u32;
        (stats.added, stats.shed) = self.find_pairs(workers, rules, memory);
        stats.shed += late;
        // Boxes don't lead to the pairs that are late.
        self.refreshed = late > 0;
        if stats.shed > 0 {
            // All that were looked for now are looked for again.
            return stats;
        }
        for c in self.changed.drain(..) {
            self.marks[c as usize] = 0;
        }
        stats
    }

    /// Makes boxes and trees fit without a look at pairs; the next update does the rest.
    #[cfg(test)]
    fn refresh(&mut self, movers: &[Mover], margin: f32) {
        self.start_movers();
        self.place_movers(movers, margin);
        self.fit_trees(false);
    }

    /// Makes the trees fit the boxes; returns how many were built anew.
    fn fit_trees(&mut self, still: bool) -> u32 {
        let built = self.fit_movers() + self.fit_statics(still);
        self.refreshed = !self.changed.is_empty();
        built
    }

    /// Begins a step, whose movers come next, in as many goes as one likes.
    pub(crate) fn start_movers(&mut self) {
        // Last step's fast movers keep their swept box as a fat one should they fall asleep on the way.
        let mut paths = std::mem::take(&mut self.paths);
        for path in paths.drain(..) {
            let c = path.collider as usize;
            if self.roles[c] >= Role::Fast {
                self.roles[c] = Role::Slow;
                self.mark(path.collider, MOVED);
            }
        }
        self.paths = paths;
    }

    /// Gives every mover that needs one a new box: the swept one if it is fast, else a fat one that is at
    /// most `margin` wider on each side [m]. One that isn't listed stays where it is (asleep).
    pub(crate) fn place_movers(&mut self, movers: &[Mover], margin: f32) {
        for mover in movers {
            let c = mover.collider as usize;
            let same = self.roles[c] == Role::Slow && self.marks[c] == 0;
            if !(same && proxy::rests(mover, margin, &self.proxies[c].bounds)) {
                let (margin, fast) = proxy::margin_of(mover, margin);
                self.place_mover(mover, margin, fast);
            }
        }
    }

    fn place_mover(&mut self, mover: &Mover, margin: f32, fast: bool) {
        let c = mover.collider as usize;
        if matches!(self.roles[c], Role::Absent | Role::Static) {
            debug_assert!(false, "collider {c} is no mover");
            return;
        }
        let endless = !mover.aabb.is_bounded();
        if endless && self.roles[c] == Role::Endless && self.proxies[c].bounds == mover.aabb {
            return;
        }
        self.mark(mover.collider, MOVED);
        if endless != (self.roles[c] == Role::Endless) {
            if endless {
                if self.proxies[c].place != NONE {
                    self.movers.remove(self.proxies[c].place);
                    self.proxies[c].place = NONE;
                }
                self.unbounded.push(mover.collider);
            } else {
                self.unbounded.retain(|&u| u != mover.collider);
            }
        }
        let proxy = &mut self.proxies[c];
        if endless {
            self.roles[c] = Role::Endless;
            proxy.bounds = mover.aabb;
            proxy.path = NONE;
            return;
        }
        if fast {
            self.roles[c] = if mover.mode == ContinuousMode::Volume { Role::Volume } else { Role::Fast };
            let mover = proxy::tamed(mover);
            proxy.bounds = proxy::swept_box(&mover, margin);
            proxy.path = self.paths.len() as u32;
            // Under a budget there is place for all.
            let mut allowance = Allowance::ENDLESS;
            allowance.push_within(&mut self.paths, Path::new(&mover, margin), self.counts.moving);
        } else {
            self.roles[c] = Role::Slow;
            proxy.bounds = proxy::fat_box(mover, margin);
        }
        if proxy.place == NONE {
            self.new_movers.push(mover.collider);
        }
    }

    /// Makes the movers' tree fit their boxes; returns how often it was built anew.
    fn fit_movers(&mut self) -> u32 {
        let BroadPhase { movers, proxies, roles, new_movers, changed, .. } = self;
        let moved = changed.iter().filter_map(|&c| {
            let proxy = &proxies[c as usize];
            let in_tree = roles[c as usize] >= Role::Slow && proxy.place != NONE;
            in_tree.then_some((proxy.place, proxy.bounds))
        });
        let bad = movers.refit(moved);
        if !bad && new_movers.is_empty() {
            return 0;
        }
        Self::add_leaves(movers, proxies, new_movers, bad)
    }

    /// Puts new static colliders into their tree; returns how often it was built anew. `still`: they look for
    /// each other too.
    fn fit_statics(&mut self, still: bool) -> u32 {
        // Each new static looks for movers, or, where they are many, each mover for statics.
        let few = self.new_statics.len() * 4 <= self.movers.leaves();
        let endless = self.unbounded.iter().any(|&u| self.marks[u as usize] != 0);
        let mut all = endless;
        let built = self.build_statics(|broad, c| {
            if few || still {
                broad.mark(c, MOVED);
            }
            all |= !few;
        });
        let BroadPhase { movers, statics, marks, changed, .. } = self;
        let mut look = |c: u32| {
            if marks[c as usize] == 0 {
                marks[c as usize] = MOVED;
                changed.push(c);
            }
        };
        if all {
            movers.for_each(&mut look);
        }
        if endless && still {
            statics.for_each(look);
        }
        built
    }

    fn build_statics(&mut self, mut each: impl FnMut(&mut Self, u32)) -> u32 {
        if self.new_statics.is_empty() {
            return 0;
        }
        self.statics_changes += 1;
        let mut new = std::mem::take(&mut self.new_statics);
        // Colliders that were removed meanwhile, or removed and added again.
        new.sort_unstable();
        new.dedup();
        new.retain(|&c| self.roles[c as usize] == Role::Static && self.proxies[c as usize].place == NONE);
        for &c in &new {
            each(self, c);
        }
        let built = Self::add_leaves(&mut self.statics, &mut self.proxies, &mut new, false);
        self.new_statics = new;
        built
    }

    fn add_leaves(tree: &mut Tree, proxies: &mut [Proxy], new: &mut Vec<u32>, bad: bool) -> u32 {
        let (bounds, place) = Proxy::boxes_and_places(proxies);
        let built = if bad {
            tree.rebuild(new, bounds, place);
            true
        } else {
            tree.add(new, bounds, place)
        };
        new.clear();
        u32::from(built)
    }

    /// Makes place for a collider that is not there.
    pub(crate) fn leave_place(&mut self, collider: u32) {
        let c = collider as usize;
        if c >= self.roles.len() {
            let mut allowance = Allowance::ENDLESS;
            allowance.fit(&mut self.roles, c + 1);
            allowance.fit(&mut self.proxies, c + 1);
            allowance.fit(&mut self.marks, c + 1);
            self.roles.resize(c + 1, Role::Absent);
            self.proxies.resize(c + 1, Proxy::NONE);
            self.marks.resize(c + 1, 0);
        }
    }

    fn grow(&mut self, collider: u32, role: Role, bounds: Aabb) {
        self.leave_place(collider);
        let c = collider as usize;
        debug_assert!(self.roles[c] == Role::Absent, "collider {c} is there already");
        self.roles[c] = role;
        self.proxies[c] = Proxy { bounds, ..Proxy::NONE };
    }

    fn mark(&mut self, collider: u32, mark: u8) {
        let old = &mut self.marks[collider as usize];
        if *old == 0 {
            self.changed.push(collider);
        }
        *old |= mark;
    }

    /// The box that is kept of a collider, if it has one.
    pub(crate) fn kept_bounds(&self, collider: u32) -> Option<Aabb> {
        let role = *self.roles.get(collider as usize)?;
        (role >= Role::Static).then(|| self.proxies[collider as usize].bounds)
    }

    /// The colliders that were swept in the last step, and their predicted motion [m].
    pub(crate) fn swept(&self) -> impl Iterator<Item = (u32, Vec3)> + '_ {
        let swept = self.paths.iter().map(|path| (path.collider, path.motion()));
        swept.filter(|(c, _)| self.roles.get(*c as usize).is_some_and(|role| *role >= Role::Fast))
    }

    /// How many colliders there are.
    pub(crate) fn population(&self) -> Population {
        Population { slots: self.roles.len(), endless: self.unbounded.len(), ..self.counts }
    }

    /// Makes place for them.
    pub(crate) fn reserve_total(&mut self, pairs: usize) {
        self.pairs.reserve_total(pairs);
        self.changes.reserve_total(find::words_of(pairs));
        self.table.reserve_total(&self.pairs, pairs);
    }

    /// Bytes that blocks take to find so many pairs in one step: each has the place of the one that found
    /// most.
    pub(crate) fn missing_to_find(pairs: usize) -> usize {
        pairs * size_of::<(u32, u32)>() * 6 / 5
    }

    /// The buffer of swept paths.
    pub(crate) fn paths(&mut self) -> &mut dyn Buffer {
        &mut self.paths
    }

    /// Nothing is swept any more.
    pub(crate) fn release_paths(&mut self) {
        if self.paths.is_empty() {
            self.paths = Vec::new();
        }
    }

    /// Live and reserved bytes of motion segments, which only continuous collision needs.
    pub(crate) fn continuous_bytes(&self) -> (usize, usize) {
        bytes_of(&self.paths)
    }
}
