//! Measures of joint rows: a displacement along an axis, a distance, or an angle; and the direction in which
//! an impulse changes it. Both follow the bodies within a step.

use super::ends::{Lever, mean, seen};
use crate::constraint::contact::row::BodyPair;
use crate::joint::{Axes, Axis, Placed};
use crate::lanes::{GatherLanes, Lanes, Record, Vec3, turned};
use bytemuck::Zeroable;

/// A measure of a row. The lever's arms are set before it is called.
pub(crate) trait Measure<L: Lanes>: Copy + Default + Zeroable {
    /// Whether it is an angle [rad] or a length [m].
    const IS_ANGLE: bool;
    /// Initialises a lane at the start of a step, and returns the displacement if that does not follow from
    /// the stored data.
    fn place(&mut self, lane: usize, at: &Placed, axes: Axes) -> f32;
    /// Updates the measure after displacements: sets force and torque of the lever, and returns the
    /// displacement. `start`: the result of `place`.
    fn follow(&mut self, d: &BodyPair<L>, lever: &mut Lever<L>, start: L) -> L;
    /// The mean speed of the displacement over a time, less its current one: directions turn.
    fn bend(&self, v: &BodyPair<L>, lever: &Lever<L>, h: L) -> L;
    /// How fast the direction of a lane turns [rad/s].
    fn turns(&self, lane: usize, lever: &Lever<L>, v: [Record; 2]) -> f32 {
        let along = lever.force.lane(lane) + lever.torque.lane(lane);
        v[0].angular.cross(along).length().max(v[1].angular.cross(along).length())
    }
}

/// A displacement along an axis of the first body [m].
#[derive(Clone, Copy, Debug, Default, Zeroable)]
#[repr(C)]
pub(crate) struct Slide<L> {
    axis: Vec3<L>,
    /// The first body's arm at the start of the step.
    arm: Vec3<L>,
    axis_now: Vec3<L>,
}

impl<L: GatherLanes> Measure<L> for Slide<L> {
    const IS_ANGLE: bool = false;

    fn place(&mut self, lane: usize, at: &Placed, axes: Axes) -> f32 {
        let axis = at.axis(0, axis_of(axes));
        self.axis.set_lane(lane, axis);
        self.arm.set_lane(lane, at.arm[0] + at.apart);
        axis.dot(at.apart)
    }
    #[inline(always)]
    fn follow(&mut self, d: &BodyPair<L>, lever: &mut Lever<L>, start: L) -> L {
        self.axis_now = turned(d.wa, self.axis);
        (lever.force, lever.torque) = (self.axis_now, Vec3::zero());
        start + (self.axis_now.dot(lever.arm[0]) - self.axis.dot(self.arm))
    }
    #[inline(always)]
    fn bend(&self, v: &BodyPair<L>, lever: &Lever<L>, h: L) -> L {
        self.axis_now.dot(seen(v, &lever.arm, h) - seen(v, &lever.arm, L::zero()))
    }
    fn turns(&self, lane: usize, _: &Lever<L>, v: [Record; 2]) -> f32 {
        v[0].angular.cross(self.axis_now.lane(lane)).length()
    }
}

/// A distance from a point, or from an axis of the first body [m].
#[derive(Clone, Copy, Debug, Default, Zeroable)]
#[repr(C)]
pub(crate) struct Distance<L> {
    /// Zero if it is from a point.
    axis: Vec3<L>,
    /// From the first body's centre to its point.
    arm: Vec3<L>,
    aside: Vec3<L>,
    axis_now: Vec3<L>,
    apart_now: Vec3<L>,
    along: Vec3<L>,
}

impl<L: GatherLanes> Measure<L> for Distance<L> {
    const IS_ANGLE: bool = false;

    fn place(&mut self, lane: usize, at: &Placed, axes: Axes) -> f32 {
        if let Axes::Perpendicular(axis) = axes {
            self.axis.set_lane(lane, at.axis(0, axis));
        }
        self.arm.set_lane(lane, at.arm[0]);
        self.aside.set_lane(lane, at.aside(axes));
        0.0
    }
    #[inline(always)]
    fn follow(&mut self, d: &BodyPair<L>, lever: &mut Lever<L>, _: L) -> L {
        self.axis_now = turned(d.wa, self.axis);
        self.apart_now = self.across(lever.arm[0] - turned(d.wa, self.arm));
        let (length, along) = direction(self.apart_now, self.aside);
        self.along = along;
        (lever.force, lever.torque) = (along, Vec3::zero());
        length
    }
    #[inline(always)]
    fn bend(&self, v: &BodyPair<L>, lever: &Lever<L>, h: L) -> L {
        let speed = self.across(seen(v, &lever.arm, h));
        let now = self.across(seen(v, &lever.arm, L::zero()));
        lengthens(self.apart_now, self.along, speed, h) + self.along.dot(speed - now)
    }
    /// The direction turns with the separation, faster the nearer the points are.
    fn turns(&self, lane: usize, lever: &Lever<L>, v: [Record; 2]) -> f32 {
        let arm = lever.arm.map(|arm| arm.lane(lane));
        let speed = v[1].linear + v[1].angular.cross(arm[1]) - v[0].linear - v[0].angular.cross(arm[0]);
        let apart = self.apart_now.lane(lane).length();
        // If the points coincide the direction is arbitrary, and only the rotation of the arms matters.
        speed.length() / apart.max(f32::MIN_POSITIVE)
    }
}

