//! Snapshots in recordings: the state of each, and the parts that they share, which are written once.

use super::geometry::{Known, found, here};
use super::part::Part;
use super::{Snapshot, weak};
use crate::error::Error;
use crate::shape::Geometry;
use crate::words::broken;
use crate::world::{SharedPart, World};
use std::borrow::Cow;
use std::sync::Arc;

/// A part that snapshots share, out of a recording.
#[derive(Clone, Debug)]
pub(crate) struct RecordedPart(Arc<Part>);

impl RecordedPart {
    /// From the bytes of [`Snapshot::part`] and its geometry.
    ///
    /// # Errors
    /// If they are not those of a part.
    pub(crate) fn new(bytes: &[u8], geometry: Vec<Geometry>) -> Result<RecordedPart, Error> {
        let (words, []) = bytes.as_chunks::<4>() else { return Err(broken("a part")) };
        let words = words.iter().map(|&word| u32::from_le_bytes(word)).collect();
        Ok(RecordedPart(Arc::new(Part::new(words, geometry.into_iter().map(Known::Here).collect()))))
    }
}

impl Snapshot {
    /// The same with geometry in the place of fingerprints, which a world has to have.
    ///
    /// # Errors
    /// If it lacks some.
    pub(super) fn with_geometry_of(&self, world: &World) -> Result<Cow<'_, Snapshot>, Error> {
        if self.foreign.is_none() {
            return Ok(Cow::Borrowed(self));
        }
        let mut own = self.clone();
        own.forms = found(&self.forms, world)?;
        for part in own.parts.iter_mut().flatten() {
            *part = Arc::new(Part::new(part.words.clone(), found(&part.geometry, world)?));
        }
        Ok(Cow::Owned(own))
    }

    /// The parts that it has in memory, to be told from others.
    pub(crate) fn part_keys(&self) -> Option<[SharedPart; 2]> {
        let [Some(fixed), Some(moving)] = &self.parts else { return None };
        Some([weak(fixed), weak(moving)])
    }

    /// The bytes of one of its parts, and the geometry that they refer to.
    pub(crate) fn part(&self, which: usize) -> (Vec<u8>, Vec<&Geometry>) {
        let Some(part) = &self.parts[which] else { return Default::default() };
        (part.words.iter().flat_map(|word| word.to_le_bytes()).collect(), here(&part.geometry).collect())
    }

    /// The hulls of its characters.
    pub(crate) fn hulls(&self) -> Vec<&Geometry> {
        here(&self.forms).collect()
    }

    /// One out of a recording: from the bytes of its state, the hulls of its characters, and its parts unless
    /// they are those of the world.
    ///
    /// # Errors
    /// As for [`Snapshot::from_bytes`].
    pub(crate) fn of_recording(
        state: &[u8],
        hulls: Vec<Geometry>,
        parts: Option<[RecordedPart; 2]>,
    ) -> Result<Snapshot, Error> {
        let mut snapshot = Snapshot::from_bytes(state)?;
        snapshot.forms = hulls.into_iter().map(Known::Here).collect();
        if let Some(parts) = parts {
            snapshot.parts = parts.map(|part| Some(part.0));
        }
        Ok(snapshot)
    }
}
