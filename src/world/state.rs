//! The state that outlives a step: the only list of it, from which snapshots are written.

use crate::body::{Bodies, Colliders};
use crate::broad_phase::BroadPhase;
use crate::config::Settings;
use crate::events::Events;
use crate::finish::Clear;
use crate::joint::Joints;
use crate::narrow_phase::Contacts;
use crate::sleep::Sleep;
use crate::world::{Buffers, Characters, World};
use glam::DVec3;

/// The state of a world. A step reads this and its own output, nothing else.
pub(crate) struct State<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) origin: DVec3,
    pub(crate) bodies: &'a Bodies,
    pub(crate) colliders: &'a Colliders,
    pub(crate) broad: &'a BroadPhase,
    pub(crate) contacts: &'a Contacts,
    pub(crate) joints: &'a Joints,
    pub(crate) characters: &'a Characters,
    pub(crate) sleep: &'a Sleep,
    pub(crate) events: &'a Events,
    /// See [`Buffers`] for these three.
    pub(crate) last_h: f32,
    pub(crate) usual_h: f32,
    pub(crate) evenness: f32,
    /// Steps until loads are estimated again, and whether any are to be.
    pub(crate) statics: (u32, bool),
    /// For each dynamic body of the last step, a ball in which its path need not be checked.
    pub(crate) clear: &'a [Clear],
}

impl World {
    /// The state of the world. No field is left out by `..`: whether a new field is state is decided here.
    pub(crate) fn state(&self) -> State<'_> {
        let World {
            settings,
            origin,
            bodies,
            colliders,
            broad,
            contacts,
            joints,
            characters,
            buffers,
            sleep,
            events,
            // These follow from the others.
            now: _,
            needs: _,
            assets: _,
            revisions: _,
            // They tell of the last step.
            report: _,
            last_demand: _,
            spent: _,
            peaks: _,
            faults: _,
            // And these belong to this world or to one step.
            removed: _,
            stage: _,
            helpers: _,
            #[cfg(feature = "observe")]
                meter: _,
            #[cfg(feature = "replay")]
                recorder: _,
        } = self;
        let Buffers {
            statics,
            solver,
            finish,
            last_h,
            evenness,
            // Each step makes these anew; joints are arranged anew in a restored world.
            forces: _,
            broad: _,
            narrow: _,
            restitution: _,
            prepare: _,
            rows: _,
            joints: _,
            impacts: _,
            dt: _,
        } = buffers;
        State {
            settings,
            origin: *origin,
            bodies,
            colliders,
            broad,
            contacts,
            joints,
            characters,
            sleep,
            events,
            last_h: *last_h,
            usual_h: solver.usual_h,
            evenness: *evenness,
            statics: (statics.wait, statics.pending),
            clear: &finish.clear,
        }
    }
}
