//! Paths of bodies in the rest of the step.

use crate::body::{Pose, exp_map};
use crate::lanes::Record;
use crate::math::Quat;
use crate::narrow_phase::BodyPath;
use crate::shape::Collider;
use glam::{DVec3, Vec3};

/// A straight path with a uniform rotation, from a moment of the step to its end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// Fraction of the step at which it begins.
    pub(super) since: f32,
    pub(super) position: DVec3,
    pub(super) rotation: Quat,
    pub(super) displacement: Vec3,
    /// Rotation vector; may be several turns.
    pub(super) spin: Vec3,
}

impl Way {
    /// Path of a body at rest.
    pub(crate) fn still(pose: &Pose) -> Way {
        Way {
            since: 0.0,
            position: pose.position,
            rotation: pose.rotation,
            displacement: Vec3::ZERO,
            spin: Vec3::ZERO,
        }
    }

    /// From the pose of a body at the start of the step, for which its collider was placed, to that at the
    /// end, with about as many revolutions as `turned` has [rad].
    pub(crate) fn taken(shape: &Collider, placed: &Pose, end: &Pose, turned: Vec3) -> Way {
        let rotation = (placed.rotation * shape.rotation.conjugate()).normalize();
        let position = placed.position - (rotation * shape.position).as_dvec3();
        Way {
            since: 0.0,
            position,
            rotation,
            displacement: (end.position - position).as_vec3(),
            spin: turn_between(rotation, end.rotation, turned),
        }
    }

    /// The rest of it from a moment on.
    pub(crate) fn rest(&self, time: f32) -> BodyPath {
        let (done, left) = self.shares(time);
        BodyPath {
            centre: self.position + self.displacement.as_dvec3() * f64::from(done),
            rotation: self.turned(done),
            displacement: self.displacement * left,
            spin: self.spin * left,
        }
    }

    /// The pose at a moment.
    pub(super) fn at(&self, time: f32) -> Pose {
        let done = self.shares(time).0;
        let position = self.position + self.displacement.as_dvec3() * f64::from(done);
        Pose { position, rotation: self.turned(done) }
    }

    fn shares(&self, time: f32) -> (f32, f32) {
        let whole = 1.0 - self.since;
        if whole <= 0.0 {
            return (1.0, 0.0);
        }
        let done = ((time - self.since) / whole).clamp(0.0, 1.0);
        (done, 1.0 - done)
    }

    fn turned(&self, share: f32) -> Quat {
        if self.spin == Vec3::ZERO {
            self.rotation
        } else {
            (exp_map(self.spin * share) * self.rotation).normalize()
        }
    }
}

/// The rotation vector from one orientation to another; of all that lead there, the one closest to `about`.
fn turn_between(from: Quat, to: Quat, about: Vec3) -> Vec3 {
    let turn = to * from.conjugate();
    let turn = if turn.w < 0.0 { -turn } else { turn };
    let sine = turn.xyz().length();
    // Without rotation the two differ by rounding.
    if sine < 1e-6 && about == Vec3::ZERO {
        return Vec3::ZERO;
    }
    let axis = if sine > 1e-6 { turn.xyz() / sine } else { about.normalize_or(Vec3::Y) };
    let angle = 2.0 * libm::atan2f(sine, turn.w);
    let whole = std::f32::consts::TAU;
    let rounds = ((about.dot(axis) - angle) / whole).round();
    axis * (angle + rounds * whole)
}

/// A body that may touch something, or was redirected.
#[derive(Clone, Copy, Debug)]
pub(super) struct Track {
    pub(super) body: u32,
    pub(super) way: Way,
    /// Acceleration: the velocity of the body is that of the end of the step [m/s²].
    pub(super) pull: Vec3,
    /// How often it was redirected.
    pub(super) turns: u32,
    /// It lost the rest of the step.
    pub(super) stands: bool,
}

impl Track {
    /// Velocities at a moment of a step of `dt` seconds, from those of its end.
    pub(super) fn velocity_at(&self, end: &Record, time: f32, dt: f32) -> Record {
        let mut velocity = *end;
        velocity.linear -= self.pull * ((1.0 - time) * dt);
        velocity
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_is_as_often_around_as_it_was() {
        let from = exp_map(Vec3::new(0.3, -0.2, 0.9));
        for turns in [0.1_f32, 1.0, 3.0, 3.3, 7.0, 20.9, -20.9, -4.0] {
            let spin = Vec3::new(0.6, 0.0, 0.8) * turns;
            let found = turn_between(from, exp_map(spin) * from, spin);
            assert!((found - spin).length() < 2e-5 * (1.0 + turns.abs()), "{spin} {found}");
        }
        assert_eq!(turn_between(from, from, Vec3::ZERO), Vec3::ZERO);
    }

    #[test]
    fn what_is_left_of_a_way_leads_to_the_same_end() {
        let way = Way {
            since: 0.25,
            position: DVec3::new(1e6, 0.0, -3.0),
            rotation: Quat::IDENTITY,
            displacement: Vec3::new(3.0, -1.0, 0.5),
            spin: Vec3::new(0.0, 9.0, 0.0),
        };
        let (rest, end) = (way.rest(0.7), way.at(1.0));
        assert!((rest.centre + rest.displacement.as_dvec3() - end.position).length() < 1e-6);
        assert!((exp_map(rest.spin) * rest.rotation).dot(end.rotation).abs() > 1.0 - 1e-6);
        assert_eq!(way.at(0.25).position, way.position);
    }
}
