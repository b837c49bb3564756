//! The two frames of a joint in the world, and how far apart they are.

use super::desc::{Axes, Axis, Frame, Motion};
use crate::body::Pose;
use glam::{Mat3, Quat, Vec3};

/// Frames in the world, with all positions relative to the first body's centre of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// From each body's centre of mass to its frame [m].
    pub(crate) arm: [Vec3; 2],
    /// From the first frame's origin to the second's [m].
    pub(crate) apart: Vec3,
    /// The frames' axes.
    pub(crate) axes: [Mat3; 2],
    /// Of the second frame as seen from the first.
    relative: Quat,
}

/// A displacement, and how velocities change it: by `along` · (vb - va) + `arm_b` · wb - `arm_a` · wa.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Displacement {
    /// [m] or [rad]
    pub(crate) value: f32,
    pub(crate) along: Vec3,
    pub(crate) arm_a: Vec3,
    pub(crate) arm_b: Vec3,
}

fn column(m: &Mat3, axis: Axis) -> Vec3 {
    match axis {
        Axis::X => m.x_axis,
        Axis::Y => m.y_axis,
        Axis::Z => m.z_axis,
    }
}

impl Placed {
    /// `frames`: in the principal axes of each body, from its centre of mass.
    pub(crate) fn new(poses: [&Pose; 2], frames: &[Frame; 2]) -> Placed {
        let arm = [0, 1].map(|i| poses[i].rotation * frames[i].position);
        let turn = [0, 1].map(|i| poses[i].rotation * frames[i].rotation);
        let apart = (poses[1].position - poses[0].position).as_vec3() + arm[1] - arm[0];
        Placed { arm, apart, axes: turn.map(Mat3::from_quat), relative: turn[0].conjugate() * turn[1] }
    }

    pub(crate) fn axis(&self, frame: usize, axis: Axis) -> Vec3 {
        column(&self.axes[frame], axis)
    }

    /// Rotation vector from the first frame to the second, in the world [rad].
    pub(crate) fn turn(&self) -> Vec3 {
        let q = if self.relative.w < 0.0 { -self.relative } else { self.relative };
        let v = Vec3::new(q.x, q.y, q.z);
        let sine = v.length();
        // Of a small angle, twice its sine.
        let scale = if sine < 1e-4 { 2.0 } else { 2.0 * libm::atan2f(sine, q.w) / sine };
        self.axes[0] * v * scale
    }

    /// Twist about an axis in -pi..=pi [rad].
    fn twist(&self, axis: Axis) -> f32 {
        let q = if self.relative.w < 0.0 { -self.relative } else { self.relative };
        2.0 * libm::atan2f(Vec3::new(q.x, q.y, q.z)[axis as usize], q.w)
    }

    /// The displacement that a limit or drive is of; `None` where it has no direction, which is where it is zero.
    pub(crate) fn displacement(&self, motion: Motion, axes: Axes) -> Option<Displacement> {
        match motion {
            Motion::Linear => {
                let (value, along) = match axes {
                    Axes::One(axis) => {
                        let n = self.axis(0, axis);
                        (n.dot(self.apart), n)
                    }
                    Axes::Around(axis) => {
                        let n = self.axis(0, axis);
                        direction(self.apart - n * n.dot(self.apart))?
                    }
                    Axes::All => direction(self.apart)?,
                };
                // On the first body, the point where the second's frame is now.
                let arm_a = (self.arm[0] + self.apart).cross(along);
                Some(Displacement { value, along, arm_a, arm_b: self.arm[1].cross(along) })
            }
            Motion::Angular => {
                let (value, about) = match axes {
                    Axes::One(axis) => {
                        let (a, b) = (self.axis(0, axis), self.axis(1, axis));
                        // What turns about the middle of the two axes changes the twist, and nothing else does.
                        let middle = 1.0 + a.dot(b);
                        let about = if middle > 1e-3 { (a + b) / middle } else { a };
                        (self.twist(axis), about)
                    }
                    Axes::Around(axis) => {
                        let (a, b) = (self.axis(0, axis), self.axis(1, axis));
                        let (sine, about) = direction(a.cross(b))?;
                        (libm::atan2f(sine, a.dot(b)), about)
                    }
                    Axes::All => direction(self.turn())?,
                };
                Some(Displacement { value, along: Vec3::ZERO, arm_a: about, arm_b: about })
            }
        }
    }
}

/// Length and direction.
fn direction(v: Vec3) -> Option<(f32, Vec3)> {
    let length = v.length();
    (length > 1e-7).then(|| (length, v / length))
}
