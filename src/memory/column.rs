//! Bytes of a buffer.

/// Live and reserved bytes of a vector's buffer.
pub(crate) fn bytes_of<T>(column: &Vec<T>) -> (usize, usize) {
    (std::mem::size_of_val(column.as_slice()), column.capacity() * size_of::<T>())
}

/// Live and reserved bytes of two things together.
pub(crate) fn add_bytes(one: (usize, usize), other: (usize, usize)) -> (usize, usize) {
    (one.0 + other.0, one.1 + other.1)
}

/// Live and reserved bytes of several things together.
pub(crate) fn sum_bytes(all: impl IntoIterator<Item = (usize, usize)>) -> (usize, usize) {
    all.into_iter().fold((0, 0), add_bytes)
}

/// Bytes that an `Arc` of a value takes beside the bytes held by the value: the value, and two counts before
/// it.
pub(crate) const fn in_arc<T>() -> usize {
    #[repr(C)]
    struct Shared<T>([usize; 2], T);
    size_of::<Shared<T>>()
}
