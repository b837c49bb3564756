//! Bodies that turn freely, four at a time.
//!
//! One rotation waits for the one before it, so that a single body leaves most of a processor idle; four side
//! by side take hardly longer than one.

use crate::config::tuning::{FREE_TURN_OWN, FREE_TURN_PART, FREE_TURN_PARTS};
use crate::lanes::{Quat as LaneQuat, Vec3 as LaneVec3, f64x4};
use crate::math::Quat;
use glam::{DQuat, DVec3, Vec3};
use std::array::from_fn;

/// A body that turns freely for some time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FreeTurn {
    pub(crate) rotation: Quat,
    /// Angular velocity [rad/s].
    pub(crate) spin: Vec3,
    /// Principal moments [kg m²].
    pub(crate) inertia: Vec3,
    /// [s].
    pub(crate) time: f32,
}

/// How many are turned at once.
pub(crate) const FREE: usize = 4;

impl FreeTurn {
    /// In how many parts it is turned: by how far its top turns about its own axis, and by how far the
    /// difference of the two like moments turns it out of that motion. Both are the most that the momentum
    /// and the energy allow, and these stay the same: parts that changed with the angular velocity, which
    /// swings, made the energy drift.
    pub(crate) fn parts(&self) -> u32 {
        let inverse = self.inertia.as_dvec3().recip();
        let axis = top_axis(self.inertia);
        let [own, i, j] = [0, 1, 2].map(|k| inverse[(axis + k) % 3]);
        let local = (self.rotation.conjugate() * self.spin).as_dvec3();
        let momentum = self.inertia.as_dvec3() * local;
        let (squared, energy) = (momentum.length_squared(), momentum.dot(local));
        let about = [i, j].map(|other| (energy - squared * other) / (own - other));
        let about = about.into_iter().fold(0.0, f64::max).min(squared).sqrt();
        let wobble = 0.5 * (i - j).abs() * squared.sqrt() / f64::from(FREE_TURN_PART);
        let own = (own - 0.5 * (i + j)).abs() * about / f64::from(FREE_TURN_OWN);
        let wanted = wobble.max(own) * f64::from(self.time);
        wanted.ceil().clamp(1.0, f64::from(FREE_TURN_PARTS)) as u32
    }

    /// Turned by itself.
    pub(crate) fn one(self) -> (Quat, Vec3) {
        self.as_top().unwrap_or_else(|| FreeTurn::all(&[self])[0])
    }

    /// The motion of a symmetric top, which has a closed solution; none of another body. Its axis and its
    /// angular velocity go around the angular momentum, and it spins about the axis.
    pub(crate) fn as_top(&self) -> Option<(Quat, Vec3)> {
        let FreeTurn { rotation, spin, inertia, time } = *self;
        let axis = if inertia.x == inertia.y {
            Vec3::Z
        } else if inertia.z == inertia.x {
            Vec3::Y
        } else if inertia.y == inertia.z {
            Vec3::X
        } else {
            return None;
        };
        let (turn, time) = (rotation.as_dquat().normalize(), f64::from(time));
        let local = turn.conjugate() * spin.as_dvec3();
        let (along, across) = (f64::from(inertia.dot(axis)), f64::from(inertia.dot(Vec3::ONE - axis)) * 0.5);
        let around = turn_by(turn * (inertia.as_dvec3() * local) * (time / across));
        let axis = axis.as_dvec3();
        let own = turn_by(axis * (local.dot(axis) * (1.0 - along / across) * time));
        let turned: Quat = (around * turn * own).normalize().into();
        // As seen from where rounding leaves the body: so the energy does not change with that.
        let spin = turned.as_dquat().normalize() * (own.conjugate() * local);
        Some((turned, spin.as_vec3()))
    }

