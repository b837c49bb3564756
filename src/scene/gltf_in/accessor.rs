//! Positions and indices out of buffers, with every offset checked before it is used.

use glam::Vec3;
use gltf::accessor::{DataType, Dimensions};

/// `count` elements of `size` bytes, `stride` apart.
struct Elements<'a> {
    bytes: &'a [u8],
    count: usize,
    stride: usize,
    size: usize,
}

impl<'a> Elements<'a> {
    fn new(
        buffers: &'a [Vec<u8>],
        view: &gltf::buffer::View,
        offset: usize,
        count: usize,
        size: usize,
    ) -> Option<Self> {
        let buffer = buffers.get(view.buffer().index())?;
        let bytes = buffer.get(view.offset()..view.offset().checked_add(view.length())?)?;
        let stride = view.stride().unwrap_or(size);
        let end = match count {
            0 => offset,
            _ => stride.checked_mul(count - 1)?.checked_add(offset)?.checked_add(size)?,
        };
        (stride >= size && end <= bytes.len()).then(|| Elements {
            bytes: &bytes[offset..],
            count,
            stride,
            size,
        })
    }

    fn iter(&self) -> impl Iterator<Item = &'a [u8]> + '_ {
        (0..self.count).map(|i| &self.bytes[i * self.stride..][..self.size])
    }
}

const OUTSIDE: &str = "an accessor reaches beyond its buffer";

/// Positions as vectors of f32 [m].
pub(super) fn positions(accessor: &gltf::Accessor, buffers: &[Vec<u8>]) -> Result<Vec<Vec3>, String> {
    if accessor.dimensions() != Dimensions::Vec3 || accessor.data_type() != DataType::F32 {
        return Err("positions must be vectors of three f32".into());
    }
    let vector = |b: &[u8]| {
        let number = |i: usize| f32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]]);
        Vec3::new(number(0), number(4), number(8))
    };
    let count = accessor.count();
    let mut out = match accessor.view() {
        Some(view) => {
            let elements = Elements::new(buffers, &view, accessor.offset(), count, 12).ok_or(OUTSIDE)?;
            elements.iter().map(vector).collect()
        }
        // All zero but for the sparse ones; without any, the data is somewhere we can't read.
        None if accessor.sparse().is_some() && count < 1 << 24 => vec![Vec3::ZERO; count],
        None => return Err("positions without a buffer (compressed meshes are not read)".into()),
    };
    if let Some(sparse) = accessor.sparse() {
        let (at, values) = (sparse.indices(), sparse.values());
        let size = at.index_type().size();
        let places = Elements::new(buffers, &at.view(), at.offset(), sparse.count(), size).ok_or(OUTSIDE)?;
        let values =
            Elements::new(buffers, &values.view(), values.offset(), sparse.count(), 12).ok_or(OUTSIDE)?;
        for (place, value) in places.iter().map(unsigned).zip(values.iter().map(vector)) {
            *out.get_mut(place as usize).ok_or("a sparse index is out of range")? = value;
        }
    }
    match out.iter().all(|p| p.is_finite()) {
        true => Ok(out),
        false => Err("a position is not finite".into()),
    }
}

/// Indices of vertices.
pub(super) fn indices(accessor: &gltf::Accessor, buffers: &[Vec<u8>]) -> Result<Vec<u32>, String> {
    if accessor.dimensions() != Dimensions::Scalar {
        return Err("indices must be scalars".into());
    }
    let size = match accessor.data_type() {
        DataType::U8 => 1,
        DataType::U16 => 2,
        DataType::U32 => 4,
        _ => return Err("indices must be unsigned".into()),
    };
    if accessor.sparse().is_some() {
        return Err("sparse indices are not read".into());
    }
    let view = accessor.view().ok_or("indices without a buffer")?;
    let elements = Elements::new(buffers, &view, accessor.offset(), accessor.count(), size).ok_or(OUTSIDE)?;
    Ok(elements.iter().map(unsigned).collect())
}

fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |n, &b| n << 8 | u32::from(b))
}
