//! Joints and their motors.

use crate::body::Body;
use crate::convert::{Three, refused};
use crate::world::World;
use backstop::glam::{DVec3, Vec3};
use backstop::{Axes, Axis, BodyHandle, Frame, JointDesc, JointHandle, Limit, Motion, Spring};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A joint of a world. Once it broke or was removed, calls with it are refused.
#[pyclass(frozen, eq, hash, from_py_object, module = "backstop")]
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Joint {
    handle: JointHandle,
    kind: JointKind,
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum JointKind {
    Hinge,
    Slider,
    Ball,
    Fixed,
    Distance,
}

impl JointKind {
    fn name(self) -> &'static str {
        match self {
            JointKind::Hinge => "hinge",
            JointKind::Slider => "slider",
            JointKind::Ball => "ball",
            JointKind::Fixed => "fixed",
            JointKind::Distance => "distance",
        }
    }

    /// What moves freely, along or about the joint's axis.
    fn motion(self) -> PyResult<Motion> {
        match self {
            JointKind::Hinge => Ok(Motion::Angular),
            JointKind::Slider => Ok(Motion::Linear),
            _ => Err(PyTypeError::new_err(format!("a {} joint has no axis to move along", self.name()))),
        }
    }
}

#[pymethods]
impl Joint {
    /// hinge, slider, ball, fixed or distance.
    #[getter]
    fn kind(&self) -> &'static str {
        self.kind.name()
    }

    fn __repr__(&self) -> String {
        format!("<Joint {}: {}>", self.handle.to_bits(), self.kind.name())
    }
}

/// A motor of a hinge or a slider.
#[pyclass(frozen, from_py_object, module = "backstop")]
#[derive(Clone, Copy)]
pub(crate) struct Motor(Drive);

#[derive(Clone, Copy)]
enum Drive {
    Velocity { velocity: f32, max_force: f32 },
    Position { position: f32, spring: Spring, max_force: f32 },
    Friction { max_force: f32 },
}

#[pymethods]
impl Motor {
    /// Holds a velocity [rad/s] or [m/s] with at most this torque [N m] or force [N].
    #[staticmethod]
    #[pyo3(signature = (velocity, max_force=f32::INFINITY))]
    fn velocity(velocity: f32, max_force: f32) -> Motor {
        Motor(Drive::Velocity { velocity, max_force })
    }

    /// Pulls to an angle [rad] or a place [m] like a spring of this frequency [Hz] and damping ratio.
    #[staticmethod]
    #[pyo3(signature = (position, hertz, damping_ratio=1.0, max_force=f32::INFINITY))]
    fn position(position: f32, hertz: f32, damping_ratio: f32, max_force: f32) -> Motor {
        let spring = Spring::Frequency { hertz, ratio: damping_ratio };
        Motor(Drive::Position { position, spring, max_force })
    }

    /// Brakes with at most this torque [N m] or force [N].
    #[staticmethod]
    fn friction(max_force: f32) -> Motor {
        Motor(Drive::Friction { max_force })
    }
}

impl Motor {
    fn along(self, motion: Motion) -> backstop::Motor {
        match self.0 {
            Drive::Velocity { velocity, max_force } => {
                backstop::Motor::velocity(motion, Axis::X, velocity, max_force)
            }
            Drive::Position { position, spring, max_force } => {
                backstop::Motor::position(motion, Axis::X, position, spring).with_max_force(max_force)
            }
            Drive::Friction { max_force } => backstop::Motor::friction(motion, Axis::X, max_force),
        }
    }
}

/// Fields that every joint may have.
fn with_fields(mut desc: JointDesc, fields: Option<&Bound<'_, PyDict>>) -> PyResult<JointDesc> {
    for (name, value) in fields.into_iter().flatten() {
        let name: String = name.extract()?;
        match name.as_str() {
            "collide" => desc.collide = value.extract()?,
            "break_force" => desc.break_force = value.extract()?,
            "break_torque" => desc.break_torque = value.extract()?,
            "user_data" => desc.user_data = value.extract()?,
            _ => return Err(PyTypeError::new_err(format!("a joint has no field `{name}`"))),
        }
    }
    Ok(desc)
}

/// Range and motor of a joint that moves along or about one axis.
fn with_motion(
    desc: JointDesc,
    motion: Motion,
    limits: Option<(f32, f32)>,
    motor: Option<Motor>,
) -> JointDesc {
    let limit = limits.map(|(min, max)| Limit::new(motion, Axes::One(Axis::X), min, max));
    let desc = limit.into_iter().fold(desc, JointDesc::with_limit);
    motor.into_iter().fold(desc, |desc, motor| desc.with_motor(motor.along(motion)))
}

impl World {
    fn frames(&self, bodies: [BodyHandle; 2], point: DVec3, axis: Vec3) -> PyResult<[Frame; 2]> {
        self.world.frames_about(bodies, point, axis).map_err(refused)
    }

    fn join(&mut self, kind: JointKind, desc: &JointDesc) -> PyResult<Joint> {
        let handle = self.world.add_joint(desc).map_err(refused)?;
        Ok(Joint { handle, kind })
    }
}

/// The two bodies of a joint.
type Two = (Body, Body);

#[pymethods]
impl World {
    /// Joins two bodies at a point of the world [m] so that they turn about an axis of the world alone.
    /// `limits`: least and greatest angle [rad].
    #[pyo3(signature = (bodies, point, axis, limits=None, motor=None, **fields))]
    fn add_hinge(
        &mut self,
        bodies: Two,
        point: Three,
        axis: Three,
        limits: Option<(f32, f32)>,
        motor: Option<Motor>,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        let bodies = [bodies.0.0, bodies.1.0];
        let desc = JointDesc::hinge(bodies, self.frames(bodies, point.into(), axis.into())?);
        let desc = with_motion(with_fields(desc, fields)?, Motion::Angular, limits, motor);
        self.join(JointKind::Hinge, &desc)
    }

