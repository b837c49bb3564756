//! Which pairs end and which begin, in blocks that any thread may work on.

use super::bvh::{STACK, Tree};
use super::{BroadPhase, FILTER, MayCollide, NONE, Order, Pair, Path, Role};
use crate::lanes::{Mask, f32x4, ones};
use crate::memory::{
    Allowance, Allowances, Amounts, Buffer, Buffers, Category, Made, Marks, buffers, bytes_of, even_out,
    sum_bytes,
};
use crate::threads::{Shared, Workers, per_block};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Movers in a block: about 10 µs of work, ten times the cost of claiming a block.
pub(super) const BLOCK: usize = per_block(64, 1);

/// Blocks that run before their results are taken in: enough for many threads, and few buffers for the
/// results of the most crowded block.
const WAVE: usize = 16;

/// Words of pairs in a block that looks whether they last.
const KEEP_WORDS: usize = per_block(16, 1);

/// The fate of 64 pairs, one bit each.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Change {
    ended: u64,
    /// They become fast, or slow.
    turned: u64,
}

/// Pairs that a block finds, and the stack of its tree walks; kept from step to step.
#[derive(Debug, Default)]
pub(super) struct Block {
    /// Both colliders of a pair; the first with [`FAST`] if it is fast.
    found: Vec<(u32, u32)>,
    stack: Vec<u32>,
    pub(super) partners: Vec<u32>,
    /// Bytes that its buffers may still grow by, and how often they could not.
    allowance: Allowance,
    shed: u32,
}

/// Colliders leave this bit free, as they do for the trees.
const FAST: u32 = super::bvh::LEAF;

buffers! { Block { bytes { found, stack, partners } } }

impl Buffers for Mutex<Block> {
    fn each(&mut self, f: &mut dyn FnMut(&mut dyn Buffer)) {
        let block = self.get_mut().unwrap_or_else(PoisonError::into_inner);
        f(&mut block.found);
        f(&mut block.stack);
        f(&mut block.partners);
    }
}

/// Blocks that work at the same time, all with buffers of the same capacities.
#[derive(Debug, Default)]
pub(super) struct Blocks {
    all: Vec<Mutex<Block>>,
    marks: Marks,
}

impl Blocks {
    /// Blocks with the stacks that they surely need.
    fn with_stacks(&mut self) -> Made<'_, Mutex<Block>> {
        let make = || Mutex::new(Block { stack: Vec::with_capacity(STACK), ..Block::default() });
        Made { all: &mut self.all, make, holds: STACK * size_of::<u32>() }
    }

    /// So many of them.
    fn used(&mut self, count: usize) -> impl Iterator<Item = &mut Block> {
        self.all[..count].iter_mut().map(|block| block.get_mut().unwrap_or_else(PoisonError::into_inner))
    }

    fn even_out(&mut self, allowance: &mut Allowance) {
        even_out(&mut self.all, &mut self.marks, allowance);
    }

    pub(super) fn each(&mut self, count: usize, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        f(&mut self.with_stacks(), count);
    }

    pub(super) fn bytes(&self) -> (usize, usize) {
        let own = self.all.iter().map(|block| lock(block).bytes());
        sum_bytes(own.chain([bytes_of(&self.all)]))
    }
}

/// Words of changes of so many pairs.
pub(super) fn words_of(pairs: usize) -> usize {
    pairs.div_ceil(64)
}

/// Which colliders may be a pair, and the bytes of one.
pub(crate) struct Rules<'a> {
    pub(crate) may_collide: MayCollide<'a>,
    pub(crate) order: Order<'a>,
    /// Bytes that the later stages of the step lack for so many pairs, all of them scratch.
    pub(crate) missing: &'a dyn Fn(usize) -> usize,
    /// Whether two that don't move may be a pair.
    pub(crate) still: bool,
}

/// Memory for pairs.
pub(crate) struct PairMemory<'a> {
    pub(crate) allowances: &'a mut Allowances,
    /// Releases so many bytes that others no longer need, if it can; returns how many.
    pub(crate) give_up: &'a mut dyn FnMut(usize) -> usize,
}

impl PairMemory<'_> {
    /// Has others release memory; says whether they did.
    fn make_room(&mut self, bytes: usize) -> bool {
        let freed = (self.give_up)(bytes);
        self.allowances.within(Category::Rows, |allowance| allowance.give(freed));
        freed > 0
    }
}

/// Bytes that blocks may want for a pair that they found no place for: lists are as long in all of them.
const LOST: usize = 256;

/// The colliders of a block's result.
fn pair_of(&(a, b): &(u32, u32)) -> (u32, u32) {
    (a & !FAST, b)
}

/// A block is only a buffer that is cleared before use: leftovers of a panicking thread do no harm.
pub(super) fn lock(block: &Mutex<Block>) -> MutexGuard<'_, Block> {
    block.lock().unwrap_or_else(PoisonError::into_inner)
}

