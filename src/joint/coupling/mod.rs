//! Couplings: two motions of joints that depend on each other, as gears, racks, screws and pulleys have them.

mod store;

use super::motion::{Axes, Axis, Motion};
use super::row::NONE;
#[cfg(feature = "serde")]
use crate::config::unbounded;
use crate::error::Error;
use crate::handle::JointHandle;
use std::f64::consts::TAU;
pub(crate) use store::{CouplingRecords, Couplings, MAX_DISPLACEMENT, SavedCouplings};

// Guard: limits of a caller's input.
/// Largest factor of a coupled motion, and one over the smallest.
const MAX_FACTOR: f64 = 1e9;
// Guard: the same.
/// Largest finite end of a coupling's range.
const MAX_SUM: f64 = 1e18;

/// The default of strengths that serde finds left out.
#[cfg(feature = "serde")]
fn unbreakable() -> [f32; 2] {
    [f32::INFINITY; 2]
}

/// A motion of a joint that is coupled to another one: the same displacement that a limit of the joint would
/// restrict, times a factor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct CoupledMotion {
    /// The joint. It need not restrict this motion.
    pub joint: JointHandle,
    /// Sliding or turning.
    pub motion: Motion,
    /// Along or about which axes. An angle is about one axis.
    pub axes: Axes,
    /// Factor on the displacement [1/m] or [1/rad], or any common multiple of both factors: of magnitude
    /// 1e-9 to 1e9.
    pub factor: f64,
}

impl CoupledMotion {
    /// A motion of a joint along or about some axes.
    pub fn new(joint: JointHandle, motion: Motion, axes: Axes, factor: f64) -> CoupledMotion {
        CoupledMotion { joint, motion, axes, factor }
    }
    /// The angle about an axis of the joint's frames, with whole turns [rad].
    pub fn angle(joint: JointHandle, axis: Axis, factor: f64) -> CoupledMotion {
        CoupledMotion { joint, motion: Motion::Angular, axes: Axes::One(axis), factor }
    }
    /// The displacement along an axis of the first frame [m].
    pub fn travel(joint: JointHandle, axis: Axis, factor: f64) -> CoupledMotion {
        CoupledMotion { joint, motion: Motion::Linear, axes: Axes::One(axis), factor }
    }
    /// The distance between the joint's two frames [m].
    pub fn distance(joint: JointHandle, factor: f64) -> CoupledMotion {
        CoupledMotion { joint, motion: Motion::Linear, axes: Axes::All, factor }
    }
    /// With another factor.
    pub fn with_factor(self, factor: f64) -> CoupledMotion {
        CoupledMotion { factor, ..self }
    }
}

/// A coupling to be added: keeps the sum of two motions of joints, each times its factor, at a value or
/// within a range.
///
/// The coupling acts on the second body of each joint, and with the opposite on the first: a gearbox bears
/// the reaction of its shafts, whether it is fixed or moves. Momentum and angular momentum are conserved.
///
/// With the feature `serde` all but the motions may be left out where it is the default. Where numbers are
/// text an infinite one is `"infinity"` or `"-infinity"`.
///
/// ```
/// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
/// # let mut world = World::new(Settings::default())?;
/// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
/// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
/// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
/// # let body = world.add_body(&desc)?;
/// # let frames = world.frames_about([ground, body], DVec3::Y * 2.0, Vec3::Z)?;
/// # let other = world.add_body(&desc.with_position(Vec3::new(2.0, 2.0, 0.0)))?;
/// # let second = world.frames_about([ground, other], DVec3::new(2.0, 2.0, 0.0), Vec3::Z)?;
/// let small = world.add_joint(&JointDesc::hinge([ground, body], frames))?;
/// let large = world.add_joint(&JointDesc::hinge([ground, other], second))?;
/// let gear = world.add_coupling(&CouplingDesc::gear([small, large], [20.0, 40.0]))?;
/// world.set_angular_velocity(body, Vec3::Z * 2.0)?;
/// world.step(1.0 / 60.0)?;
/// let [fast, slow] = [body, other].map(|wheel| world.angular_velocity(wheel));
/// assert!((fast?.z + 2.0 * slow?.z).abs() < 1e-3);
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct CouplingDesc {
    /// The two motions: of two joints, or two different ones of the same joint.
    pub motions: [CoupledMotion; 2],
    /// Least and greatest value of the sum, infinite for none. `None`, the default, keeps the sum at its
    /// value when the coupling is added. In a range that is given, angles count from -pi..=pi when the
    /// coupling is added.
    #[cfg_attr(feature = "serde", serde(with = "unbounded::range", default))]
    pub range: Option<[f64; 2]>,
    /// The coupling breaks if it exerts more than this on the first or the second motion [N] or [N m].
    /// Default infinity.
    #[cfg_attr(feature = "serde", serde(with = "unbounded::pair", default = "unbreakable"))]
    pub break_force: [f32; 2],
    /// The caller's own.
    #[cfg_attr(feature = "serde", serde(default))]
    pub user_data: u64,
}

