//! The parts of the standard library that threads share. The model check puts loom's in their place
//! (`loom/src/sync.rs`).

pub(super) use std::sync::Mutex;
pub(super) use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// [`std::cell::UnsafeCell`] with the interface of loom's, which sees when an access begins and ends.
#[derive(Debug, Default)]
pub(super) struct UnsafeCell<T>(std::cell::UnsafeCell<T>);

impl<T> UnsafeCell<T> {
    pub(super) fn with<R>(&self, read: impl FnOnce(*const T) -> R) -> R {
        read(self.0.get())
    }

    pub(super) fn with_mut<R>(&self, write: impl FnOnce(*mut T) -> R) -> R {
        write(self.0.get())
    }
}

/// One turn of a loop that waits for another thread; `turns` counts them. A thread whose core is wanted by
/// someone else gives way after some microseconds.
pub(super) fn pause(turns: &mut u32) {
    *turns = turns.saturating_add(1);
    if *turns < 4096 { std::hint::spin_loop() } else { std::thread::yield_now() }
}