    /// Free rotations of up to four, however fast, each in as many parts as it takes: the rotations and
    /// angular velocities at the end. The momentum and the energy are conserved. Intermediate results have
    /// more digits than input and output, because a rounding that favours one direction, step after step,
    /// would add up.
    pub(crate) fn all(turns: &[FreeTurn]) -> [(Quat, Vec3); FREE] {
        let mut lanes = [FreeTurn { inertia: Vec3::ONE, ..FreeTurn::default() }; FREE];
        lanes.iter_mut().zip(turns).for_each(|(lane, turn)| *lane = *turn);
        let mut tops = lanes.map(|turn| Top::of(&turn));
        // Lanes that are empty take as long as others.
        (turns.len()..FREE).for_each(|lane| tops[lane].parts = tops[0].parts);
        // With the axes of each in the order in which its top's is the last.
        let vector = |of: fn(&FreeTurn) -> Vec3| {
            from_fn(|k| f64x4::from(from_fn(|lane| f64::from(of(&lanes[lane])[tops[lane].cycled(k)]))))
        };
        let (inertia, spin) = (vector(|turn| turn.inertia), vector(|turn| turn.spin));
        let [x, y, z] = vector(|turn| turn.rotation.xyz());
        let turn = unit4([x, y, z, f64x4::from(lanes.map(|turn| f64::from(turn.rotation.w)))]);
        let local: [f64x4; 3] = quat(turn).conjugate().rotate(spin.into()).into();
        let momentum: [f64x4; 3] = from_fn(|k| inertia[k] * local[k]);
        let mut four = Four { turn, momentum };
        four.tumble(&tops);
        // The part of the rotation about the angular momentum, which stays constant.
        let time = f64x4::from(from_fn(|lane| tops[lane].across * f64::from(lanes[lane].time)));
        let precession = quat(turn).rotate(momentum.into()) * time;
        let (sine, cosine) = half_turn(precession.length_squared());
        let LaneQuat { v, w } = LaneQuat { v: precession * sine, w: cosine }.compose(quat(four.turn));
        four.turn = [v.x, v.y, v.z, w];
        four.keep_energy(inertia.map(|moment| f64x4::splat(1.0) / moment), momentum);
        let turn = unit4(four.turn).map(|component| component.to_array().map(|component| component as f32));
        let local: [f64x4; 3] = from_fn(|k| four.momentum[k] / inertia[k]);
        let wide = unit4(turn.map(|component| f64x4::from(component.map(f64::from))));
        let spin: [f64x4; 3] = quat(wide).rotate(local.into()).into();
        from_fn(|lane| {
            let at = |k: usize| tops[lane].uncycled(k);
            let (turn, spin) = (turn.map(|turn| turn[lane]), spin.map(|spin| spin.as_array()[lane] as f32));
            let turn = Quat::from_xyzw(turn[at(0)], turn[at(1)], turn[at(2)], turn[3]);
            (turn, Vec3::new(spin[at(0)], spin[at(1)], spin[at(2)]))
        })
    }
}

fn unit4(q: [f64x4; 4]) -> [f64x4; 4] {
    let one = f64x4::splat(1.0) / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    q.map(|component| component * one)
}

fn quat([x, y, z, w]: [f64x4; 4]) -> LaneQuat<f64x4> {
    LaneQuat { v: LaneVec3::new(x, y, z), w }
}

/// The symmetric top that is most like a body, and how its motion is resolved.
#[derive(Clone, Copy, Default)]
struct Top {
    /// The body axis that is the axis of the top: the other two moments differ least.
    axis: usize,
    /// One over the moment of the two that are alike, their mean [1/(kg m²)].
    across: f64,
    /// Rotation about the axis in one part, per unit of the momentum about it [rad].
    around: f64,
    /// The same about the two others, by a quarter of their difference.
    rest: f64,
    parts: u32,
}

/// The axis of the top that is most like a body with such moments.
fn top_axis(inertia: Vec3) -> usize {
    let inverse = inertia.recip();
    let apart = [(inverse.y - inverse.z).abs(), (inverse.z - inverse.x).abs(), (inverse.x - inverse.y).abs()];
    if apart[0] <= apart[1] && apart[0] <= apart[2] {
        0
    } else if apart[1] <= apart[2] {
        1
    } else {
        2
    }
}

impl Top {
    fn of(turn: &FreeTurn) -> Top {
        let (inverse, axis) = (turn.inertia.recip(), top_axis(turn.inertia));
        let [i, j] = [1, 2].map(|next| f64::from(inverse[(axis + next) % 3]));
        let (across, parts) = (0.5 * (i + j), turn.parts());
        let h = f64::from(turn.time) / f64::from(parts);
        Top { axis, across, around: (f64::from(inverse[axis]) - across) * h, rest: 0.25 * (i - j) * h, parts }
    }

