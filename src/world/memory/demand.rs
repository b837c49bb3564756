//! The needs of the starting step, and the release of buffers that only earlier steps needed.

use super::needs::Demand;
use crate::config::ContinuousMode;
use crate::world::World;
use glam::Vec3;

impl World {
    /// Whether any body is continuous.
    #[inline]
    pub(crate) fn is_continuous(&self) -> bool {
        self.settings.continuous != ContinuousMode::Discrete && self.bodies.continuous > 0
    }

    /// Whether gravity or forces accelerate bodies.
    #[inline]
    pub(crate) fn is_accelerated(&self) -> bool {
        self.settings.gravity != Vec3::ZERO || !self.bodies.force.is_empty()
    }

    /// The features that the starting step needs.
    pub(crate) fn demand(&self) -> Demand {
        let listening = self.needs.events > 0 || self.needs.sensors > 0 || self.events.has_any();
        let needed = [
            (self.needs.friction > 0, Demand::FRICTION),
            (self.needs.restitution > 0, Demand::RESTITUTION),
            (listening, Demand::LISTENING),
            (self.needs.hooks > 0, Demand::HOOKS),
            (self.joints.count > 0 || self.joints.has_events(), Demand::JOINTS),
            (self.is_continuous(), Demand::CONTINUOUS),
            (self.bodies.any_solved_after(), Demand::SOLVED_AFTER),
            (self.is_accelerated(), Demand::ACCELERATION),
            (self.needs.rolling > 0, Demand::ROLLING),
            (self.needs.rare_materials > 0, Demand::RARE_MATERIALS),
            (self.needs.soft > 0, Demand::SOFT),
        ];
        Demand(needed.iter().fold(0, |all, (is, part)| all | (u16::from(*is) * part)))
    }

    /// At the end of a step that needed `now`: releases the buffers that only earlier ones needed. With a
    /// budget reserved memory stays, so that content that needs it again is never refused.
    pub(crate) fn release(&mut self, now: Demand) {
        if self.needs.rolling == 0 {
            // They are state, which must not depend on a budget.
            self.contacts.clear_rolling();
        }
        if !self.settings.budget.is_none() {
            self.last_demand.0 |= now.0;
            return;
        }
        let gone = self.last_demand.0 & !now.0;
        self.last_demand = now;
        if gone != 0 {
            self.release_all(gone);
        }
    }

    #[cold]
    fn release_all(&mut self, gone: u16) {
        let buffers = &mut self.buffers;
        if gone & Demand::RESTITUTION != 0 {
            buffers.restitution = Default::default();
        }
        if gone & Demand::LISTENING != 0 {
            self.events.release();
        }
        if gone & Demand::HOOKS != 0 {
            (self.events.tweaks, self.events.vetoed) = Default::default();
            buffers.rows.surfaces = Vec::new();
        }
        if gone & Demand::JOINTS != 0 {
            self.joints.release();
            buffers.joints.release();
            buffers.rows.tree_contacts = Vec::new();
            buffers.finish.part_trees();
            self.revisions.moving += 1;
        }
        if gone & Demand::CONTINUOUS != 0 {
            buffers.finish.release();
            buffers.prepare.forget_ahead();
            self.broad.release_paths();
        }
        if gone & Demand::SOLVED_AFTER != 0 {
            buffers.prepare.lower();
        }
        if gone & Demand::ACCELERATION != 0 {
            buffers.forces.acceleration = Vec::new();
        }
        if gone & Demand::ROLLING != 0 {
            buffers.rows.rolling = Vec::new();
            self.contacts.forget_rolling();
        }
        if gone & Demand::SOFT != 0 {
            buffers.rows.soft = Default::default();
        }
        if gone & Demand::RARE_MATERIALS != 0 {
            (self.colliders.rare, buffers.rows.surfaces) = Default::default();
        }
        // Friction is released when rows are prepared, sleep when a step begins.
    }
}
