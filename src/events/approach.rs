//! Approach of bodies at the start of a step, before anything is solved.

use crate::body::{Bodies, Colliders};
use crate::forces::Forces;
use crate::handle::BodyHandle;
use crate::narrow_phase::{ContactRef, Point};
use glam::{DVec3, Vec3};

/// Bodies and colliders at the start of the step, and the accelerations of the bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StartOfStep<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) colliders: &'a Colliders,
    pub(crate) forces: &'a Forces,
    /// Length of the step [s].
    pub(crate) dt: f32,
}

/// How two bodies approach each other at a contact point before anything is solved, where they are at the
/// start of the step.
pub(crate) struct Approach {
    /// Unit, from a to b, in the world.
    pub(crate) normal: Vec3,
    pub(crate) position: DVec3,
    /// Along the normal [m/s].
    pub(crate) speed: f32,
}

impl StartOfStep<'_> {
    /// The body of a collider.
    pub(crate) fn body_of(&self, collider: u32) -> BodyHandle {
        self.bodies.handle(self.colliders.summaries[collider as usize].body as usize)
    }

    /// How the bodies approach each other at a contact point.
    pub(crate) fn approach(&self, contact: ContactRef<'_>, point: &Point) -> Approach {
        let shape = &self.colliders.poses[contact.a as usize];
        let normal = shape.rotation * contact.normal;
        let at = shape.position + (shape.rotation * point.position).as_dvec3();
        let [a, b] = [contact.a, contact.b].map(|c| self.speed_before(c, at, contact.fraction));
        Approach { normal, position: at, speed: -normal.dot(b - a) }
    }

    /// Velocity of a point of a collider's body at the start of the step, plus the acceleration up to a
    /// fraction of it.
    fn speed_before(&self, collider: u32, at: DVec3, fraction: f32) -> Vec3 {
        let i = self.colliders.summaries[collider as usize].body as usize;
        let forces = self.forces;
        let Some(v) = forces.start.get(i) else { return Vec3::ZERO };
        let pull = forces.acceleration.get(i).map_or(Vec3::ZERO, |a| a.linear) * (self.dt * fraction);
        let arm = (at - self.bodies.pose[i].position).as_vec3();
        v.linear + pull + v.angular.cross(arm)
    }
    /// Change of a body's velocity at a point by a unit impulse along a direction there [1/kg].
    pub(crate) fn mobility(&self, i: usize, at: DVec3, direction: Vec3) -> f32 {
        let Some(inertia) = self.forces.inverse_inertia.get(i) else { return 0.0 };
        let arm = (at - self.bodies.pose[i].position).as_vec3().cross(direction);
        let turned = inertia.mul(crate::lanes::Vec3::new(arm.x, arm.y, arm.z)).lane(0);
        let free = self.bodies.traits[i].free(direction).length_squared();
        self.bodies.mass[i].inverse * free + arm.dot(turned)
    }
}
