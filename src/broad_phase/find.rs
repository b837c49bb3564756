//! Which pairs end and which begin, in blocks that any thread may work on.

use super::bvh::Tree;
use super::{BroadPhase, FILTER, MayCollide, NONE, Order, Pair, Path, Role};
use crate::lanes::{Mask, f32x4};
use crate::memory::bytes_of;
use crate::threads::Crew;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Movers in a block: about 10 µs of work, ten times what claiming a block costs.
const BLOCK: usize = 64;

/// Pairs in a block that looks whether they last.
const KEEP_BLOCK: usize = 1024;

/// What a block finds, and the stack of its walks; kept from step to step.
#[derive(Debug, Default)]
pub(super) struct Block {
    found: Vec<Pair>,
    /// Places of pairs that end, upwards, and of those that become fast or slow.
    ended: Vec<u32>,
    turned: Vec<u32>,
    stack: Vec<u32>,
    pub(super) partners: Vec<u32>,
}

impl Block {
    pub(super) fn bytes(&self) -> (usize, usize) {
        let columns = [
            bytes_of(&self.found),
            bytes_of(&self.ended),
            bytes_of(&self.turned),
            bytes_of(&self.stack),
            bytes_of(&self.partners),
        ];
        columns.iter().fold((0, 0), |sum, b| (sum.0 + b.0, sum.1 + b.1))
    }
}

/// A block is only a buffer that is cleared before use: what a panicking thread left in it does no harm.
pub(super) fn lock(block: &Mutex<Block>) -> MutexGuard<'_, Block> {
    block.lock().unwrap_or_else(PoisonError::into_inner)
}

impl BroadPhase {
    /// Drops the pairs that may no longer touch.
    pub(super) fn keep_pairs(&mut self, crew: &Crew, may_collide: MayCollide, removed: &mut Vec<Pair>) {
        let count = self.pairs.len().div_ceil(KEEP_BLOCK);
        self.grow_blocks(count);
        let this = &*self;
        this.run(crew, count, &|b| {
            let block = &mut *lock(&this.blocks[b]);
            block.ended.clear();
            block.turned.clear();
            let end = this.pairs.len().min((b + 1) * KEEP_BLOCK);
            for place in b * KEEP_BLOCK..end {
                let Pair { a, b, fast, .. } = this.pairs[place];
                let marks = this.marks[a as usize] | this.marks[b as usize];
                if marks == 0 {
                    continue;
                }
                if !this.may_touch(a, b) || (marks & FILTER != 0 && !may_collide(a, b)) {
                    block.ended.push(place as u32);
                } else if fast != this.is_fast(a, b) {
                    block.turned.push(place as u32);
                }
            }
        });
        for block in &self.blocks[..count] {
            for &place in &lock(block).turned {
                self.pairs[place as usize].fast ^= true;
            }
        }
        // From the end: what moves to a freed place is one that stays.
        for block in self.blocks[..count].iter().rev() {
            for &place in lock(block).ended.iter().rev() {
                removed.push(self.table.swap_remove(&mut self.pairs, place as usize));
            }
        }
    }

    /// Searches for the pairs of all that changed; returns how many are new.
    pub(super) fn find_pairs(&mut self, crew: &Crew, may_collide: MayCollide, order: Order) -> u32 {
        let count = self.changed.len().div_ceil(BLOCK);
        self.grow_blocks(count);
        let this = &*self;
        this.run(crew, count, &|b| {
            let block = &mut *lock(&this.blocks[b]);
            block.found.clear();
            let end = this.changed.len().min((b + 1) * BLOCK);
            for &c in &this.changed[b * BLOCK..end] {
                let path = this.path(c).filter(|_| this.roles[c as usize] == Role::Fast);
                this.partners(c, path, block);
                this.keep_reported(c, &mut block.partners);
                for &other in &block.partners {
                    // The table before the exact test: most that are found are pairs already, and were tested.
                    if this.table.find(&this.pairs, c, other).is_none()
                        && this.may_touch(c, other)
                        && may_collide(c, other)
                    {
                        let (a, b) = order(c, other);
                        block.found.push(Pair { a, b, contact: NONE, fast: this.is_fast(c, other) });
                    }
                }
            }
        });
        let before = self.pairs.len();
        for block in &self.blocks[..count] {
            for &pair in &lock(block).found {
                self.table.push(&mut self.pairs, pair);
            }
        }
        (self.pairs.len() - before) as u32
    }

