//! Quaternions whose products are the same sums in the same order on every target.
//!
//! glam's own `Quat` is SIMD where the target has it: aligned to 16 bytes, and its products are summed in
//! another order, or fused, on each instruction set. Here callers pass and get it; the engine computes with
//! [`Quat`]. A feature of glam would do as well, but Cargo would turn it on for the whole program. Scenes
//! that are made with it are the same on every machine.

use glam::{DQuat, Mat3, Vec3};
use std::ops::{Mul, Neg};

/// A rotation as a unit quaternion of `f32`, aligned to 4 bytes. Plain arithmetic in a fixed order: the same
/// bits on every target.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Quat {
    /// Part along x.
    pub x: f32,
    /// Part along y.
    pub y: f32,
    /// Part along z.
    pub z: f32,
    /// The real part: cosine of half the angle.
    pub w: f32,
}

impl Quat {
    /// No rotation.
    pub const IDENTITY: Quat = Quat::from_xyzw(0.0, 0.0, 0.0, 1.0);

    /// From its parts.
    #[inline]
    pub const fn from_xyzw(x: f32, y: f32, z: f32, w: f32) -> Quat {
        Quat { x, y, z, w }
    }

    /// From x, y, z and w.
    #[inline]
    pub const fn from_array([x, y, z, w]: [f32; 4]) -> Quat {
        Quat { x, y, z, w }
    }

    /// x, y, z and w.
    #[inline]
    pub const fn to_array(self) -> [f32; 4] {
        [self.x, self.y, self.z, self.w]
    }

    /// The vector part: axis times the sine of half the angle.
    #[inline]
    pub fn xyz(self) -> Vec3 {
        Vec3::new(self.x, self.y, self.z)
    }

    /// The axes that the rotation turns x, y and z into, as columns.
    #[inline]
    pub fn matrix(self) -> Mat3 {
        let Quat { x, y, z, w } = self;
        let (x2, y2, z2) = (x + x, y + y, z + z);
        let (xx, xy, xz) = (x * x2, x * y2, x * z2);
        let (yy, yz, zz) = (y * y2, y * z2, z * z2);
        let (wx, wy, wz) = (w * x2, w * y2, w * z2);
        Mat3::from_cols(
            Vec3::new(1.0 - (yy + zz), xy + wz, xz - wy),
            Vec3::new(xy - wz, 1.0 - (xx + zz), yz + wx),
            Vec3::new(xz + wy, yz - wx, 1.0 - (xx + yy)),
        )
    }

    /// The rotation vector that leads from this rotation to another, of at most half a turn [rad].
    pub(crate) fn turn_to(self, to: Quat) -> Vec3 {
        let q = to * self.conjugate();
        let q = if q.w < 0.0 { -q } else { q };
        let sine = q.xyz().length();
        // For a small angle, twice the sine of its half.
        q.xyz() * if sine < 1e-4 { 2.0 } else { 2.0 * libm::atan2f(sine, q.w) / sine }
    }

    /// The shortest rotation from one unit vector to another; half a turn about any axis that is normal to
    /// both if they are opposite.
    pub fn from_rotation_arc(from: Vec3, to: Vec3) -> Quat {
        // Rounding: closer to (anti)parallel, the cross product has no direction.
        const NEARLY_ONE: f32 = 1.0 - 2.0 * f32::EPSILON;
        let cos = from.dot(to);
        if cos > NEARLY_ONE {
            return Quat::IDENTITY;
        }
        if cos < -NEARLY_ONE {
            let axis = from.any_orthonormal_vector();
            return Quat::from_xyzw(axis.x, axis.y, axis.z, 0.0);
        }
        let axis = from.cross(to);
        Quat::from_xyzw(axis.x, axis.y, axis.z, 1.0 + cos).normalize()
    }

    /// The inverse rotation.
    #[inline]
    pub fn conjugate(self) -> Quat {
        Quat::from_xyzw(-self.x, -self.y, -self.z, self.w)
    }

    /// The sum of the products of the parts.
    #[inline]
    pub fn dot(self, other: Quat) -> f32 {
        self.x * other.x + self.y * other.y + self.z * other.z + self.w * other.w
    }

    /// The square of its length.
    #[inline]
    pub fn length_squared(self) -> f32 {
        self.dot(self)
    }

    /// Its length: 1 for a rotation.
    #[inline]
    pub fn length(self) -> f32 {
        self.length_squared().sqrt()
    }

    /// The same rotation with a length of 1; not a number if it has none.
    #[inline]
    pub fn normalize(self) -> Quat {
        let scale = 1.0 / self.length();
        Quat::from_xyzw(self.x * scale, self.y * scale, self.z * scale, self.w * scale)
    }

    /// Between two rotations along the straight line: not at an even rate, but nearly so over small angles.
    pub fn lerp(self, end: Quat, share: f32) -> Quat {
        let sign = if self.dot(end) >= 0.0 { 1.0 } else { -1.0 };
        let [a, b] = [self.to_array(), end.to_array()];
        let part = |i: usize| a[i] * (1.0 - share) + (b[i] * sign) * share;
        Quat::from_array(std::array::from_fn(part)).normalize()
    }

