//! Bytes of a buffer.

/// Live and reserved bytes of a vector's buffer.
pub(crate) fn bytes_of<T>(column: &Vec<T>) -> (usize, usize) {
    (std::mem::size_of_val(column.as_slice()), column.capacity() * size_of::<T>())
}
