//! Bytes of a buffer.

/// Live and reserved bytes of a vector's buffer.
pub(crate) fn bytes_of<T>(column: &Vec<T>) -> (usize, usize) {
    (std::mem::size_of_val(column.as_slice()), column.capacity() * size_of::<T>())
}

/// Bytes that an `Arc` of a value takes beside what the value itself holds: the value, and two counts before it.
pub(crate) const fn in_arc<T>() -> usize {
    #[repr(C)]
    struct Shared<T>([usize; 2], T);
    size_of::<Shared<T>>()
}
