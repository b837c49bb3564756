//! What `src/threads/sync.rs` has of the standard library, by loom: each access is an event that the model
//! checker orders.

pub(crate) use loom::cell::UnsafeCell;
pub(crate) use loom::sync::Mutex;
pub(crate) use loom::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// Turns in vain after which a helper sleeps.
const PATIENCE: u32 = 1;

/// Lets another thread run: nothing changes until one has. A helper that has found nothing for some turns
/// sleeps until the case is over, or two of them could give way to each other for ever while the caller never
/// runs. A turn in vain changes nothing, so what it might have claimed later is claimed in another execution,
/// by one that came late.
pub(crate) fn pause(turns: &mut u32) {
    *turns += 1;
    if *turns > PATIENCE && loom::thread::current().name() == Some(crate::HELPER) {
        loom::thread::park();
    } else {
        loom::thread::yield_now();
    }
}
