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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::exp_map;
    use glam::DVec3;
    use std::f32::consts::PI;

    struct Random(u32);

    impl Random {
        /// In -1..1.
        fn next(&mut self) -> f32 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
        }
        fn vec3(&mut self) -> Vec3 {
            Vec3::new(self.next(), self.next(), self.next())
        }
        fn quat(&mut self) -> Quat {
            exp_map(self.vec3() * 1.8)
        }
    }

    const ALL: [Axes; 7] = [
        Axes::One(Axis::X),
        Axes::One(Axis::Y),
        Axes::One(Axis::Z),
        Axes::Around(Axis::X),
        Axes::Around(Axis::Y),
        Axes::Around(Axis::Z),
        Axes::All,
    ];

    /// How velocities change a displacement, by differences.
    #[test]
    fn displacements_change_as_their_rows_say() {
        let mut random = Random(1);
        let mut checked = 0;
        for case in 0..300 {
            let frames = [0; 2].map(|_| Frame { position: random.vec3(), rotation: random.quat() });
            // Far out, where a single-precision position would be a millimetre off.
            let poses = [0; 2].map(|_| Pose {
                position: random.vec3().as_dvec3() + DVec3::splat(1e4),
                rotation: random.quat(),
            });
            let (v, w) = ([0; 2].map(|_| random.vec3()), [0; 2].map(|_| random.vec3()));
            let after = |time: f32| {
                let moved = [0, 1].map(|i| Pose {
                    position: poses[i].position + (v[i] * time).as_dvec3(),
                    rotation: exp_map(w[i] * time) * poses[i].rotation,
                });
                Placed::new([&moved[0], &moved[1]], &frames)
            };
            let now = after(0.0);
            for motion in [Motion::Linear, Motion::Angular] {
                for axes in ALL {
                    let d = now.displacement(motion, axes).unwrap();
                    // Where an angle turns round, and where small angles are of no direction, it has no slope.
                    if motion == Motion::Angular && (d.value.abs() > 2.8 || d.value.abs() < 0.05) {
                        continue;
                    }
                    let step = 2e-3;
                    let value = |t: f32| after(t).displacement(motion, axes).unwrap().value;
                    let found = (value(step) - value(-step)) / (2.0 * step);
                    let said = d.along.dot(v[1] - v[0]) + d.arm_b.dot(w[1]) - d.arm_a.dot(w[0]);
                    let tolerance = 0.01 * (1.0 + d.along.length() + d.arm_a.length() + d.arm_b.length());
                    // Close to half a turn of tilt the twist runs away.
                    let tilted = |axis| now.axis(0, axis).dot(now.axis(1, axis)) < -0.9;
                    if motion == Motion::Linear || !matches!(axes, Axes::One(axis) if tilted(axis)) {
                        assert!(
                            (found - said).abs() < tolerance,
                            "{case} {motion:?} {axes:?}: {found} {said}"
                        );
                        checked += 1;
                    }
                }
            }
        }
        assert!(checked > 3000, "{checked}");
    }

    fn turned_by(axis: Vec3, angle: f32) -> Placed {
        let at = |rotation| Pose { position: DVec3::ZERO, rotation };
        // The first is turned too: it is the relative rotation that counts.
        let first = exp_map(Vec3::new(0.3, -1.0, 0.8));
        let second = first * exp_map(axis * angle);
        Placed::new([&at(first), &at(second)], &[Frame::default(); 2])
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
                    let tilt = placed.displacement(Motion::Angular, Axes::Around(other));
                    let tilt = tilt.map_or(0.0, |d| d.value);
                    assert!((tilt - angle.abs()).abs() < 1e-6, "{axis:?} {other:?} {angle}: {tilt}");
                }
                // About its own axis it is no tilt.
                let own = placed.displacement(Motion::Angular, Axes::Around(axis)).map_or(0.0, |d| d.value);
                assert!(own < 1e-3, "{axis:?} {angle}: {own}");
            }
        }
        // Further than half a turn is less than half a turn the other way.
        assert!((turned_by(Vec3::X, 4.0).twist(Axis::X) - (4.0 - 2.0 * PI)).abs() < 1e-5);
    }

    #[test]
    fn what_coincides_has_no_direction() {
        let placed = turned_by(Vec3::X, 0.0);
        for motion in [Motion::Linear, Motion::Angular] {
            assert!(placed.displacement(motion, Axes::All).is_none());
            assert!(placed.displacement(motion, Axes::Around(Axis::Y)).is_none());
            assert!(placed.displacement(motion, Axes::One(Axis::Y)).unwrap().value.abs() < 1e-6);
        }
    }

    /// At half a turn of tilt there is no twist to speak of, but there are numbers.
    #[test]
    fn opposite_axes_give_numbers() {
        for axes in ALL {
            let d = turned_by(Vec3::Y, PI).displacement(Motion::Angular, axes);
            let Some(d) = d else { continue };
            let finite = d.value.is_finite() && d.arm_a.is_finite() && d.arm_b.is_finite();
            assert!(finite && d.arm_a.length() < 2e3, "{axes:?}: {d:?}");
        }
    }
}