    /// Which axis is the `k`-th in the order in which the top's is the last,
    fn cycled(&self, k: usize) -> usize {
        (self.axis + 1 + k) % 3
    }

    /// and where in that order the `k`-th axis is.
    fn uncycled(&self, k: usize) -> usize {
        (2 + k - self.axis) % 3
    }
}

/// Four free bodies.
#[derive(Clone, Copy)]
struct Four {
    turn: [f64x4; 4],
    momentum: [f64x4; 3],
}

impl Four {
    /// Free rotations save for the precession: that by which the whole motion turns about the angular
    /// momentum, which is the same all along and so can be added at the end.
    ///
    /// A symmetric top, which has a closed solution, and the remaining difference of its two like moments, in
    /// turn (Touma and Wisdom, *Lie-Poisson integrators for rigid body dynamics in the solar system*, 1994).
    /// Every part is a rotation, so the angular momentum is conserved to rounding at any length of step; a
    /// needle, whose moments are as 1 to 10 000, keeps its energy too, where an iteration for the implicit
    /// midpoint would not converge.
    fn tumble(&mut self, tops: &[Top; FREE]) {
        let (least, most) =
            tops.iter().fold((u32::MAX, 1), |(least, most), top| (least.min(top.parts), most.max(top.parts)));
        let [around, rest] = [tops.map(|top| top.around), tops.map(|top| top.rest)].map(f64x4::from);
        let parts = f64x4::from(tops.map(|top| f64::from(top.parts)));
        self.spin::<0>(rest);
        for part in 1..=most {
            let before = *self;
            self.spin::<1>(-rest);
            self.spin::<2>(around);
            self.spin::<1>(-rest);
            // The end of one part and the beginning of the next.
            let goes_on = f64x4::splat(f64::from(part)).simd_lt(parts);
            self.spin::<0>(goes_on.select(rest + rest, rest));
            if part > least {
                // Some are done.
                let is_done = parts.simd_lt(f64x4::splat(f64::from(part)));
                let keep = |now: &mut f64x4, before: f64x4| *now = is_done.select(before, *now);
                self.turn.iter_mut().zip(before.turn).for_each(|(now, before)| keep(now, before));
                self.momentum.iter_mut().zip(before.momentum).for_each(|(now, before)| keep(now, before));
            }
        }
    }

    /// Moves the momentum of each, as the body sees it, on its sphere to where the body has the energy that
    /// it had with the momentum `before`; in the world the momentum is conserved.
    ///
    /// The squares of its three parts are shares of a whole, and the energy is the mean of 1/I over them: two
    /// linear equations, so the shares that have both lie on a line, from those before. Of these it gets
    /// those to which the momentum is nearest, as far as none is negative.
    fn keep_energy(&mut self, inverse: [f64x4; 3], before: [f64x4; 3]) {
        let zero = f64x4::splat(0.0);
        let positive = |x: f64x4| x.max(f64x4::splat(f64::MIN_POSITIVE));
        let squared = |m: [f64x4; 3]| LaneVec3::from(m).length_squared();
        let whole = squared(before);
        let (from, to) =
            (f64x4::splat(1.0) / positive(whole), f64x4::splat(1.0) / positive(squared(self.momentum)));
        let had: [f64x4; 3] = from_fn(|k| before[k] * before[k] * from);
        let has: [f64x4; 3] = from_fn(|k| self.momentum[k] * self.momentum[k] * to);
        let along: [f64x4; 3] = from_fn(|k| inverse[(k + 1) % 3] - inverse[(k + 2) % 3]);
        let (mut over, mut under) = (zero, zero);
        let (mut least, mut most) = (f64x4::splat(f64::NEG_INFINITY), f64x4::splat(f64::INFINITY));
        for k in 0..3 {
            // Rounding: none is quite zero, or it could not grow.
            let weighed = along[k] / (has[k] + f64x4::splat(1e-9));
            over += weighed * (has[k] - had[k]);
            under += weighed * along[k];
            let end = -had[k] / along[k];
            least = along[k].simd_gt(zero).select(least.max(end), least);
            most = along[k].simd_lt(zero).select(most.min(end), most);
        }
        let by = (over / positive(under)).max(least).min(most);
        let length = to.sqrt();
        let now = self.momentum.map(|m| m * length);
        let moved: [f64x4; 3] = from_fn(|k| {
            let size = (had[k] + by * along[k]).max(zero).sqrt();
            now[k].simd_lt(zero).select(-size, size)
        });
        let (a, b) = (LaneVec3::from(moved), LaneVec3::from(now));
        let arc = LaneQuat { v: a.cross(b), w: f64x4::splat(1.0) + a.dot(b) };
        let LaneQuat { v, w } = quat(self.turn).compose(arc);
        self.turn = [v.x, v.y, v.z, w];
        let length = whole.sqrt();
        self.momentum = moved.map(|m| m * length);
    }

