//! Materials, and the part of them that colliders keep: all have friction and restitution; rare fields are in
//! a column of their own.

use super::flags::{BELT, IDLE_DAMPING, ROLLS, SOFT};
use crate::config::fields;
use crate::error::Error;
use crate::limits;
use glam::Vec3;

/// How two values of a material become one. Where two surfaces say different ways, the one that stands first
/// here counts: an average with a default material stays an average.
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

/// The fields of [`Material`], for everything that is made of them: here, and in the loader of scenes. `base`
/// has the fields that every collider keeps, `rare` those of few; each is a list for [`fields`]. `Vec3` and
/// `Combine` are those of the place where the list is used.
#[doc(hidden)]
#[macro_export]
macro_rules! material_fields {
    ($then:ident) => {
        $then! {
            base {
                /// Coulomb coefficient while the surfaces stick.
                with_static_friction(static_friction: f32) = 0.6,
                    "static friction" [0.0, f32::MAX] "at least zero";
                /// Coulomb coefficient while they slide.
                with_dynamic_friction(dynamic_friction: f32) = 0.6,
                    "dynamic friction" [0.0, f32::MAX] "at least zero";
                /// Share of the approach speed that comes back.
                with_restitution(restitution: f32) = 0.0, "restitution" [0.0, 1.0] "in 0..=1";
                /// How two coefficients of friction become one.
                with_friction_combine(friction_combine: Combine) = Combine::Average;
                /// How two coefficients of restitution become one.
                with_restitution_combine(restitution_combine: Combine) = Combine::Average;
            }
            rare {
                /// Lever arm of the load against rolling [m]: the torque against rotation about axes in the
                /// surface is at most this times the normal force (the coefficient of rolling resistance as a
                /// length). A solid ball of radius r on a level floor slows down by (5/7) g b / r, and stays
                /// on slopes below atan(b / r).
                with_rolling_friction(rolling_friction: f32) = 0.0,
                    "rolling friction" [0.0, limits::MAX_LENGTH] "in 0..=1e6 m";
                /// Lever arm of the load against spinning [m]: the torque against rotation about the normal
                /// is at most this times the normal force, beside the torque of sliding friction about the
                /// middle of a contact of several points.
                with_spinning_friction(spinning_friction: f32) = 0.0,
                    "spinning friction" [0.0, limits::MAX_LENGTH] "in 0..=1e6 m";
                /// Velocity at which the surface moves past the shape, in the shape's frame [m/s]: a belt.
                /// Friction pulls touching bodies along.
                with_surface_velocity(surface_velocity: Vec3, into) = Vec3::ZERO,
                    "surface velocity" [-limits::MAX_SPEED, limits::MAX_SPEED] "within 1e6 along each axis";
                /// Frequency of the spring with which the surface yields [Hz]; 0 for a rigid one, for which
                /// [`Settings::contact_hertz`](crate::Settings::contact_hertz) counts.
                ///
                /// It is the frequency of the two bodies on the spring of their contact: a body that lies
                /// flat on a soft floor sinks by g / (2 pi f)², whatever its mass. An edge has half the
                /// spring of a face with four points, a corner a quarter. A load sinks a body further, and
                /// each contact of a body has a spring of its own. Of two surfaces the softer one decides.
                /// The surface gives way by at most half the inner radius of the thinner shape (half a ball's
                /// radius, or a quarter of a plate's thickness), and is rigid there. The spring alone throws
                /// back bodies that fall on it: a soft contact has no restitution. Springs above 0.16 of the
                /// rate of substeps act as one of that frequency (docs/decisions/soft-contacts.md).
                with_contact_hertz(contact_hertz: f32) = 0.0, "contact hertz" [0.0, 1e6] "in 0..=1e6 Hz";
                /// Damping ratio of that spring: with 0 a ball comes back with nearly its energy, with 1 it
                /// does not swing. Damping that would stop a body within a substep is reduced to that.
                with_contact_damping(contact_damping: f32) = 1.0,
                    "contact damping" [0.0, 100.0] "in 0..=100";
            }
        }
    };
}