    /// Whether all parts are finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.to_array().iter().all(|part| part.is_finite())
    }

    /// The same in `f64`.
    #[inline]
    pub fn as_dquat(self) -> DQuat {
        DQuat::from_xyzw(f64::from(self.x), f64::from(self.y), f64::from(self.z), f64::from(self.w))
    }
}

/// Two rotations, one after the other: `self * other` turns by `other` first.
impl Mul for Quat {
    type Output = Quat;
    #[inline]
    fn mul(self, o: Quat) -> Quat {
        Quat::from_xyzw(
            self.w * o.x + self.x * o.w + self.y * o.z - self.z * o.y,
            self.w * o.y - self.x * o.z + self.y * o.w + self.z * o.x,
            self.w * o.z + self.x * o.y - self.y * o.x + self.z * o.w,
            self.w * o.w - self.x * o.x - self.y * o.y - self.z * o.z,
        )
    }
}

/// Turns a vector.
impl Mul<Vec3> for Quat {
    type Output = Vec3;
    #[inline]
    fn mul(self, vector: Vec3) -> Vec3 {
        let (axis, w) = (self.xyz(), self.w);
        vector * (w * w - axis.dot(axis)) + axis * (vector.dot(axis) * 2.0) + axis.cross(vector) * (w * 2.0)
    }
}

impl Neg for Quat {
    type Output = Quat;
    #[inline]
    fn neg(self) -> Quat {
        Quat::from_xyzw(-self.x, -self.y, -self.z, -self.w)
    }
}

impl Default for Quat {
    fn default() -> Quat {
        Quat::IDENTITY
    }
}

impl From<DQuat> for Quat {
    #[inline]
    fn from(q: DQuat) -> Quat {
        Quat::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32)
    }
}

impl From<glam::Quat> for Quat {
    #[inline]
    fn from(q: glam::Quat) -> Quat {
        Quat::from_array(q.to_array())
    }
}

impl From<Quat> for glam::Quat {
    #[inline]
    fn from(q: Quat) -> glam::Quat {
        glam::Quat::from_array(q.to_array())
    }
}

/// Rotations by angles, for tests and benches alone: they ask the platform for sines, which differ.
#[cfg(any(test, feature = "internals"))]
#[cfg_attr(not(test), expect(dead_code, reason = "benches need one of them"))]
impl Quat {
    pub(crate) fn from_axis_angle(axis: Vec3, angle: f32) -> Quat {
        glam::Quat::from_axis_angle(axis, angle).into()
    }

    pub(crate) fn from_scaled_axis(vector: Vec3) -> Quat {
        glam::Quat::from_scaled_axis(vector).into()
    }

    pub(crate) fn from_rotation_x(angle: f32) -> Quat {
        Quat::from_axis_angle(Vec3::X, angle)
    }

    pub(crate) fn from_rotation_y(angle: f32) -> Quat {
        Quat::from_axis_angle(Vec3::Y, angle)
    }

    pub(crate) fn from_rotation_z(angle: f32) -> Quat {
        Quat::from_axis_angle(Vec3::Z, angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// glam's product is rounded otherwise on each instruction set; the parts are below 1, so that an error
    /// of four roundings is below 4 * 2^-24.
    #[test]
    fn products_are_those_of_glam_but_for_rounding() {
        let mut random = Random(1);
        let mut quat = || {
            let mut part = || random.range(-1.0, 1.0);
            Quat::from_xyzw(part(), part(), part(), part()).normalize()
        };
        for _ in 0..1000 {
            let (p, q) = (quat(), quat());
            let v = (quat().xyz(), glam::Quat::from(p) * glam::Quat::from(q));
            let near = |a: f32, b: f32| (a - b).abs() < 4.0 * f32::EPSILON;
            assert!((p * q).to_array().into_iter().zip(v.1.to_array()).all(|(a, b)| near(a, b)));
            let (turned, expected) = (p * v.0, glam::Quat::from(p) * v.0);
            assert!(turned.abs_diff_eq(expected, 8.0 * f32::EPSILON), "{turned} {expected}");
            assert!((p.conjugate() * (p * v.0)).abs_diff_eq(v.0, 8.0 * f32::EPSILON));
            let to = p * Vec3::X;
            // An arc of nearly half a turn loses digits with its axis, which is a difference.
            if to.x > -0.5 {
                let arc = Quat::from_rotation_arc(Vec3::X, to);
                assert!((arc * Vec3::X).abs_diff_eq(to, 8.0 * f32::EPSILON), "{to}");
            }
        }
        let back = Quat::from_rotation_arc(Vec3::X, -Vec3::X) * Vec3::X;
        assert!(back.abs_diff_eq(-Vec3::X, 4.0 * f32::EPSILON));
    }

    #[test]
    fn a_quaternion_takes_sixteen_bytes_at_any_address() {
        assert_eq!((size_of::<Quat>(), align_of::<Quat>()), (16, 4));
    }
}