    fn grow_blocks(&mut self, count: usize) {
        if self.blocks.len() < count {
            self.blocks.resize_with(count, Mutex::default);
        }
    }

    #[cfg(not(test))]
    fn run(&self, crew: &Crew, count: usize, work: &(dyn Fn(usize) + Sync)) {
        crew.run(count, work);
    }

    #[cfg(test)]
    fn run(&self, crew: &Crew, count: usize, work: &(dyn Fn(usize) + Sync)) {
        match self.shuffle.map(|shuffle| shuffle(count)) {
            Some(order) => crew.run(count, &|b| work(order[b])),
            None => crew.run(count, work),
        }
    }

    /// All whose boxes touch this one's (or are touched by the path, if there is one, within rounding), save what
    /// can't collide with it. An endless one finds nothing: the others find it.
    pub(super) fn partners(&self, collider: u32, path: Option<&Path>, block: &mut Block) {
        let Block { stack, partners, .. } = block;
        partners.clear();
        let bounds = &self.proxies[collider as usize].bounds;
        let role = self.roles[collider as usize];
        if matches!(role, Role::Absent | Role::New | Role::Endless) {
            return;
        }

        let mut search = |tree: &Tree| match path {
            None => tree.visit_box(stack, bounds, |c| partners.push(c)),
            Some(path) => {
                let lanes = path.lanes::<f32x4>();
                tree.visit(stack, |node| lanes.hits(node.min, node.max).bits(), |c| partners.push(c));
            }
        };
        if role != Role::Static {
            search(&self.statics);
        }
        search(&self.movers);
        if role != Role::Static {
            partners.extend(&self.unbounded);
        }
    }

    /// Of two that both search, who reports the pair: the higher reports, of equals the lower index. Whoever doesn't
    /// search has 0. The order of [`Role`] sees to the rest: a static one searches only for movers that don't, a path
    /// may miss what a swept box touches, and both look further than a fat box.
    #[inline]
    fn rank(&self, c: u32) -> u8 {
        self.roles[c as usize] as u8 * u8::from(self.marks[c as usize] != 0)
    }

    /// Leaves only the partners that this one reports.
    fn keep_reported(&self, c: u32, partners: &mut Vec<u32>) {
        let (rank, mut kept) = (self.rank(c), 0);
        // No branch: every other answer is no, in no order that could be predicted.
        for i in 0..partners.len() {
            let other = partners[i];
            partners[kept] = other;
            let theirs = self.rank(other);
            kept += usize::from((rank > theirs) | ((rank == theirs) & (c < other)));
        }
        partners.truncate(kept);
    }

    /// Whether two may touch within the step: the definition of a pair but for filters.
    pub(super) fn may_touch(&self, i: u32, j: u32) -> bool {
        let (a, b) = (&self.proxies[i as usize].bounds, &self.proxies[j as usize].bounds);
        if !a.overlaps(b) {
            return false;
        }
        let role = |c: u32| self.roles[c as usize];
        // By their boxes alone: a volume is one, and what has no end can't be met by a path.
        let boxes = |c: u32| matches!(role(c), Role::Volume | Role::Endless);
        if boxes(i) || boxes(j) {
            return true;
        }
        match (self.path(i), self.path(j)) {
            (None, None) => true,
            (Some(p), Some(q)) => p.meets(q),
            (Some(p), None) => p.hits(b),
            (None, Some(q)) => q.hits(a),
        }
    }

    /// Whether the narrow phase must cast this pair.
    pub(super) fn is_fast(&self, i: u32, j: u32) -> bool {
        match (self.path(i), self.path(j)) {
            (None, None) => false,
            (Some(p), Some(q)) => p.outruns(q),
            _ => true,
        }
    }

    #[inline]
    fn path(&self, collider: u32) -> Option<&Path> {
        let fast = self.roles[collider as usize] >= Role::Fast;
        fast.then(|| &self.paths[self.proxies[collider as usize].path as usize])
    }
}
