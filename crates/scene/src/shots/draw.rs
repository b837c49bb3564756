//! Random numbers of a shot: steps, sizes and speeds.

use crate::rng::Rng;

/// Steps that a shot may take [s].
const STEPS: [f32; 5] = [1.0 / 20.0, 1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0, 1.0 / 240.0];
/// Mean of those.
const MEAN_STEP: f32 = 0.0225;

/// The generator of a shot: the states of different shots are far apart, whatever the seed.
pub(super) fn generator(seed: u64, number: u64) -> Rng {
    Rng::new(Rng::new(seed ^ number.wrapping_mul(0xD134_2543_DE82_EF95)).bits())
}

/// Lengths of steps, all the same in half of the cases, and their mean [s].
pub(super) fn step_lengths(rng: &mut Rng, most: usize) -> (Vec<f32>, f32) {
    let varying = rng.bits() & 1 == 0;
    let fixed = STEPS[pick(rng, STEPS.len())];
    let steps = (0..most).map(|_| if varying { STEPS[pick(rng, STEPS.len())] } else { fixed }).collect();
    (steps, if varying { MEAN_STEP } else { fixed })
}

/// The steps that cover a time [s].
pub(super) fn until(mut steps: Vec<f32>, time: f32) -> Vec<f32> {
    let mut left = time;
    steps.retain(|dt| {
        let wanted = left > 0.0;
        left -= dt;
        wanted
    });
    steps
}

/// A number below `count`.
pub(super) fn pick(rng: &mut Rng, count: usize) -> usize {
    (rng.bits() >> 33) as usize % count
}

/// Uniform in the logarithm.
pub(super) fn log_range(rng: &mut Rng, low: f32, high: f32) -> f32 {
    low * libm::expf(rng.range(0.0, libm::logf(high / low)))
}
