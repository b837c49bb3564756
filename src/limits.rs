//! The ranges of a caller's input, stated once, with a checker for each kind of number:
//!
//! | Kind | Checker | Of |
//! | --- | --- | --- |
//! | place in the world | `position` | bodies, origins, targets, points of forces, characters |
//! | offset on a body | `offset` | shapes, centres of mass, frames of joints, bones, points of hulls |
//! | coordinate | `coordinate` | vertices of meshes, heights of fields |
//! | size | `length`, `length_or_zero` | shapes, bones, the length unit |
//! | velocity | `speed`, `speed_cap` | bodies, belts, walks |
//! | acceleration | `acceleration` | gravity and factors on it |
//! | force, torque, impulse | `force` | what acts on bodies, and its sum |
//! | load | `load` | strengths and thresholds of joints and couplings |
//! | mass, moments | `inertia`, `density` | mass properties, shapes, skeletons |
//! | rate of damping | `damping` | bodies |
//! | coefficient | `friction`, `share` | materials, hooks |
//! | other amount | `amount` | thresholds and times of settings, forces of motors and characters |
//! | time | `step` | steps, walks, targets |
//!
//! Rotations are checked by [`unit_quat`], springs, limits and motors in `joint/motion.rs`, rays and casts in
//! `query/ray.rs`. `tests/world/each_call/numbers.rs` goes through all calls.
//!
//! The ranges: Each is far beyond any honest scene, and close enough that the stages' results in `f32` stay
//! finite: the fourth power of the largest distance, `(2e9)^4 = 1.6e37`, is one.

use crate::error::Error;
pub use crate::error::{finite, finite3, positive, within};
use crate::math::Quat;
use glam::{DVec3, Vec3};

/// Largest coordinate of a position [m]: beyond the moon, where `f32` has steps of 64 m around an origin.
pub const MAX_POSITION: f64 = 1e9;
/// Largest speed [m/s] and spin [rad/s], along or about each axis: a hundred times the speed of meteors. In
/// the longest step it is a way of 1e7 m, and its square is far from the end of numbers.
pub const MAX_SPEED: f32 = 1e6;
/// The fastest that a step leaves a body [m/s], [rad/s], along or about each axis: the range of a caller's
/// input, and the increase by gravity, springs and impacts in honest steps. A body that would be faster is
/// stopped ([`StepReport::faulted`](crate::StepReport::stopped)).
pub const MAX_LEFT_SPEED: f32 = 2.0 * MAX_SPEED;
/// Smallest radius or half extent [m]: the moments of a ball of water so small are 1e-27 kg m², and one over
/// them is a number.
pub const MIN_LENGTH: f32 = 1e-6;
/// Largest radius, half extent, offset of a shape or arm of a joint [m]: the moments of a ball of rock so
/// large are 1e34 kg m².
pub const MAX_LENGTH: f32 = 1e6;
/// Largest coordinate of a triangle mesh or height field [m]: squares of areas stay numbers.
pub const MAX_COORDINATE: f32 = 1e7;
/// Shortest step [s]: below, the gain of a step at 1 g is less than the resolution of `f32` at 100 m/s.
pub const MIN_STEP: f32 = 1e-6;
/// Longest step [s]: physics at a tenth of a frame a second is none.
pub const MAX_STEP: f32 = 10.0;
/// Largest gravity [m/s²] along each axis, and largest factor on it.
pub const MAX_ACCELERATION: f32 = 1e6;
/// Largest force [N], torque [N m] and impulse [N s] along or about each axis, also in sum: it would lift
/// 1e17 kg, and its square is a number.
pub const MAX_FORCE: f32 = 1e18;
/// Largest mass [kg], moment of inertia [kg m²] and one over each: sums and products of a few stay numbers.
pub const MAX_MASS: f32 = 1e36;
/// Largest density [kg/m³].
pub const MAX_DENSITY: f32 = 1e15;
/// Largest linear or angular damping of a body [1/s].
pub const MAX_DAMPING: f32 = 1e6;

