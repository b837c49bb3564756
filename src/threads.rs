//! Blocks of work, claimed one by one; all that knows rayon.
//!
//! A step has hundreds of short parallel stages, and handing each to a pool costs microseconds. So helpers are called
//! once a step: they wait, spinning, for the caller to announce a stage, and claim blocks of it beside the caller, who
//! works where it is. Nobody waits for a helper that has not claimed a block: if none ever arrives, because the pool has
//! other work, the caller does all.

use crate::memory::in_arc;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

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

#[cfg(feature = "parallel")]
impl End {
    /// Half of the crew at either end.
    fn of(helper: usize) -> End {
        if helper.is_multiple_of(2) { End::Back } else { End::Front }
    }
}

/// The stage that is being worked on.
#[cfg_attr(not(feature = "parallel"), allow(dead_code, reason = "only helpers read it"))]
#[derive(Debug, Default)]
struct Stage {
    /// Epoch (16 bits), end (24) and start (24) of the blocks that are not claimed, in one word, so that a claim is one
    /// exchange and can't mistake one stage for another.
    ticket: AtomicU64,
    done: AtomicUsize,
    /// There is no step to help with.
    quit: AtomicBool,
    /// Helpers that the pool was asked for and that have not left yet, whether they have arrived or not.
    called: AtomicUsize,
    /// Helpers that have arrived and not left.
    present: AtomicUsize,
    /// Written by the caller only while no block is claimed.
    work: std::cell::UnsafeCell<Option<Erased>>,
    /// Whether a helper's block panicked, and with what.
    panicked: AtomicBool,
    payload: Mutex<Option<Box<dyn Any + Send>>>,
}

// SAFETY: `work` is written only by the caller in `run`, before the ticket is released and after every claimed block
// of the stage before is done; helpers read it only while they hold a claimed block, see `help`.
unsafe impl Sync for Stage {}
// SAFETY: as above; nothing of a stage belongs to a thread.
unsafe impl Send for Stage {}
/// What a panic leaves of a stage is never looked at.
impl std::panic::RefUnwindSafe for Stage {}

/// Where the helpers of a world's steps look for work. It is kept from step to step, because a helper that the pool had no
/// thread for is not waited for: it may arrive in a later step and help there, or when there is no world any more. Made when
/// help is first asked for from outside of the pool.
#[derive(Debug, Default)]
pub(crate) struct Helpers(Option<Arc<Stage>>);

impl Helpers {
    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let bytes = if self.0.is_some() { in_arc::<Stage>() } else { 0 };
        (bytes, bytes)
    }
}

/// Counts a block as done, also when its work panics: the caller must not wait for ever.
struct Done<'a>(&'a AtomicUsize);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::Release);
    }
}

#[cfg_attr(not(feature = "parallel"), allow(dead_code, reason = "only helpers need it"))]
impl Stage {
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
        if self.panicked.load(Ordering::Relaxed) {
            let mut payload = self.payload.lock().unwrap_or_else(PoisonError::into_inner);
            resume_unwind(payload.take().unwrap_or_else(|| Box::new("a block panicked")));
        }
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

