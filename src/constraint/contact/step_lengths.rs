//! Steps of different lengths: the springs of contacts, and the scaling of impulses that bear loads.
//!
//! A body comes to rest only if every step has the same equilibrium at any length. The sag under a load
//! depends on the spring alone, so the spring is the same from step to step ([`usual_substep`]); and impulses
//! of lasting loads scale with the length of the substep ([`StepLengths`]).

use crate::config::tuning::{
    EVEN_STEP_BAND, EVENNESS_SHARE, LOAD_TIME, NEW_FORCE_SHARE, SPRING_STEP_FALL, SPRING_STEP_RISE,
};
use std::ops::{Add, Mul, Sub};

/// The substep for which the springs of contacts are made [s], after a step with substeps of `h` seconds;
/// `usual`: that of the steps before, or zero.
///
/// A spring as stiff as each substep allows yields by the square of its length: with alternating steps of
/// 1/30 and 1/144 s a box sags 23 times as far in one as in the other, is thrown up in between, and pumps
/// energy into the bodies that stand on it.
pub(crate) fn usual_substep(usual: f32, h: f32) -> f32 {
    if usual == 0.0 { h } else { h.clamp(usual * (1.0 - SPRING_STEP_FALL), usual * (1.0 + SPRING_STEP_RISE)) }
}

/// Share of recent steps that were about as long as the step before; `before`: the same a step ago, zero at
/// first.
pub(crate) fn evenness(before: f32, lengths: StepLengths) -> f32 {
    let even = f32::from(u8::from((lengths.now - lengths.last).abs() <= EVEN_STEP_BAND * lengths.last));
    before + (even - before) * EVENNESS_SHARE
}

/// This step, its substeps, and those of the last step.
///
/// An impulse consists of the part that a load requires in a substep and of the part of the last pass that
/// stopped the remaining velocities. The load scales with the length of the substep. The rest is a momentum
/// and not a force: if it scaled too, it would grow by the ratio whenever a long step follows a short one,
/// and two boxes would rock each other at alternating steps of 1/30 and 1/144 s. So it never grows; that it
/// shrinks before a shorter step keeps a tower of 20 up that falls otherwise. The mean over the last seconds
/// separates load and rest: a shorter mean would follow a sway, with a lag, and pump it at every hitch. But
/// where every step has another length, only the mean is warm-started in springs, and it follows within a few
/// steps. While steps are equally long nothing is stored.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepLengths {
    dt: f32,
    /// Substep of the last step, or of this one if it is the first [s].
    last: f32,
    now: f32,
    /// Weight of this step's force in the mean of the last steps.
    share: f32,
    warm_starting: bool,
}

/// A number or a vector.
pub(crate) trait Load:
    Copy + Default + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<f32, Output = Self>
{
}

impl Load for f32 {}
impl Load for glam::Vec4 {}

impl StepLengths {
    /// For a step of `dt` seconds with substeps of `now` seconds, after substeps of `last` seconds or zero.
    pub(crate) fn new(last: f32, now: f32, dt: f32, evenness: f32, warm_starting: bool) -> Self {
        let share = (dt / LOAD_TIME).max(NEW_FORCE_SHARE * (1.0 - evenness).powi(2)).min(1.0);
        StepLengths { dt, last: if last > 0.0 { last } else { now }, now, share, warm_starting }
    }

    /// The whole of this step [s].
    pub(crate) fn dt(self) -> f32 {
        self.dt
    }

    /// The substep of the last step, or of this one if it is the first [s].
    pub(crate) fn last(self) -> f32 {
        self.last
    }

    /// The substep of this step [s].
    pub(crate) fn now(self) -> f32 {
        self.now
    }

    /// Factor on impulses of loads; zero without warm starting.
    pub(crate) fn ratio(self) -> f32 {
        if self.warm_starting { self.now / self.last } else { 0.0 }
    }

    /// The impulse to start with, after one of the last step. `mean`: force, or zero if it is not known.
    pub(crate) fn carry<T: Load>(self, impulse: T, mean: T) -> T {
        if self.now == self.last && self.warm_starting {
            impulse
        } else if mean == T::default() || !self.warm_starting {
            impulse * self.ratio()
        } else {
            mean * self.now + (impulse - mean * self.last) * self.ratio().min(1.0)
        }
    }

    /// The mean force after a step that ended with an impulse.
    pub(crate) fn follow<T: Load>(self, mean: T, impulse: T) -> T {
        if mean == T::default() && self.now == self.last {
            return mean;
        }
        let force = impulse * (1.0 / self.now);
        if mean == T::default() { force } else { mean + (force - mean) * self.share }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By Newton: a force of 10 N is an impulse of 0.1 N s in 10 ms and of 0.4 N s in 40 ms.
    #[test]
    fn loads_go_with_the_length_of_the_substep_and_momenta_never_grow() {
        let longer = StepLengths::new(0.01, 0.04, 0.16, 1.0, true);
        assert!((longer.carry(0.1, 10.0) - 0.4_f32).abs() < 1e-6);
        assert!((longer.carry(0.13, 10.0) - 0.43_f32).abs() < 1e-6);
        let shorter = StepLengths::new(0.04, 0.01, 0.04, 1.0, true);
        assert!((shorter.carry(0.48, 10.0) - 0.12_f32).abs() < 1e-6);
        // Equal lengths: the same bits, and nothing is stored.
        let same = StepLengths::new(0.01, 0.01, 0.04, 1.0, true);
        assert_eq!((same.carry(0.13, 7.0), same.follow(0.0, 0.13)), (0.13, 0.0));
        assert_eq!(StepLengths::new(0.01, 0.04, 0.16, 1.0, false).carry(0.1, 10.0), 0.0);
    }

    /// With a hundred short steps to a long one the spring is that of the short ones, within the hundredth
    /// that a long one adds.
    #[test]
    fn a_hitch_now_and_then_softens_nothing() {
        let mut usual = 0.0;
        for step in 0..10_000 {
            usual = usual_substep(usual, if step % 100 == 99 { 0.06 } else { 0.004 });
            assert!((0.004..0.00405).contains(&usual), "{step}: {usual}");
        }
    }
}
