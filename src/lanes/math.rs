//! Vectors, quaternions and matrices over lanes.

use super::{Lanes, Mask};
use bytemuck::{Pod, Zeroable};
use std::f32::consts::PI;
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// Numbers of vectors and rotations: lanes of `f32`, and of `f64`.
pub(crate) trait Arithmetic:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
}
impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Neg<Output = T>> Arithmetic for T {}

/// A vector per lane.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct Vec3<L> {
    pub(crate) x: L,
    pub(crate) y: L,
    pub(crate) z: L,
}

// SAFETY: zero is a value of every field.
unsafe impl<L: Zeroable> Zeroable for Vec3<L> {}
// SAFETY: it is nothing but lanes, of which any bits are numbers, in the order of C.
unsafe impl<L: Pod> Pod for Vec3<L> {}
// SAFETY: as for `Vec3`.
unsafe impl<L: Zeroable> Zeroable for Sym3<L> {}
// SAFETY: as for `Vec3`.
unsafe impl<L: Pod> Pod for Sym3<L> {}

impl<L: Arithmetic> Vec3<L> {
    #[inline(always)]
    pub(crate) fn new(x: L, y: L, z: L) -> Self {
        Vec3 { x, y, z }
    }
    #[inline(always)]
    pub(crate) fn dot(self, o: Self) -> L {
        self.x * o.x + self.y * o.y + self.z * o.z
    }
    #[inline(always)]
    pub(crate) fn cross(self, o: Self) -> Self {
        Vec3 {
            x: self.y * o.z - self.z * o.y,
            y: self.z * o.x - self.x * o.z,
            z: self.x * o.y - self.y * o.x,
        }
    }
    #[inline(always)]
    pub(crate) fn length_squared(self) -> L {
        self.dot(self)
    }
}

impl<L: Lanes> Vec3<L> {
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        Self::splat(glam::Vec3::ZERO)
    }
    #[inline(always)]
    pub(crate) fn splat(v: glam::Vec3) -> Self {
        Vec3 { x: L::splat(v.x), y: L::splat(v.y), z: L::splat(v.z) }
    }
    /// Lane `i` from `f(i)`.
    #[inline(always)]
    pub(crate) fn from_fn(f: impl Fn(usize) -> glam::Vec3) -> Self {
        Vec3 { x: L::from_fn(|i| f(i).x), y: L::from_fn(|i| f(i).y), z: L::from_fn(|i| f(i).z) }
    }
    #[inline(always)]
    pub(crate) fn lane(self, i: usize) -> glam::Vec3 {
        glam::Vec3::new(self.x.lane(i), self.y.lane(i), self.z.lane(i))
    }
    pub(crate) fn set_lane(&mut self, i: usize, value: glam::Vec3) {
        self.x.set_lane(i, value.x);
        self.y.set_lane(i, value.y);
        self.z.set_lane(i, value.z);
    }
    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Vec3 { x: self.x.abs(), y: self.y.abs(), z: self.z.abs() }
    }
    #[inline(always)]
    pub(crate) fn min(self, o: Self) -> Self {
        Vec3 { x: self.x.min(o.x), y: self.y.min(o.y), z: self.z.min(o.z) }
    }
    #[inline(always)]
    pub(crate) fn max(self, o: Self) -> Self {
        Vec3 { x: self.x.max(o.x), y: self.y.max(o.y), z: self.z.max(o.z) }
    }
    #[inline(always)]
    pub(crate) fn length(self) -> L {
        self.length_squared().sqrt()
    }
    #[inline(always)]
    pub(crate) fn select(mask: L::Mask, yes: Self, no: Self) -> Self {
        Vec3 {
            x: L::select(mask, yes.x, no.x),
            y: L::select(mask, yes.y, no.y),
            z: L::select(mask, yes.z, no.z),
        }
    }
    /// Two unit vectors that make a right-handed basis with this unit vector: `self = t1 x t2`.
    /// Continuous but for one sign change at z = 0, branch-free: Duff et al., *Building an Orthonormal
    /// Basis, Revisited* (JCGT 2017).
    #[inline(always)]
    pub(crate) fn tangents(self) -> (Self, Self) {
        let sign = self.z.sign();
        let a = -(L::one() / (sign + self.z));
        let b = self.x * self.y * a;
        (
            Vec3::new(L::one() + sign * self.x * self.x * a, sign * b, -(sign * self.x)),
            Vec3::new(b, sign + self.y * self.y * a, -self.y),
        )
    }
}

