//! Sleep of the world's bodies: ask, wake, send.

use super::World;
use crate::body::BodyKind;
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::record::record;

impl World {
    /// Whether a body is asleep.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn is_asleep(&self, body: BodyHandle) -> Result<bool, Error> {
        let index = self.index(body)?;
        Ok(self.bodies.asleep().contains(&index) && !self.bodies.traits[index].disabled)
    }

    /// How many bodies are asleep.
    pub fn asleep(&self) -> usize {
        self.bodies.sleepers()
    }

    /// How many islands are asleep.
    pub fn islands_asleep(&self) -> usize {
        self.sleep.count()
    }

    /// Wakes a body and all that sleeps with it.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn wake(&mut self, body: BodyHandle) -> Result<(), Error> {
        let index = self.index(body)?;
        record!(self, Wake(body));
        self.wake_body(index);
        Ok(())
    }

    /// Sends a dynamic body to sleep with all that it touches or is joined to, however fast they are, unless one of them
    /// never sleeps or is carried by a kinematic body that moves. Does nothing where sleep is not switched on
    /// ([`Settings::sleeping`](crate::Settings::sleeping)), and before the first step.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn send_to_sleep(&mut self, body: BodyHandle) -> Result<(), Error> {
        let index = self.index(body)?;
        record!(self, SendToSleep(body));
        // The column of a world that has just ceased to sleep lasts until the next step.
        let sleeps = self.settings.sleeping && self.bodies.rests;
        if sleeps && index < self.bodies.dynamic() && self.bodies.rest.len() == self.bodies.len() {
            self.send_island_to_sleep(index as u32);
        }
        Ok(())
    }

    /// Sets whether a body may fall asleep; one that may not keeps its island awake.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_can_sleep(&mut self, body: BodyHandle, can_sleep: bool) -> Result<(), Error> {
        let index = self.index(body)?;
        record!(self, SetCanSleep(body, can_sleep));
        let index = if can_sleep { index } else { self.wake_body(index) };
        self.revise(index);
        self.bodies.traits[index].sleepless = !can_sleep && self.bodies.kind[index] == BodyKind::Dynamic;
        Ok(())
    }
}
