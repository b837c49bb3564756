//! The parts of a joint: motions along and about axes, springs, limits and motors.

use crate::error::{Error, within};
use crate::limits;

#[cfg(feature = "serde")]
use super::desc::infinity;

// Guard: a limit of a caller's input.
/// Largest displacement that a limit or a motor may name [m] or [rad].
const MAX_DISPLACEMENT: f32 = limits::MAX_POSITION as f32;

/// A direction of relative motion, along or about axes of the first body's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Axis {
    /// x
    X,
    /// y
    Y,
    /// z
    Z,
}

impl Axis {
    /// All three.
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];
}

/// Which axes a limit restricts together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Axes {
    /// Linear: the signed distance along one axis [m]. Angular: the twist about it [rad].
    One(Axis),
    /// The two others than this. Linear: the distance from the line along it [m]. Angular: the angle between
    /// this axis of the two frames, a cone [rad].
    Perpendicular(Axis),
    /// Linear: the distance of the two frames [m]. Angular: the angle of the whole rotation between them
    /// [rad].
    All,
}

/// Sliding or turning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Motion {
    /// [m]
    Linear,
    /// [rad]
    Angular,
}

/// A spring with a damper.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "lowercase", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Spring {
    /// Force or torque per displacement and per speed: [N/m] and [N s/m], or [N m/rad] and [N m s/rad].
    Coefficients {
        /// At least zero.
        stiffness: f32,
        /// At least zero; infinite holds the speed exactly.
        #[cfg_attr(feature = "serde", serde(with = "crate::config::unbounded"))]
        damping: f32,
    },
    /// The same by frequency and damping ratio of the joined bodies, independent of their mass.
    Frequency {
        /// Undamped [Hz], up to 1e9.
        hertz: f32,
        /// 1 is critical, 1e9 the most.
        ratio: f32,
    },
    /// Acceleration per displacement [1/s²] and per speed [1/s].
    Acceleration {
        /// At least zero.
        stiffness: f32,
        /// At least zero; infinite holds the speed exactly.
        #[cfg_attr(feature = "serde", serde(with = "crate::config::unbounded"))]
        damping: f32,
    },
}

/// A spring as its rows take it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringCoefficients {
    /// Force per displacement, [N/m] or [N m/rad]; per effective mass [1/s²].
    pub stiffness: f32,
    /// Force per speed, [N s/m] or [N m s/rad]; per effective mass [1/s].
    pub damping: f32,
    /// Whether both are per effective mass.
    pub per_mass: bool,
}

impl SpringCoefficients {
    /// Those of a row whose effective mass is one over `mobility` [1/kg or 1/(kg m²)].
    pub(crate) fn with_mobility(self, mobility: f32) -> SpringCoefficients {
        let by = if self.per_mass { mobility } else { 1.0 };
        SpringCoefficients { stiffness: self.stiffness / by, damping: self.damping / by, per_mass: false }
    }
}

impl Spring {
    // Guard: a limit of a caller's input.
    /// The most stiffness or finite damping that is allowed.
    pub const MAX_COEFFICIENT: f32 = 1e20;

    /// Its stiffness and damping, however it was described.
    pub fn coefficients(self) -> SpringCoefficients {
        match self {
            Spring::Coefficients { stiffness, damping } => {
                SpringCoefficients { stiffness, damping, per_mass: false }
            }
            Spring::Acceleration { stiffness, damping } => {
                SpringCoefficients { stiffness, damping, per_mass: true }
            }
            Spring::Frequency { hertz, ratio } => {
                let omega = std::f32::consts::TAU * hertz;
                SpringCoefficients { stiffness: omega * omega, damping: 2.0 * ratio * omega, per_mass: true }
            }
        }
    }

    pub(super) fn validate(self) -> Result<(), Error> {
        let (stiffness, damping) = match self {
            Spring::Coefficients { stiffness, damping } | Spring::Acceleration { stiffness, damping } => {
                (stiffness, damping)
            }
            Spring::Frequency { hertz, ratio } => {
                // Their squares and products must be numbers too.
                within("spring frequency", hertz, 0.0, 1e9, "in 0..=1e9")?;
                within("spring damping ratio", ratio, 0.0, 1e9, "in 0..=1e9")?;
                return Ok(());
            }
        };
        within("spring stiffness", stiffness, 0.0, Self::MAX_COEFFICIENT, "in 0..=1e20")?;
        if damping != f32::INFINITY {
            within("spring damping", damping, 0.0, Self::MAX_COEFFICIENT, "in 0..=1e20 or infinite")?;
        }
        Ok(())
    }
}

/// Keeps a displacement within a range. A range of no width locks.
///
/// ```
/// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
/// // A knee bends between 0 and 2.4 rad, and gives way softly at the end.
/// let stop = Spring::Frequency { hertz: 10.0, ratio: 1.0 };
/// let knee = Limit::new(Motion::Angular, Axes::One(Axis::X), 0.0, 2.4).with_spring(stop);
/// assert!(knee.validate().is_ok());
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Limit {
    /// The limited axes.
    pub motion: Motion,
    /// Along or about which axes.
    pub axes: Axes,
    /// Least allowed [m] or [rad]; minus infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::config::unbounded"))]
    pub min: f32,
    /// Most allowed, not below `min`; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::config::unbounded"))]
    pub max: f32,
    /// The spring that pushes back beyond the range; `None` is rigid.
    #[cfg_attr(feature = "serde", serde(default))]
    pub spring: Option<Spring>,
}

