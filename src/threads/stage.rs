//! The stage that is worked on: blocks, which the caller and its helpers claim one by one.
//!
//! Only two pairs of orderings carry data. The ticket's store releases the work pointer, and the exchange
//! that claims a block acquires it. `done` releases a block's writes, and the caller acquires it before `run`
//! returns. All other accesses are relaxed: they only say when to look again. `scripts/reliability model`
//! checks this file under every order of events that the memory model allows, in small cases (`loom/`).

use super::sync::{AtomicBool, AtomicU64, AtomicUsize, Mutex, Ordering, UnsafeCell, pause};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::PoisonError;

const BITS: u32 = 32;
const MASK: u64 = (1 << BITS) - 1;

pub(super) type Work<'a> = &'a (dyn Fn(usize) + Sync + 'a);

/// A [`Work`] without its lifetime: where the caller's reference lies, and how to call through it.
type Erased = (*const (), fn(*const (), usize));

/// Which end of the blocks that are left is claimed.
///
/// The caller works from the front and the first helper from the back, until they meet. Stages that go over
/// the same blocks again and again, as the solver's do, thus leave most of a block's data in the cache of one
/// core.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Front,
    Back,
}

impl End {
    /// Half of the workers at either end.
    pub(super) fn of(helper: usize) -> End {
        if helper.is_multiple_of(2) { End::Back } else { End::Front }
    }
}

/// The stage that is being worked on.
#[derive(Debug, Default)]
pub(super) struct Stage {
    /// The range of blocks that are not claimed: its end in the upper half, its start in the lower.
    ///
    /// Nothing tells one stage's ticket from another's, and nothing need: which block a claim takes follows
    /// from the ticket alone, and the exchange succeeds only if the ticket has that value now. A helper that
    /// slept through any number of stages therefore claims a block of the present stage or none.
    ticket: AtomicU64,
    done: AtomicUsize,
    /// There is no step to help with.
    quit: AtomicBool,
    /// Helpers that the pool was asked for and that have not left yet, whether they have arrived or not.
    called: AtomicUsize,
    /// Helpers that have arrived and not left.
    present: AtomicUsize,
    /// Written by the caller only while no block is claimed.
    work: UnsafeCell<Option<Erased>>,
    /// Whether a helper's block panicked, and its payload.
    panicked: AtomicBool,
    payload: Mutex<Option<Box<dyn Any + Send>>>,
}

// SAFETY: `work` is written only by the caller in `run`, before the ticket is released and after every
// claimed block of the stage before is done; helpers read it only while they hold a claimed block, see
// `help`.
unsafe impl Sync for Stage {}
// SAFETY: as above; nothing of a stage belongs to a thread.
unsafe impl Send for Stage {}
/// A stage is never looked at after a panic.
impl std::panic::RefUnwindSafe for Stage {}

/// Counts a block as done, also when its work panics: the caller must not wait for ever.
struct Done<'a>(&'a AtomicUsize);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::Release);
    }
}

impl Stage {
    /// Runs `work` once for each of at most `u32::MAX` blocks and returns when all are done. Only one thread
    /// at a time may call this, the caller.
    pub(super) fn run(&self, blocks: usize, work: Work<'_>) {
        fn call(work: *const (), block: usize) {
            // SAFETY: `work` points to the reference that the caller of `run` holds, see below.
            unsafe { (*work.cast::<Work<'_>>())(block) }
        }
        self.done.store(0, Ordering::Relaxed);
        // SAFETY: no helper holds a block now, so no thread reads while this writes. This function does not
        // return before all blocks are done, and a helper uses the pointer only while it holds a block, so it
        // never outlives the reference.
        self.work.with_mut(|slot| unsafe { *slot = Some(((&raw const work).cast(), call)) });
        self.ticket.store((blocks as u64) << BITS, Ordering::Release);
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
        let mut ticket = self.ticket.load(Ordering::Relaxed);
        loop {
            let (front, back) = (ticket & MASK, ticket >> BITS);
            if front >= back {
                return None;
            }
            let (next, block) = match end {
                End::Front => (ticket + 1, front),
                End::Back => (ticket - (1 << BITS), back - 1),
            };
            match self.ticket.compare_exchange_weak(ticket, next, Ordering::Acquire, Ordering::Relaxed) {
                Ok(_) => return Some(block as usize),
                Err(now) => ticket = now,
            }
        }
    }

    /// Lets helpers in, those that are still there from an earlier step too.
    pub(super) fn open(&self) {
        self.panicked.store(false, Ordering::Relaxed);
        self.quit.store(false, Ordering::Relaxed);
    }

    /// Asks for helpers until so many are called. `spawn` sends one, with its number, which is to run
    /// [`Stage::answer`].
    pub(super) fn call(&self, helping: usize, spawn: impl Fn(usize)) {
        while self.called.load(Ordering::Relaxed) < helping {
            spawn(self.called.fetch_add(1, Ordering::Relaxed));
        }
    }

    /// The work of a helper that was called.
    pub(super) fn answer(&self, number: usize) {
        self.help(End::of(number));
        self.called.fetch_sub(1, Ordering::Relaxed);
    }

    /// Works on the announced stages until the caller quits. A panic is kept for the caller: it must not end
    /// the pool's thread, nor leave the caller without an answer.
    pub(super) fn help(&self, end: End) {
        self.present.fetch_add(1, Ordering::Relaxed);
        let mut turns = 0;
        while !self.quit.load(Ordering::Relaxed) {
            let Some(block) = self.claim(end) else {
                pause(&mut turns);
                continue;
            };
            turns = 0;
            let _done = Done(&self.done);
            // SAFETY: this helper holds a block that is not done, so the caller is still in `run` of the
            // stage that the block belongs to, and does not write.
            if let Some((work, call)) = self.work.with(|slot| unsafe { *slot })
                && let Err(payload) = catch_unwind(AssertUnwindSafe(|| call(work, block)))
            {
                *self.payload.lock().unwrap_or_else(PoisonError::into_inner) = Some(payload);
                self.panicked.store(true, Ordering::Relaxed);
            }
        }
        self.present.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Waits for every claimed block of a stage, also when the caller's own block panics.
struct Finish<'a> {
    stage: &'a Stage,
    blocks: usize,
}

impl Drop for Finish<'_> {
    fn drop(&mut self) {
        // Blocks left unclaimed after a panic are given up, so that only claimed ones are waited for.
        let mut unclaimed = 0;
        while self.stage.claim(End::Front).is_some() {
            unclaimed += 1;
        }
        let mut turns = 0;
        while self.stage.done.load(Ordering::Acquire) + unclaimed < self.blocks {
            pause(&mut turns);
        }
    }
}

/// Sends the helpers away when a step ends, also when it panics.
pub(super) struct Quit<'a> {
    pub(super) stage: &'a Stage,
    /// For those that have arrived: on a thread of the pool, a wait in `join` for a helper takes up other
    /// work meanwhile, and returns when that is done.
    pub(super) wait: bool,
}

impl Drop for Quit<'_> {
    fn drop(&mut self) {
        self.stage.quit.store(true, Ordering::Relaxed);
        let mut turns = 0;
        while self.wait && self.stage.present.load(Ordering::Relaxed) > 0 {
            pause(&mut turns);
        }
    }
}
