//! Access to an object: any number of calls that read it, or one that changes it.

use super::status::{Outcome, Refusal};
use parking_lot::{RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::cell::RefCell;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How long a change waits for the reads under way. Much longer than any read takes, but bounded: a callback
/// of a read may itself wait for that change.
const PATIENCE: Duration = Duration::from_secs(1);

thread_local! {
    /// Addresses of the objects that this thread reads. One that it would change, too, it reads in a
    /// callback.
    static READ: RefCell<Vec<usize>> = const { RefCell::new(Vec::new()) };
}

/// An object behind a lock, for which only a change waits, and only for reads.
///
/// A change that waits has the lock's writer bit, so reads that begin meanwhile are refused, as they are
/// beside the change itself. Otherwise reads that overlap without a gap would keep every change out.
pub(crate) struct Shared<T> {
    content: RwLock<T>,
    /// Whether a change panicked, and may have left half of its work.
    broken: AtomicBool,
}

impl<T> Shared<T> {
    pub(crate) fn new(content: T) -> Shared<T> {
        Shared { content: RwLock::new(content), broken: AtomicBool::new(false) }
    }

    /// To read. Refused beside a change.
    pub(crate) fn read(&self) -> Outcome<Reading<'_, T>> {
        let guard = self.content.try_read().ok_or(Refusal::Busy)?;
        self.whole()?;
        let address = self.address();
        READ.with_borrow_mut(|read| read.push(address));
        Ok(Reading { guard, address })
    }

    /// To change. Refused beside another change, and by a callback of a read.
    pub(crate) fn change(&self) -> Outcome<Changing<'_, T>> {
        let guard = self.lock()?;
        self.whole()?;
        Ok(guard)
    }

    /// Replaces the content as a whole, whether or not it is broken, which the closure is told; if it
    /// succeeds, the content is whole.
    pub(crate) fn mend(&self, mend: impl FnOnce(&mut T, bool) -> Outcome) -> Outcome {
        let mut guard = self.lock()?;
        mend(&mut guard, self.broken.load(Ordering::Relaxed))?;
        self.broken.store(false, Ordering::Relaxed);
        Ok(())
    }

    fn whole(&self) -> Outcome {
        // The lock orders it.
        if self.broken.load(Ordering::Relaxed) { Err(Refusal::Panicked) } else { Ok(()) }
    }

    fn address(&self) -> usize {
        std::ptr::from_ref(self).addr()
    }

    fn lock(&self) -> Outcome<Changing<'_, T>> {
        let in_callback = READ.with_borrow(|read| read.contains(&self.address()));
        let guard = if in_callback || self.content.is_locked_exclusive() {
            self.content.try_write()
        } else {
            self.content.try_write_until(Instant::now() + PATIENCE)
        };
        let guard = guard.ok_or(Refusal::Busy)?;
        Ok(Changing { guard, broken: &self.broken, panicking: std::thread::panicking() })
    }
}

/// See [`Shared::read`].
pub(crate) struct Reading<'a, T> {
    guard: RwLockReadGuard<'a, T>,
    address: usize,
}

impl<T> Deref for Reading<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.guard
    }
}

impl<T> Drop for Reading<'_, T> {
    fn drop(&mut self) {
        READ.with_borrow_mut(|read| {
            if let Some(last) = read.iter().rposition(|&address| address == self.address) {
                read.swap_remove(last);
            }
        });
    }
}

/// See [`Shared::change`]. A panic while it is held breaks the object.
pub(crate) struct Changing<'a, T> {
    guard: RwLockWriteGuard<'a, T>,
    broken: &'a AtomicBool,
    /// Whether the thread was unwinding already.
    panicking: bool,
}

impl<T> Deref for Changing<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.guard
    }
}

impl<T> DerefMut for Changing<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.guard
    }
}

impl<T> Drop for Changing<'_, T> {
    fn drop(&mut self) {
        if !self.panicking && std::thread::panicking() {
            self.broken.store(true, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::abi::guard::call;
    use crate::abi::status::{BS_ERROR_BUSY, BS_ERROR_PANIC, BS_OK};
    use std::sync::atomic::AtomicU32;

    /// Two threads that read without a gap kept the one that changes out: 0 of 600. Expected: each change
    /// waits for the reads under way and then comes through, and reads come through between changes.
    #[test]
    fn readers_that_never_pause_keep_no_change_out() {
        let (shared, done, reads) = (Shared::new(0u32), AtomicBool::new(false), AtomicU32::new(0));
        std::thread::scope(|scope| {
            for _ in 0..3 {
                scope.spawn(|| {
                    while !done.load(Ordering::Relaxed) {
                        if let Ok(value) = shared.read() {
                            std::thread::sleep(Duration::from_micros(20));
                            std::hint::black_box(*value);
                            reads.fetch_add(1, Ordering::Relaxed);
                        }
                    }
                });
            }
            for i in 0..600 {
                *shared.change().unwrap_or_else(|_| panic!("change {i}")) += 1;
                std::thread::sleep(Duration::from_micros(50));
            }
            done.store(true, Ordering::Relaxed);
        });
        assert_eq!(*shared.read().unwrap(), 600);
        assert!(reads.load(Ordering::Relaxed) > 0);
    }

    /// Expected: at once, as nothing would ever end the wait.
    #[test]
    fn a_callback_of_a_read_is_refused_a_change_of_the_same_object() {
        let shared = Shared::new(0);
        let (start, read) = (Instant::now(), shared.read().unwrap());
        assert_eq!(call(|| shared.change().map(drop)), BS_ERROR_BUSY);
        assert!(start.elapsed() < PATIENCE / 2);
        drop(read);
        assert_eq!(call(|| shared.change().map(drop)), BS_OK);
        // Nor does a change wait for another.
        let start = Instant::now();
        let change = shared.change().unwrap();
        std::thread::scope(|scope| {
            scope.spawn(|| assert_eq!(call(|| shared.change().map(drop)), BS_ERROR_BUSY));
            scope.spawn(|| assert_eq!(call(|| shared.read().map(drop)), BS_ERROR_BUSY));
        });
        drop(change);
        assert!(start.elapsed() < PATIENCE / 2);
    }

    /// Expected: after a while, as a callback that waits for another thread's change would never end.
    #[test]
    fn a_change_gives_up_on_a_read_that_does_not_end() {
        let shared = Shared::new(0);
        let (start, _read) = (Instant::now(), shared.read().unwrap());
        std::thread::scope(|scope| {
            scope.spawn(|| assert_eq!(call(|| shared.change().map(drop)), BS_ERROR_BUSY));
        });
        assert!(start.elapsed() >= PATIENCE);
        assert_eq!(call(|| shared.read().map(drop)), BS_OK);
    }

    #[test]
    fn a_change_that_panics_breaks_the_object_until_it_is_mended() {
        let shared = Shared::new(0);
        let panics = || {
            let _change = shared.change()?;
            panic!("halfway");
        };
        assert_eq!(call(panics), BS_ERROR_PANIC);
        assert_eq!(call(|| shared.read().map(drop)), BS_ERROR_PANIC);
        assert_eq!(call(|| shared.change().map(drop)), BS_ERROR_PANIC);
        assert_eq!(
            call(|| shared.mend(|_, broken| {
                assert!(broken);
                Err(Refusal::Busy)
            })),
            BS_ERROR_BUSY
        );
        assert_eq!(call(|| shared.read().map(drop)), BS_ERROR_PANIC);
        assert_eq!(call(|| shared.mend(|_, _| Ok(()))), BS_OK);
        assert_eq!(call(|| shared.read().map(drop)), BS_OK);
    }
}