impl Limit {
    /// A rigid one.
    pub fn new(motion: Motion, axes: Axes, min: f32, max: f32) -> Limit {
        Limit { motion, axes, min, max, spring: None }
    }
    /// No motion at all.
    pub fn lock(motion: Motion, axes: Axes) -> Limit {
        Limit::new(motion, axes, 0.0, 0.0)
    }
    /// With another range, from `min` to `max` [m] or [rad].
    pub fn with_range(self, min: f32, max: f32) -> Limit {
        Limit { min, max, ..self }
    }
    /// Yields like a spring beyond its range.
    pub fn with_spring(self, spring: Spring) -> Limit {
        Limit { spring: Some(spring), ..self }
    }

    /// Whether nothing moves, and nothing yields.
    pub(crate) fn locks(&self) -> bool {
        self.min == 0.0 && self.max == 0.0 && self.spring.is_none()
    }

    /// Whether all of its numbers are in their ranges.
    ///
    /// # Errors
    /// If one is not.
    pub fn validate(&self) -> Result<(), Error> {
        for (what, value) in [("joint limit min", self.min), ("joint limit max", self.max)] {
            if value.is_nan() {
                return Err(Error::NotFinite { what, value: value.into() });
            }
            if value.is_finite() {
                within(what, value, -MAX_DISPLACEMENT, MAX_DISPLACEMENT, "within 1e9 or infinite")?;
            }
        }
        if self.min > self.max || self.min == f32::INFINITY || self.max == f32::NEG_INFINITY {
            let value = self.max.into();
            return Err(Error::OutOfRange { what: "joint limit max", expected: "at least min", value });
        }
        if !matches!(self.axes, Axes::One(_)) && self.max < 0.0 {
            let value = self.max.into();
            return Err(Error::OutOfRange { what: "joint limit max", expected: "at least zero", value });
        }
        self.spring.map_or(Ok(()), Spring::validate)
    }
}

/// Pulls a displacement to a target position, a target velocity, or both, with a bounded force.
///
/// A spring without damping is an oscillator, one with infinite damping and no stiffness a motor that holds
/// its velocity up to `max_force`, and such a motor at rest is friction.
///
/// ```
/// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
/// let fan = Motor::velocity(Motion::Angular, Axis::X, 20.0, 5.0);
/// let servo = Motor::position(
///     Motion::Angular,
///     Axis::X,
///     0.5,
///     Spring::Frequency { hertz: 5.0, ratio: 1.0 },
/// );
/// let stiff_hinge = Motor::friction(Motion::Angular, Axis::X, 2.0);
/// assert!([fan, servo, stiff_hinge].iter().all(|motor| motor.validate().is_ok()));
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Motor {
    /// Along or about the axis.
    pub motion: Motion,
    /// An axis of the first body's frame.
    pub axis: Axis,
    /// [m] or [rad], within 1e9.
    #[cfg_attr(feature = "serde", serde(default))]
    pub position: f32,
    /// [m/s] or [rad/s], within 1e6.
    #[cfg_attr(feature = "serde", serde(default))]
    pub velocity: f32,
    /// How hard it pulls.
    pub spring: Spring,
    /// The most force [N] or torque [N m]; infinity for no bound.
    #[cfg_attr(feature = "serde", serde(with = "crate::config::unbounded", default = "infinity"))]
    pub max_force: f32,
}

impl Motor {
    /// Holds a speed [m/s] or [rad/s] with at most so much force [N] or torque [N m].
    pub fn velocity(motion: Motion, axis: Axis, velocity: f32, max_force: f32) -> Motor {
        let spring = Spring::Coefficients { stiffness: 0.0, damping: f32::INFINITY };
        Motor { motion, axis, position: 0.0, velocity, spring, max_force }
    }
    /// Coulomb friction in the joint: resists any motion with at most so much force [N] or torque [N m].
    pub fn friction(motion: Motion, axis: Axis, max_force: f32) -> Motor {
        Motor::velocity(motion, axis, 0.0, max_force)
    }
    /// A spring towards a position [m] or [rad]. It is integrated implicitly, so that an undamped one loses
    /// amplitude, less with more substeps.
    pub fn position(motion: Motion, axis: Axis, position: f32, spring: Spring) -> Motor {
        Motor { motion, axis, position, velocity: 0.0, spring, max_force: f32::INFINITY }
    }
    /// With another target: a position [m] or [rad] and a velocity [m/s] or [rad/s].
    pub fn with_target(self, position: f32, velocity: f32) -> Motor {
        Motor { position, velocity, ..self }
    }
    /// With another spring.
    pub fn with_spring(self, spring: Spring) -> Motor {
        Motor { spring, ..self }
    }
    /// With at most so much force [N] or torque [N m].
    pub fn with_max_force(self, max_force: f32) -> Motor {
        Motor { max_force, ..self }
    }

    /// Whether all of its numbers are in their ranges.
    ///
    /// # Errors
    /// If one is not.
    pub fn validate(&self) -> Result<(), Error> {
        within("motor position", self.position, -MAX_DISPLACEMENT, MAX_DISPLACEMENT, "within 1e9")?;
        within("motor velocity", self.velocity, -limits::MAX_SPEED, limits::MAX_SPEED, "within 1e6")?;
        if self.max_force != f32::INFINITY {
            limits::amount("motor force", self.max_force)?;
        }
        self.spring.validate()
    }
}