impl<L> From<[L; 3]> for Vec3<L> {
    #[inline(always)]
    fn from([x, y, z]: [L; 3]) -> Self {
        Vec3 { x, y, z }
    }
}
impl<L> From<Vec3<L>> for [L; 3] {
    #[inline(always)]
    fn from(v: Vec3<L>) -> Self {
        [v.x, v.y, v.z]
    }
}
impl<L: Arithmetic> Add for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Vec3 { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}
impl<L: Arithmetic> Sub for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Vec3 { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}
impl<L: Arithmetic> Neg for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Vec3 { x: -self.x, y: -self.y, z: -self.z }
    }
}
impl<L: Arithmetic> Mul<L> for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: L) -> Self {
        Vec3 { x: self.x * s, y: self.y * s, z: self.z * s }
    }
}
impl<L: Arithmetic> AddAssign for Vec3<L> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<L: Arithmetic> SubAssign for Vec3<L> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

/// A rotation per lane, as a unit quaternion.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Quat<L> {
    pub(crate) v: Vec3<L>,
    pub(crate) w: L,
}

impl<L: Arithmetic> Quat<L> {
    #[inline(always)]
    pub(crate) fn conjugate(self) -> Self {
        Quat { v: -self.v, w: self.w }
    }
    /// First `o`, then `self`.
    #[inline(always)]
    pub(crate) fn compose(self, o: Self) -> Self {
        Quat { v: o.v * self.w + self.v * o.w + self.v.cross(o.v), w: self.w * o.w - self.v.dot(o.v) }
    }
    #[inline(always)]
    pub(crate) fn rotate(self, p: Vec3<L>) -> Vec3<L> {
        let t = self.v.cross(p);
        let t = t + t;
        p + t * self.w + self.v.cross(t)
    }
}

impl<L: Lanes> Quat<L> {
    /// Lane `i` from `f(i)`.
    #[inline(always)]
    pub(crate) fn from_fn(f: impl Fn(usize) -> crate::math::Quat) -> Self {
        Quat {
            v: Vec3::new(L::from_fn(|i| f(i).x), L::from_fn(|i| f(i).y), L::from_fn(|i| f(i).z)),
            w: L::from_fn(|i| f(i).w),
        }
    }
    #[inline(always)]
    pub(crate) fn to_matrix(self) -> Mat3<L> {
        let (one, d) = (L::one(), self.v + self.v);
        let (xx, yy, zz) = (self.v.x * d.x, self.v.y * d.y, self.v.z * d.z);
        let (xy, xz, yz) = (self.v.x * d.y, self.v.x * d.z, self.v.y * d.z);
        let w = d * self.w;
        Mat3 {
            x: Vec3::new(one - (yy + zz), xy + w.z, xz - w.y),
            y: Vec3::new(xy - w.z, one - (xx + zz), yz + w.x),
            z: Vec3::new(xz + w.y, yz - w.x, one - (xx + yy)),
        }
    }
}

/// A 3x3 matrix per lane, by columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mat3<L> {
    pub(crate) x: Vec3<L>,
    pub(crate) y: Vec3<L>,
    pub(crate) z: Vec3<L>,
}

impl<L: Lanes> Mat3<L> {
    #[inline(always)]
    pub(crate) fn mul(self, p: Vec3<L>) -> Vec3<L> {
        self.x * p.x + self.y * p.y + self.z * p.z
    }
    /// The transpose times `p`: for a rotation, its inverse.
    #[inline(always)]
    pub(crate) fn mul_transposed(self, p: Vec3<L>) -> Vec3<L> {
        Vec3::new(self.x.dot(p), self.y.dot(p), self.z.dot(p))
    }
}

/// A symmetric 3x3 matrix per lane.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct Sym3<L> {
    pub(crate) xx: L,
    pub(crate) yy: L,
    pub(crate) zz: L,
    pub(crate) xy: L,
    pub(crate) xz: L,
    pub(crate) yz: L,
}

