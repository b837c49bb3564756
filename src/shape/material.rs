//! Materials, and what colliders keep of them: all have friction and restitution; what few have is in a
//! column of its own.

use super::flags::{BELT, IDLE_DAMPING, ROLLS, SOFT};
use crate::config::with_fields;
use crate::error::{Error, within};
use crate::limits;
use glam::Vec3;

/// How two values of a material become one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Combine {
    /// (a + b) / 2
    #[default]
    Average,
    /// The smaller.
    Minimum,
    /// The larger.
    Maximum,
    /// a b
    Multiply,
}

impl Combine {
    fn of(self, a: f32, b: f32) -> f32 {
        match self {
            Combine::Average => 0.5 * (a + b),
            Combine::Minimum => a.min(b),
            Combine::Maximum => a.max(b),
            Combine::Multiply => a * b,
        }
    }
}

/// Friction and restitution of a surface. Where two surfaces want different ways to combine, the first
/// of average, minimum, maximum, multiply is taken (as glTF's `KHR_physics_rigid_bodies` has it). Of rolling
/// and of spinning friction the larger of the two counts, surface velocities add up, and the softer surface
/// decides how the contact yields.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
#[non_exhaustive]
pub struct Material {
    /// Coulomb coefficient while the surfaces stick, at least zero. Default 0.6.
    pub static_friction: f32,
    /// Coulomb coefficient while they slide, at least zero. Default 0.6.
    pub dynamic_friction: f32,
    /// Share of the approach speed that comes back, 0..=1. Default 0.
    pub restitution: f32,
    /// Default average.
    pub friction_combine: Combine,
    /// Default average.
    pub restitution_combine: Combine,
    /// Lever arm of the load against rolling [m], 0..=1e6: the torque against rotation about axes in the
    /// surface is at most this times the normal force (the coefficient of rolling resistance as a length). A
    /// solid ball of radius r on a level floor slows down by (5/7) g b / r, and stays on slopes below
    /// atan(b / r). Default 0.
    pub rolling_friction: f32,
    /// Lever arm of the load against spinning [m], 0..=1e6: the torque against rotation about the normal is
    /// at most this times the normal force, beside what sliding friction does about the middle of a contact
    /// of several points. Default 0.
    pub spinning_friction: f32,
    /// Velocity at which the surface moves past the shape, in the shape's frame [m/s], within 1e6 along each
    /// axis: a belt. Friction pulls what touches it along. Default zero.
    pub surface_velocity: Vec3,
    /// Frequency of the spring with which the surface yields [Hz], 0..=1e6; 0 for a rigid one, for which
    /// [`Settings::contact_hertz`](crate::Settings::contact_hertz) counts. Default 0.
    ///
    /// It is the frequency of the two bodies on the spring of their contact: a body that lies flat on a soft
    /// floor sinks by g / (2 pi f)², whatever its mass. An edge has half the spring of a face with four
    /// points, a corner a quarter. What a body carries sinks it further, and each contact of a body has a
    /// spring of its own. Of two surfaces the softer one decides. The surface gives way by at most half the
    /// inner radius of the thinner shape (half a ball's radius, or a quarter of a plate's thickness), and is
    /// rigid there. The spring alone throws back what falls on it: a soft contact has no restitution. Springs
    /// above 0.16 of the rate of substeps act as one of that frequency
    /// (docs/decisions/soft-contacts.md).
    pub contact_hertz: f32,
    /// Damping ratio of that spring, 0..=100: with 0 a ball comes back with nearly its energy, with 1 it does
    /// not swing. Damping that would stop a body within a substep is reduced to that. Default 1.
    pub contact_damping: f32,
}

impl Default for Material {
    fn default() -> Self {
        Material::of(BaseMaterial::default(), RareMaterial::default())
    }
}

with_fields! {
    Material {
        with_static_friction(static_friction: f32),
        with_dynamic_friction(dynamic_friction: f32),
        with_restitution(restitution: f32),
        with_friction_combine(friction_combine: Combine),
        with_restitution_combine(restitution_combine: Combine),
        with_rolling_friction(rolling_friction: f32),
        with_spinning_friction(spinning_friction: f32),
        with_surface_velocity(surface_velocity: into Vec3),
        with_contact_hertz(contact_hertz: f32),
        with_contact_damping(contact_damping: f32),
    }
}

impl Material {
    /// One coefficient for sticking and sliding.
    pub fn with_friction(mut self, friction: f32) -> Self {
        (self.static_friction, self.dynamic_friction) = (friction, friction);
        self
    }

    /// What all colliders keep.
    pub(crate) fn base(&self) -> BaseMaterial {
        BaseMaterial {
            static_friction: self.static_friction,
            dynamic_friction: self.dynamic_friction,
            restitution: self.restitution,
            friction_combine: self.friction_combine,
            restitution_combine: self.restitution_combine,
        }
    }

