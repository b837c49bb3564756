//! Descriptions of joints: limits and motors between two frames.

use super::motion::{Axes, Axis, Limit, Motion, Motor, Spring};
use crate::config::RowGroup;
use crate::error::{Error, each};
use crate::handle::BodyHandle;
use crate::limits;
use crate::limits::unit_quat;
use glam::Vec3;

/// The default of bounds that serde finds left out.
#[cfg(feature = "serde")]
pub(super) fn infinity() -> f32 {
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
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// # let frames = world.frames_about([ground, body], DVec3::Y * 2.0, Vec3::Z)?;
    /// // A weld which breaks above 10 kN or 500 N m.
    /// let weld = JointDesc::fixed([ground, body], frames).with_break_force(10_000.0, 500.0);
    /// world.add_joint(&weld)?;
    /// # Ok::<(), Error>(())
    /// ```
    pub fn fixed(bodies: [BodyHandle; 2], frames: [Frame; 2]) -> JointDesc {
        let joint = JointDesc::ball(bodies, frames);
        joint.with_limit(Limit::lock(Motion::Angular, Axes::All))
    }

    /// The two frames' origins stay together; all rotation is free. Add a limit around an axis for a cone,
    /// about it for a twist.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// # let frames = world.frames_about([ground, body], DVec3::Y * 2.0, Vec3::Z)?;
    /// // The head of a lamp: it turns freely about a point.
    /// let joint = world.add_joint(&JointDesc::ball([ground, body], frames))?;
    /// # Ok::<(), Error>(())
    /// ```
    pub fn ball(bodies: [BodyHandle; 2], frames: [Frame; 2]) -> JointDesc {
        JointDesc::new(bodies, frames).with_limit(Limit::lock(Motion::Linear, Axes::All))
    }

    /// Turns about the frames' x only.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// # let frames = world.frames_about([ground, body], DVec3::Y * 2.0, Vec3::Z)?;
    /// // A door about the vertical axis.
    /// let frames = world.frames_about([ground, body], DVec3::new(-0.5, 2.0, 0.0), Vec3::Y)?;
    /// let door = world.add_joint(&JointDesc::hinge([ground, body], frames))?;
    /// # Ok::<(), Error>(())
    /// ```
    pub fn hinge(bodies: [BodyHandle; 2], frames: [Frame; 2]) -> JointDesc {
        let joint = JointDesc::ball(bodies, frames);
        joint.with_limit(Limit::lock(Motion::Angular, Axes::Perpendicular(Axis::X)))
    }

    /// Slides along the frames' x only.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// # let frames = world.frames_about([ground, body], DVec3::Y * 2.0, Vec3::Z)?;
    /// // A drawer: 0.4 m along the frames' x.
    /// let range = Limit::new(Motion::Linear, Axes::One(Axis::X), 0.0, 0.4);
    /// let drawer = world.add_joint(&JointDesc::slider([ground, body], frames).with_limit(range))?;
    /// # Ok::<(), Error>(())
    /// ```
    pub fn slider(bodies: [BodyHandle; 2], frames: [Frame; 2]) -> JointDesc {
        JointDesc::new(bodies, frames)
            .with_limit(Limit::lock(Motion::Linear, Axes::Perpendicular(Axis::X)))
            .with_limit(Limit::lock(Motion::Angular, Axes::All))
    }

    /// The frames' origins stay at a distance between `min` and `max` [m]: a rod if they are equal, a rope if
    /// `min` is zero. It is solved row by row: a rope of many links that bears a load keeps its length with
    /// ball joints, which are solved together.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// # let frames = world.frames_about([ground, body], DVec3::Y * 2.0, Vec3::Z)?;
    /// // A rope of 3 m.
    /// let rope = world.add_joint(&JointDesc::distance([ground, body], frames, 0.0, 3.0))?;
    /// # Ok::<(), Error>(())
    /// ```
    pub fn distance(bodies: [BodyHandle; 2], frames: [Frame; 2], min: f32, max: f32) -> JointDesc {
        JointDesc::new(bodies, frames).with_limit(Limit::new(Motion::Linear, Axes::All, min, max))
    }

    /// A wheel (second body) on a car (first): its hub moves along the frames' y by up to `travel` [m] to
    /// either side and is held by a spring; it turns freely about x, its axle, and not otherwise. Add a motor
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

    /// With a further motor.
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