    /// Joins two bodies so that they slide along an axis of the world alone. `limits`: least and greatest
    /// displacement [m].
    #[pyo3(signature = (bodies, point, axis, limits=None, motor=None, **fields))]
    fn add_slider(
        &mut self,
        bodies: Two,
        point: Three,
        axis: Three,
        limits: Option<(f32, f32)>,
        motor: Option<Motor>,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        let bodies = [bodies.0.0, bodies.1.0];
        let desc = JointDesc::slider(bodies, self.frames(bodies, point.into(), axis.into())?);
        let desc = with_motion(with_fields(desc, fields)?, Motion::Linear, limits, motor);
        self.join(JointKind::Slider, &desc)
    }

    /// Joins two bodies at a point of the world [m], about which they turn. `swing`: greatest angle of `axis`
    /// from where it is now [rad]; `twist`: least and greatest angle about it [rad].
    #[pyo3(signature = (bodies, point, axis=None, swing=None, twist=None, **fields))]
    fn add_ball(
        &mut self,
        bodies: Two,
        point: Three,
        axis: Option<Three>,
        swing: Option<f32>,
        twist: Option<(f32, f32)>,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        let bodies = [bodies.0.0, bodies.1.0];
        let axis = axis.map_or(Vec3::Y, Into::into);
        let desc = JointDesc::ball(bodies, self.frames(bodies, point.into(), axis)?);
        let around = Axes::Perpendicular(Axis::X);
        let swing = swing.map(|angle| Limit::new(Motion::Angular, around, 0.0, angle));
        let twist = twist.map(|(min, max)| Limit::new(Motion::Angular, Axes::One(Axis::X), min, max));
        let desc = swing.into_iter().chain(twist).fold(desc, JointDesc::with_limit);
        self.join(JointKind::Ball, &with_fields(desc, fields)?)
    }

    /// Joins two bodies as they are: they no longer move relative to each other.
    #[pyo3(signature = (bodies, point, **fields))]
    fn add_fixed(
        &mut self,
        bodies: Two,
        point: Three,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        let bodies = [bodies.0.0, bodies.1.0];
        let desc = JointDesc::fixed(bodies, self.frames(bodies, point.into(), Vec3::Y)?);
        self.join(JointKind::Fixed, &with_fields(desc, fields)?)
    }

    /// Keeps two points, one on each body and both in the world [m], between two distances [m]: a rope if
    /// `min` is zero, a rod if both are the same.
    #[pyo3(signature = (bodies, points, min, max, **fields))]
    fn add_distance(
        &mut self,
        bodies: Two,
        points: (Three, Three),
        min: f32,
        max: f32,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        let bodies = [bodies.0.0, bodies.1.0];
        let [first, _] = self.frames(bodies, points.0.into(), Vec3::Y)?;
        let [_, second] = self.frames(bodies, points.1.into(), Vec3::Y)?;
        let desc = JointDesc::distance(bodies, [first, second], min, max);
        self.join(JointKind::Distance, &with_fields(desc, fields)?)
    }

    /// Removes a joint.
    fn remove_joint(&mut self, joint: Joint) -> PyResult<()> {
        self.world.remove_joint(joint.handle).map_err(refused)
    }

    /// Whether a joint is there: it did not break and was not removed.
    fn has_joint(&self, joint: Joint) -> bool {
        self.world.contains_joint(joint.handle)
    }

    /// Gives a hinge or a slider a motor, or none.
    #[pyo3(signature = (joint, motor))]
    fn set_motor(&mut self, joint: Joint, motor: Option<Motor>) -> PyResult<()> {
        let motion = joint.kind.motion()?;
        let done = match motor {
            Some(motor) => self.world.set_joint_motor(joint.handle, motor.along(motion)),
            None => self.world.remove_joint_motor(joint.handle, motion, Axis::X).map(drop),
        };
        done.map_err(refused)
    }

    /// Gives a hinge or a slider a range [rad] or [m].
    fn set_limits(&mut self, joint: Joint, min: f32, max: f32) -> PyResult<()> {
        let limit = Limit::new(joint.kind.motion()?, Axes::One(Axis::X), min, max);
        self.world.set_joint_limit(joint.handle, limit).map_err(refused)
    }

    /// Angle of a hinge [rad], displacement of a slider [m], or distance of a distance joint [m].
    fn joint_position(&self, joint: Joint) -> PyResult<f32> {
        let (motion, axes) = match joint.kind {
            JointKind::Distance => (Motion::Linear, Axes::All),
            kind => (kind.motion()?, Axes::One(Axis::X)),
        };
        self.world.joint_position(joint.handle, motion, axes).map_err(refused)
    }

    /// Speed of a hinge [rad/s] or a slider [m/s].
    fn joint_velocity(&self, joint: Joint) -> PyResult<f32> {
        self.world.joint_velocity(joint.handle, joint.kind.motion()?, Axis::X).map_err(refused)
    }

    /// Force [N] and torque [N m] of a joint in the last step, in the world.
    fn joint_force(&self, joint: Joint) -> PyResult<([f32; 3], [f32; 3])> {
        let (force, torque) = self.world.joint_force(joint.handle).map_err(refused)?;
        Ok((force.to_array(), torque.to_array()))
    }
}
