//! Descriptions of joints: limits and motors between two frames.

use crate::config::RowGroup;
use crate::error::{Error, each, within};
use crate::handle::BodyHandle;
use crate::limits;
use crate::limits::unit_quat;
use glam::Vec3;

// Guard: a limit of what a caller may say.
/// Largest displacement that a limit or drive may name [m] or [rad].
const MAX_DISPLACEMENT: f32 = limits::MAX_POSITION as f32;

/// The default of bounds that serde finds left out.
#[cfg(feature = "serde")]
fn infinity() -> f32 {
    f32::INFINITY
}

/// Where a joint sits on a body, in the body's own axes and from its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Frame {
    /// [m], within 1e6 along each axis.
    pub position: Vec3,
    /// The joint's x, y and z in the body's axes.
    pub rotation: glam::Quat,
}

impl Default for Frame {
    fn default() -> Self {
        Frame { position: Vec3::ZERO, rotation: glam::Quat::IDENTITY }
    }
}

impl Frame {
    /// A frame that is not turned, at a point of the body.
    pub fn at(position: Vec3) -> Frame {
        Frame { position, ..Frame::default() }
    }
    /// With other axes: the joint's x, y and z in the body's axes.
    pub fn with_rotation(self, rotation: glam::Quat) -> Frame {
        Frame { rotation, ..self }
    }

    pub(crate) fn validate(&self) -> Result<(), Error> {
        limits::offset("joint frame position", self.position)?;
        unit_quat("joint frame rotation", self.rotation).map(drop)
    }
}

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
    // Guard: a limit of what a caller may say.
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
    /// A spring towards a position [m] or [rad].
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
        within("drive position", self.position, -MAX_DISPLACEMENT, MAX_DISPLACEMENT, "within 1e9")?;
        within("drive velocity", self.velocity, -limits::MAX_SPEED, limits::MAX_SPEED, "within 1e6")?;
        if self.max_force != f32::INFINITY {
            limits::amount("drive force", self.max_force)?;
        }
        self.spring.validate()
    }
}

/// A joint to be added: two bodies, a frame on each, and limits and motors of their relative motion.
///
/// The relative motion is that of the second frame as seen from the first. Frames that coincide have no
/// displacement.
///
/// With the feature `serde` all but the bodies may be left out where it is the default. Where numbers are
/// text an infinite one is `"infinity"` or `"-infinity"`.
///
/// ```
/// use backstop::glam::{DVec3, Quat, Vec3};
/// use backstop::{Axis, BodyDesc, Motor, Geometry, JointDesc, Motion, Settings, ShapeDesc, World};
///
/// # fn main() -> Result<(), backstop::Error> {
/// let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO))?;
/// let post = world.add_body(&BodyDesc::fixed())?;
/// let door = ShapeDesc::new(Geometry::cuboid(0.5, 1.0, 0.05)).with_position(Vec3::X * 0.5);
/// let door = world.add_body(&BodyDesc::dynamic().with_shape(door))?;
/// // A hinge turns about the x axis of its frames, which is upright here; a motor opens it at 1 rad/s.
/// let bodies = [post, door];
/// let frames = world.frames_at(bodies, DVec3::ZERO, Quat::from_rotation_arc(Vec3::X, Vec3::Y))?;
/// let motor = Motor::velocity(Motion::Angular, Axis::X, 1.0, 500.0);
/// let hinge = JointDesc::hinge(bodies, frames).with_motor(motor);
/// world.add_joint(&hinge)?;
/// for _ in 0..60 {
///     world.step(1.0 / 60.0)?;
/// }
/// assert!((world.angular_velocity(door)?.y - 1.0).abs() < 0.01);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct JointDesc {
    /// The two bodies, at least one of them dynamic.
    pub bodies: [BodyHandle; 2],
    /// Where the joint sits on each.
    #[cfg_attr(feature = "serde", serde(default))]
    pub frames: [Frame; 2],
    /// Limits of the relative motion.
    #[cfg_attr(feature = "serde", serde(default))]
    pub limits: Vec<Limit>,
    /// Motors of the relative motion.
    #[cfg_attr(feature = "serde", serde(default))]
    pub motors: Vec<Motor>,
    /// Whether the two bodies collide with each other. Default no.
    #[cfg_attr(feature = "serde", serde(default))]
    pub collide: bool,
    /// The joint breaks above this force [N]. Default infinity.
    #[cfg_attr(feature = "serde", serde(with = "crate::config::unbounded", default = "infinity"))]
    pub break_force: f32,
    /// The joint breaks above this torque [N m]. Default infinity.
    #[cfg_attr(feature = "serde", serde(with = "crate::config::unbounded", default = "infinity"))]
    pub break_torque: f32,
    /// The joint is among [`World::strained_joints`](crate::World::strained_joints) after each step in which
    /// its force is above this [N]. Default infinity.
    #[cfg_attr(feature = "serde", serde(with = "crate::config::unbounded", default = "infinity"))]
    pub force_threshold: f32,
    /// The same of its torque [N m]. Default infinity.
    #[cfg_attr(feature = "serde", serde(with = "crate::config::unbounded", default = "infinity"))]
    pub torque_threshold: f32,
    /// Has its rows solved right after those of this group, unless their own place is later: later rows win.
    /// A tree of joints goes as a whole. Default none.
    #[cfg_attr(feature = "serde", serde(default))]
    pub solved_after: Option<RowGroup>,
    /// The caller's own.
    #[cfg_attr(feature = "serde", serde(default))]
    pub user_data: u64,
}

