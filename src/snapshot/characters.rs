//! Characters: for each slot its generation, the kind of its content, its geometry, and its words.

use super::geometry::{Known, code_in, geometry_of};
use crate::character::checked_character;
use crate::error::Error;
use crate::shape::Geometry;
use crate::words::broken;
use crate::world::{CHARACTER_WORDS, Characters, Resident, World};

/// Words of a slot: generation, a code, four numbers of the geometry, and those of the character.
pub(super) const CHARACTER: usize = 6 + CHARACTER_WORDS;

/// Codes of a slot without a character, and of one that is the capsule of its settings. Others are those of
/// geometry.
const NOBODY: u32 = u32::MAX;
const CAPSULE: u32 = u32::MAX - 1;
/// The code of a hull, whose number is its place among the forms.
const HULL: u32 = 5;

/// Writes all slots; returns how many. Hulls go into `forms`.
pub(super) fn save_characters(from: &Characters, forms: &mut Vec<Known>, out: &mut Vec<u32>) -> u32 {
    forms.clear();
    for place in &from.slots {
        let start = out.len();
        out.resize(start + CHARACTER, 0);
        let words = &mut out[start..];
        words[0] = place.generation;
        words[1] = NOBODY;
        if let Some(Resident { geometry, words: own }) = &place.resident {
            words[6..].copy_from_slice(own);
            let (code, numbers) = geometry.as_ref().map_or((CAPSULE, [0; 4]), |form| code_of(form, forms));
            words[1] = code;
            words[2..6].copy_from_slice(&numbers);
        }
    }
    from.slots.len() as u32
}

fn code_of(form: &Geometry, forms: &mut Vec<Known>) -> (u32, [u32; 4]) {
    if let Geometry::Hull(_) = form {
        forms.push(Known::Here(form.clone()));
    }
    code_in(form, forms.len().saturating_sub(1) as u32)
}

/// A slot: its generation, and its character. Words from outside are `checked`.
fn read(words: &[u32], forms: &[Known], checked: bool) -> Result<(u32, Option<Resident>), Error> {
    let geometry = match words[1] {
        NOBODY => return Ok((words[0], None)),
        CAPSULE => None,
        HULL => match forms.get(words[2] as usize) {
            Some(Known::Here(form)) => Some(form.clone()),
            _ => return Err(broken("a shape")),
        },
        code => Some(geometry_of(code, &words[2..6], &[])?),
    };
    let own = &words[6..];
    if checked {
        return Ok((words[0], Some(checked_character(geometry, own)?.resident())));
    }
    let words_of = own.try_into().map_err(|_| broken("a character"))?;
    Ok((words[0], Some(Resident { geometry, words: words_of })))
}

/// Refuses characters that a world can't have.
pub(super) fn check_characters(words: &[u32], forms: &[Known]) -> Result<(), Error> {
    words.as_chunks::<CHARACTER>().0.iter().try_for_each(|slot| read(slot, forms, true).map(drop))
}

/// Puts characters into a world that has none. They were written by this process, or checked.
pub(super) fn restore_characters(world: &mut World, words: &[u32], forms: &[Known]) {
    for slot in words.as_chunks::<CHARACTER>().0 {
        if let Ok((generation, resident)) = read(slot, forms, false) {
            world.restore_character(generation, resident);
        }
    }
}
