//! Sleep of the world's bodies: look up, wake, put to sleep.

use super::{Buffers, Change, World};
use crate::broad_phase::Aabb;
use crate::error::Error;
use crate::events::Events;
use crate::handle::BodyHandle;
use crate::memory::{Allowance, Category};
use crate::sleep::{Islands, RestTime, Ties, count_rest};
use crate::threads::Workers;

/// # Sleep
impl World {
    /// Whether a body is asleep.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// world.set_settings(Settings::default().with_sleeping(true))?;
    /// for _ in 0..180 {
    ///     world.step(1.0 / 60.0)?;
    /// }
    /// assert!(world.is_sleeping(body)?);
    /// world.wake(body)?;
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn is_sleeping(&self, body: BodyHandle) -> Result<bool, Error> {
        let index = self.index(body)?;
        Ok(self.bodies.asleep().contains(&index) && !self.bodies.traits[index].disabled)
    }

    /// Number of sleeping bodies.
    pub fn sleeping_body_count(&self) -> usize {
        self.bodies.sleepers()
    }

    /// Number of sleeping islands.
    pub fn sleeping_island_count(&self) -> usize {
        self.sleep.count()
    }

    /// Wakes a body and its island.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn wake(&mut self, body: BodyHandle) -> Result<(), Error> {
        let index = self.index(body)?;
        self.note(Change::Wake(body));
        self.wake_body(index);
        Ok(())
    }

    /// Puts a dynamic body to sleep with all bodies that it touches or is joined to, however fast they are,
    /// unless one of them never sleeps or is carried by a moving kinematic body. Does nothing if sleeping is
    /// off ([`Settings::sleeping`](crate::Settings::sleeping)), and before the first step.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn sleep(&mut self, body: BodyHandle) -> Result<(), Error> {
        let index = self.index(body)?;
        self.note(Change::Sleep(body));
        // If sleeping was just switched off, the column still exists until the next step.
        let sleeps = self.settings.sleeping && self.bodies.rests;
        if sleeps && index < self.bodies.dynamic() && self.bodies.rest.len() == self.bodies.len() {
            self.send_island_to_sleep(index as u32);
        }
        Ok(())
    }

    /// Whether a body may fall asleep; see [`BodyDesc::can_sleep`](crate::BodyDesc::can_sleep).
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn can_sleep(&self, body: BodyHandle) -> Result<bool, Error> {
        Ok(!self.bodies.traits[self.index(body)?].sleepless)
    }

    /// Sets whether a body may fall asleep; one that may not keeps its island awake. Nothing happens if it is
    /// so already.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_can_sleep(&mut self, body: BodyHandle, can_sleep: bool) -> Result<(), Error> {
        let index = self.index(body)?;
        if self.bodies.traits[index].sleepless != can_sleep {
            return Ok(());
        }
        self.note(Change::SetCanSleep(body, can_sleep));
        let index = if can_sleep { index } else { self.wake_body(index) };
        self.revise(index);
        self.bodies.traits[index].sleepless = !can_sleep;
        Ok(())
    }
    /// Wakes the islands that something reaches within the step; returns whether there were any. Pairs and
    /// predicted motions must be those of the step.
    pub(crate) fn wake_what_is_reached(&mut self) -> bool {
        if self.sleep.count() == 0 {
            return false;
        }
        let (mut islands, buffers, _) = self.split_islands();
        islands.wake_what_is_reached(&buffers.forces.motion)
    }

    /// Wakes a body with its island, if it sleeps, and marks it as moving. Returns its new index.
    pub(crate) fn wake_body(&mut self, index: usize) -> usize {
        self.split_islands().0.wake_body(index)
    }

    /// Wakes a body and all others that it touches or may touch, because something about it changed. Returns
    /// its new index.
    pub(crate) fn disturb(&mut self, index: usize) -> usize {
        self.split_islands().0.disturb(index)
    }

    /// Wakes all bodies whose boxes overlap a new one.
    pub(crate) fn disturb_box(&mut self, bounds: &Aabb) {
        self.split_islands().0.disturb_box(bounds);
    }

    /// Wakes all bodies.
    pub(crate) fn wake_all(&mut self) {
        self.split_islands().0.wake_all();
    }

    /// Counts how long bodies have been at rest, and puts islands to sleep that have been for long enough.
    pub(crate) fn rest(&mut self, workers: &Workers<'_>, dt: f32) {
        if !self.settings.sleeping {
            return;
        }
        let tired = count_rest(workers, &mut self.bodies, &self.colliders.summaries, &self.settings, dt);
        if self.sleep.is_due(tired) {
            self.split_islands().0.find(RestTime::Measured);
            let (time, allowance) = (self.settings.sleep_time, self.room_to_sleep());
            let (mut islands, _, events) = self.split_islands();
            islands.send_tired(time, events, allowance);
        }
    }

    fn send_island_to_sleep(&mut self, index: u32) {
        self.split_islands().0.find(RestTime::Endless);
        let allowance = self.room_to_sleep();
        let (mut islands, _, events) = self.split_islands();
        islands.send(index, events, allowance);
    }

    /// Bytes that the pairs of islands that fall asleep may take.
    fn room_to_sleep(&mut self) -> Allowance {
        if self.needs.events > 0 {
            self.refresh_event_allowance();
        }
        self.allowance(Category::BroadPhase)
    }

    /// For each body, the number of a dynamic body's island, for display; `u32::MAX` for other bodies.
    pub(crate) fn islands(&self) -> Vec<u32> {
        self.sleep.numbers(&Ties {
            bodies: &self.bodies,
            summaries: &self.colliders.summaries,
            pairs: &self.broad.pairs,
            contacts: &self.contacts,
            joints: &self.joints,
            touching: self.settings.measures().touch,
        })
    }

    fn split_islands(&mut self) -> (Islands<'_>, &mut Buffers, &mut Events) {
        let measures = self.settings.measures();
        let World { sleep, bodies, colliders, broad, contacts, joints, buffers, events, .. } = self;
        (Islands { sleep, bodies, colliders, broad, contacts, joints, measures }, buffers, events)
    }
}
