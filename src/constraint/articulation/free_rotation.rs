//! Rotation of the bodies of trees within a substep: rotation vectors, and torque-free rotation, over lanes.

use crate::lanes::{Lanes, Mask, Quat, Sym3, Vec3, kernel};
use std::f32::consts::TAU;

/// The sine of half an angle divided by the angle, and the cosine of half of it, from the square of the
/// angle.
#[inline(always)]
fn half_turn<L: Lanes>(square: L) -> (L, L) {
    if !square.gt(L::one()).any() {
        let s = L::splat(1.0 / 3840.0) - square * L::splat(1.0 / 645_120.0);
        let c = L::splat(1.0 / 46_080.0) - square * L::splat(1.0 / 10_321_920.0);
        let s = L::splat(0.5) - square * (L::splat(1.0 / 48.0) - square * s);
        return (s, L::one() - square * (L::splat(0.125) - square * (L::splat(1.0 / 384.0) - square * c)));
    }
    if square.gt(L::splat(40.0)).any() {
        return far_half_turn(square);
    }
    // Series for a quarter of the angle, which is at most a quarter of a turn; then the double-angle
    // formulas.
    let x = square * L::splat(1.0 / 16.0);
    let sine = series(x, [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0]);
    let less = [0.5, -1.0 / 24.0, 1.0 / 720.0, -1.0 / 40_320.0, 1.0 / 3_628_800.0, -1.0 / 479_001_600.0];
    let cosine = L::one() - x * series(x, less);
    (L::splat(0.5) * sine * cosine, L::one() - L::splat(2.0) * (x * sine * sine))
}

#[cold]
fn far_half_turn<L: Lanes>(square: L) -> (L, L) {
    let (mut s, mut c) = (L::zero(), L::one());
    for lane in 0..L::N {
        let angle = square.lane(lane).sqrt();
        let (sine, cosine) = libm::sincosf(0.5 * angle);
        s.set_lane(lane, if angle > 0.0 { sine / angle } else { 0.5 });
        c.set_lane(lane, cosine);
    }
    (s, c)
}

#[inline(always)]
fn series<L: Lanes>(x: L, [c0, c1, c2, c3, c4, c5]: [f32; 6]) -> L {
    let rest = L::splat(c2) + x * (L::splat(c3) + x * (L::splat(c4) + x * L::splat(c5)));
    L::splat(c0) + x * (L::splat(c1) + x * rest)
}

/// The rotation with a rotation vector.
#[inline(always)]
pub(crate) fn exp<L: Lanes>(by: Vec3<L>) -> Quat<L> {
    let (s, c) = half_turn(by.length_squared());
    Quat { v: by * s, w: c }
}

/// The rotation vector of a rotation of up to half a turn.
#[inline(always)]
pub(crate) fn log<L: Lanes>(q: Quat<L>) -> Vec3<L> {
    let sign = q.w.sign();
    let (v, w) = (q.v * sign, q.w * sign);
    // The tangent of a quarter of the angle, and of an eighth: that is below 0.42, and its arctangent a short
    // series.
    let one = L::one();
    let over = one / (one + w);
    let quarter = v.length_squared() * (over * over);
    let half = one / (one + (one + quarter).sqrt());
    let x = quarter * (half * half);
    let arc = series(x, [1.0, -1.0 / 3.0, 1.0 / 5.0, -1.0 / 7.0, 1.0 / 9.0, -1.0 / 11.0])
        + x * x * x * (x * x * x) * (L::splat(1.0 / 13.0) - x * L::splat(1.0 / 15.0));
    v * (L::splat(8.0) * over * half * arc)
}

/// The same plus whole turns, as near as possible to an estimate.
#[inline(always)]
pub(crate) fn log_near<L: Lanes>(q: Quat<L>, near: Vec3<L>) -> Vec3<L> {
    let v = log(q);
    if near.length_squared().gt(L::splat(8.0)).any() { with_turns(v, near) } else { v }
}

kernel! {
    fn with_turns<'a, L: Lanes>(v: Vec3<L>, near: Vec3<L>) -> Vec3<L> {
        let length = v.length();
        let some = length.gt(L::zero());
        let over = L::one() / L::select(some, length, L::one());
        // Adding this rounds to an integer in `f32`.
        let whole = L::splat(1.5 * (1 << 23) as f32);
        let off = (near.dot(v) * over - length) * L::splat(1.0 / TAU);
        let turns = L::select(some, (off + whole) - whole, L::zero());
        v + v * (turns * L::splat(TAU) * over)
    }
}

/// The change of a vector by a rotation, without cancellation when that is small.
#[inline(always)]
pub(crate) fn moved_by<L: Lanes>(q: Quat<L>, p: Vec3<L>) -> Vec3<L> {
    let once = q.v.cross(p);
    let once = once + once;
    once * q.w + q.v.cross(once)
}