impl CouplingDesc {
    /// Keeps the sum of two motions at its present value.
    pub fn new(motions: [CoupledMotion; 2]) -> CouplingDesc {
        CouplingDesc { motions, range: None, break_force: [f32::INFINITY; 2], user_data: 0 }
    }

    /// Two meshing gears on hinges about the frames' x, by their numbers of teeth: while the first turns by
    /// `teeth[1]` turns, the second turns back by `teeth[0]`. A negative number, for one of the two, makes
    /// them turn alike: a belt, a chain, a ring gear with teeth inside.
    pub fn gear(hinges: [JointHandle; 2], teeth: [f64; 2]) -> CouplingDesc {
        CouplingDesc::new([0, 1].map(|i| CoupledMotion::angle(hinges[i], Axis::X, teeth[i])))
    }

    /// A pinion on a hinge and a rack on a slider, both along the frames' x: while the pinion turns by one
    /// turn, the rack travels by 2 pi `radius` [m].
    pub fn rack(hinge: JointHandle, slider: JointHandle, radius: f64) -> CouplingDesc {
        CouplingDesc::new([
            CoupledMotion::angle(hinge, Axis::X, radius),
            CoupledMotion::travel(slider, Axis::X, -1.0),
        ])
    }

    /// A screw: a body that turns by one turn about the frames' x of a joint travels by `lead` [m] along it.
    /// The joint must leave both free; a joint for each, a nut on a hinge and a slide, is
    /// [`CouplingDesc::rack`].
    pub fn screw(joint: JointHandle, lead: f64) -> CouplingDesc {
        CouplingDesc::rack(joint, joint, lead / TAU)
    }

    /// A rope over two pulleys: the distance of the first joint's frames and `ratio` times that of the
    /// second's are together at most `length` [m], less if the rope is slack. Each joint runs from a pulley
    /// to the body that hangs there, and restricts nothing itself
    /// ([`JointDesc::new`](crate::JointDesc::new)).
    pub fn pulley(ropes: [JointHandle; 2], ratio: f64, length: f64) -> CouplingDesc {
        CouplingDesc::new([CoupledMotion::distance(ropes[0], 1.0), CoupledMotion::distance(ropes[1], ratio)])
            .with_range(Some([f64::NEG_INFINITY, length]))
    }

