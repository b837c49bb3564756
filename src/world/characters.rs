//! Characters that live in a world. Here they are a geometry and words, which snapshots, hashes and
//! recordings carry; `src/character/` reads and writes these.

use crate::error::Error;
use crate::handle::CharacterHandle;
use crate::memory::{Buffer, buffers};
use crate::shape::Geometry;
use crate::world::World;

/// Words of a character besides its geometry.
pub(crate) const CHARACTER_WORDS: usize = 51;

/// A character of a world.
#[derive(Clone, Debug)]
pub(crate) struct Resident {
    /// Its shape, if that is no capsule of its settings.
    pub(crate) geometry: Option<Geometry>,
    pub(crate) words: [u32; CHARACTER_WORDS],
}

/// A place for a character, and how many it had.
#[derive(Debug)]
pub(crate) struct CharacterSlot {
    pub(crate) generation: u32,
    pub(crate) resident: Option<Resident>,
}

/// All characters of a world, by slot.
#[derive(Debug, Default)]
pub(crate) struct Characters {
    pub(crate) slots: Vec<CharacterSlot>,
}

buffers! { Characters { bytes { slots } } }

impl Characters {
    pub(crate) fn get(&self, handle: CharacterHandle) -> Result<&Resident, Error> {
        let place =
            self.slots.get(handle.slot as usize).filter(|place| place.generation == handle.generation);
        place.and_then(|place| place.resident.as_ref()).ok_or(Error::StaleCharacter)
    }

    /// Handles and characters, by slot.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (CharacterHandle, &Resident)> {
        self.slots.iter().enumerate().filter_map(|(slot, place)| {
            let handle = CharacterHandle { slot: slot as u32, generation: place.generation };
            place.resident.as_ref().map(|resident| (handle, resident))
        })
    }

    /// The lowest free slot.
    fn free(&self) -> usize {
        self.slots.iter().position(|place| place.resident.is_none()).unwrap_or(self.slots.len())
    }
}

impl World {
    /// Puts a character into the lowest free slot, for which there is memory.
    pub(crate) fn insert_resident(&mut self, resident: Resident) -> CharacterHandle {
        let slot = self.characters.free();
        if slot == self.characters.slots.len() {
            self.characters.slots.push(CharacterSlot { generation: 1, resident: None });
        }
        self.set_resident(slot, Some(resident));
        CharacterHandle { slot: slot as u32, generation: self.characters.slots[slot].generation }
    }

    /// Removes a character that is there.
    pub(crate) fn remove_resident(&mut self, handle: CharacterHandle) {
        self.set_resident(handle.slot as usize, None);
        let generation = &mut self.characters.slots[handle.slot as usize].generation;
        *generation = generation.wrapping_add(1);
    }

    /// Replaces a character that is there.
    pub(crate) fn replace_resident(&mut self, handle: CharacterHandle, resident: Resident) {
        self.set_resident(handle.slot as usize, Some(resident));
    }

    /// Replaces the words of a character that is there; its geometry stays.
    pub(crate) fn write_resident(&mut self, handle: CharacterHandle, words: &[u32; CHARACTER_WORDS]) {
        if let Some(resident) = &mut self.characters.slots[handle.slot as usize].resident {
            resident.words = *words;
        }
    }

    /// Slots if another character comes.
    pub(crate) fn slots_with_another(&self) -> usize {
        self.characters.slots.len().max(self.characters.free() + 1)
    }

    fn set_resident(&mut self, slot: usize, new: Option<Resident>) {
        if let Some(geometry) = new.as_ref().and_then(|resident| resident.geometry.as_ref()) {
            self.assets.add(geometry);
        }
        let old = std::mem::replace(&mut self.characters.slots[slot].resident, new);
        if let Some(geometry) = old.and_then(|resident| resident.geometry) {
            self.assets.remove(&geometry);
        }
    }

    /// Removes all characters, before a snapshot is restored.
    pub(crate) fn clear_characters(&mut self) {
        (0..self.characters.slots.len()).for_each(|slot| self.set_resident(slot, None));
        self.characters.slots.clear();
    }

    /// Puts a character of a snapshot, or an empty place, behind the others.
    pub(crate) fn restore_character(&mut self, generation: u32, resident: Option<Resident>) {
        self.characters.slots.push(CharacterSlot { generation, resident: None });
        self.set_resident(self.characters.slots.len() - 1, resident);
    }

    pub(in crate::world) fn character_buffer(&mut self) -> &mut dyn Buffer {
        &mut self.characters.slots
    }
}
