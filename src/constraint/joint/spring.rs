//! Springs, dampers and motors, solved implicitly over a substep; and the stops of motors.

use crate::joint::SpringCoefficients;
use crate::lanes::Lanes;

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

/// A spring and damper, solved implicitly over a substep: requested speed per displacement, yield per
/// impulse, and the requested speed beside that; none if there is neither.
pub(super) fn implicit(spring: &SpringCoefficients, target: f32, h: f32) -> Option<[f32; 3]> {
    let (k, c) = (spring.stiffness, spring.damping);
    let d = h * k + c;
    if d == f32::INFINITY {
        return Some([0.0, 0.0, target]);
    }
    (d > 0.0).then(|| [k / d, 1.0 / (h * d), c / d * target])
}

/// A spring or a motor as a row has it: see [`RowBatch`](super::row::RowBatch).
pub(super) struct Spring {
    pub(super) pull: f32,
    pub(super) give: f32,
    pub(super) speed: f32,
    pub(super) most: f32,
    /// Speed per impulse of what it acts on.
    pub(super) mobility: f32,
}

impl Spring {
    /// The energy that it can give back, and what it gives by its target speed [J]. `over`: its displacement;
    /// `impulse`: of the last substep of `h` seconds.
    pub(super) fn energy(&self, over: f32, impulse: f32, h: f32) -> [f32; 2] {
        let &Spring { pull, give, speed, most, mobility } = self;
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
