//! The border: only a status crosses it, never a panic.

use super::status::{BS_OK, BsStatus, Outcome, Refusal, keep_message};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs the body of a function of the interface.
///
/// Unwind safety: what a panic may leave half done is behind a lock, and the lock is poisoned by it.
pub(crate) fn call(work: impl FnOnce() -> Outcome) -> BsStatus {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => {
            keep_message(None);
            BS_OK
        }
        Ok(Err(refusal)) => {
            keep_message(Some(&refusal));
            refusal.status()
        }
        Err(payload) => {
            keep_message(Some(&format_args!("a call panicked: {}", words_of(&*payload))));
            drop_quietly(payload);
            Refusal::Panicked.status()
        }
    }
}

/// The same for functions that can't fail but by a defect, and have a value to return then.
pub(crate) fn value_or<T>(otherwise: T, work: impl FnOnce() -> T) -> T {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(value) => value,
        Err(payload) => {
            drop_quietly(payload);
            otherwise
        }
    }
}

fn words_of(payload: &(dyn Any + Send)) -> &str {
    let fixed = payload.downcast_ref::<&'static str>().copied();
    fixed.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no words")
}

/// A payload may panic when it is dropped.
fn drop_quietly(payload: Box<dyn Any + Send>) {
    if let Err(second) = catch_unwind(AssertUnwindSafe(|| drop(payload))) {
        std::mem::forget(second);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::abi::status::{BS_ERROR_NULL, BS_ERROR_PANIC, bs_last_error};
    use std::ffi::CStr;

    fn message() -> String {
        // SAFETY: it is valid until the next call of this thread, and copied before.
        unsafe { CStr::from_ptr(bs_last_error()) }.to_str().unwrap().to_owned()
    }

    struct Bomb;

    impl Drop for Bomb {
        fn drop(&mut self) {
            panic!("once more");
        }
    }

    #[test]
    fn a_panic_becomes_a_status_with_its_words() {
        assert_eq!(call(|| panic!("number {}", 7)), BS_ERROR_PANIC);
        assert_eq!(message(), "a call panicked: number 7");
        assert_eq!(call(|| std::panic::panic_any(Bomb)), BS_ERROR_PANIC);
        assert_eq!(message(), "a call panicked: no words");
        assert_eq!(value_or(3, || panic!("none")), 3);
        assert_eq!(call(|| Err(Refusal::Null("desc"))), BS_ERROR_NULL);
        assert_eq!(message(), "desc is null or misaligned");
        assert_eq!(call(|| Ok(())), BS_OK);
        assert_eq!(message(), "");
    }
}
