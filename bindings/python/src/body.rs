//! Bodies: their handles, and what is done with one.

use crate::convert::{Four, Three, refused};
use crate::world::World;
use backstop::BodyHandle;
use pyo3::prelude::*;

/// A body of a world. After the body was removed, calls with it are refused.
#[pyclass(frozen, eq, hash, from_py_object, module = "backstop")]
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Body(pub(crate) BodyHandle);

#[pymethods]
impl Body {
    fn __repr__(&self) -> String {
        format!("Body({})", self.0.to_bits())
    }
}

#[pymethods]
impl World {
    /// Position of a body's origin [m].
    fn position(&self, body: Body) -> PyResult<[f64; 3]> {
        self.world.position(body.0).map(|at| at.to_array()).map_err(refused)
    }

    /// Rotation of a body, a unit quaternion x, y, z, w.
    fn rotation(&self, body: Body) -> PyResult<[f32; 4]> {
        self.world.rotation(body.0).map(|turn| turn.to_array()).map_err(refused)
    }

    /// Velocity of a body's centre of mass [m/s].
    fn velocity(&self, body: Body) -> PyResult<[f32; 3]> {
        self.world.linear_velocity(body.0).map(|v| v.to_array()).map_err(refused)
    }

    /// Angular velocity of a body about the world's axes [rad/s].
    fn angular_velocity(&self, body: Body) -> PyResult<[f32; 3]> {
        self.world.angular_velocity(body.0).map(|v| v.to_array()).map_err(refused)
    }

    /// Mass of a body [kg].
    fn mass(&self, body: Body) -> PyResult<f32> {
        self.world.mass(body.0).map_err(refused)
    }

    /// Puts a body elsewhere. Without a rotation it keeps its own.
    #[pyo3(signature = (body, position, rotation=None))]
    fn set_pose(&mut self, body: Body, position: Three, rotation: Option<Four>) -> PyResult<()> {
        let own = self.world.rotation(body.0).map_err(refused)?;
        self.world.set_pose(body.0, position.into(), rotation.map_or(own, Into::into)).map_err(refused)
    }

    /// Sets the velocity of a body [m/s], and its angular velocity [rad/s] if it is given.
    #[pyo3(signature = (body, linear, angular=None))]
    fn set_velocity(&mut self, body: Body, linear: Three, angular: Option<Three>) -> PyResult<()> {
        match angular {
            Some(angular) => self.world.set_velocity(body.0, linear.into(), angular.into()),
            None => self.world.set_linear_velocity(body.0, linear.into()),
        }
        .map_err(refused)
    }

    /// Adds a force [N] for the next step, at the centre of mass or at a point of the world [m].
    #[pyo3(signature = (body, force, point=None))]
    fn add_force(&mut self, body: Body, force: Three, point: Option<Three>) -> PyResult<()> {
        match point {
            Some(point) => self.world.add_force_at(body.0, force.into(), point.into()),
            None => self.world.add_force(body.0, force.into()),
        }
        .map_err(refused)
    }

    /// Adds a torque [N m] for the next step.
    fn add_torque(&mut self, body: Body, torque: Three) -> PyResult<()> {
        self.world.add_torque(body.0, torque.into()).map_err(refused)
    }

    /// Changes velocities by an impulse [N s], at the centre of mass or at a point of the world [m].
    #[pyo3(signature = (body, impulse, point=None))]
    fn apply_impulse(&mut self, body: Body, impulse: Three, point: Option<Three>) -> PyResult<()> {
        match point {
            Some(point) => self.world.apply_impulse_at(body.0, impulse.into(), point.into()),
            None => self.world.apply_impulse(body.0, impulse.into()),
        }
        .map_err(refused)
    }

    /// Wakes a body and its island.
    fn wake(&mut self, body: Body) -> PyResult<()> {
        self.world.wake(body.0).map_err(refused)
    }

    /// Whether a body sleeps.
    fn is_sleeping(&self, body: Body) -> PyResult<bool> {
        self.world.is_sleeping(body.0).map_err(refused)
    }
}
