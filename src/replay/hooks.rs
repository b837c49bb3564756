//! What hooks said, in place of the hooks.

use crate::constraint::Tweak;
use crate::world::{ContactHook, ContactHooks};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, PoisonError};

/// What was said of a contact of which something was said.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Decision {
    /// How many contacts were shown since the last of which something was said.
    after: u32,
    veto: bool,
    friction: Option<[f32; 2]>,
    restitution: Option<f32>,
    surface: Option<Vec3>,
}

impl Decision {
    fn new((tweak, veto): (Tweak, bool), after: u32) -> Option<Decision> {
        let friction = (!tweak.friction[0].is_nan()).then_some(tweak.friction);
        let restitution = (!tweak.restitution.is_nan()).then_some(tweak.restitution);
        // The other way round, no speed is minus zero.
        let surface = tweak.surface.to_array().map(f32::to_bits) != [0; 3];
        let surface = surface.then_some(tweak.surface);
        let silent = !veto && friction.is_none() && restitution.is_none() && surface.is_none();
        (!silent).then_some(Decision { after, veto, friction, restitution, surface })
    }

    fn said(&self) -> (Tweak, bool) {
        let tweak = Tweak {
            friction: self.friction.unwrap_or(Tweak::NONE.friction),
            restitution: self.restitution.unwrap_or(Tweak::NONE.restitution),
            surface: self.surface.unwrap_or(Tweak::NONE.surface),
        };
        (tweak, self.veto)
    }
}

/// Hooks, and a note of what they say.
pub(super) struct Heard<'a> {
    hooks: &'a dyn ContactHooks,
    /// What was said, and contacts since. Locked by one thread only, again and again: hooks are asked by one.
    notes: Mutex<(Vec<Decision>, u32)>,
}

impl<'a> Heard<'a> {
    pub(super) fn new(hooks: &'a dyn ContactHooks) -> Heard<'a> {
        Heard { hooks, notes: Mutex::default() }
    }
    pub(super) fn decisions(self) -> Vec<Decision> {
        self.notes.into_inner().unwrap_or_else(PoisonError::into_inner).0
    }
}

impl ContactHooks for Heard<'_> {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        self.hooks.contact(contact);
        let mut notes = self.notes.lock().unwrap_or_else(PoisonError::into_inner);
        let (decisions, silent) = &mut *notes;
        match Decision::new(contact.said(), *silent) {
            Some(decision) => {
                decisions.push(decision);
                *silent = 0;
            }
            None => *silent += 1,
        }
    }
}

/// Says what was said.
pub(super) struct Told<'a> {
    decisions: &'a [Decision],
    /// The next decision, and contacts since the last.
    at: Mutex<(usize, u32)>,
}

impl<'a> Told<'a> {
    pub(super) fn new(decisions: &'a [Decision]) -> Told<'a> {
        Told { decisions, at: Mutex::default() }
    }
}

impl ContactHooks for Told<'_> {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        let mut at = self.at.lock().unwrap_or_else(PoisonError::into_inner);
        let (next, silent) = &mut *at;
        match self.decisions.get(*next).filter(|decision| decision.after == *silent) {
            Some(decision) => {
                let (tweak, veto) = decision.said();
                contact.say(tweak, veto);
                (*next, *silent) = (*next + 1, 0);
            }
            None => *silent += 1,
        }
    }
}
