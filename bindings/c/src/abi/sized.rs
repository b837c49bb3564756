//! Descriptions that may grow: `size` comes first, and a shorter one means defaults for the rest.

use super::status::{Outcome, Refusal};
use std::mem::MaybeUninit;

/// A description that begins with its size.
///
/// # Safety
/// It is `repr(C)`, its first field is a `u32` with the size, any bytes are a valid value of it, and `ENDS`
/// are the ends of its fields.
pub(crate) unsafe trait Described: Copy {
    /// What messages call it.
    const NAME: &'static str;
    /// Where fields end [bytes]: the sizes that it has had or may have had.
    const ENDS: &'static [usize];

    /// The values of fields that the caller does not know of.
    fn defaults() -> Self;
}

/// Size of a field, by how it is reached.
pub(crate) const fn size_of_field<T, F>(_: fn(&T) -> &F) -> usize {
    size_of::<F>()
}

/// Whether fields follow each other without a gap: in a gap a later field would find a caller who never heard
/// of it.
pub(crate) const fn has_no_gaps(starts: &[usize], ends: &[usize], size: usize) -> bool {
    let mut at = 0;
    let mut i = 0;
    while i < starts.len() {
        if starts[i] != at {
            return false;
        }
        at = ends[i];
        i += 1;
    }
    at == size
}

/// Implements `Described` for a type by the list of its fields; [`record`](super::twin::record) has the list.
macro_rules! described {
    ($name:ident, $defaults:expr, [$($field:ident),* $(,)?]) => {
        // SAFETY: all of these types are `repr(C)`, of numbers, pointers and optional functions; the ends are
        // taken from the fields themselves.
        unsafe impl $crate::abi::sized::Described for $name {
            const NAME: &'static str = stringify!($name);
            const ENDS: &'static [usize] = &[$(
                std::mem::offset_of!($name, $field)
                    + $crate::abi::sized::size_of_field(|this: &$name| &this.$field),
            )*];

            fn defaults() -> Self {
                $defaults
            }
        }

        // Pointers are of another size elsewhere, and there a gap is the lesser evil.
        #[cfg(target_pointer_width = "64")]
        const _: () = assert!($crate::abi::sized::has_no_gaps(
            &[$(std::mem::offset_of!($name, $field)),*],
            <$name as $crate::abi::sized::Described>::ENDS,
            size_of::<$name>(),
        ));
    };
}
pub(crate) use described;

/// Reads a description.
///
/// # Safety
/// If it is not null and aligned, it points to a size and to so many bytes, size included.
pub(crate) unsafe fn read<T: Described>(at: *const T) -> Outcome<T> {
    if at.is_null() || !at.is_aligned() {
        return Err(Refusal::Null(T::NAME));
    }
    // SAFETY: the size is the first field.
    let size = unsafe { at.cast::<u32>().read() };
    // SAFETY: the size was read from there.
    unsafe { read_of_size(at, size) }
}

/// Reads a description of a size that the caller says: with an array of them, that of its first.
///
/// # Safety
/// So many bytes can be read.
unsafe fn read_of_size<T: Described>(at: *const T, size: u32) -> Outcome<T> {
    let known = T::ENDS.contains(&(size as usize));
    if !known {
        return Err(Refusal::Size { what: T::NAME, given: size, own: size_of::<T>() });
    }
    let mut value = MaybeUninit::new(T::defaults());
    // SAFETY: `ENDS` does not go beyond the type, and any bytes are a value of it.
    let mut value = unsafe {
        std::ptr::copy_nonoverlapping(at.cast::<u8>(), value.as_mut_ptr().cast::<u8>(), size as usize);
        value.assume_init()
    };
    // From here on it is one of this version.
    // SAFETY: the size is the first field.
    unsafe { (&raw mut value).cast::<u32>().write(size_of::<T>() as u32) };
    Ok(value)
}

/// The same, where null means the defaults.
///
/// # Safety
/// As `read`.
pub(crate) unsafe fn read_or_default<T: Described>(at: *const T) -> Outcome<T> {
    if at.is_null() {
        return Ok(T::defaults());
    }
    // SAFETY: as this function.
    unsafe { read(at) }
}

/// Reads an array of descriptions, which all have the size of the first.
///
/// # Safety
/// As `read`, for `count` of them, one after the other by that size.
pub(crate) unsafe fn read_all<T: Described>(at: *const T, count: usize) -> Outcome<Vec<T>> {
    if count == 0 {
        return Ok(Vec::new());
    }
    // SAFETY: the first is one.
    let first = unsafe { read(at) }?;
    // SAFETY: `read` has checked the pointer.
    let size = unsafe { at.cast::<u32>().read() };
    let stride = size as usize;
    if !stride.is_multiple_of(align_of::<T>()) || count.checked_mul(stride).is_none() {
        return Err(Refusal::Size { what: T::NAME, given: size, own: size_of::<T>() });
    }
    let mut all = vec![first];
    for i in 1..count {
        // SAFETY: the caller has so many of them, and the stride keeps the alignment.
        let next = unsafe {
            let next = at.byte_add(i * stride);
            (next, next.cast::<u32>().read())
        };
        if next.1 != size {
            return Err(Refusal::Size { what: T::NAME, given: next.1, own: size_of::<T>() });
        }
        // SAFETY: the size was read from there.
        all.push(unsafe { read_of_size(next.0, size) }?);
    }
    Ok(all)
}

/// How much of a report a struct of the caller has place for, whose `size` says how much of it the caller
/// knows.
///
/// # Safety
/// As `read`.
pub(crate) unsafe fn place<T: Described>(at: *const T) -> Outcome<usize> {
    if at.is_null() || !at.is_aligned() {
        return Err(Refusal::Null(T::NAME));
    }
    // SAFETY: the size is the first field.
    let given = unsafe { at.cast::<u32>().read() };
    let size = (given as usize).min(size_of::<T>());
    if !T::ENDS.contains(&size) {
        return Err(Refusal::Size { what: T::NAME, given, own: size_of::<T>() });
    }
    Ok(size)
}

/// Writes a report into a struct of the caller: no more than there is place for, and `size` becomes what was
/// written.
///
/// # Safety
/// As `read`, and so many bytes can be written.
pub(crate) unsafe fn write<T: Described>(at: *mut T, value: T) -> Outcome {
    // SAFETY: as this function.
    let size = unsafe { place(at) }?;
    // SAFETY: the caller has at least so many bytes.
    unsafe {
        std::ptr::copy_nonoverlapping((&raw const value).cast::<u8>(), at.cast::<u8>(), size);
        at.cast::<u32>().write(size as u32);
    }
    Ok(())
}
