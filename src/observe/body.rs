//! A body as the solver has it.

use crate::error::Error;
use crate::handle::BodyHandle;
use crate::world::World;
use glam::{DQuat, DVec3};

/// Mass, inertia and motion of a body, in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Mass [kg].
    pub mass: f64,
    /// Principal moments of inertia [kg m²].
    pub inertia: DVec3,
    /// Centre of mass [m].
    pub centre: DVec3,
    /// Rotation of the principal axes.
    pub axes: DQuat,
    /// Velocity of the centre of mass [m/s].
    pub linear: DVec3,
    /// Angular velocity [rad/s].
    pub angular: DVec3,
    /// Its acceleration by gravity [m/s²].
    pub gravity: DVec3,
}

impl BodyState {
    /// The state of a body of a world.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn of(world: &World, body: BodyHandle) -> Result<BodyState, Error> {
        Ok(BodyState::at(world, world.index(body)?))
    }

    /// The states of the dynamic bodies that are awake, in the order of
    /// [`System::bodies`](crate::observe::System::bodies).
    pub fn of_awake(world: &World) -> Vec<BodyState> {
        (0..world.bodies.dynamic()).map(|i| BodyState::at(world, i)).collect()
    }

    fn at(world: &World, i: usize) -> BodyState {
        let bodies = &world.bodies;
        let (pose, velocity) = (&bodies.pose[i], &bodies.velocity[i]);
        BodyState {
            mass: bodies.details[i].mass.into(),
            inertia: bodies.mass[i].inertia.as_dvec3(),
            centre: pose.position,
            axes: pose.rotation.as_dquat().normalize(),
            linear: velocity.linear.as_dvec3(),
            angular: velocity.angular.as_dvec3(),
            gravity: world.settings.gravity.as_dvec3() * f64::from(bodies.traits[i].gravity_scale),
        }
    }

    /// Angular momentum about its centre of mass [kg m²/s].
    pub fn spin(&self) -> DVec3 {
        self.axes * (self.inertia * (self.axes.conjugate() * self.angular))
    }

    /// [J]
    pub fn kinetic_energy(&self) -> f64 {
        let spin = self.axes.conjugate() * self.angular;
        0.5 * (self.mass * self.linear.length_squared() + spin.dot(self.inertia * spin))
    }

    /// Kinetic and potential energy [J].
    pub fn energy(&self) -> f64 {
        self.kinetic_energy() - self.mass * self.gravity.dot(self.centre)
    }
}
