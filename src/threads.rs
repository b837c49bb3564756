//! Blocks of work, claimed one by one; all that knows rayon.
//!
//! A step has hundreds of short parallel stages, and handing each to a pool costs microseconds. So the pool is
//! entered once a step: helpers wait, spinning, for the caller to announce a stage, and claim blocks of it beside
//! the caller. Nobody waits for a helper that has not claimed a block: if none ever arrives, the caller does all.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// Who works on a step: the caller alone, or with helpers.
#[derive(Clone, Copy)]
pub(crate) struct Crew<'a> {
    stage: Option<&'a Stage>,
}

impl Crew<'_> {
    /// Only the caller.
    pub(crate) fn alone() -> Self {
        Crew { stage: None }
    }

    /// Runs `work` once for each block in `0..blocks` and returns when all are done. Blocks run in any order and at
    /// the same time: what a block writes must be its own.
    pub(crate) fn run(&self, blocks: usize, work: &(dyn Fn(usize) + Sync)) {
        match self.stage {
            Some(stage) if blocks > 1 && blocks <= MASK as usize => stage.run(blocks, work),
            _ => (0..blocks).for_each(work),
        }
    }
}

/// What a block has of whatever is shared. Under Miri the least, or worlds small enough for it would be one block.
pub(crate) const fn per_block(usual: usize, least: usize) -> usize {
    if cfg!(miri) { least } else { usual }
}

const BITS: u32 = 24;
const MASK: u64 = (1 << BITS) - 1;

type Work<'a> = &'a (dyn Fn(usize) + Sync + 'a);

/// A [`Work`] without its lifetime: where the caller's reference lies, and how to call through it.
type Erased = (*const (), fn(*const (), usize));

/// Which end of the blocks that are left is claimed.
///
/// The caller works from the front and the first helper from the back, until they meet. Stages that go over the same
/// blocks again and again, as the solver's do, thus leave most of a block's data in the cache of one core.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    Front,
    #[cfg_attr(not(feature = "parallel"), allow(dead_code, reason = "only helpers claim there"))]
    Back,
}

/// The stage that is being worked on.
#[cfg_attr(not(feature = "parallel"), allow(dead_code, reason = "only helpers read it"))]
struct Stage {
    /// Epoch (16 bits), end (24) and start (24) of the blocks that are not claimed, in one word, so that a claim is one
    /// exchange and can't mistake one stage for another.
    ticket: AtomicU64,
    done: AtomicUsize,
    quit: AtomicBool,
    /// Written by the caller only while no block is claimed.
    work: std::cell::UnsafeCell<Option<Erased>>,
}

// SAFETY: `work` is written only by the caller in `run`, before the ticket is released and after every claimed block
// of the stage before is done; helpers read it only while they hold a claimed block, see `help`.
unsafe impl Sync for Stage {}

/// Counts a block as done, also when its work panics: the caller must not wait for ever.
struct Done<'a>(&'a AtomicUsize);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::Release);
    }
}

#[cfg_attr(not(feature = "parallel"), allow(dead_code, reason = "only helpers need it"))]
impl Stage {
    fn new() -> Self {
        Stage {
            ticket: AtomicU64::new(0),
            done: AtomicUsize::new(0),
            quit: AtomicBool::new(false),
            work: std::cell::UnsafeCell::new(None),
        }
    }

    fn run(&self, blocks: usize, work: Work<'_>) {
        fn call(work: *const (), block: usize) {
            // SAFETY: `work` points to the reference that the caller of `run` holds, see below.
            unsafe { (*work.cast::<Work<'_>>())(block) }
        }
        let epoch = (self.ticket.load(Ordering::Relaxed) >> (2 * BITS)).wrapping_add(1);
        self.done.store(0, Ordering::Relaxed);
        // SAFETY: no helper holds a block now, so nobody reads while this writes. This function does not return
        // before all blocks are done, and a helper uses the pointer only while it holds a block, so it never outlives
        // the reference.
        unsafe { *self.work.get() = Some(((&raw const work).cast(), call)) };
        self.ticket.store(epoch << (2 * BITS) | (blocks as u64) << BITS, Ordering::Release);
        let finish = Finish { stage: self, blocks };
        while let Some(block) = self.claim(End::Front) {
            let _done = Done(&self.done);
            work(block);
        }
        drop(finish);
    }

    /// Takes a block of the current stage, if any is left.
    fn claim(&self, end: End) -> Option<usize> {
        let mut ticket = self.ticket.load(Ordering::Acquire);
        loop {
            let (front, back) = (ticket & MASK, ticket >> BITS & MASK);
            if front >= back {
                return None;
            }
            let (next, block) = match end {
                End::Front => (ticket + 1, front),
                End::Back => (ticket - (1 << BITS), back - 1),
            };
            match self.ticket.compare_exchange_weak(ticket, next, Ordering::AcqRel, Ordering::Acquire) {
                Ok(_) => return Some(block as usize),
                Err(now) => ticket = now,
            }
        }
    }

    /// Works on what the caller announces until it quits.
    fn help(&self, end: End) {
        let mut idle = 0u32;
        while !self.quit.load(Ordering::Acquire) {
            if let Some(block) = self.claim(end) {
                idle = 0;
                let _done = Done(&self.done);
                // SAFETY: this helper holds a block that is not done, so the caller is still in `run` of the stage
                // that the block belongs to, and does not write.
                if let Some((work, call)) = unsafe { *self.work.get() } {
                    call(work, block);
                }
            } else {
                idle += 1;
                // A helper whose core is wanted by someone else gives way after some microseconds.
                if idle < 4096 { std::hint::spin_loop() } else { std::thread::yield_now() }
            }
        }
    }
}

/// Waits for every claimed block of a stage, also when the caller's own block panics.
struct Finish<'a> {
    stage: &'a Stage,
    blocks: usize,
}

impl Drop for Finish<'_> {
    fn drop(&mut self) {
        // What is left unclaimed after a panic is given up, so that only claimed blocks are waited for.
        let mut unclaimed = 0;
        while self.stage.claim(End::Front).is_some() {
            unclaimed += 1;
        }
        let mut idle = 0u32;
        while self.stage.done.load(Ordering::Acquire) + unclaimed < self.blocks {
            idle += 1;
            if idle < 4096 { std::hint::spin_loop() } else { std::thread::yield_now() }
        }
    }
}

