//! Characters that live in a world: snapshots have their state, recordings every change of it, and the hash
//! of the world counts it.

use super::{BsCharacter, BsCharacterReport, Walker, looking, moving};
use crate::abi::guard::call;
use crate::abi::lock::Changing;
use crate::abi::pointers::Out;
use crate::abi::sized::{place, write};
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::values::{BsVec3, BsWorldCharacter};
use crate::query::{BsQueryFilter, with_filter};
use crate::world::{BsWorld, change, changing, get_all, reading};
use backstop::{CharacterReport, QueryFilter};

/// Puts a copy of a character into a world, where `bs_world_walk_character` moves it. Bodies don't notice it.
/// `added` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_add_character(
    world: *mut BsWorld,
    character: *const BsCharacter,
    added: *mut BsWorldCharacter,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, walker, out) = unsafe {
            let out = Out::optional("the place for the handle", added)?;
            (changing(world)?, looking(character)?, out)
        };
        let handle = content.add_character(&walker.character)?;
        if let Some(out) = out {
            out.set(handle.into());
        }
        Ok(())
    })
}

/// Removes a character from a world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_remove_character(
    world: *mut BsWorld,
    character: BsWorldCharacter,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.remove_character(character.into())) }
}

/// Makes `copy` what a character of a world is now: to read its settings, shape, position and ground. It has
/// no report.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_character(
    world: *const BsWorld,
    character: BsWorldCharacter,
    copy: *mut BsCharacter,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, mut copy) = unsafe { (reading(world)?, moving(copy)?) };
        *copy =
            Walker { character: content.character(character.into())?, report: CharacterReport::default() };
        Ok(())
    })
}

/// Replaces a character of a world: to place it somewhere else, to give it other settings or another shape.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_set_character(
    world: *mut BsWorld,
    character: BsWorldCharacter,
    to: *const BsCharacter,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, to) = unsafe { (changing(world)?, looking(to)?) };
        Ok(content.set_character(character.into(), &to.character)?)
    })
}

/// `bs_character_walk` of a character of the world. `filter` may be null, `report` too, and `copy` as well,
/// which becomes the character after the walk and has its report: for `bs_character_hits` and
/// `bs_character_push`. What a predicate asks of this world is refused with `BS_ERROR_BUSY`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_walk_character(
    world: *mut BsWorld,
    character: BsWorldCharacter,
    filter: *const BsQueryFilter,
    velocity: BsVec3,
    dt: f32,
    report: *mut BsCharacterReport,
    copy: *mut BsCharacter,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, copy) = unsafe {
            let copy: Option<Changing<'_, Walker>> = if copy.is_null() { None } else { Some(moving(copy)?) };
            (changing(world)?, copy)
        };
        if !report.is_null() {
            // A report that can't be written is refused before the walk.
            // SAFETY: the caller keeps to the header.
            unsafe { place(report) }?;
        }
        let walk = |filter: &QueryFilter<'_>| -> Outcome {
            let walked = content.walk_character(character.into(), filter, velocity.into(), dt)?;
            let walker = Walker { character: content.character(character.into())?, report: walked };
            if !report.is_null() {
                // SAFETY: the caller keeps to the header.
                unsafe { write(report, walker.told()) }?;
            }
            if let Some(mut copy) = copy {
                *copy = walker;
            }
            Ok(())
        };
        // SAFETY: the caller keeps to the header.
        unsafe { with_filter(filter, walk) }
    })
}

/// The characters of a world, by handle. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_characters(
    world: *const BsWorld,
    characters: *mut BsWorldCharacter,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get_all(world, "characters", (characters, capacity, count), |w| Ok(w.characters().collect())) }
}