    /// Works on what the caller announces until it quits. A panic is kept for the caller: it must not end the pool's thread,
    /// nor leave the caller without an answer.
    fn help(&self, end: End) {
        self.present.fetch_add(1, Ordering::Relaxed);
        let mut idle = 0u32;
        while !self.quit.load(Ordering::Acquire) {
            if let Some(block) = self.claim(end) {
                idle = 0;
                let _done = Done(&self.done);
                // SAFETY: this helper holds a block that is not done, so the caller is still in `run` of the stage
                // that the block belongs to, and does not write.
                if let Some((work, call)) = unsafe { *self.work.get() }
                    && let Err(payload) = catch_unwind(AssertUnwindSafe(|| call(work, block)))
                {
                    *self.payload.lock().unwrap_or_else(PoisonError::into_inner) = Some(payload);
                    self.panicked.store(true, Ordering::Relaxed);
                }
            } else {
                idle += 1;
                // A helper whose core is wanted by someone else gives way after some microseconds.
                if idle < 4096 { std::hint::spin_loop() } else { std::thread::yield_now() }
            }
        }
        self.present.fetch_sub(1, Ordering::Release);
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

/// Runs `f` here, with a crew of at most `threads` from the caller's rayon pool.
#[cfg(feature = "parallel")]
pub(crate) fn with_crew<R: Send>(
    threads: usize,
    helpers: &mut Helpers,
    f: impl FnOnce(Crew<'_>) -> R + Send,
) -> R {
    // Asking rayon starts its pool: not for one thread.
    let helping = if threads > 1 { threads.min(rayon::current_num_threads()) - 1 } else { 0 };
    if helping == 0 {
        return f(Crew::alone());
    }
    if rayon::current_thread_index().is_some() {
        let stage = Stage::default();
        return beside(&stage, helping, || {
            let _quit = Quit { stage: &stage, wait: true };
            f(Crew { stage: Some(&stage) })
        });
    }
    let stage = helpers.0.get_or_insert_default();
    stage.panicked.store(false, Ordering::Relaxed);
    stage.quit.store(false, Ordering::Release);
    let _quit = Quit { stage, wait: false };
    // Not `join`, which would have this thread wait until the pool has one to run all of this on.
    while stage.called.load(Ordering::Relaxed) < helping {
        let number = stage.called.fetch_add(1, Ordering::Relaxed);
        let stage = stage.clone();
        rayon::spawn(move || {
            stage.help(End::of(number));
            stage.called.fetch_sub(1, Ordering::Relaxed);
        });
    }
    f(Crew { stage: Some(stage) })
}

/// Runs `f` on this thread of a pool, and offers so many helpers to the others: what none has taken by the end is taken
/// back.
#[cfg(feature = "parallel")]
fn beside<R: Send>(stage: &Stage, helping: usize, f: impl FnOnce() -> R + Send) -> R {
    fn offer(stage: &Stage, helping: usize, f: &mut (dyn FnMut() + Send)) {
        match helping.checked_sub(1) {
            None => f(),
            Some(rest) => drop(rayon::join(|| offer(stage, rest, f), || stage.help(End::of(rest)))),
        }
    }
    let (mut f, mut result) = (Some(f), None);
    offer(stage, helping, &mut || result = f.take().map(|f| f()));
    match result {
        Some(result) => result,
        None => unreachable!("it was called once"),
    }
}

/// Sends the helpers away when a step ends, also when it panics.
#[cfg(feature = "parallel")]
struct Quit<'a> {
    stage: &'a Stage,
    /// For those that have arrived: on a thread of the pool whoever waits in `join` for a helper takes up other work meanwhile,
    /// and returns when that is done.
    wait: bool,
}

#[cfg(feature = "parallel")]
impl Drop for Quit<'_> {
    fn drop(&mut self) {
        self.stage.quit.store(true, Ordering::Release);
        let mut idle = 0u32;
        while self.wait && self.stage.present.load(Ordering::Acquire) > 0 {
            idle += 1;
            if idle < 4096 { std::hint::spin_loop() } else { std::thread::yield_now() }
        }
    }
}

/// Runs `f` with the caller alone: built without threads.
#[cfg(not(feature = "parallel"))]
pub(crate) fn with_crew<R>(_threads: usize, _helpers: &mut Helpers, f: impl FnOnce(Crew<'_>) -> R) -> R {
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

    /// All elements, to be looked at.
    ///
    /// # Safety
    /// Until the stage is over nobody may write any.
    #[cfg(feature = "lab")]
    pub(crate) unsafe fn all(&self) -> &[T] {
        // SAFETY: the whole slice; nobody writes by the contract.
        unsafe { std::slice::from_raw_parts(self.start, self.len) }
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
            with_crew(threads, &mut Helpers::default(), |crew| {
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
        with_crew(8, &mut Helpers::default(), |crew| {
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
            let mut helpers = Helpers::default();
            let run = || with_crew(2, &mut helpers, |crew| crew.run(10, &|block| assert_ne!(block, bad)));
            assert!(catch_unwind(AssertUnwindSafe(run)).is_err());
        }
    }
}