/// A part of a [`Material`], as colliders keep it.
macro_rules! part {
    ($(#[$meta:meta])* $of:ident, $get:ident { $(
        $(#[doc = $doc:literal])+
        $with:ident($field:ident: $kind:ty $(, $into:ident)?) = $default:expr
            $(, $what:literal $ends:tt $range:literal)?;
    )+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "replay", derive(serde::Serialize, serde::Deserialize))]
        pub(crate) struct $of { $(pub(crate) $field: $kind),+ }

        impl Default for $of {
            fn default() -> Self {
                $of { $($field: $default),+ }
            }
        }

        impl $of {
            /// The names of its fields.
            #[cfg(test)]
            #[allow(dead_code, reason = "one of the two parts is asked")]
            pub(crate) const NAMES: &[&str] = &[$(stringify!($field)),+];

            fn put(self, to: &mut Material) {
                $(to.$field = self.$field;)+
            }
        }

        impl Material {
            $(#[$meta])*
            pub(crate) fn $get(&self) -> $of {
                $of { $($field: self.$field),+ }
            }
        }
    };
}

macro_rules! materials {
    (base { $($base:tt)+ } rare { $($rare:tt)+ }) => {
        fields! {
            /// Friction and restitution of a surface. Where two surfaces want different ways to combine, the
            /// first of average, minimum, maximum, multiply is taken (as glTF's `KHR_physics_rigid_bodies`
            /// has it). Of rolling and of spinning friction the larger of the two counts, surface velocities
            /// add up, and the softer surface decides how the contact yields.
            ///
            /// ```
            /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
            /// let ice = Material::default().with_friction(0.02);
            /// let rubber = Material::default().with_friction(1.0).with_restitution(0.8);
            /// ```
            #[derive(Clone, Copy, Debug, PartialEq)]
            #[cfg_attr(
                feature = "serde",
                derive(serde::Serialize, serde::Deserialize),
                serde(default, deny_unknown_fields)
            )]
            #[non_exhaustive]
            pub struct Material { $($base)+ $($rare)+ }
        }

        part! {
            /// The part of a [`Material`] that every collider has.
            BaseMaterial, base { $($base)+ }
        }

        part! {
            /// The part of a [`Material`] that few colliders have; the default in others.
            RareMaterial, rare { $($rare)+ }
        }
    };
}
material_fields!(materials);

impl Material {
    /// One coefficient for sticking and sliding.
    pub fn with_friction(mut self, friction: f32) -> Self {
        (self.static_friction, self.dynamic_friction) = (friction, friction);
        self
    }

    /// Whether its contacts are soft.
    pub(crate) fn is_soft(&self) -> bool {
        self.contact_hertz > 0.0
    }

    pub(crate) fn of(base: BaseMaterial, rare: RareMaterial) -> Material {
        let mut all = Material::default();
        base.put(&mut all);
        rare.put(&mut all);
        all
    }

    pub(crate) fn validate(&self) -> Result<(), Error> {
        self.check_ranges()
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

impl RareMaterial {
    /// Frequency [Hz] and damping ratio of the spring between two surfaces: those of the softer one, and of
    /// two alike the lower damping. The frequency is zero if both are rigid.
    pub(crate) fn spring_with(&self, other: &RareMaterial) -> (f32, f32) {
        let own = (self.contact_hertz, self.contact_damping);
        let others = (other.contact_hertz, other.contact_damping);
        let softer = own.0 < others.0 || own.0 == others.0 && own.1 < others.1;
        if others.0 == 0.0 || own.0 > 0.0 && softer { own } else { others }
    }

    /// Bits of [`ColliderSummary::flags`](super::ColliderSummary::flags): fields that differ from the
    /// default.
    pub(crate) fn flags(&self) -> u8 {
        let rolls = self.rolling_friction > 0.0 || self.spinning_friction > 0.0;
        let moves = self.surface_velocity != Vec3::ZERO;
        let soft = if self.contact_hertz > 0.0 { SOFT } else { 0 };
        let idle = soft == 0 && self.contact_damping != 1.0;
        let idle = if idle { IDLE_DAMPING } else { 0 };
        (if rolls { ROLLS } else { 0 }) | (if moves { BELT } else { 0 }) | soft | idle
    }
}