impl BroadPhase {
    /// Drops the pairs that may no longer touch. Returns how many there was no place for in `removed`: they
    /// last until they are looked at again.
    pub(super) fn keep_pairs(
        &mut self,
        workers: &Workers,
        may_collide: MayCollide,
        removed: &mut Vec<Pair>,
        allowance: &mut Allowance,
    ) -> u32 {
        let mut late = 0;
        let mut changes = std::mem::take(&mut self.changes);
        // Pairs are only taken in if there is room for this.
        let words = allowance.fit(&mut changes, words_of(self.pairs.len()));
        late += self.pairs.len().saturating_sub(64 * words) as u32;
        changes.clear();
        changes.resize(words, Change::default());
        {
            let (this, all) = (&*self, Shared::new(&mut changes));
            this.run(workers, words.div_ceil(KEEP_WORDS), &|b| {
                for word in b * KEEP_WORDS..words.min((b + 1) * KEEP_WORDS) {
                    // SAFETY: each word is in one block.
                    unsafe { *all.get(word) = this.change_of(word, may_collide) };
                }
            });
        }
        for (word, change) in changes.iter().enumerate() {
            ones(change.turned).for_each(|bit| self.pairs[word * 64 + bit].fast ^= true);
        }
        // From the end: the entry that moves to a freed place is one that stays.
        for (word, change) in changes.iter().enumerate().rev() {
            let mut ended = change.ended;
            while ended != 0 {
                let bit = 63 - ended.leading_zeros() as usize;
                ended ^= 1 << bit;
                if allowance.fit(removed, removed.len() + 1) > removed.len() {
                    removed.push(self.table.swap_remove(&mut self.pairs, word * 64 + bit));
                } else {
                    late += 1;
                }
            }
        }
        self.changes = changes;
        late
    }

    /// The fate of the 64 pairs of a word.
    fn change_of(&self, word: usize, may_collide: MayCollide) -> Change {
        let mut change = Change::default();
        for (bit, pair) in self.pairs[word * 64..].iter().take(64).enumerate() {
            let &Pair { a, b, fast, .. } = pair;
            let marks = self.marks[a as usize] | self.marks[b as usize];
            if marks == 0 {
                continue;
            }
            if !self.may_touch(a, b) || (marks & FILTER != 0 && !may_collide(a, b)) {
                change.ended |= 1 << bit;
            } else if fast != self.is_fast(a, b) {
                change.turned |= 1 << bit;
            }
        }
        change
    }

    /// Searches for the pairs of all that changed; returns how many are new, and how many there was no room
    /// for.
    pub(super) fn find_pairs(
        &mut self,
        workers: &Workers,
        rules: &Rules,
        memory: &mut PairMemory<'_>,
    ) -> (u32, u32) {
        let wanted = self.changed.len().div_ceil(BLOCK);
        // A budget is shared out among all that want something of it; bodies brought blocks for all.
        let wave = if memory.allowances.is_endless() { WAVE } else { wanted };
        let count = wanted.min(wave);
        memory.allowances.within(Category::BroadPhase, |allowance| self.grow_blocks(count, allowance));
        let (mut shed, before) = (0, self.pairs.len());
        for first in (0..wanted).step_by(count.max(1)) {
            let count = count.min(wanted - first);
            let mut lost = self.search_within(workers, first, count, rules, memory.allowances);
            if lost > 0 && memory.make_room(LOST * lost as usize) {
                lost = self.search_within(workers, first, count, rules, memory.allowances);
            }
            shed += lost + self.take_in(count, rules, memory);
        }
        ((self.pairs.len() - before) as u32, shed)
    }

    /// Searches with an equal share for each block of half of the room, and gives all as much as one needed;
    /// returns how often it was too little.
    fn search_within(
        &mut self,
        workers: &Workers,
        first: usize,
        count: usize,
        rules: &Rules,
        allowances: &mut Allowances,
    ) -> u32 {
        allowances.within(Category::BroadPhase, |allowance| {
            let share = allowance.share(2 * count);
            for block in self.blocks.used(count) {
                (block.allowance, block.shed) = (share, 0);
            }
            self.search(workers, first, count, rules);
            let mut shed = 0;
            for block in self.blocks.used(count) {
                allowance.take(share.left() - block.allowance.left());
                shed += block.shed;
            }
            allowance.within(8, |allowance| self.blocks.even_out(allowance));
            shed
        })
    }

    /// Searches for the pairs of some blocks of changed colliders.
    fn search(&self, workers: &Workers, first: usize, count: usize, rules: &Rules) {
        let &Rules { may_collide, order, still, .. } = rules;
        self.run(workers, count, &|b| {
            let block = &mut *lock(&self.blocks.all[b]);
            block.found.clear();
            let start = (first + b) * BLOCK;
            for &c in &self.changed[start..self.changed.len().min(start + BLOCK)] {
                let path = self.path(c).filter(|path| self.roles[c as usize] == Role::Fast && path.is_long());
                self.partners(c, path, still, block);
                self.keep_reported(c, &mut block.partners);
                for &other in &block.partners {
                    // The table before the exact test: most that are found are pairs already, and were
                    // tested.
                    if self.table.find(&self.pairs, c, other).is_none()
                        && self.may_touch(c, other)
                        && may_collide(c, other)
                    {
                        let (a, b) = order(c, other);
                        let pair = (if self.is_fast(c, other) { a | FAST } else { a }, b);
                        block.shed += u32::from(!block.allowance.push(&mut block.found, pair));
                    }
                }
            }
        });
    }