impl<L: Lanes> Distance<L> {
    #[inline(always)]
    fn across(&self, v: Vec3<L>) -> Vec3<L> {
        v - self.axis_now * self.axis_now.dot(v)
    }
}

/// The twist about an axis [rad].
#[derive(Clone, Copy, Debug, Default, Zeroable)]
#[repr(C)]
pub(crate) struct Twist<L> {
    axis: [Vec3<L>; 2],
}

impl<L: GatherLanes> Measure<L> for Twist<L> {
    const IS_ANGLE: bool = true;

    fn place(&mut self, lane: usize, at: &Placed, axes: Axes) -> f32 {
        let axis = axis_of(axes);
        self.axis[0].set_lane(lane, at.axis(0, axis));
        self.axis[1].set_lane(lane, at.axis(1, axis));
        at.twist(axis)
    }
    #[inline(always)]
    fn follow(&mut self, d: &BodyPair<L>, lever: &mut Lever<L>, start: L) -> L {
        let now = between([turned(d.wa, self.axis[0]), turned(d.wb, self.axis[1])]);
        (lever.force, lever.torque) = (Vec3::zero(), now);
        start + (between(self.axis) + now).dot(d.wb - d.wa) * L::splat(0.5)
    }
    #[inline(always)]
    fn bend(&self, _: &BodyPair<L>, _: &Lever<L>, _: L) -> L {
        L::zero()
    }
}

/// The mean of two axes: only rotation about it changes the twist.
#[inline(always)]
fn between<L: Lanes>([a, b]: [Vec3<L>; 2]) -> Vec3<L> {
    let middle = L::one() + a.dot(b);
    let some = middle.gt(L::splat(1e-3));
    Vec3::select(some, (a + b) * (L::one() / L::select(some, middle, L::one())), a)
}

/// The angle between an axis of each body [rad].
#[derive(Clone, Copy, Debug, Default, Zeroable)]
#[repr(C)]
pub(crate) struct Tilt<L> {
    axis: [Vec3<L>; 2],
    aside: Vec3<L>,
    axis_now: [Vec3<L>; 2],
    about: Vec3<L>,
    now: L,
}

impl<L: GatherLanes> Measure<L> for Tilt<L> {
    const IS_ANGLE: bool = true;

    fn place(&mut self, lane: usize, at: &Placed, axes: Axes) -> f32 {
        let axis = axis_of(axes);
        self.axis[0].set_lane(lane, at.axis(0, axis));
        self.axis[1].set_lane(lane, at.axis(1, axis));
        self.aside.set_lane(lane, at.aside(axes));
        0.0
    }
    #[inline(always)]
    fn follow(&mut self, d: &BodyPair<L>, lever: &mut Lever<L>, _: L) -> L {
        let [a, b] = [turned(d.wa, self.axis[0]), turned(d.wb, self.axis[1])];
        let (sine, about) = direction(a.cross(b), self.aside);
        (self.axis_now, self.about, self.now) = ([a, b], about, angle(sine, a.dot(b)));
        (lever.force, lever.torque) = (Vec3::zero(), about);
        self.now
    }
    #[inline(always)]
    fn bend(&self, v: &BodyPair<L>, _: &Lever<L>, h: L) -> L {
        let [a, b] = self.axis_now;
        let a = a + mean(Vec3::zero(), v.wa, a, h) * h;
        let b = b + mean(Vec3::zero(), v.wb, b, h) * h;
        let moved = angle(a.cross(b).length(), a.dot(b)) - self.now;
        // Near the axis of the cone the direction turns too far.
        let path = (v.wb - v.wa).length() * h;
        let some = h.gt(L::zero()) & (path + path).lt(self.now);
        L::select(some, moved / L::select(some, h, L::one()) - self.about.dot(v.wb - v.wa), L::zero())
    }
}

