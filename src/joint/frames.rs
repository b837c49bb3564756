//! The two frames of a joint in the world, and how far apart they are.

use super::motion::{Axes, Axis, Motion};
use super::row::LockKind;
use crate::body::Pose;
use crate::lanes::Record;
use crate::math::Quat;
use glam::{Mat3, Vec3};

/// A frame of a joint in the principal axes of its body, from the centre of mass [m].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct JointFrame {
    pub(crate) position: Vec3,
    pub(crate) rotation: Quat,
}

/// Frames in the world, with all positions relative to the first body's centre of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// From each body's centre of mass to its frame [m].
    pub(crate) arm: [Vec3; 2],
    /// From the first frame's origin to the second's [m].
    pub(crate) apart: Vec3,
    /// The frames' axes.
    pub(crate) axes: [Mat3; 2],
    /// Rotation of the second frame as seen from the first.
    relative: Quat,
}

fn column(m: &Mat3, axis: Axis) -> Vec3 {
    match axis {
        Axis::X => m.x_axis,
        Axis::Y => m.y_axis,
        Axis::Z => m.z_axis,
    }
}

/// Twist of a rotation about an axis in -pi..=pi [rad].
pub(crate) fn twist_of(rotation: Quat, axis: Axis) -> f32 {
    let q = if rotation.w < 0.0 { -rotation } else { rotation };
    2.0 * libm::atan2f(Vec3::new(q.x, q.y, q.z)[axis as usize], q.w)
}

impl Placed {
    pub(crate) fn new(poses: [&Pose; 2], frames: &[JointFrame; 2]) -> Placed {
        let arm = [0, 1].map(|i| poses[i].rotation * frames[i].position);
        let turn = [0, 1].map(|i| poses[i].rotation * frames[i].rotation);
        let apart = (poses[1].position - poses[0].position).as_vec3() + arm[1] - arm[0];
        Placed { arm, apart, axes: turn.map(Quat::matrix), relative: turn[0].conjugate() * turn[1] }
    }

    pub(crate) fn axis(&self, frame: usize, axis: Axis) -> Vec3 {
        column(&self.axes[frame], axis)
    }

    /// Rotation vector from the first frame to the second, in the world [rad].
    pub(crate) fn turn(&self) -> Vec3 {
        let q = if self.relative.w < 0.0 { -self.relative } else { self.relative };
        let v = Vec3::new(q.x, q.y, q.z);
        let sine = v.length();
        // A small angle is twice its half's sine.
        let scale = if sine < 1e-4 { 2.0 } else { 2.0 * libm::atan2f(sine, q.w) / sine };
        self.axes[0] * v * scale
    }

    /// Twist about an axis in -pi..=pi [rad].
    pub(crate) fn twist(&self, axis: Axis) -> f32 {
        twist_of(self.relative, axis)
    }

    /// The quantity that a limit of a motion restricts [m] or [rad]: the measure of its rows, before whole
    /// turns are counted.
    pub(crate) fn displacement(&self, motion: Motion, axes: Axes) -> f32 {
        match (motion, axes) {
            (Motion::Linear, Axes::One(axis)) => self.axis(0, axis).dot(self.apart),
            (Motion::Linear, Axes::Perpendicular(axis)) => {
                self.apart.reject_from_normalized(self.axis(0, axis)).length()
            }
            (Motion::Linear, Axes::All) => self.apart.length(),
            (Motion::Angular, Axes::One(axis)) => self.twist(axis),
            (Motion::Angular, Axes::Perpendicular(axis)) => {
                let [a, b] = [0, 1].map(|frame| self.axis(frame, axis));
                libm::atan2f(a.cross(b).length(), a.dot(b))
            }
            (Motion::Angular, Axes::All) => self.turn().length(),
        }
    }

    /// How fast the displacement along or the twist about an axis grows [m/s] or [rad/s], given the
    /// velocities of the bodies' centres of mass. The first body's axes turn with it.
    pub(crate) fn speed(&self, motion: Motion, axis: Axis, v: [Record; 2]) -> f32 {
        let [a, b] = [0, 1].map(|frame| self.axis(frame, axis));
        match motion {
            Motion::Linear => {
                let of_first = v[0].linear + v[0].angular.cross(self.arm[0] + self.apart);
                let of_second = v[1].linear + v[1].angular.cross(self.arm[1]);
                a.dot(of_second - of_first)
            }
            Motion::Angular => {
                // Only rotation about the mean of the two axes changes the twist.
                let middle = 1.0 + a.dot(b);
                let about = if middle > 1e-3 { (a + b) / middle } else { a };
                about.dot(v[1].angular - v[0].angular)
            }
        }
    }

    /// By how much a lock of rotation is off, about [rad].
    pub(crate) fn turned_by(&self, lock: Option<LockKind>) -> f32 {
        match lock {
            Some(LockKind::Weld) => self.turn().length(),
            Some(LockKind::Hinge(axis)) => (self.axis(1, axis) - self.axis(0, axis)).length(),
            _ => 0.0,
        }
    }

    /// A direction for rows whose displacement is zero and so has none: a distance with a lower limit has to
    /// open in some direction.
    pub(crate) fn aside(&self, axes: Axes) -> Vec3 {
        let axis = match axes {
            Axes::All => Axis::X,
            // Across the axis.
            Axes::One(axis) | Axes::Perpendicular(axis) => Axis::ALL[(axis as usize + 1) % 3],
        };
        self.axis(0, axis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::exp_map;
    use glam::DVec3;
    use std::f32::consts::PI;

    fn turned_by(axis: Vec3, angle: f32) -> Placed {
        let at = |rotation| Pose { position: DVec3::ZERO, rotation };
        // The first frame is rotated too: only the relative rotation counts.
        let first = exp_map(Vec3::new(0.3, -1.0, 0.8));
        let second = first * exp_map(axis * angle);
        Placed::new([&at(first), &at(second)], &[JointFrame::default(); 2])
    }

    #[test]
    fn angles_are_those_of_the_turn() {
        for angle in [-3.1_f32, -2.0, -0.5, -1e-3, 0.0, 1e-3, 0.7, 1.6, 3.1] {
            for (axis, along) in [(Axis::X, Vec3::X), (Axis::Y, Vec3::Y), (Axis::Z, Vec3::Z)] {
                let placed = turned_by(along, angle);
                assert!(
                    (placed.twist(axis) - angle).abs() < 1e-6,
                    "{axis:?} {angle}: {}",
                    placed.twist(axis)
                );
                assert!((placed.turn().length() - angle.abs()).abs() < 1e-6, "{axis:?} {angle}");
                for other in Axis::ALL.into_iter().filter(|other| *other != axis) {
                    assert!(placed.twist(other).abs() < 1e-5, "{axis:?} {other:?} {angle}");
                    let tilt = placed.axis(0, other).angle_between(placed.axis(1, other));
                    assert!((tilt - angle.abs()).abs() < 1e-3, "{axis:?} {other:?} {angle}: {tilt}");
                }
            }
        }
        // More than half a turn is less than half a turn in the other direction.
        assert!((turned_by(Vec3::X, 4.0).twist(Axis::X) - (4.0 - 2.0 * PI)).abs() < 1e-5);
    }
}
