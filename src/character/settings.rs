//! Settings of a character.

use crate::config::fields;
use crate::error::{Error, finite3, positive, within};
use crate::limits;
use glam::Vec3;

fields! {
    /// A capsule that walks: its size, and what it may climb, push and stand on. A character with a shape of
    /// its own ([`Character::set_shape`](crate::Character::set_shape)) takes all but the size.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(default, deny_unknown_fields)
    )]
    pub struct CharacterSettings {
        /// Radius of the capsule, above zero [m].
        _(radius: f32) = 0.3;
        /// Half the distance between the centres of its two balls [m]: 1.8 m tall by default.
        _(half_height: f32) = 0.6, "character half height" [0.0, limits::MAX_LENGTH] "in 0..=1e6";
        /// The distance that it keeps from everything, above zero [m]: room for rounding and for moving
        /// bodies. It stands this high above the ground.
        _(skin: f32) = 0.02;
        /// The steepest ground to stand and walk on [rad]; steeper surfaces are walls.
        _(max_slope: f32) = 50.0 * std::f32::consts::PI / 180.0, "character slope" [0.0, 1.57] "in 0..=1.57";
        /// The highest step to climb [m]. The round bottom gets over edges lower than
        /// `(radius + skin) * (1 - cos(max_slope))` all the same.
        _(step_height: f32) = 0.3, "character step height" [0.0, limits::MAX_LENGTH] "in 0..=1e6";
        /// A walking character stays on ground that drops by up to this [m].
        _(snap: f32) = 0.3, "character snap" [0.0, limits::MAX_LENGTH] "in 0..=1e6";
        /// Obstacles that a walk may slide along; the rest of the path is dropped.
        _(iterations: u32) = 8, "character iterations" [1.0, 64.0] "in 1..=64";
        /// The upward direction; a unit vector.
        _(up: Vec3) = Vec3::Y;
        /// Mass for pushes on dynamic bodies and for its weight on them [kg].
        _(mass: f32) = 80.0, "character mass" [0.0, f32::MAX] "at least zero";
        /// The greatest force of a push [N].
        _(strength: f32) = 500.0, "character strength" [0.0, f32::MAX] "at least zero";
    }
}

impl CharacterSettings {
    /// Checks every range.
    ///
    /// # Errors
    /// Names the first that is out of range.
    pub fn validate(&self) -> Result<(), Error> {
        positive("character radius", self.radius)?;
        within("character radius", self.radius, 0.0, limits::MAX_LENGTH, "at most 1e6")?;
        positive("character skin", self.skin)?;
        within("character skin", self.skin, 0.0, self.radius, "at most the radius")?;
        finite3("character up", self.up)?;
        within("character up", self.up.length(), 0.999, 1.001, "a unit vector")?;
        self.check_ranges()
    }
}
