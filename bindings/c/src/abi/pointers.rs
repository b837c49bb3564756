//! Pointers of the caller, checked as far as they can be: null, alignment, capacity. That they point to what
//! the header says is the caller's promise, and the one thing that each function here asks for.

use super::status::{Outcome, Refusal};

/// What a pointer points to.
///
/// # Safety
/// If it is not null and aligned, it points to a valid `T`, which nothing changes for `'a`.
pub(crate) unsafe fn borrow<'a, T>(what: &'static str, at: *const T) -> Outcome<&'a T> {
    if at.is_null() || !at.is_aligned() {
        return Err(Refusal::Null(what));
    }
    // SAFETY: checked above, and promised by the caller.
    Ok(unsafe { &*at })
}

/// So many elements. Null will do for none.
///
/// # Safety
/// As `borrow`, for `count` elements.
pub(crate) unsafe fn slice<'a, T>(what: &'static str, at: *const T, count: usize) -> Outcome<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check(what, at, count)?;
    // SAFETY: checked above, and promised by the caller.
    Ok(unsafe { std::slice::from_raw_parts(at, count) })
}

fn check<T>(what: &'static str, at: *const T, count: usize) -> Outcome {
    let fits = count.checked_mul(size_of::<T>()).is_some_and(|bytes| bytes <= isize::MAX as usize);
    if at.is_null() || !at.is_aligned() || !fits {
        return Err(Refusal::Null(what));
    }
    Ok(())
}

/// A place for one value, which is written when everything has succeeded.
#[derive(Clone, Copy)]
pub(crate) struct Out<T>(*mut T);

impl<T> Out<T> {
    /// # Safety
    /// If it is not null and aligned, a `T` can be written to it, for as long as the `Out` is used.
    pub(crate) unsafe fn new(what: &'static str, at: *mut T) -> Outcome<Out<T>> {
        if at.is_null() || !at.is_aligned() { Err(Refusal::Null(what)) } else { Ok(Out(at)) }
    }

    /// The same, where null means that the caller does not want it.
    ///
    /// # Safety
    /// As `new`.
    pub(crate) unsafe fn optional(what: &'static str, at: *mut T) -> Outcome<Option<Out<T>>> {
        if at.is_null() {
            return Ok(None);
        }
        // SAFETY: as this function.
        unsafe { Out::new(what, at) }.map(Some)
    }

    pub(crate) fn set(self, value: T) {
        // SAFETY: `new` checked the pointer, and its caller promised the rest. What was there is the
        // caller's, who may not have written anything yet: it is not dropped.
        unsafe { self.0.write(value) }
    }
}

/// A buffer of the caller with the place for the number of its elements.
pub(crate) struct Buffer<T> {
    what: &'static str,
    at: *mut T,
    capacity: usize,
    count: Out<usize>,
}

impl<T> Buffer<T> {
    /// The buffer may be null if its capacity is zero.
    ///
    /// # Safety
    /// If they are not null and aligned, `capacity` elements can be written to `at` and one to `count`.
    pub(crate) unsafe fn new(
        what: &'static str,
        at: *mut T,
        capacity: usize,
        count: *mut usize,
    ) -> Outcome<Buffer<T>> {
        if capacity > 0 {
            check(what, at, capacity)?;
        }
        // SAFETY: as this function.
        let count = unsafe { Out::new("the count", count) }?;
        Ok(Buffer { what, at, capacity, count })
    }

    /// Whether so many fit; writes the number.
    pub(crate) fn reserve(&self, needed: usize) -> Outcome {
        self.count.set(needed);
        if needed > self.capacity {
            return Err(Refusal::Buffer { what: self.what, capacity: self.capacity, needed });
        }
        Ok(())
    }

    /// Writes all of them, or only their number.
    pub(crate) fn fill(&self, items: impl ExactSizeIterator<Item = T>) -> Outcome {
        self.fill_with(items.len(), items)
    }

    /// Writes so many of them, or only their number.
    pub(crate) fn fill_with(&self, count: usize, items: impl Iterator<Item = T>) -> Outcome {
        self.reserve(count)?;
        for (i, item) in items.take(self.capacity).enumerate() {
            // SAFETY: `i` is below the capacity, for which `new` checked the pointer and its caller promised
            // the rest.
            unsafe { self.at.add(i).write(item) }
        }
        Ok(())
    }
}