/// Largest force or impulse that is carried from step to step [N], [N s]: beyond the loads of the heaviest
/// possible bodies; the sum of a few is still finite.
pub(crate) const MAX_LOAD: f32 = 10.0 * MAX_MASS;

pub(crate) fn position(at: DVec3) -> Result<(), Error> {
    let what = "position";
    for value in at.to_array() {
        if !value.is_finite() {
            return Err(Error::NotFinite { what, value });
        }
        if value.abs() > MAX_POSITION {
            return Err(Error::OutOfRange { what, expected: "within 1e9 m along each axis", value });
        }
    }
    Ok(())
}

/// Whether all of a vector is within `most`.
fn within3(what: &'static str, v: Vec3, most: f32, expected: &'static str) -> Result<(), Error> {
    v.to_array().iter().try_for_each(|&x| within(what, x, -most, most, expected).map(drop))
}

pub(crate) fn speed(what: &'static str, v: Vec3) -> Result<(), Error> {
    within3(what, v, MAX_SPEED, "within 1e6 along each axis")
}

/// A force, a torque or an impulse.
pub(crate) fn force(what: &'static str, v: Vec3) -> Result<(), Error> {
    within3(what, v, MAX_FORCE, "within 1e18 along each axis")
}

pub(crate) fn acceleration(what: &'static str, v: Vec3) -> Result<(), Error> {
    within3(what, v, MAX_ACCELERATION, "within 1e6 along each axis")
}

/// A rate of linear or angular damping.
pub(crate) fn damping(what: &'static str, value: f32) -> Result<(), Error> {
    within(what, value, 0.0, MAX_DAMPING, "in 0..=1e6").map(drop)
}

/// The density of a shape.
pub(crate) fn density(value: f32) -> Result<(), Error> {
    within("density", value, 0.0, MAX_DENSITY, "in 0..=1e15").map(drop)
}

/// A greatest speed, linear or angular.
pub(crate) fn speed_cap(what: &'static str, value: Option<f32>) -> Result<(), Error> {
    value.map_or(Ok(()), |value| within(what, value, 0.0, MAX_SPEED, "in 0..=1e6").map(drop))
}

/// An offset from a body's origin.
pub(crate) fn offset(what: &'static str, v: Vec3) -> Result<(), Error> {
    within3(what, v, MAX_LENGTH, "within 1e6 m along each axis")
}

/// A place of a body's centre of mass or of a shape, which its body's origin may be this far from.
pub(crate) fn centre(at: DVec3) -> Result<(), Error> {
    let most = MAX_POSITION + 4.0 * f64::from(MAX_LENGTH);
    if at.abs().cmple(DVec3::splat(most)).all() { Ok(()) } else { position(at) }
}

/// A velocity that a step left.
pub(crate) fn left_speed(what: &'static str, v: Vec3) -> Result<(), Error> {
    within3(what, v, MAX_LEFT_SPEED, "within 2e6 along each axis")
}

/// An offset from a body's centre of mass, which may be as far from its origin as the shape.
pub(crate) fn lever(what: &'static str, v: Vec3) -> Result<(), Error> {
    within3(what, v, 4.0 * MAX_LENGTH, "within 4e6 m along each axis")
}

/// A radius or a half extent.
pub(crate) fn length(what: &'static str, value: f32) -> Result<(), Error> {
    // Values that are not positive have an error of their own.
    crate::error::positive(what, value)?;
    within(what, value, MIN_LENGTH, MAX_LENGTH, "in 1e-6..=1e6 m").map(drop)
}

/// The same, or zero.
pub(crate) fn length_or_zero(what: &'static str, value: f32) -> Result<(), Error> {
    if value == 0.0 {
        Ok(())
    } else {
        within(what, value, MIN_LENGTH, MAX_LENGTH, "zero or in 1e-6..=1e6 m").map(drop)
    }
}

/// A coordinate of a mesh or a height field.
pub(crate) fn coordinate(what: &'static str, value: f32) -> Result<(), Error> {
    within(what, value, -MAX_COORDINATE, MAX_COORDINATE, "within 1e7").map(drop)
}

