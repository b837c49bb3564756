//! How two shapes move against each other within a step.

use crate::math::Quat;
use crate::narrow_phase::Relative;
use crate::shape::Collider;
use glam::{DQuat, DVec3, Vec3};

/// The path of a body within a step: its centre of mass goes straight, and it turns evenly around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyPath {
    /// Centre of mass at the start, in the world [m].
    pub(crate) centre: DVec3,
    /// Rotation at the start.
    pub(crate) rotation: Quat,
    /// Velocity times the step [m].
    pub(crate) displacement: Vec3,
    /// Angular velocity times the step [rad]; may be several turns.
    pub(crate) spin: Vec3,
}

/// The motion of shape a relative to shape b, in the axes of the world, with the origin in the centre of mass
/// of b's body, which it follows. Only differences of positions are left, so it is as exact far from the
/// world's origin as near it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    /// Centre of mass of a's body at the start [m].
    pub(crate) start: DVec3,
    /// Displacement of a's body less that of b's [m].
    pub(crate) displacement: Vec3,
    pub(crate) a: Turn,
    pub(crate) b: Turn,
}

/// How a shape turns about its body's centre of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    /// From the centre of mass to the shape's origin, at the start [m].
    pub(crate) lever: Vec3,
    /// Rotation of the shape in the world at the start.
    pub(crate) rotation: Quat,
    /// Angular velocity times the step [rad].
    pub(crate) spin: Vec3,
}

impl Motion {
    pub(crate) fn new(a: &Collider, path_a: &BodyPath, b: &Collider, path_b: &BodyPath) -> Motion {
        Motion {
            start: path_a.centre - path_b.centre,
            displacement: path_a.displacement - path_b.displacement,
            a: Turn::new(a, path_a),
            b: Turn::new(b, path_b),
        }
    }

    /// The rest of the motion after a fraction at which the shapes touched, without its component along
    /// `normal` into b.
    pub(crate) fn after(&self, fraction: f32, normal: Vec3) -> Motion {
        let (t, left) = (f64::from(fraction), 1.0 - fraction);
        let rest = |turn: &Turn| {
            let (rotation, lever) = turn.at(t);
            Turn { rotation: rotation.into(), lever: lever.as_vec3(), spin: turn.spin * left }
        };
        let way = self.displacement * left;
        Motion {
            start: self.start + self.displacement.as_dvec3() * t,
            displacement: way - normal * way.dot(normal).max(0.0),
            a: rest(&self.a),
            b: rest(&self.b),
        }
    }

    /// Pose of shape b in the frame of shape a after a fraction of the step, for the kernels.
    pub(crate) fn relative(&self, fraction: f32) -> Relative {
        let t = f64::from(fraction);
        let (rotation_a, lever_a) = self.a.at(t);
        let (rotation_b, lever_b) = self.b.at(t);
        let centre = self.start + self.displacement.as_dvec3() * t;
        Relative {
            position: (rotation_a.conjugate() * (lever_b - lever_a - centre)).as_vec3(),
            rotation: (rotation_a.conjugate() * rotation_b).into(),
        }
    }
}

impl Turn {
    fn new(shape: &Collider, path: &BodyPath) -> Turn {
        Turn {
            lever: path.rotation * shape.position,
            rotation: path.rotation * shape.rotation,
            spin: path.spin,
        }
    }

    /// The shape's rotation and lever after a fraction of the step.
    pub(crate) fn at(&self, t: f64) -> (DQuat, DVec3) {
        let turned = turn(self.spin.as_dvec3() * t);
        (turned * self.rotation.as_dquat().normalize(), turned * self.lever.as_dvec3())
    }
}

/// The rotation by a rotation vector.
pub(crate) fn turn(spin: DVec3) -> DQuat {
    let angle = spin.length();
    if angle == 0.0 {
        return DQuat::IDENTITY;
    }
    let (sin, cos) = libm::sincos(0.5 * angle);
    let axis = spin * (sin / angle);
    DQuat::from_xyzw(axis.x, axis.y, axis.z, cos)
}
