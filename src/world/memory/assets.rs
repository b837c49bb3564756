//! Hulls, meshes and height fields that shapes share.

use crate::memory::{Amounts, Category, in_arc};
use crate::shape::{Geometry, Kind};

/// Shared geometry, counted once however many shapes use it.
#[derive(Debug, Default)]
pub(in crate::world) struct Assets {
    /// Address, number of uses, kind, and bytes.
    pub(in crate::world) list: Vec<(usize, u32, Kind, (usize, usize))>,
}

impl Assets {
    fn key(geometry: &Geometry) -> Option<(usize, Kind, (usize, usize))> {
        // The size of the shared value is included in its bytes; the rest is the counters of the `Arc`.
        let counts = in_arc::<usize>() - size_of::<usize>();
        let (live, reserved) = geometry.bytes();
        Some((geometry.address()?, Kind::of(geometry), (live + counts, reserved + counts)))
    }

    /// How many shapes use a geometry.
    pub(in crate::world) fn uses(&self, geometry: &Geometry) -> u32 {
        let key = Self::key(geometry).map_or(0, |entry| entry.0);
        self.list.binary_search_by_key(&key, |e| e.0).map_or(0, |i| self.list[i].1)
    }

    pub(in crate::world) fn add(&mut self, geometry: &Geometry) {
        if let Some((key, kind, bytes)) = Self::key(geometry) {
            match self.list.binary_search_by_key(&key, |e| e.0) {
                Ok(i) => self.list[i].1 += 1,
                Err(i) => self.list.insert(i, (key, 1, kind, bytes)),
            }
        }
    }

    pub(in crate::world) fn remove(&mut self, geometry: &Geometry) {
        if let Some((key, ..)) = Self::key(geometry)
            && let Ok(i) = self.list.binary_search_by_key(&key, |e| e.0)
        {
            self.list[i].1 -= 1;
            if self.list[i].1 == 0 {
                self.list.remove(i);
            }
        }
    }

    fn category(kind: Kind) -> Category {
        if kind == Kind::Hull { Category::Shapes } else { Category::Meshes }
    }

    /// Category and bytes of each geometry.
    pub(in crate::world) fn bytes(&self) -> impl Iterator<Item = (Category, (usize, usize))> + '_ {
        self.list.iter().map(|&(_, _, kind, bytes)| (Self::category(kind), bytes))
    }

    /// Reserved bytes of all geometries of a kind.
    pub(in crate::world) fn bytes_of(&self, kind: Kind) -> usize {
        self.list.iter().filter(|one| one.2 == kind).map(|one| one.3.1).sum()
    }

    /// Bytes that geometries would add, each counted once, and how many of them are new.
    pub(in crate::world) fn cost<'a>(
        &self,
        geometries: impl Iterator<Item = &'a Geometry>,
    ) -> (Amounts, usize) {
        let is_new = |key: usize| self.list.binary_search_by_key(&key, |e| e.0).is_err();
        let mut new: Vec<_> = geometries.filter_map(Self::key).filter(|(key, ..)| is_new(*key)).collect();
        new.sort_unstable();
        new.dedup();
        let mut bytes = Amounts::default();
        new.iter().for_each(|&(_, kind, (_, reserved))| bytes.add(Self::category(kind), reserved));
        (bytes, new.len())
    }
}
