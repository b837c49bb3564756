//! The two frames of a joint in the world, in `f64`.

use crate::body::Pose;
use crate::joint::{Axis, JointFrame, LockKind};
use glam::{DMat3, DQuat, DVec3};

/// Frames in the world, with positions relative to the first body's centre of mass.
pub(super) struct Frames {
    /// From each body's centre of mass to its own frame [m].
    pub(super) arm: [DVec3; 2],
    /// From the first frame's origin to the second's [m].
    pub(super) apart: DVec3,
    pub(super) axes: [DMat3; 2],
    relative: DQuat,
}

impl Frames {
    pub(super) fn new(poses: [&Pose; 2], frames: &[JointFrame; 2]) -> Frames {
        let turn = poses.map(|pose| pose.rotation.as_dquat().normalize());
        let arm = [0, 1].map(|i| turn[i] * frames[i].position.as_dvec3());
        let turn = [0, 1].map(|i| turn[i] * frames[i].rotation.as_dquat().normalize());
        let apart = poses[1].position - poses[0].position + arm[1] - arm[0];
        Frames { arm, apart, axes: turn.map(DMat3::from_quat), relative: turn[0].conjugate() * turn[1] }
    }

    pub(super) fn axis(&self, frame: usize, axis: Axis) -> DVec3 {
        self.axes[frame].col(axis as usize)
    }

    /// The shorter of both rotations.
    fn short(&self) -> DQuat {
        if self.relative.w < 0.0 { -self.relative } else { self.relative }
    }

    /// Rotation vector from the first frame to the second, in the world [rad].
    pub(super) fn turn(&self) -> DVec3 {
        let q = self.short();
        let v = q.xyz();
        let sine = v.length();
        let scale = if sine < 1e-9 { 2.0 } else { 2.0 * libm::atan2(sine, q.w) / sine };
        self.axes[0] * v * scale
    }

    /// Twist about an axis in -pi..=pi [rad].
    pub(super) fn twist(&self, axis: Axis) -> f64 {
        let q = self.short();
        2.0 * libm::atan2(q.xyz()[axis as usize], q.w)
    }

    /// The directions that a lock keeps, and the error along each [m] or [rad].
    pub(super) fn locked(&self, kind: LockKind) -> Vec<(DVec3, f64)> {
        let whole = |error: DVec3| [DVec3::X, DVec3::Y, DVec3::Z].map(|d| (d, error.dot(d))).to_vec();
        let across = |axis: DVec3, error: DVec3| {
            let (t, s) = axis.any_orthonormal_pair();
            vec![(t, error.dot(t)), (s, error.dot(s))]
        };
        match kind {
            LockKind::Point => whole(self.apart),
            LockKind::Weld => whole(self.turn()),
            LockKind::Line(axis) => across(self.axis(0, axis), self.apart),
            LockKind::Hinge(axis) => {
                let axes = [0, 1].map(|side| self.axis(side, axis));
                let sine = axes[0].cross(axes[1]);
                let angle = libm::atan2(sine.length(), axes[0].dot(axes[1]));
                across(axes[0], sine.normalize_or_zero() * angle)
            }
        }
    }
}
