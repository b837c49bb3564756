//! A body in an impact that is solved on its own, outside of the rows.

use crate::body::Bodies;
use crate::forces::world_inertia;
use crate::lanes::{self, Record, Sym3};
use glam::Vec3;

/// One of the two bodies of an impact, at the time of the impact.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ImpactBody {
    pub(crate) velocity: Record,
    /// Along each axis of the world; zero for a body that can't be pushed, and along locked axes.
    pub(crate) inverse_mass: Vec3,
    pub(crate) inverse_inertia: Sym3<f32>,
}

impl ImpactBody {
    /// A dynamic body in its current state.
    pub(crate) fn now(bodies: &Bodies, i: usize) -> ImpactBody {
        ImpactBody {
            velocity: bodies.velocity[i],
            inverse_mass: bodies.traits[i].free(Vec3::splat(bodies.mass[i].inverse)),
            inverse_inertia: world_inertia(bodies, i),
        }
    }

    /// Velocity of a point at `arm` from the centre [m/s].
    pub(crate) fn at(&self, arm: Vec3) -> Vec3 {
        self.velocity.linear + self.velocity.angular.cross(arm)
    }

    pub(crate) fn turned(&self, torque: Vec3) -> Vec3 {
        self.inverse_inertia.mul(lanes::Vec3::new(torque.x, torque.y, torque.z)).lane(0)
    }

    /// Change of velocity there by a unit impulse along a direction [1/kg].
    pub(crate) fn ease(&self, arm: Vec3, along: Vec3) -> f32 {
        let torque = arm.cross(along);
        (self.inverse_mass * along).dot(along) + torque.dot(self.turned(torque))
    }

    pub(crate) fn push(&mut self, arm: Vec3, impulse: Vec3) {
        self.velocity.linear += impulse * self.inverse_mass;
        self.velocity.angular += self.turned(arm.cross(impulse));
    }
}
