//! The recorded decisions of hooks, in place of the hooks.

use crate::constraint::Tweak;
use crate::world::{ContactHook, ContactHooks};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, PoisonError};

/// The decision about a contact, for contacts that hooks vetoed or edited.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Decision {
    /// How many contacts were shown since the last decision.
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

/// Records the answers of hooks.
#[derive(Debug, Default)]
pub(super) struct Heard {
    pub(super) decisions: Vec<Decision>,
    /// Contacts since the last of which something was said.
    silent: u32,
}

impl Heard {
    pub(super) fn record(&mut self, tweak: Tweak, vetoed: bool) {
        match Decision::new((tweak, vetoed), self.silent) {
            Some(decision) => {
                self.decisions.push(decision);
                self.silent = 0;
            }
            None => self.silent += 1,
        }
    }
}

/// Replays the decisions.
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
