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

    fn at(&self, i: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..][..self.size]
    }

    fn iter(&self) -> impl Iterator<Item = &'a [u8]> + '_ {
        (0..self.count).map(|i| self.at(i))
    }
}

const OUTSIDE: &str = "an accessor reaches beyond its buffer";

/// Positions as they lie in the file. Implicit zeros take no memory: a file of a few hundred bytes may state
/// millions of them.
pub(super) struct Positions<'a> {
    elements: Option<Elements<'a>>,
    count: usize,
    /// In ascending order of the index.
    sparse: Vec<(u32, Vec3)>,
}

impl<'a> Positions<'a> {
    /// Those of an accessor of vectors of f32 [m].
    pub(super) fn new(accessor: &gltf::Accessor, buffers: &'a [Vec<u8>]) -> Result<Positions<'a>, String> {
        if accessor.dimensions() != Dimensions::Vec3 || accessor.data_type() != DataType::F32 {
            return Err("positions must be vectors of three f32".into());
        }
        let count = accessor.count();
        let elements = match accessor.view() {
            Some(view) => Some(Elements::new(buffers, &view, accessor.offset(), count, 12).ok_or(OUTSIDE)?),
            // All zero but for the sparse ones; without any, the data is somewhere we can't read.
            None if accessor.sparse().is_some() => None,
            None => return Err("positions without a buffer (compressed meshes are not read)".into()),
        };
        let mut sparse = Vec::new();
        if let Some(list) = accessor.sparse() {
            let (at, values) = (list.indices(), list.values());
            let size = at.index_type().size();
            let places =
                Elements::new(buffers, &at.view(), at.offset(), list.count(), size).ok_or(OUTSIDE)?;
            let values =
                Elements::new(buffers, &values.view(), values.offset(), list.count(), 12).ok_or(OUTSIDE)?;
            sparse.extend(places.iter().map(unsigned).zip(values.iter().map(vector)));
            if sparse.iter().any(|&(place, _)| place as usize >= count) {
                return Err("a sparse index is out of range".into());
            }
            sparse.sort_by_key(|s| s.0);
        }
        let stored = elements.iter().flat_map(Elements::iter).map(vector);
        let finite = stored.chain(sparse.iter().map(|s| s.1)).all(|p| p.is_finite());
        match finite {
            true => Ok(Positions { elements, count, sparse }),
            false => Err("a position is not finite".into()),
        }
    }

    pub(super) fn get(&self, index: u32) -> Option<Vec3> {
        // Among several for one index, the last counts.
        let after = self.sparse.partition_point(|s| s.0 <= index);
        match self.sparse[..after].last() {
            Some(&(place, value)) if place == index => Some(value),
            _ if index as usize >= self.count => None,
            _ => Some(self.elements.as_ref().map_or(Vec3::ZERO, |e| vector(e.at(index as usize)))),
        }
    }
}

fn vector(b: &[u8]) -> Vec3 {
    let number = |i: usize| f32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]]);
    Vec3::new(number(0), number(4), number(8))
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