/// A coefficient of friction.
pub(crate) fn friction(what: &'static str, value: f32) -> Result<(), Error> {
    amount(what, value)
}

/// A share of something, as a coefficient of restitution.
pub(crate) fn share(what: &'static str, value: f32) -> Result<(), Error> {
    within(what, value, 0.0, 1.0, "in 0..=1").map(drop)
}

/// Types of fields with a range.
pub(crate) trait Ranged {
    /// Refuses values outside of `[low, high]`.
    fn check(self, what: &'static str, ends: [f32; 2], expected: &'static str) -> Result<(), Error>;
}

impl Ranged for f32 {
    fn check(self, what: &'static str, [low, high]: [f32; 2], expected: &'static str) -> Result<(), Error> {
        // Values that are not positive have an error of their own.
        if low > 0.0 {
            positive(what, self)?;
        }
        within(what, self, low, high, expected).map(drop)
    }
}

impl Ranged for u32 {
    fn check(self, what: &'static str, [low, high]: [f32; 2], expected: &'static str) -> Result<(), Error> {
        within(what, self as f32, low, high, expected).map(drop)
    }
}

impl Ranged for usize {
    fn check(self, what: &'static str, [low, high]: [f32; 2], expected: &'static str) -> Result<(), Error> {
        within(what, self as f32, low, high, expected).map(drop)
    }
}

impl<T: Ranged> Ranged for Option<T> {
    fn check(self, what: &'static str, ends: [f32; 2], expected: &'static str) -> Result<(), Error> {
        self.map_or(Ok(()), |value| value.check(what, ends, expected))
    }
}

impl Ranged for Vec3 {
    fn check(self, what: &'static str, [low, high]: [f32; 2], expected: &'static str) -> Result<(), Error> {
        self.to_array().iter().try_for_each(|&x| within(what, x, low, high, expected).map(drop))
    }
}

/// An amount that nothing bounds from above.
pub(crate) fn amount(what: &'static str, value: f32) -> Result<(), Error> {
    within(what, value, 0.0, f32::MAX, "at least zero").map(drop)
}

/// A bound of a force or a torque; infinite for none.
pub(crate) fn load(what: &'static str, value: f32) -> Result<(), Error> {
    if value >= 0.0 {
        return Ok(());
    }
    Err(Error::OutOfRange { what, expected: "at least zero", value: value.into() })
}

/// A rotation that is a unit quaternion within rounding, normalised; or an error that names it.
///
/// # Errors
/// If a part is not finite, or its length differs from 1 by more than a hundredth.
pub fn unit_quat(what: &'static str, q: impl Into<Quat>) -> Result<Quat, Error> {
    let q = q.into();
    for value in q.to_array() {
        finite(what, value)?;
    }
    within(what, q.length(), 0.99, 1.01, "a unit quaternion")?;
    Ok(q.normalize())
}

/// A direction of any length but zero, made a unit vector; or an error that names it.
pub(crate) fn direction(what: &'static str, v: Vec3) -> Result<Vec3, Error> {
    for value in v.to_array() {
        finite(what, value)?;
    }
    // By its greatest component first: squares of very large or small ones leave the range.
    let v = v / v.abs().max_element();
    let unit = v / v.length();
    if unit.is_finite() {
        return Ok(unit);
    }
    Err(Error::OutOfRange { what, expected: "not zero", value: 0.0 })
}

/// The length of a step [s].
///
/// # Errors
/// If it is not in [`MIN_STEP`]`..=`[`MAX_STEP`].
pub fn step(dt: f32) -> Result<f32, Error> {
    within("dt", dt, MIN_STEP, MAX_STEP, "in 1e-6..=10 s")
}

/// A mass or a moment of inertia of a body that can be pushed.
pub(crate) fn inertia(what: &'static str, value: f32) -> Result<(), Error> {
    finite(what, value)?;
    within(what, value, 1.0 / MAX_MASS, MAX_MASS, "in 1e-36..=1e36").map(drop)
}
