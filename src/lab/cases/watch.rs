//! What measures: passages through zero, angles that go round, and thresholds by bisection.

use crate::error::Error;
use std::f64::consts::TAU;

/// When a number passed zero, between steps by a straight line.
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

    /// From a passage to the next but one of those after the first; not a number before there are three.
    pub(super) fn period(&self) -> f64 {
        match self.times[..] {
            [first, _, third, ..] => third - first,
            _ => f64::NAN,
        }
    }
}

/// An angle that goes round and round [rad]; less than half a turn from look to look.
#[derive(Default)]
pub(super) struct Turns {
    before: Option<f64>,
    /// In all.
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

/// Up to which value something does not happen and from which on it does, between `low` and `high`, by so many halvings;
/// not a number if it happens at the one or does not at the other.
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
