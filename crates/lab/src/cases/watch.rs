//! Measuring instruments: zero crossings, angles over several turns, and thresholds by bisection.

use backstop::Error;
use std::f64::consts::TAU;

/// Times at which a number passed zero, linearly interpolated between steps.
#[derive(Default)]
pub(super) struct Passages {
    before: Option<(f64, f64)>,
    pub(super) times: Vec<f64>,
}

impl Passages {
    pub(super) fn see(&mut self, time: f64, value: f64) {
        if let Some((then, was)) = self.before
            && was * value < 0.0
        {
            self.times.push(then + (time - then) * was / (was - value));
        }
        self.before = Some((time, value));
    }

    /// Time from the first crossing to the third; NaN if there are fewer.
    pub(super) fn period(&self) -> f64 {
        match self.times[..] {
            [first, _, third, ..] => third - first,
            _ => f64::NAN,
        }
    }
}

/// An angle summed over many turns [rad]; between two measurements it changes by less than half a turn.
#[derive(Default)]
pub(super) struct Turns {
    before: Option<f64>,
    /// The sum.
    pub(super) gone: f64,
}

impl Turns {
    pub(super) fn see(&mut self, angle: f64) {
        if let Some(before) = self.before {
            let turn = angle - before;
            self.gone += turn - (turn / TAU).round() * TAU;
        }
        self.before = Some(angle);
    }
}

/// The value between `low` and `high` from which on something happens, by repeated bisection; NaN if it
/// happens at `low` already, or not even at `high`.
pub(super) fn threshold(
    [low, high]: [f64; 2],
    halvings: u32,
    mut happens: impl FnMut(f64) -> Result<bool, Error>,
) -> Result<f64, Error> {
    let (mut low, mut high) = (low, high);
    if happens(low)? || !happens(high)? {
        return Ok(f64::NAN);
    }
    for _ in 0..halvings {
        let middle = 0.5 * (low + high);
        *(if happens(middle)? { &mut high } else { &mut low }) = middle;
    }
    Ok(0.5 * (low + high))
}