    /// Turns bodies about one of their own axes, by `rate` times their momentum about that axis [rad]; the
    /// momentum as seen from a body turns back.
    #[inline(always)]
    fn spin<const AXIS: usize>(&mut self, rate: f64x4) {
        let Four { turn: q, momentum: m } = self;
        let angle = rate * m[AXIS];
        let (s, c) = half_turn(angle * angle);
        let s = s * angle;
        let (i, j) = ((AXIS + 1) % 3, (AXIS + 2) % 3);
        (q[AXIS], q[3]) = (q[AXIS] * c + q[3] * s, q[3] * c - q[AXIS] * s);
        (q[i], q[j]) = (q[i] * c + q[j] * s, q[j] * c - q[i] * s);
        let (sin, cos) = (s * c + s * c, c * c - s * s);
        (m[i], m[j]) = (m[i] * cos + m[j] * sin, m[j] * cos - m[i] * sin);
    }
}

/// Sine of half an angle divided by the angle, and cosine of half of it, by the angle's square.
#[inline(always)]
fn half_turn(t: f64x4) -> (f64x4, f64x4) {
    let (s, c) = series(t);
    let small = t.simd_lt(f64x4::splat(SMALL));
    if small.all() {
        return (s, c);
    }
    // Angles too large for the series: sine and cosine of a quarter of the angle, doubled twice.
    let quarter = t * f64x4::splat(1.0 / 16.0);
    let (s_quarter, c_quarter) = series(quarter);
    let half = f64x4::splat(1.0) - f64x4::splat(2.0) * quarter * s_quarter * s_quarter;
    let s = small.select(s, s_quarter * c_quarter * half);
    let c = small.select(c, f64x4::splat(2.0) * half * half - f64x4::splat(1.0));
    if t.simd_lt(f64x4::splat(16.0 * SMALL)).all() { (s, c) } else { large_half_turn(t, s, c) }
}

// Rounding: up to here the series are exact to f64.
/// Square of an angle up to which the series are good for [rad²].
const SMALL: f64 = 0.25;

/// They end where the next term is below 1e-13.
#[inline(always)]
fn series(t: f64x4) -> (f64x4, f64x4) {
    let k = f64x4::splat;
    let s = k(1.0 / 645_120.0) - t * (k(1.0 / 185_794_560.0) - t * k(1.0 / 81_749_606_400.0));
    let s = k(0.5) - t * (k(1.0 / 48.0) - t * (k(1.0 / 3840.0) - t * s));
    let c = k(1.0 / 46_080.0) - t * (k(1.0 / 10_321_920.0) - t * k(1.0 / 3_715_891_200.0));
    (s, k(1.0) - t * (k(1.0 / 8.0) - t * (k(1.0 / 384.0) - t * c)))
}

/// Sine and cosine by the library functions, for angles that are larger still.
#[inline(never)]
fn large_half_turn(t: f64x4, mut s: f64x4, mut c: f64x4) -> (f64x4, f64x4) {
    for (lane, t) in t.to_array().into_iter().enumerate().filter(|(_, t)| *t >= 16.0 * SMALL) {
        let angle = t.sqrt();
        let (sin, cos) = libm::sincos(0.5 * angle);
        (s.as_mut_array()[lane], c.as_mut_array()[lane]) = (sin / angle, cos);
    }
    (s, c)
}

/// The rotation by a rotation vector.
fn turn_by(vector: DVec3) -> DQuat {
    let angle = vector.length();
    let (sin, cos) = libm::sincos(0.5 * angle);
    let vector = if angle > 0.0 { vector * (sin / angle) } else { DVec3::ZERO };
    DQuat::from_xyzw(vector.x, vector.y, vector.z, cos)
}

#[cfg(test)]
mod tests;