    /// Appends the results of the blocks, as far as there is room: first the pairs with colliders that don't
    /// move.
    fn take_in(&mut self, count: usize, rules: &Rules, memory: &mut PairMemory<'_>) -> u32 {
        let found: usize = self.blocks.used(count).map(|block| block.found.len()).sum();
        // Those that were taken out come back.
        let before = self.pairs.len() + self.away;
        let mut quota = [usize::MAX; 2];
        if !memory.allowances.is_endless() {
            let bytes = self.missing(before + found) + (rules.missing)(before + found);
            memory.make_room(bytes.saturating_sub(memory.allowances.whole()));
            let most = self.most_pairs(before + found, rules, memory.allowances);
            let granted = most.saturating_sub(before);
            let of_static = self.blocks.all[..count].iter().map(|block| {
                let block = lock(block);
                block.found.iter().filter(|pair| self.has_static(pair_of(pair))).count()
            });
            let of_static = of_static.sum::<usize>().min(granted);
            quota = [granted - of_static, of_static];
            let missing = self.missing(most);
            memory.allowances.within(Category::BroadPhase, |allowance| allowance.take(missing));
            self.reserve_total(most);
        }
        let mut shed = 0;
        for b in 0..count {
            let found = std::mem::take(&mut lock(&self.blocks.all[b]).found);
            for pair in &found {
                let (a, b) = pair_of(pair);
                let left = &mut quota[usize::from(self.has_static((a, b)))];
                if *left > 0 {
                    *left -= 1;
                    let pair =
                        Pair { a, b, contact: NONE, fast: pair.0 & FAST != 0, touching: false, apart: 0 };
                    self.table.push(&mut self.pairs, pair);
                } else {
                    shed += 1;
                }
            }
            lock(&self.blocks.all[b]).found = found;
        }
        shed
    }

    /// How many pairs, of so many wanted, there is room for in all that has an entry for each.
    fn most_pairs(&self, wanted: usize, rules: &Rules, allowances: &Allowances) -> usize {
        let missing = |pairs: usize| {
            let mut missing = Amounts::default();
            missing.add(Category::BroadPhase, self.missing(pairs));
            missing.add(Category::Scratch, (rules.missing)(pairs));
            missing
        };
        allowances.most(self.pairs.len(), wanted, &missing)
    }

    fn has_static(&self, (a, b): (u32, u32)) -> bool {
        let still = |c: u32| matches!(self.roles[c as usize], Role::Static | Role::Endless);
        still(a) || still(b)
    }

    /// Makes sure that there are so many blocks; under a budget there are.
    fn grow_blocks(&mut self, count: usize, allowance: &mut Allowance) {
        if count > self.blocks.all.len() {
            // A few more, or every other step would add one.
            self.blocks.with_stacks().reserve_total(count + count / 4);
            allowance.within(2, |allowance| self.blocks.even_out(allowance));
        }
    }

    #[cfg(not(test))]
    fn run(&self, workers: &Workers, count: usize, work: &(dyn Fn(usize) + Sync)) {
        workers.run(count, work);
    }

    #[cfg(test)]
    fn run(&self, workers: &Workers, count: usize, work: &(dyn Fn(usize) + Sync)) {
        match self.shuffle.map(|shuffle| shuffle(count)) {
            Some(order) => workers.run(count, &|b| work(order[b])),
            None => workers.run(count, work),
        }
    }

    /// All whose boxes touch this one's (or are touched by the path, if there is one, within rounding), save
    /// colliders that can't collide with it. An endless one finds nothing: the others find it. `still`: two
    /// that don't move may be a pair.
    pub(super) fn partners(&self, collider: u32, path: Option<&Path>, still: bool, block: &mut Block) {
        let Block { stack, partners, allowance, shed, .. } = block;
        partners.clear();
        let mut add = |c: u32| *shed += u32::from(!allowance.push(partners, c));
        let bounds = &self.proxies[collider as usize].bounds;
        let role = self.roles[collider as usize];
        if matches!(role, Role::Absent | Role::New | Role::Endless) {
            return;
        }

        let mut search = |tree: &Tree| match path {
            None => tree.visit_box(stack, bounds, &mut add),
            Some(path) => {
                let lanes = path.lanes::<f32x4>();
                tree.visit(stack, |node| lanes.hits(node.min, node.max).bits(), &mut add);
            }
        };
        let all = still || role != Role::Static;
        if all {
            search(&self.statics);
        }
        search(&self.movers);
        if all {
            self.unbounded.iter().for_each(|&c| add(c));
        }
    }

    /// Decides which of two searching colliders reports the pair: the one with the higher rank, or of equal
    /// ranks the lower index. A collider that does not search has rank 0. The order of [`Role`] sees to the
    /// rest: a static one searches only for movers that don't, a path may miss colliders that a swept box
    /// touches, and both look further than a fat box.
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
        // By their boxes alone: a volume is one, and endless colliders can't be met by a path.
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
