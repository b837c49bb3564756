//! What a character is and may do.

use crate::error::{Error, finite3, positive, within};
use crate::limits;
use glam::Vec3;

/// A capsule that walks: its size, and what it may climb, push and stand on. A character with a shape of its
/// own ([`Character::set_shape`](crate::Character::set_shape)) takes all but the size.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct CharacterSettings {
    /// Radius of the capsule, above zero [m]. Default 0.3.
    pub radius: f32,
    /// Half the distance between the centres of its two balls, at least zero [m]. Default 0.6: 1.8 m tall.
    pub half_height: f32,
    /// The distance that it keeps from everything, above zero [m]: room for rounding and for moving bodies.
    /// It stands this high above the ground. Default 0.02.
    pub skin: f32,
    /// The steepest ground to stand and walk on [rad], in 0..=1.57; steeper surfaces are walls. Default 50
    /// degrees.
    pub max_slope: f32,
    /// The highest step to climb, at least zero [m]. The round bottom gets over edges lower than
    /// `(radius + skin) * (1 - cos(max_slope))` all the same. Default 0.3.
    pub step_height: f32,
    /// A walking character stays on ground that drops by up to this [m], at least zero. Default 0.3.
    pub snap: f32,
    /// Obstacles that a walk may slide along, 1..=64; the rest of the path is dropped. Default 8.
    pub iterations: u32,
    /// The upward direction; a unit vector. Default y.
    pub up: Vec3,
    /// Mass for pushes on dynamic bodies and for its weight on them, at least zero [kg]. Default 80.
    pub mass: f32,
    /// The greatest force of a push, at least zero [N]. Default 500.
    pub strength: f32,
}

impl Default for CharacterSettings {
    fn default() -> Self {
        CharacterSettings {
            radius: 0.3,
            half_height: 0.6,
            skin: 0.02,
            max_slope: 50.0 * std::f32::consts::PI / 180.0,
            step_height: 0.3,
            snap: 0.3,
            iterations: 8,
            up: Vec3::Y,
            mass: 80.0,
            strength: 500.0,
        }
    }
}

impl CharacterSettings {
    /// Checks every range.
    ///
    /// # Errors
    /// Names the first that is out of range.
    pub fn validate(&self) -> Result<(), Error> {
        let most = 1e6;
        positive("character radius", self.radius)?;
        within("character radius", self.radius, 0.0, most, "at most 1e6")?;
        within("character half height", self.half_height, 0.0, most, "in 0..=1e6")?;
        positive("character skin", self.skin)?;
        within("character skin", self.skin, 0.0, self.radius, "at most the radius")?;
        within("character slope", self.max_slope, 0.0, 1.57, "in 0..=1.57")?;
        within("character step height", self.step_height, 0.0, most, "in 0..=1e6")?;
        within("character snap", self.snap, 0.0, most, "in 0..=1e6")?;
        within("character iterations", self.iterations as f32, 1.0, 64.0, "in 1..=64")?;
        finite3("character up", self.up)?;
        within("character up", self.up.length(), 0.999, 1.001, "a unit vector")?;
        limits::amount("character mass", self.mass)?;
        limits::amount("character strength", self.strength)
    }
}
