//! A new world, its settings and its origin.

use super::{Change, World};
use crate::config::Settings;
use crate::error::Error;
use crate::limits;
use glam::DVec3;

/// # Settings and origin
impl World {
    /// An empty world.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn new(settings: Settings) -> Result<World, Error> {
        settings.validate()?;
        Ok(World { settings, ..World::default() })
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Replaces the settings; the next step uses them. Settings that are no others change nothing.
    ///
    /// # Errors
    /// If a setting is out of range, or their budget does not allow the parts that they switch on (sleeping,
    /// a continuous method that settles bodies on meshes or meets impacts at their times) for the bodies of
    /// the world, or the most that its joints may take if they are arranged in another way (`order`,
    /// `joint_trees`). A budget alone is never refused.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        settings.validate()?;
        if settings == self.settings {
            return Ok(());
        }
        self.reserve_for_settings(&settings)?;
        self.note(Change::SetSettings(&settings));
        if settings.gravity != self.settings.gravity || !settings.sleeping {
            self.wake_all();
        }
        if self.rearranges(&settings) {
            self.joints.arrange_anew();
        }
        self.settings = settings;
        // Their reach may be another one.
        self.broad.pairs.iter_mut().for_each(|pair| pair.apart = 0);
        if self.bodies.len() > 0 {
            // With a budget, the memory that bodies can't do without is held from now on.
            self.reserve_for_step();
        }
        Ok(())
    }

    /// The point that single-precision positions are relative to [m]. Zero unless set.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Moves the point that single-precision positions are relative to. Bodies stay where they are.
    ///
    /// # Errors
    /// If it is beyond [`limits::MAX_POSITION`].
    pub fn set_origin(&mut self, origin: DVec3) -> Result<(), Error> {
        limits::position(origin)?;
        self.note(Change::SetOrigin(origin));
        self.origin = origin;
        Ok(())
    }
}
