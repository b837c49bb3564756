//! Which changes of components are the plugin's own, told by their ticks.

use bevy_ecs::change_detection::Tick;
use bevy_ecs::entity::Entity;

/// Most ticks that are kept. Changes of others count as those of somebody else, and are compared by value.
const MOST: usize = 8;

/// Ticks of systems that wrote transforms and velocities of all bodies that move, in passes over all bodies.
#[derive(Debug, Default)]
pub(crate) struct OwnWrites {
    ticks: Vec<Tick>,
    /// Bodies that somebody else wrote before, in part or with such a tick: commands that are applied just
    /// before a system have its tick.
    others: Vec<Entity>,
}

impl OwnWrites {
    /// Notes a system that writes now.
    pub(crate) fn note(&mut self, tick: Tick) {
        if self.ticks.len() == MOST {
            self.ticks.remove(0);
        }
        self.ticks.push(tick);
    }

    /// Has a body be compared by value, whatever the tick of its last change.
    #[inline]
    pub(crate) fn look_at(&mut self, entity: Entity) {
        self.others.push(entity);
    }

    /// Whether a change may be that of somebody else.
    #[inline]
    pub(crate) fn may_be_foreign(&self, entity: Entity, changed: Tick) -> bool {
        !self.ticks.contains(&changed) || self.others.contains(&entity)
    }

    /// Forgets all of it: changes from now on count.
    pub(crate) fn clear(&mut self) {
        self.ticks.clear();
        self.others.clear();
    }
}