/// Runs `f` with a crew of at most `threads`, from the caller's rayon pool.
#[cfg(feature = "parallel")]
pub(crate) fn with_crew<R: Send>(threads: usize, f: impl FnOnce(Crew<'_>) -> R + Send) -> R {
    struct Quit<'a>(&'a AtomicBool);
    impl Drop for Quit<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Release);
        }
    }
    fn helpers(stage: &Stage, count: usize) {
        // Half of the crew at either end.
        let end = if count % 2 == 1 { End::Back } else { End::Front };
        match count {
            0 => {}
            1 => stage.help(end),
            _ => drop(rayon::join(|| stage.help(end), || helpers(stage, count - 1))),
        }
    }
    // Asking rayon starts its pool: not for one thread.
    let helping = if threads > 1 { threads.min(rayon::current_num_threads()) - 1 } else { 0 };
    if helping == 0 {
        return f(Crew::alone());
    }
    let stage = Stage::new();
    let caller = || {
        let _quit = Quit(&stage.quit);
        f(Crew { stage: Some(&stage) })
    };
    rayon::join(caller, || helpers(&stage, helping)).0
}

/// Runs `f` with the caller alone: built without threads.
#[cfg(not(feature = "parallel"))]
pub(crate) fn with_crew<R>(_threads: usize, f: impl FnOnce(Crew<'_>) -> R) -> R {
    f(Crew::alone())
}

/// A slice whose elements different blocks of a stage may write, each element by one block at most.
pub(crate) struct Shared<'a, T> {
    start: *mut T,
    len: usize,
    lifetime: std::marker::PhantomData<&'a mut [T]>,
}

// SAFETY: the elements are handed out one by one under the contract of `get`; sharing the slice shares nothing else.
unsafe impl<T: Send> Sync for Shared<'_, T> {}
// SAFETY: as for any `&mut [T]`.
unsafe impl<T: Send> Send for Shared<'_, T> {}

impl<'a, T> Shared<'a, T> {
    pub(crate) fn new(slice: &'a mut [T]) -> Self {
        Shared { start: slice.as_mut_ptr(), len: slice.len(), lifetime: std::marker::PhantomData }
    }

    /// The element at `i`, to be written. Panics if `i` is outside.
    ///
    /// # Safety
    /// Until the stage is over no other thread may ask for the same element, and this one may hold it only once.
    #[inline(always)]
    #[allow(clippy::mut_from_ref, reason = "the contract is the caller's, see above")]
    pub(crate) unsafe fn get(&self, i: usize) -> &mut T {
        assert!(i < self.len);
        // SAFETY: inside the slice by the assertion; exclusive by the contract.
        unsafe { &mut *self.start.add(i) }
    }

    /// Some elements in a row, to be written. Panics if any is outside.
    ///
    /// # Safety
    /// As for [`Shared::get`], for each of them.
    #[allow(clippy::mut_from_ref, reason = "the contract is the caller's, see above")]
    pub(crate) unsafe fn part(&self, range: std::ops::Range<usize>) -> &mut [T] {
        assert!(range.start <= range.end && range.end <= self.len);
        // SAFETY: inside the slice by the assertion; exclusive by the contract.
        unsafe { std::slice::from_raw_parts_mut(self.start.add(range.start), range.len()) }
    }

    /// A copy of the element at `i`.
    ///
    /// # Safety
    /// Until the stage is over no other thread may write the element.
    #[inline(always)]
    pub(crate) unsafe fn read(&self, i: usize) -> T
    where
        T: Copy,
    {
        assert!(i < self.len);
        // SAFETY: inside the slice by the assertion; nobody writes by the contract.
        unsafe { *self.start.add(i) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_block_runs_once_with_any_crew() {
        for threads in [1, 2, 3, 8] {
            with_crew(threads, |crew| {
                for blocks in [0, 1, 2, 7, 100] {
                    for _ in 0..if cfg!(miri) { 4 } else { 50 } {
                        let mut counts = vec![0u32; blocks];
                        let shared = Shared::new(&mut counts);
                        // SAFETY: each block writes its own element.
                        crew.run(blocks, &|block| unsafe { *shared.get(block) += 1 });
                        assert!(counts.iter().all(|&c| c == 1));
                    }
                }
            });
        }
    }

    #[test]
    fn a_crew_without_free_threads_still_finishes() {
        // The pool has one thread, so the helpers that were asked for never arrive.
        with_crew(8, |crew| {
            let sum = AtomicUsize::new(0);
            crew.run(1000, &|block| {
                sum.fetch_add(block, Ordering::Relaxed);
            });
            assert_eq!(sum.into_inner(), 499_500);
        });
    }

    #[test]
    fn a_panic_in_any_block_reaches_the_caller() {
        // The caller takes the first block, and a helper, if there is one, the last.
        for bad in [0, 4, 9] {
            let run = || with_crew(2, |crew| crew.run(10, &|block| assert_ne!(block, bad)));
            assert!(std::panic::catch_unwind(run).is_err());
        }
    }
}
