//! What the caller hears of the last step, and what of it the world has to see to.

use super::World;
use crate::broad_phase::Pair;
use crate::error::Error;
use crate::events::{ContactEnd, ContactEvent, Sensing, SensorEvent, StartOfStep, Touching};
use crate::handle::ShapeHandle;

impl World {
    /// Shapes that began to touch in the last step, of pairs of which one asks for [`events`](crate::ShapeDesc::events);
    /// sorted by their handles. What touched within the step and was thrown off again counts as touching, if it was pushed.
    pub fn contact_begins(&self) -> &[ContactEvent] {
        &self.events.begins
    }

    /// Shapes that no longer touch since the last step, or that were removed while they did.
    pub fn contact_ends(&self) -> &[ContactEnd] {
        &self.events.ends
    }

    /// Shapes that hit each other in the last step, at [`Settings::hit_speed`](crate::Settings::hit_speed) or faster.
    pub fn contact_hits(&self) -> &[ContactEvent] {
        &self.events.hits
    }

    /// What came into sensors in the last step, however fast. What crossed one within the step is here and in
    /// [`World::sensor_ends`].
    pub fn sensor_begins(&self) -> &[SensorEvent] {
        &self.events.entered
    }

    /// What left sensors in the last step, or was removed while it was in one.
    pub fn sensor_ends(&self) -> &[SensorEvent] {
        &self.events.left
    }

    /// Shapes that are in a sensor, in the order of their handles, as of the last step; written into `into`.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn visitors(&self, sensor: ShapeHandle, into: &mut Vec<ShapeHandle>) -> Result<(), Error> {
        let collider = self.collider(sensor)?;
        into.clear();
        for pair in self.broad.pairs.iter().chain(self.sleep.kept_pairs()).filter(|pair| pair.touching) {
            let other = match collider {
                c if c == pair.a => pair.b,
                c if c == pair.b => pair.a,
                _ => continue,
            };
            into.push(self.shape_handle(other));
        }
        into.sort_unstable();
        Ok(())
    }

    /// Nobody listens to a shape any more: unless the other's listen, it is not known whom it touches.
    pub(crate) fn forget_touches(&mut self, collider: u32) {
        let summaries = &self.colliders.summaries;
        for pair in self.broad.pairs.iter_mut().filter(|pair| pair.a == collider || pair.b == collider) {
            let [a, b] = [pair.a, pair.b].map(|c| &summaries[c as usize]);
            pair.touching &= a.has_events() || b.has_events() || a.is_sensor() || b.is_sensor();
        }
    }

    /// Pairs that end are heard of, if anyone listens to them.
    pub(crate) fn part_pair(&mut self, pair: &Pair) {
        self.events.part(&self.colliders, pair);
    }

    /// Makes place for the impulses of contacts, if anyone listens.
    pub(crate) fn reserve_impulses(&mut self) {
        let wanted = if self.needs.events > 0 { self.contacts.all.len() } else { 0 };
        self.events.impulses.clear();
        if wanted > 0 {
            self.refresh_event_allowance();
        }
        self.events.reserve_impulses(wanted);
    }

    /// Compares who touches with who did, and measures impacts.
    pub(crate) fn record_contact_events(&mut self) {
        if self.needs.events == 0 {
            return;
        }
        self.refresh_event_allowance();
        let World { bodies, colliders, buffers, contacts, settings, broad, events, .. } = self;
        let start = StartOfStep { bodies, colliders, forces: &buffers.forces, dt: buffers.dt };
        Touching { start, contacts, settings }.record(&mut broad.pairs, events);
    }

    /// Who came into sensors and who left them in this step.
    pub(crate) fn record_sensor_events(&mut self) {
        if self.needs.sensors == 0 {
            return;
        }
        self.refresh_event_allowance();
        let World { bodies, colliders, settings, broad, events, .. } = self;
        Sensing { bodies, colliders, settings }.record(&mut broad.pairs, events);
    }

    /// What was heard in the step, in its order.
    pub(crate) fn sort_events(&mut self) {
        self.refresh_event_allowance();
        self.events.finish(self.settings.event_capacity as usize);
    }

    pub(crate) fn start_of_step(&self) -> StartOfStep<'_> {
        let (bodies, colliders, buffers) = (&self.bodies, &self.colliders, &self.buffers);
        StartOfStep { bodies, colliders, forces: &buffers.forces, dt: buffers.dt }
    }
}