// Rounding: of moments of inertia.
/// Moments that differ by a smaller share are taken as equal.
const LEVEL: f32 = 1e-5;

/// Principal moments of inertia [kg m²].
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Moments<L> {
    /// Principal axes at the start of the step. The third is the axis of a symmetric top: the other two have
    /// the most similar moments.
    pub(crate) axes: Quat<L>,
    pub(crate) inertia: Vec3<L>,
    pub(crate) inverse: Vec3<L>,
}

impl<L: Lanes> Default for Moments<L> {
    fn default() -> Self {
        let (one, zero) = (L::one(), L::zero());
        let ones = Vec3::new(one, one, one);
        Moments { axes: Quat { v: Vec3::new(zero, zero, zero), w: one }, inertia: ones, inverse: ones }
    }
}

impl<L: Lanes> Moments<L> {
    /// Stores a body's moments, given in the axes of its pose.
    pub(crate) fn put(
        &mut self,
        lane: usize,
        axes: crate::math::Quat,
        inertia: glam::Vec3,
        inverse: glam::Vec3,
    ) {
        let apart =
            [(inverse.y - inverse.z).abs(), (inverse.z - inverse.x).abs(), (inverse.x - inverse.y).abs()];
        let third = if apart[2] <= apart[0] && apart[2] <= apart[1] {
            2
        } else if apart[0] <= apart[1] {
            0
        } else {
            1
        };
        // Nearly equal counts as equal, which leaves less to solve.
        let (mut inertia, mut inverse) = (inertia, inverse);
        let mut level = |i: usize, j: usize| {
            if (inverse[i] - inverse[j]).abs() <= LEVEL * inverse[i] {
                (inertia[j], inverse[j]) = (inertia[i], inverse[i]);
            }
        };
        level((third + 1) % 3, (third + 2) % 3);
        level((third + 1) % 3, third);
        // The rotation that renames the axes.
        let (half, order) = (0.5, [(third + 1) % 3, (third + 2) % 3, third]);
        let renamed = match third {
            0 => crate::math::Quat::from_xyzw(half, half, half, half),
            1 => crate::math::Quat::from_xyzw(-half, -half, -half, half),
            _ => crate::math::Quat::IDENTITY,
        };
        let axes = axes * renamed;
        self.axes.v.set_lane(lane, glam::Vec3::new(axes.x, axes.y, axes.z));
        self.axes.w.set_lane(lane, axes.w);
        self.inertia.set_lane(lane, glam::Vec3::from_array(order.map(|i| inertia[i])));
        self.inverse.set_lane(lane, glam::Vec3::from_array(order.map(|i| inverse[i])));
    }

    /// Inertia and its inverse in world axes, of a body whose axes these are now.
    #[inline(always)]
    pub(crate) fn in_world(&self, axes: Quat<L>) -> [Sym3<L>; 2] {
        let m = axes.to_matrix();
        [self.inertia, self.inverse].map(|d| {
            let (x, y, z) = (m.x * d.x, m.y * d.y, m.z * d.z);
            Sym3 {
                xx: x.x * m.x.x + y.x * m.y.x + z.x * m.z.x,
                yy: x.y * m.x.y + y.y * m.y.y + z.y * m.z.y,
                zz: x.z * m.x.z + y.z * m.y.z + z.z * m.z.z,
                xy: x.x * m.x.y + y.x * m.y.y + z.x * m.z.y,
                xz: x.x * m.x.z + y.x * m.y.z + z.x * m.z.z,
                yz: x.y * m.x.z + y.y * m.y.z + z.y * m.z.z,
            }
        })
    }

    /// Torque-free rotation over a time: the rotation in the world, and the change of the angular velocity.
    ///
    /// Alternates between a symmetric top, which has a closed solution, and the remaining difference of its
    /// two similar moments (Touma and Wisdom, 1994; as for single bodies in `body/free.rs`). Every part is a
    /// rotation, so angular momentum is conserved at any length of step. All is accumulated as changes: a
    /// spin about a principal axis does not change, and rounding must not speed it up from substep to
    /// substep.
    #[inline(always)]
    pub(crate) fn flow(&self, axes: Quat<L>, omega: Vec3<L>, h: L) -> (Quat<L>, Vec3<L>) {
        let (k, own) = (self.inverse, axes.conjugate().rotate(omega));
        let m = Vec3::new(own.x * self.inertia.x, own.y * self.inertia.y, own.z * self.inertia.z);
        let half = L::splat(0.5);
        let (across, rest) = (half * (k.x + k.y), half * half * (k.x - k.y) * h);
        let around = k.z - across;
        let (uneven, round) = (rest.abs().gt(L::zero()).any(), !around.abs().gt(L::zero()).any());
        let (mut turn, mut more) = (Quat { v: Vec3::zero(), w: L::one() }, Vec3::zero());
        if uneven {
            spin::<L, 0>(&mut turn, m, &mut more, rest);
            spin::<L, 1>(&mut turn, m, &mut more, -rest);
        }
        turn = turn.compose(exp((m + more) * (across * h)));
        if !round {
            spin::<L, 2>(&mut turn, m, &mut more, around * h);
        }
        if uneven {
            spin::<L, 1>(&mut turn, m, &mut more, -rest);
            spin::<L, 0>(&mut turn, m, &mut more, rest);
        }
        // Correction of its length after rounding, to first order.
        let one = L::splat(1.5) - half * (turn.v.length_squared() + turn.w * turn.w);
        let turn = Quat { v: turn.v * one, w: turn.w * one };
        let world = Quat { v: axes.rotate(turn.v), w: turn.w };
        let change = Vec3::new(more.x * k.x, more.y * k.y, more.z * k.z);
        (world, axes.rotate(change + moved_by(turn, own + change)))
    }
}

