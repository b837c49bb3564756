//! Changes of a contact by a caller before it is solved, in place of the materials of its shapes.

use glam::Vec3;

/// Changes of a contact by hooks; NaN where they changed nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tweak {
    pub(crate) friction: [f32; 2],
    pub(crate) restitution: f32,
    /// By which the surface of b moves past that of a, in the world [m/s].
    pub(crate) surface: Vec3,
}

impl Tweak {
    pub(crate) const NONE: Tweak =
        Tweak { friction: [f32::NAN; 2], restitution: f32::NAN, surface: Vec3::ZERO };

    pub(crate) fn is_none(&self) -> bool {
        self.friction[0].is_nan() && self.restitution.is_nan() && self.surface == Vec3::ZERO
    }

    pub(crate) fn friction_or(&self, own: (f32, f32)) -> (f32, f32) {
        if self.friction[0].is_nan() { own } else { self.friction.into() }
    }
    pub(crate) fn restitution_or(&self, own: f32) -> f32 {
        if self.restitution.is_nan() { own } else { self.restitution }
    }
}

/// Changes of a contact by hooks.
#[inline]
pub(crate) fn tweak_of(tweaks: &[Tweak], slot: usize) -> Tweak {
    tweaks.get(slot).copied().unwrap_or(Tweak::NONE)
}