impl<L: Lanes> Sym3<L> {
    pub(crate) fn lane(&self, i: usize) -> Sym3<f32> {
        let Sym3 { xx, yy, zz, xy, xz, yz } = *self;
        let [xx, yy, zz, xy, xz, yz] = [xx, yy, zz, xy, xz, yz].map(|x| x.lane(i));
        Sym3 { xx, yy, zz, xy, xz, yz }
    }
    pub(crate) fn set_lane(&mut self, i: usize, value: &Sym3<f32>) {
        self.xx.set_lane(i, value.xx);
        self.yy.set_lane(i, value.yy);
        self.zz.set_lane(i, value.zz);
        self.xy.set_lane(i, value.xy);
        self.xz.set_lane(i, value.xz);
        self.yz.set_lane(i, value.yz);
    }
    /// Every entry by a factor.
    #[inline(always)]
    pub(crate) fn scaled(self, by: L) -> Self {
        Sym3 {
            xx: self.xx * by,
            yy: self.yy * by,
            zz: self.zz * by,
            xy: self.xy * by,
            xz: self.xz * by,
            yz: self.yz * by,
        }
    }
    #[inline(always)]
    pub(crate) fn select(mask: L::Mask, yes: Self, no: Self) -> Self {
        Sym3 {
            xx: L::select(mask, yes.xx, no.xx),
            yy: L::select(mask, yes.yy, no.yy),
            zz: L::select(mask, yes.zz, no.zz),
            xy: L::select(mask, yes.xy, no.xy),
            xz: L::select(mask, yes.xz, no.xz),
            yz: L::select(mask, yes.yz, no.yz),
        }
    }
    #[inline(always)]
    pub(crate) fn mul(self, p: Vec3<L>) -> Vec3<L> {
        Vec3::new(
            self.xx * p.x + self.xy * p.y + self.xz * p.z,
            self.xy * p.x + self.yy * p.y + self.yz * p.z,
            self.xz * p.x + self.yz * p.y + self.zz * p.z,
        )
    }
}

/// Rotates a vector by a rotation vector.
#[inline(always)]
pub(crate) fn turned<L: Lanes>(by: Vec3<L>, v: Vec3<L>) -> Vec3<L> {
    // Twice by half the angle, with series for its sine and cosine that are good for half a turn.
    let mut half = by * L::splat(0.5);
    if half.length_squared().gt(L::splat(10.0)).any() {
        half = without_whole_turns(half);
    }
    let x = half.length_squared();
    let sine =
        half * series(x, [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0]);
    let less = [0.5, -1.0 / 24.0, 1.0 / 720.0, -1.0 / 40_320.0, 1.0 / 3_628_800.0, -1.0 / 479_001_600.0];
    let cosine = L::one() - x * series(x, less);
    let once = sine.cross(v);
    let once = once + once;
    v + once * cosine + sine.cross(once)
}

/// Half of a rotation vector, without whole turns.
#[cold]
#[inline(always)]
fn without_whole_turns<L: Lanes>(half: Vec3<L>) -> Vec3<L> {
    let length = half.length();
    let length = L::select(length.gt(L::zero()), length, L::one());
    // Adding this rounds to an integer in `f32`.
    let whole = L::splat(1.5 * (1 << 23) as f32);
    let turns = (length * L::splat(1.0 / PI) + whole) - whole;
    half * (L::one() - turns * L::splat(PI) / length)
}

#[inline(always)]
fn series<L: Lanes>(x: L, [c0, c1, c2, c3, c4, c5]: [f32; 6]) -> L {
    let rest = L::splat(c2) + x * (L::splat(c3) + x * (L::splat(c4) + x * L::splat(c5)));
    L::splat(c0) + x * (L::splat(c1) + x * rest)
}

#[cfg(test)]
mod tests {
    use super::super::{f32x4, f32x8};
    use super::*;

    fn close<L: Lanes>() {
        let (q, p) =
            (crate::math::Quat::from_xyzw(0.1, -0.4, 0.3, 0.8).normalize(), glam::vec3(1.0, -2.0, 0.5));
        let lanes = Quat::<L>::from_fn(|_| q);
        let rotated = lanes.rotate(Vec3::splat(p)).lane(0);
        assert!((rotated - q * p).length() < 1e-6);
        assert!((lanes.to_matrix().mul(Vec3::splat(p)).lane(0) - rotated).length() < 1e-6);
        let back = lanes.to_matrix().mul_transposed(Vec3::splat(rotated)).lane(0);
        assert!((back - p).length() < 1e-6);
        for n in [glam::Vec3::Y, glam::Vec3::NEG_Z, p.normalize()] {
            let (t1, t2) = Vec3::<L>::splat(n).tangents();
            assert!((t1.lane(0).cross(t2.lane(0)) - n).length() < 1e-6);
        }
    }

    #[test]
    fn rotations_and_bases_agree_with_glam() {
        close::<f32>();
        close::<f32x4>();
        close::<f32x8>();
    }

    #[test]
    fn vectors_turn_as_by_quaternions() {
        let (axis, v) = (glam::vec3(0.6, -0.48, 0.64), glam::vec3(1.0, -2.0, 0.5));
        for angle in [0.0, 1e-4, 0.5, 2.0, 3.1, 6.0, 6.4, 20.0, -100.0] {
            let expected = glam::Quat::from_axis_angle(axis, angle) * v;
            let turned = turned::<f32>(Vec3::splat(axis * angle), Vec3::splat(v)).lane(0);
            // The error of the series, at half a turn of half the angle: 3e-4 in the sine.
            assert!((turned - expected).length() < 3e-3, "{angle}: {turned} {expected}");
        }
    }
}