/// Turns a body about one of its own axes, by `rate` times its momentum about that axis [rad]; in the body's
/// frame, the momentum `start + more` turns the other way.
#[inline(always)]
fn spin<L: Lanes, const AXIS: usize>(turn: &mut Quat<L>, start: Vec3<L>, more: &mut Vec3<L>, rate: L) {
    let zero = L::zero();
    let m = start + *more;
    let angle = rate
        * match AXIS {
            0 => m.x,
            1 => m.y,
            _ => m.z,
        };
    let (s, c) = half_turn(angle * angle);
    let s = s * angle;
    // The sine, and the cosine minus one.
    let (sin, less) = (s * c + s * c, -(s * s + s * s));
    let (v, changed) = match AXIS {
        0 => (Vec3::new(s, zero, zero), Vec3::new(zero, m.y * less + m.z * sin, m.z * less - m.y * sin)),
        1 => (Vec3::new(zero, s, zero), Vec3::new(m.x * less - m.z * sin, zero, m.z * less + m.x * sin)),
        _ => (Vec3::new(zero, zero, s), Vec3::new(m.x * less + m.y * sin, m.y * less - m.x * sin, zero)),
    };
    *turn = turn.compose(Quat { v, w: c });
    *more += changed;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{FreeTurn, exp_map};
    use crate::math::Quat as Turn;
    use glam::{Vec3 as Vector, vec3};

    fn lanes(q: Turn) -> Quat<f32> {
        Quat::from_fn(|_| q)
    }

    #[test]
    fn rotation_vectors_are_those_of_quaternions() {
        let axis = vec3(0.6, -0.48, 0.64);
        for angle in [0.0, 1e-5, 0.5, 0.99, 1.01, 2.0, 3.1, 6.0, 6.4, 20.0, -100.0] {
            let q = exp(Vec3::<f32>::splat(axis * angle));
            let expected = Turn::from_axis_angle(axis, angle);
            let turned = q.rotate(Vec3::splat(vec3(1.0, -2.0, 0.5))).lane(0);
            assert!((turned - expected * vec3(1.0, -2.0, 0.5)).length() < 2e-5, "{angle}");
            // Including whole turns.
            let back = log_near(q, Vec3::splat(axis * (angle + 0.3))).lane(0);
            assert!((back - axis * angle).length() < 1e-6 * angle.abs().max(2.0), "{angle}: {back}");
        }
    }

    /// Compared with the same in `f64`, which is tested against the elliptic integral.
    #[test]
    fn what_turns_freely_does_so_as_single_bodies_do() {
        for inertia in [vec3(1.0, 2.0, 2.5), vec3(2.0, 1.0, 2.0), vec3(0.3, 0.3, 0.5), vec3(1.0, 1.0, 1.0)] {
            let (start, spin) = (exp_map(vec3(0.4, -0.7, 1.0)), vec3(8.0, -5.0, 3.0));
            let mut moments = Moments::<f32>::default();
            moments.put(0, start, inertia, inertia.recip());
            let (mut by, mut w) = (Turn::IDENTITY, spin);
            let (mut q, mut v) = (start, spin);
            for _ in 0..500 {
                let (turn, more) = moments.flow(lanes(by).compose(moments.axes), Vec3::splat(w), 1.0 / 240.0);
                let turn = Turn::from_xyzw(turn.v.x, turn.v.y, turn.v.z, turn.w);
                (by, w) = ((turn * by).normalize(), w + more.lane(0));
                (q, v) = FreeTurn { rotation: q, spin: v, inertia, time: 1.0 / 240.0 }.one();
            }
            let momentum = |q: Turn, w: Vector| q * (inertia * (q.conjugate() * w));
            let (was, is) = (momentum(start, spin), momentum(by * start, w));
            assert!((is - was).length() < 2e-5 * was.length(), "{inertia}: {is}, was {was}");
            assert!((w - v).length() < 0.02, "{inertia}: {w}, not {v}");
            assert!((by * start).dot(q).abs() > 0.9999, "{inertia}");
        }
    }
}
