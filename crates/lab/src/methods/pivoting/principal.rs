//! Driving one row at a time until it obeys its law, by principal pivots, while finished rows keep theirs:
//! common parts of Dantzig's and Keller's methods.

use crate::methods::forms::Boxed;
use crate::methods::linear;
use crate::methods::tableau::{SMALL, Tableau};
use crate::problem::nearest_within;

/// Where the increase of a driving variable ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Driven {
    /// The row obeys its law.
    Done,
    /// No row blocks: a ray.
    Ray,
    /// Pivots ran out, or there was no pivot.
    Limit,
}

/// The bound that stops a driven variable.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stop {
    /// w of the driven row is zero.
    Still,
    /// x of the driven row is at a bound.
    Bound(f64),
    /// Another row: its x is at this bound, or its w is zero.
    Other(usize, Option<f64>),
}

/// Values and basis of a boxed problem.
///
/// Invariant: x of a row that isn't basic is at a bound (or where a free row starts); w of a basic one is
/// zero, except for the row that is being driven.
pub(super) struct Principal<'a> {
    boxed: &'a Boxed,
    pub(super) tableau: Tableau,
    pub(super) x: Vec<f64>,
    pub(super) w: Vec<f64>,
    /// Rows that obey their law, and block.
    pub(super) done: Vec<bool>,
    pub(super) pivots: u32,
    since: u32,
}

