//! Blocks of work, claimed one by one; all that knows rayon.
//!
//! A step has hundreds of short parallel stages, and handing each to a pool costs microseconds. So helpers
//! are called once a step: they wait, spinning, for the caller to announce a stage, and claim blocks of it
//! beside the caller, who works where it is. The caller never waits for a helper that has not claimed a
//! block: if none ever arrives, because the pool has other work, the caller does all.

#[cfg_attr(not(feature = "parallel"), allow(dead_code, reason = "only helpers need all of it"))]
mod stage;
mod sync;

use crate::memory::in_arc;
use bytemuck::Pod;
use stage::Stage;
#[cfg(feature = "parallel")]
use stage::{End, Quit};
use std::sync::Arc;

/// The threads of a step: the caller alone, or with helpers.
#[derive(Clone, Copy)]
pub(crate) struct Workers<'a> {
    stage: Option<&'a Stage>,
}

impl Workers<'_> {
    /// Only the caller.
    pub(crate) fn alone() -> Self {
        Workers { stage: None }
    }

    /// Runs `work` once for each block in `0..blocks` and returns when all are done. Blocks run in any order
    /// and at the same time: a block may write only its own data.
    pub(crate) fn run(&self, blocks: usize, work: &(dyn Fn(usize) + Sync)) {
        match self.stage {
            Some(stage) if blocks > 1 && u32::try_from(blocks).is_ok() => stage.run(blocks, work),
            _ => (0..blocks).for_each(work),
        }
    }
}

/// Elements of a block. Under Miri the least, or worlds small enough for it would be one block.
pub(crate) const fn per_block(usual: usize, least: usize) -> usize {
    if cfg!(miri) { least } else { usual }
}

/// Where the helpers of a world's steps look for work. It is kept from step to step, because a helper that
/// the pool had no thread for is not waited for: it may arrive in a later step and help there, or when there
/// is no world any more. Made when help is first asked for from outside of the pool.
#[derive(Debug, Default)]
pub(crate) struct Helpers(Option<Arc<Stage>>);

impl Helpers {
    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let bytes = if self.0.is_some() { in_arc::<Stage>() } else { 0 };
        (bytes, bytes)
    }
}

/// Runs `f` here, with a crew of at most `threads` from the caller's rayon pool.
#[cfg(feature = "parallel")]
pub(crate) fn with_workers<R: Send>(
    threads: usize,
    helpers: &mut Helpers,
    f: impl FnOnce(Workers<'_>) -> R + Send,
) -> R {
    // Asking rayon starts its pool: not for one thread.
    let helping = if threads > 1 { threads.min(rayon::current_num_threads()) - 1 } else { 0 };
    if helping == 0 {
        return f(Workers::alone());
    }
    if rayon::current_thread_index().is_some() {
        let stage = Stage::default();
        return beside(&stage, helping, || {
            let _quit = Quit { stage: &stage, wait: true };
            f(Workers { stage: Some(&stage) })
        });
    }
    let stage = helpers.0.get_or_insert_default();
    stage.open();
    let _quit = Quit { stage, wait: false };
    // Not `join`, which would have this thread wait until the pool has one to run all of this on.
    stage.call(helping, |number| {
        let stage = stage.clone();
        rayon::spawn(move || stage.answer(number));
    });
    f(Workers { stage: Some(stage) })
}

/// Runs `f` on this thread of a pool, and offers so many helpers to the others: offers that none has taken by
/// the end are taken back.
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

/// Runs `f` with the caller alone: built without threads.
#[cfg(not(feature = "parallel"))]
pub(crate) fn with_workers<R>(
    _threads: usize,
    _helpers: &mut Helpers,
    f: impl FnOnce(Workers<'_>) -> R,
) -> R {
    f(Workers::alone())
}

/// A slice whose elements different blocks of a stage may write, each element by one block at most.
pub(crate) struct Shared<'a, T> {
    start: *mut T,
    len: usize,
    lifetime: std::marker::PhantomData<&'a mut [T]>,
}

// SAFETY: the elements are handed out one by one under the contract of `get`; sharing the slice shares
// nothing else.
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
    /// Until the stage is over no other thread may ask for the same element, and this one may hold it only
    /// once.
    #[inline(always)]
    #[allow(clippy::mut_from_ref, reason = "the contract is the caller's, see above")]
    pub(crate) unsafe fn get(&self, i: usize) -> &mut T {
        assert!(i < self.len);
        // SAFETY: inside the slice by the assertion; exclusive by the contract.
        unsafe { &mut *self.start.add(i) }
    }

    /// The element at `i`, to be written; `None` if `i` is outside.
    ///
    /// # Safety
    /// As for [`Shared::get`].
    #[inline(always)]
    #[allow(clippy::mut_from_ref, reason = "the contract is the caller's, see above")]
    pub(crate) unsafe fn find(&self, i: usize) -> Option<&mut T> {
        // SAFETY: by the contract.
        if i < self.len { Some(unsafe { self.get(i) }) } else { None }
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
    /// Until the stage is over no thread may write any.
    #[cfg(feature = "observe")]
    pub(crate) unsafe fn all(&self) -> &[T] {
        // SAFETY: the whole slice; no thread writes by the contract.
        unsafe { std::slice::from_raw_parts(self.start, self.len) }
    }

    /// The same elements as another type of the same size, of which any bits are a value too.
    #[inline(always)]
    pub(crate) fn cast<U: Pod>(&self) -> Shared<'_, U>
    where
        T: Pod,
    {
        // SAFETY: any bits are a value of either.
        unsafe { self.reinterpret() }
    }

    /// The same elements as another type.
    ///
    /// # Safety
    /// Every value of the one type is one of the other, in the same layout.
    #[inline(always)]
    pub(crate) unsafe fn reinterpret<U>(&self) -> Shared<'_, U> {
        const { assert!(size_of::<T>() == size_of::<U>() && align_of::<T>() == align_of::<U>()) };
        Shared { start: self.start.cast(), len: self.len, lifetime: std::marker::PhantomData }
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
        // SAFETY: inside the slice by the assertion; no thread writes by the contract.
        unsafe { *self.start.add(i) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn every_block_runs_once_with_any_crew() {
        for threads in [1, 2, 3, 8] {
            with_workers(threads, &mut Helpers::default(), |workers| {
                for blocks in [0, 1, 2, 7, 100] {
                    for _ in 0..if cfg!(miri) { 4 } else { 50 } {
                        let mut counts = vec![0u32; blocks];
                        let shared = Shared::new(&mut counts);
                        // SAFETY: each block writes its own element.
                        workers.run(blocks, &|block| unsafe { *shared.get(block) += 1 });
                        assert!(counts.iter().all(|&c| c == 1));
                    }
                }
            });
        }
    }

    #[test]
    fn a_crew_without_free_threads_still_finishes() {
        // The pool has one thread, so the helpers that were asked for never arrive.
        with_workers(8, &mut Helpers::default(), |workers| {
            let sum = AtomicUsize::new(0);
            workers.run(1000, &|block| {
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
            let run =
                || with_workers(2, &mut helpers, |workers| workers.run(10, &|block| assert_ne!(block, bad)));
            assert!(catch_unwind(AssertUnwindSafe(run)).is_err());
        }
    }
}
