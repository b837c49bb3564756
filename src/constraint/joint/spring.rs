//! Springs, dampers and motors, solved implicitly over a substep; and the stops of motors.

use crate::joint::SpringCoefficients;
use crate::lanes::Lanes;
use bytemuck::Zeroable;

/// The stops of a motor that has none.
pub(crate) const ENDLESS: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];

/// The speed that a motor may have at a displacement, so that it does not pass its stops within a substep;
/// beyond one it goes back as the stop asks, at `rate` and at most at `push`. Two rows that both must have
/// their way would push each other ever harder.
#[inline(always)]
pub(crate) fn before_stops<L: Lanes>(
    speed: L,
    now: L,
    stops: &[L; 2],
    inverse_h: L,
    [rate, push]: [L; 2],
) -> L {
    let [low, high] = [stops[0] - now, stops[1] - now];
    let zero = L::zero();
    let low = low.min(zero) * inverse_h + (low.max(zero) * rate).min(push);
    let high = high.max(zero) * inverse_h + (high.min(zero) * rate).max(-push);
    speed.max(low).min(high)
}

/// A spring or a motor as a row has it: a damped spring, solved implicitly over a substep.
#[derive(Clone, Copy, Debug, Default, Zeroable)]
#[repr(C)]
pub(crate) struct Spring<L> {
    /// Requested speed per displacement beyond the range [1/s], requested speed beside that, and yield per
    /// impulse; all zero for rigid rows.
    pub(crate) pull: L,
    pub(crate) speed: L,
    pub(crate) give: L,
    /// Maximum impulse in a substep [N s] or [N m s].
    pub(crate) most: L,
}

impl<L: Lanes> Spring<L> {
    pub(super) fn set_lane(&mut self, lane: usize, one: &Spring<f32>) {
        self.pull.set_lane(lane, one.pull);
        self.speed.set_lane(lane, one.speed);
        self.give.set_lane(lane, one.give);
        self.most.set_lane(lane, one.most);
    }

    pub(super) fn lane(&self, lane: usize) -> Spring<f32> {
        let [pull, speed, give, most] = [self.pull, self.speed, self.give, self.most].map(|x| x.lane(lane));
        Spring { pull, speed, give, most }
    }
}

impl Spring<f32> {
    /// With a target speed and a maximum impulse, for substeps of `h` seconds; none if there is neither
    /// stiffness nor damping.
    pub(super) fn new(of: &SpringCoefficients, target: f32, most: f32, h: f32) -> Option<Spring<f32>> {
        let (k, c) = (of.stiffness, of.damping);
        let d = h * k + c;
        if d == f32::INFINITY {
            return Some(Spring { pull: 0.0, speed: target, give: 0.0, most });
        }
        (d > 0.0).then(|| Spring { pull: k / d, speed: c / d * target, give: 1.0 / (h * d), most })
    }

    /// The energy that it can give back, and its work by the target speed [J]. `over`: its displacement;
    /// `impulse`: of the last substep of `h` seconds; `mobility`: speed per impulse of the bodies that it
    /// acts on.
    pub(super) fn energy(&self, over: f32, impulse: f32, h: f32, mobility: f32) -> [f32; 2] {
        let &Spring { pull, speed, give, most } = self;
        if give <= 0.0 {
            // A motor that does not yield.
            return [0.0, (impulse * speed).max(0.0)];
        }
        let d = 1.0 / (h * give);
        let k = pull * d;
        let c = d - h * k;
        let k = k / (1.0 + h * h * k * mobility);
        let force = most / h;
        let stored = if k * over <= force { 0.5 * k * over * over } else { force * (over - 0.5 * force / k) };
        let requested = if c > 1e-6 * d { speed * d / c } else { 0.0 };
        [stored, (impulse * requested).max(0.0)]
    }
}