/// The angle of all rotation [rad].
#[derive(Clone, Copy, Debug, Zeroable)]
#[repr(C)]
pub(crate) struct Turn<L> {
    /// Rotation vector from the first body to the second.
    error: Vec3<L>,
    /// Share of a small rotation across the vector that shows in it.
    share: L,
    aside: Vec3<L>,
    error_now: Vec3<L>,
    about: Vec3<L>,
}

impl<L: Lanes> Default for Turn<L> {
    fn default() -> Self {
        Turn { share: L::one(), ..Zeroable::zeroed() }
    }
}

impl<L: GatherLanes> Measure<L> for Turn<L> {
    const IS_ANGLE: bool = true;

    fn place(&mut self, lane: usize, at: &Placed, axes: Axes) -> f32 {
        let error = at.turn();
        let half = 0.5 * error.length();
        self.error.set_lane(lane, error);
        self.aside.set_lane(lane, at.aside(axes));
        self.share.set_lane(lane, if half < 1e-3 { 1.0 } else { half / libm::tanf(half) });
        0.0
    }
    #[inline(always)]
    fn follow(&mut self, d: &BodyPair<L>, lever: &mut Lever<L>, _: L) -> L {
        let about = direction(self.error, self.aside).1;
        let error = self.error + self.seen(about, d.wb - d.wa);
        let (length, about) = direction(turned((d.wa + d.wb) * L::splat(0.5), error), self.aside);
        (self.error_now, self.about) = (about * length, about);
        (lever.force, lever.torque) = (Vec3::zero(), about);
        length
    }
    #[inline(always)]
    fn bend(&self, v: &BodyPair<L>, _: &Lever<L>, h: L) -> L {
        let speed = self.seen(self.about, v.wb - v.wa);
        lengthens(self.error_now, self.about, speed, h)
    }
}

impl<L: Lanes> Turn<L> {
    /// Rate of a rotation vector, without the common rotation of both bodies.
    #[inline(always)]
    fn seen(&self, about: Vec3<L>, w: Vec3<L>) -> Vec3<L> {
        let own = about * about.dot(w);
        own + (w - own) * self.share
    }
}

fn axis_of(axes: Axes) -> Axis {
    match axes {
        Axes::One(axis) | Axes::Perpendicular(axis) => axis,
        Axes::All => Axis::X,
    }
}

/// Length and direction; a zero vector has the direction of `aside`.
#[inline(always)]
fn direction<L: Lanes>(v: Vec3<L>, aside: Vec3<L>) -> (L, Vec3<L>) {
    let length = v.length();
    let some = length.gt(L::splat(1e-7));
    (length, Vec3::select(some, v * (L::one() / L::select(some, length, L::one())), aside))
}

/// The mean rate at which a vector lengthens over a time in which it changes at a constant velocity, less
/// that at its start. Zero if it would turn too far: no row along its current direction could correct for
/// that.
#[inline(always)]
fn lengthens<L: Lanes>(v: Vec3<L>, along: Vec3<L>, speed: Vec3<L>, h: L) -> L {
    // (|v + h s| - |v|) / h, without cancellation.
    let path = speed * h;
    let (end, length) = (v + path, v.length());
    let some = (path.length_squared() * L::splat(4.0)).lt(length * length);
    let sum = length + end.length();
    L::select(some, (v + end).dot(speed) / L::select(some, sum, L::one()) - along.dot(speed), L::zero())
}

/// The angle of a nonnegative sine and a cosine with a common factor: in 0..=pi, to 1e-6.
#[inline(always)]
fn angle<L: Lanes>(sine: L, cosine: L) -> L {
    let (s, c) = (sine, cosine.abs());
    let steep = s.gt(c);
    let (low, high) = (L::select(steep, c, s), L::select(steep, s, c));
    let t = low / L::select(high.gt(L::zero()), high, L::one());
    let x = t * t;
    // Abramowitz and Stegun 4.4.49.
    let c = [
        0.002_866_225_7,
        -0.016_165_737,
        0.042_909_614,
        -0.075_289_64,
        0.106_562_64,
        -0.142_089,
        0.199_935_51,
        -0.333_331_45,
    ];
    let series = c.into_iter().fold(L::zero(), |sum, c| sum * x + L::splat(c));
    let t = t + t * x * series;
    let t = L::select(steep, L::splat(std::f32::consts::FRAC_PI_2) - t, t);
    L::select(cosine.lt(L::zero()), L::splat(std::f32::consts::PI) - t, t)
}

#[cfg(test)]
mod tests;