    /// Whether its contacts are soft.
    pub(crate) fn is_soft(&self) -> bool {
        self.contact_hertz > 0.0
    }

    /// What few colliders have.
    pub(crate) fn rare(&self) -> RareMaterial {
        RareMaterial {
            rolling_friction: self.rolling_friction,
            spinning_friction: self.spinning_friction,
            surface_velocity: self.surface_velocity,
            contact_hertz: self.contact_hertz,
            contact_damping: self.contact_damping,
        }
    }

    pub(crate) fn of(base: BaseMaterial, rare: RareMaterial) -> Material {
        Material {
            static_friction: base.static_friction,
            dynamic_friction: base.dynamic_friction,
            restitution: base.restitution,
            friction_combine: base.friction_combine,
            restitution_combine: base.restitution_combine,
            rolling_friction: rare.rolling_friction,
            spinning_friction: rare.spinning_friction,
            surface_velocity: rare.surface_velocity,
            contact_hertz: rare.contact_hertz,
            contact_damping: rare.contact_damping,
        }
    }

    pub(crate) fn validate(&self) -> Result<(), Error> {
        limits::friction("static friction", self.static_friction)?;
        limits::friction("dynamic friction", self.dynamic_friction)?;
        limits::share("restitution", self.restitution)?;
        within("rolling friction", self.rolling_friction, 0.0, limits::MAX_LENGTH, "in 0..=1e6 m")?;
        within("spinning friction", self.spinning_friction, 0.0, limits::MAX_LENGTH, "in 0..=1e6 m")?;
        within("contact hertz", self.contact_hertz, 0.0, 1e6, "in 0..=1e6 Hz")?;
        within("contact damping", self.contact_damping, 0.0, 100.0, "in 0..=100")?;
        limits::speed("surface velocity", self.surface_velocity)
    }
}

/// The part of a [`Material`] that every collider has.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "replay", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct BaseMaterial {
    pub(crate) static_friction: f32,
    pub(crate) dynamic_friction: f32,
    pub(crate) restitution: f32,
    pub(crate) friction_combine: Combine,
    pub(crate) restitution_combine: Combine,
}

impl Default for BaseMaterial {
    fn default() -> Self {
        BaseMaterial {
            static_friction: 0.6,
            dynamic_friction: 0.6,
            restitution: 0.0,
            friction_combine: Combine::Average,
            restitution_combine: Combine::Average,
        }
    }
}

impl BaseMaterial {
    /// Static and dynamic friction of two surfaces.
    pub(crate) fn friction_with(&self, other: &BaseMaterial) -> (f32, f32) {
        let how = self.friction_combine.min(other.friction_combine);
        (
            how.of(self.static_friction, other.static_friction),
            how.of(self.dynamic_friction, other.dynamic_friction),
        )
    }
    /// Restitution of two surfaces.
    pub(crate) fn restitution_with(&self, other: &BaseMaterial) -> f32 {
        self.restitution_combine.min(other.restitution_combine).of(self.restitution, other.restitution)
    }
}

/// The part of a [`Material`] that few colliders have; the default in others.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "replay", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RareMaterial {
    pub(crate) rolling_friction: f32,
    pub(crate) spinning_friction: f32,
    pub(crate) surface_velocity: Vec3,
    pub(crate) contact_hertz: f32,
    pub(crate) contact_damping: f32,
}

impl Default for RareMaterial {
    fn default() -> Self {
        RareMaterial {
            rolling_friction: 0.0,
            spinning_friction: 0.0,
            surface_velocity: Vec3::ZERO,
            contact_hertz: 0.0,
            contact_damping: 1.0,
        }
    }
}

impl RareMaterial {
    /// Frequency [Hz] and damping ratio of the spring between two surfaces: those of the softer one, and of
    /// two alike the lower damping. The frequency is zero if both are rigid.
    pub(crate) fn spring_with(&self, other: &RareMaterial) -> (f32, f32) {
        let own = (self.contact_hertz, self.contact_damping);
        let others = (other.contact_hertz, other.contact_damping);
        let softer = own.0 < others.0 || own.0 == others.0 && own.1 < others.1;
        if others.0 == 0.0 || own.0 > 0.0 && softer { own } else { others }
    }

    /// Bits of [`ColliderSummary::flags`](super::ColliderSummary::flags): what is not as by default.
    pub(crate) fn flags(&self) -> u8 {
        let rolls = self.rolling_friction > 0.0 || self.spinning_friction > 0.0;
        let moves = self.surface_velocity != Vec3::ZERO;
        let soft = if self.contact_hertz > 0.0 { SOFT } else { 0 };
        let idle = soft == 0 && self.contact_damping != 1.0;
        let idle = if idle { IDLE_DAMPING } else { 0 };
        (if rolls { ROLLS } else { 0 }) | (if moves { BELT } else { 0 }) | soft | idle
    }
}