impl<'a> Principal<'a> {
    pub(super) fn new(boxed: &'a Boxed) -> Principal<'a> {
        let x: Vec<f64> = (0..boxed.rows()).map(|i| boxed.bound(i)).collect();
        Principal {
            boxed,
            tableau: Tableau::new(&boxed.m, &boxed.q),
            w: boxed.w(&x),
            done: vec![false; x.len()],
            x,
            pivots: 0,
            since: 0,
        }
    }

    /// The violation of w given the bound of x; a free row must have w = 0.
    pub(super) fn violation(&self, i: usize) -> f64 {
        let (x, w) = (self.x[i], self.w[i]);
        let (lo, hi) = (self.boxed.lo[i], self.boxed.hi[i]);
        if lo == hi {
            0.0
        } else if w < 0.0 {
            if x < hi { -w } else { 0.0 }
        } else if x > lo {
            w
        } else {
            0.0
        }
    }

    /// Makes x of a row basic if its w is zero, which moves nothing. Rows without bounds must be basic, as
    /// their w has to remain zero.
    pub(super) fn settle(&mut self, i: usize) {
        if self.boxed.is_free(i) && !self.tableau.basic[i] && self.pivotable(i, i) {
            self.tableau.pivot(i);
            self.pivots += 1;
        }
        self.done[i] = true;
    }

    fn pivotable(&self, i: usize, j: usize) -> bool {
        let column = linear::greatest(self.tableau.t.column(j).as_slice());
        let pivot = self.tableau.t[(i, j)].abs();
        pivot > SMALL * column && (self.tableau.basic[j] || pivot > 0.1 * SMALL * self.tableau.size)
    }

    /// Drives row `i` until it obeys its law.
    pub(super) fn drive(&mut self, i: usize, limit: u32) -> Driven {
        let sign = if self.w[i] < 0.0 { 1.0 } else { -1.0 };
        // Number of steps of length zero, and the basis after a power of two of them: if it recurs, they
        // cycle (Brent).
        let (mut idle, mut mark) = (0_u32, Vec::new());
        while self.pivots < limit {
            let Some((length, stop)) = self.reach(i, sign) else { return Driven::Ray };
            idle = if length > 0.0 { 0 } else { idle + 1 };
            if idle > 1 && self.tableau.basic == mark {
                return Driven::Limit;
            }
            if idle.is_power_of_two() {
                mark.clone_from(&self.tableau.basic);
            }
            self.advance(i, sign * length);
            match stop {
                Stop::Still => {
                    self.w[i] = 0.0;
                    if !self.tableau.basic[i] {
                        self.exchange(i);
                    }
                    self.done[i] = true;
                    return Driven::Done;
                }
                Stop::Bound(bound) => {
                    self.x[i] = bound;
                    if self.tableau.basic[i] {
                        self.exchange(i);
                    }
                    self.done[i] = true;
                    return Driven::Done;
                }
                Stop::Other(k, bound) => {
                    match bound {
                        Some(bound) => self.x[k] = bound,
                        None => self.w[k] = 0.0,
                    }
                    if self.pivotable(k, k) {
                        self.exchange(k);
                    } else if self.tableau.pivot_two(i, k) {
                        self.pivots += 1;
                        self.refresh();
                    } else {
                        return Driven::Limit;
                    }
                }
            }
        }
        Driven::Limit
    }

    fn exchange(&mut self, k: usize) {
        self.tableau.pivot(k);
        self.pivots += 1;
        self.refresh();
    }

    /// Computes the tableau anew from time to time, as rounding errors accumulate in it.
    fn refresh(&mut self) {
        self.since += 1;
        let every = (self.x.len() as u32 / 4).max(50);
        if self.since < every {
            return;
        }
        self.since = 0;
        let wanted: Vec<usize> = (0..self.x.len()).filter(|&k| self.tableau.basic[k]).collect();
        let mut again = Tableau::new(&self.boxed.m, &self.boxed.q);
        again.pivot_all(&wanted);
        if again.basic == self.tableau.basic {
            self.tableau = again;
            let fixed: Vec<f64> = (0..self.x.len())
                .map(|k| if self.tableau.basic[k] { self.w[k] } else { self.x[k] })
                .collect();
            // The w of the driven row counts as well, which `values` takes for zero.
            let mut values = self.tableau.values(&fixed);
            for k in (0..self.x.len()).filter(|&k| self.tableau.basic[k] && self.w[k] != 0.0) {
                let column = self.tableau.t.column(k);
                values.iter_mut().zip(column.iter()).for_each(|(value, t)| *value += t * self.w[k]);
            }
            for (k, value) in values.into_iter().enumerate() {
                if self.tableau.basic[k] {
                    self.x[k] = value;
                } else {
                    self.w[k] = value;
                }
            }
        }
    }

    /// How far the nonbasic variable of pair `i` can go, and the bound that stops it.
    fn reach(&self, i: usize, sign: f64) -> Option<(f64, Stop)> {
        let t = self.tableau.t.column(i);
        let small = SMALL * linear::greatest(t.as_slice()).max(f64::MIN_POSITIVE);
        let mut best: Option<(f64, Stop)> = None;
        let mut offer = |length: f64, stop: Stop| {
            let length = length.max(0.0);
            // Among ties the first: the driven row itself, then the least index.
            if length.is_finite() && best.is_none_or(|(least, _)| length < least) {
                best = Some((length, stop));
            }
        };
        let (lo, hi) = (self.boxed.lo[i], self.boxed.hi[i]);
        let bound = |rate: f64, k: usize| if rate > 0.0 { self.boxed.hi[k] } else { self.boxed.lo[k] };
        if self.tableau.basic[i] {
            offer(self.w[i].abs(), Stop::Still);
            let rate = sign * t[i];
            if rate.abs() > small {
                let to = bound(rate, i);
                offer((to - self.x[i]) / rate, Stop::Bound(to));
            }
        } else {
            let rate = sign * t[i];
            // Only towards zero, and only where there will be a pivot.
            if rate * sign > small && self.pivotable(i, i) {
                offer(-self.w[i] / rate, Stop::Still);
            }
            let to = if sign > 0.0 { hi } else { lo };
            offer((to - self.x[i]) * sign, Stop::Bound(to));
        }
        for k in (0..self.x.len()).filter(|&k| k != i && self.done[k]) {
            let rate = sign * t[k];
            if rate.abs() <= small {
                continue;
            }
            if self.tableau.basic[k] {
                let to = bound(rate, k);
                offer((to - self.x[k]) / rate, Stop::Other(k, Some(to)));
            } else if self.boxed.lo[k] < self.boxed.hi[k] {
                let at_lo = self.x[k] <= self.boxed.lo[k];
                if at_lo == (rate < 0.0) {
                    offer(-self.w[k] / rate, Stop::Other(k, None));
                }
            }
        }
        best
    }

    fn advance(&mut self, i: usize, length: f64) {
        if length == 0.0 {
            return;
        }
        let t = self.tableau.t.column(i);
        for k in 0..self.x.len() {
            if self.tableau.basic[k] {
                self.x[k] += t[k] * length;
            } else {
                self.w[k] += t[k] * length;
            }
        }
        if self.tableau.basic[i] {
            self.w[i] += length;
        } else {
            self.x[i] += length;
        }
    }

    /// x of the basis computed anew, if that is better.
    pub(super) fn refined(&self) -> Vec<f64> {
        let free: Vec<usize> = (0..self.x.len()).filter(|&k| self.tableau.basic[k]).collect();
        if let Some(x) = self.boxed.with_free(&free, &self.x) {
            let x: Vec<f64> =
                (0..x.len()).map(|i| nearest_within(x[i], self.boxed.lo[i], self.boxed.hi[i])).collect();
            if self.boxed.error(&x) <= self.boxed.error(&self.x) {
                return x;
            }
        }
        self.x.clone()
    }
}