    /// With other motions.
    pub fn with_motions(self, motions: [CoupledMotion; 2]) -> CouplingDesc {
        CouplingDesc { motions, ..self }
    }
    /// With another range of the sum; `None` keeps the sum at its present value.
    pub fn with_range(self, range: Option<[f64; 2]>) -> CouplingDesc {
        CouplingDesc { range, ..self }
    }
    /// Breaks above this force or torque on either motion [N] or [N m].
    pub fn with_break_force(self, break_force: [f32; 2]) -> CouplingDesc {
        CouplingDesc { break_force, ..self }
    }
    /// With a number of the caller's own.
    pub fn with_user_data(self, user_data: u64) -> CouplingDesc {
        CouplingDesc { user_data, ..self }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// Names the first that is not finite or out of its range; if an angle is not about one axis, or both
    /// motions are the same.
    pub fn validate(&self) -> Result<(), Error> {
        let [a, b] = &self.motions;
        for motion in [a, b] {
            check_factor(motion.factor)?;
            if motion.motion == Motion::Angular && !matches!(motion.axes, Axes::One(_)) {
                return Err(Error::CoupledMotion { expected: "about one axis, if it is an angle" });
            }
        }
        if (a.joint, a.motion, a.axes) == (b.joint, b.motion, b.axes) {
            return Err(Error::CoupledMotion { expected: "another one than the second" });
        }
        self.range.map_or(Ok(()), check_range)?;
        super::check_loads(["coupling strength"; 2], self.break_force)
    }
}

pub(crate) fn check_factor(factor: f64) -> Result<(), Error> {
    let (what, value) = ("coupling factor", factor);
    if !value.is_finite() {
        return Err(Error::NotFinite { what, value });
    }
    if (1.0 / MAX_FACTOR..=MAX_FACTOR).contains(&value.abs()) {
        return Ok(());
    }
    Err(Error::OutOfRange { what, expected: "of magnitude 1e-9..=1e9", value })
}

pub(crate) fn check_range([min, max]: [f64; 2]) -> Result<(), Error> {
    for (what, value) in [("coupling min", min), ("coupling max", max)] {
        if value.is_nan() {
            return Err(Error::NotFinite { what, value });
        }
        if value.is_finite() && value.abs() > MAX_SUM {
            return Err(Error::OutOfRange { what, expected: "within 1e18 or infinite", value });
        }
    }
    if min > max || min == f64::INFINITY || max == f64::NEG_INFINITY {
        return Err(Error::OutOfRange { what: "coupling max", expected: "at least min", value: max });
    }
    Ok(())
}

/// A coupled motion of a joint, without its factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Term {
    /// Slot of the joint; [`NONE`] in a coupling that was removed.
    pub(crate) joint: u32,
    pub(crate) motion: Motion,
    pub(crate) axes: Axes,
}

impl Term {
    /// The displacement with whole turns that is nearest to another one, given that without.
    pub(crate) fn unwrapped(&self, displacement: f32, near: f64) -> f64 {
        let value = f64::from(displacement);
        if self.motion == Motion::Linear || !near.is_finite() {
            return value;
        }
        value + TAU * ((near - value) / TAU).round()
    }
}

/// A coupling. Its slot is its index: it never moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coupling {
    pub(crate) terms: [Term; 2],
    pub(crate) factors: [f64; 2],
    /// Range of the sum.
    pub(crate) range: [f64; 2],
    pub(crate) strength: [f32; 2],
    pub(crate) user_data: u64,
    /// The displacements after the last step, with whole turns [m] or [rad].
    pub(crate) displacements: [f64; 2],
    /// At the lower and the upper end, in the last substep, per scaled factor (see [`Coupling::scaled`]).
    pub(crate) impulse: [f32; 2],
    /// The part of the impulse that does not yield.
    pub(crate) lasting_impulse: f32,
    /// On each motion in the last substep [N] or [N m].
    pub(crate) load: [f32; 2],
}

impl Coupling {
    pub(crate) fn is_there(&self) -> bool {
        self.terms[0].joint != NONE
    }

    /// The two joints, by their slots.
    pub(crate) fn joints(&self) -> [u32; 2] {
        self.terms.map(|term| term.joint)
    }

    pub(crate) fn sum(&self, displacements: [f64; 2]) -> f64 {
        self.factors[0] * displacements[0] + self.factors[1] * displacements[1]
    }

    /// Whether it keeps one value, and pushes either way.
    pub(crate) fn is_equality(&self) -> bool {
        self.range[0] == self.range[1]
    }

    /// The divisor of factors for the solver, whose numbers are `f32`: the greater magnitude.
    pub(crate) fn scale(&self) -> f64 {
        self.factors[0].abs().max(self.factors[1].abs())
    }

    /// Factors of which the greater has magnitude one.
    pub(crate) fn scaled(&self) -> [f32; 2] {
        self.factors.map(|factor| (factor / self.scale()) as f32)
    }

    pub(crate) fn is_overloaded(&self) -> bool {
        (0..2).any(|i| self.load[i].abs() > self.strength[i])
    }

    /// Forgets its load.
    pub(crate) fn forget(&mut self) {
        (self.impulse, self.lasting_impulse, self.load) = ([0.0; 2], 0.0, [0.0; 2]);
    }
}