impl JointDesc {
    /// A joint that restricts nothing yet.
    pub fn new(bodies: [BodyHandle; 2], frames: [Frame; 2]) -> JointDesc {
        JointDesc {
            bodies,
            frames,
            limits: Vec::new(),
            motors: Vec::new(),
            collide: false,
            break_force: f32::INFINITY,
            break_torque: f32::INFINITY,
            force_threshold: f32::INFINITY,
            torque_threshold: f32::INFINITY,
            solved_after: None,
            user_data: 0,
        }
    }

    /// No relative motion.
    pub fn fixed(bodies: [BodyHandle; 2], frames: [Frame; 2]) -> JointDesc {
        let joint = JointDesc::ball(bodies, frames);
        joint.with_limit(Limit::lock(Motion::Angular, Axes::All))
    }

    /// The two frames' origins stay together; all rotation is free. Add a limit around an axis for a cone,
    /// about it for a twist.
    pub fn ball(bodies: [BodyHandle; 2], frames: [Frame; 2]) -> JointDesc {
        JointDesc::new(bodies, frames).with_limit(Limit::lock(Motion::Linear, Axes::All))
    }

    /// Turns about the frames' x only.
    pub fn hinge(bodies: [BodyHandle; 2], frames: [Frame; 2]) -> JointDesc {
        let joint = JointDesc::ball(bodies, frames);
        joint.with_limit(Limit::lock(Motion::Angular, Axes::Perpendicular(Axis::X)))
    }

    /// Slides along the frames' x only.
    pub fn slider(bodies: [BodyHandle; 2], frames: [Frame; 2]) -> JointDesc {
        JointDesc::new(bodies, frames)
            .with_limit(Limit::lock(Motion::Linear, Axes::Perpendicular(Axis::X)))
            .with_limit(Limit::lock(Motion::Angular, Axes::All))
    }

    /// The frames' origins stay at a distance between `min` and `max` [m]: a rod if they are equal, a rope if
    /// `min` is zero.
    pub fn distance(bodies: [BodyHandle; 2], frames: [Frame; 2], min: f32, max: f32) -> JointDesc {
        JointDesc::new(bodies, frames).with_limit(Limit::new(Motion::Linear, Axes::All, min, max))
    }

    /// A wheel (second body) on a car (first): its hub moves along the frames' y by up to `travel` [m] to
    /// either side and is held by a spring; it turns freely about x, its axle, and not otherwise. Add a drive
    /// about x for an engine.
    pub fn wheel(bodies: [BodyHandle; 2], frames: [Frame; 2], travel: f32, spring: Spring) -> JointDesc {
        JointDesc::new(bodies, frames)
            .with_limit(Limit::lock(Motion::Linear, Axes::Perpendicular(Axis::Y)))
            .with_limit(Limit::lock(Motion::Angular, Axes::Perpendicular(Axis::X)))
            .with_limit(Limit::new(Motion::Linear, Axes::One(Axis::Y), -travel, travel))
            .with_motor(Motor::position(Motion::Linear, Axis::Y, 0.0, spring))
    }

    /// With a further limit.
    pub fn with_limit(mut self, limit: Limit) -> JointDesc {
        self.limits.push(limit);
        self
    }

    /// With a further drive.
    pub fn with_motor(mut self, drive: Motor) -> JointDesc {
        self.motors.push(drive);
        self
    }

    /// Whether the two bodies collide with each other.
    pub fn with_collide(mut self, collide: bool) -> JointDesc {
        self.collide = collide;
        self
    }

    /// Breaks above this force [N] and this torque [N m]; infinity for never.
    pub fn with_break_force(mut self, force: f32, torque: f32) -> JointDesc {
        (self.break_force, self.break_torque) = (force, torque);
        self
    }

    /// Is reported above this force [N] and this torque [N m]; infinity for never.
    pub fn with_thresholds(mut self, force: f32, torque: f32) -> JointDesc {
        (self.force_threshold, self.torque_threshold) = (force, torque);
        self
    }

    /// Rows right after those of a group, if that is later.
    pub fn with_solved_after(mut self, above: RowGroup) -> JointDesc {
        self.solved_after = Some(above);
        self
    }

    /// With a number of the caller's own.
    pub fn with_user_data(mut self, user_data: u64) -> JointDesc {
        self.user_data = user_data;
        self
    }

    /// Checks every number.
    ///
    /// # Errors
    /// Names the first that is not finite or out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        if self.bodies[0] == self.bodies[1] {
            return Err(Error::JointToItself);
        }
        each("frame", &self.frames, Frame::validate)?;
        each("limit", &self.limits, Limit::validate)?;
        each("drive", &self.motors, Motor::validate)?;
        check_loads(STRENGTH, [self.break_force, self.break_torque])?;
        check_loads(THRESHOLD, [self.force_threshold, self.torque_threshold])
    }
}

/// Names of the bounds of a joint's force and torque in errors.
pub(crate) const STRENGTH: [&str; 2] = ["break force", "break torque"];
/// See [`STRENGTH`].
pub(crate) const THRESHOLD: [&str; 2] = ["force threshold", "torque threshold"];

/// Checks bounds of a joint's force and torque.
pub(crate) fn check_loads(what: [&'static str; 2], loads: [f32; 2]) -> Result<(), Error> {
    what.into_iter().zip(loads).try_for_each(|(what, value)| limits::load(what, value))
}

pub(super) fn axes_code(axes: Axes) -> u32 {
    match axes {
        Axes::One(axis) => axis as u32,
        Axes::Perpendicular(axis) => 3 + axis as u32,
        Axes::All => 6,
    }
}

pub(super) fn axes_of(code: u32) -> Option<Axes> {
    match code {
        axis @ 0..=2 => Some(Axes::One(Axis::ALL[axis as usize])),
        axis @ 3..=5 => Some(Axes::Perpendicular(Axis::ALL[axis as usize - 3])),
        6 => Some(Axes::All),
        _ => None,
    }
}
