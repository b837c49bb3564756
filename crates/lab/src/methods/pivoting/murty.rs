//! Murty's least-index method.

use crate::methods::forms::{Boxed, groups};
use crate::methods::linear::greatest;
use crate::methods::rounds::{Outcome, by_boxes};
use crate::methods::run::run;
use crate::methods::tableau::Tableau;
use crate::methods::{Effort, Solution, Status};
use crate::problem::{Problem, nearest_within};

/// Bard's method with Murty's rule (1974): among the rows that violate their law, the one with the least
/// index changes sides by a principal pivot, until no row violates its law.
///
/// A pivot costs n². Finite for P-matrices, whatever the start, with 2ⁿ - 1 pivots at worst (Murty 1978).
/// With finite bounds a row that violates one moves to it, and a row that leaves its bound becomes free. A
/// singular principal minor breaks it: then `M + eps D` is solved in proximal rounds, which reach the
/// solution if M is positive semidefinite. Friction as for [`dantzig`](crate::methods::dantzig). A start
/// says which rows begin free.
pub fn murty(problem: &Problem, effort: &Effort) -> Solution {
    run(problem, effort, |run| by_boxes(run, groups(&run.problem), effort.friction, solve_boxed))
}

fn solve_boxed(boxed: &Boxed, start: Option<&[f64]>, limit: u32) -> Outcome {
    let mut sides = Sides::new(boxed, start);
    let mut pivots = 0;
    let mut status = Status::Limit;
    // Brent's detection of a cycle, which occurs only if the matrix is not a P-matrix.
    let mut mark = Vec::new();
    while let Some(values) = sides.values(boxed) {
        let noise = sides.noise;
        let wrong =
            (0..boxed.rows()).find_map(|i| sides.wrong(boxed, i, values[i], noise).map(|side| (i, side)));
        let Some((i, side)) = wrong else {
            status = Status::Solved;
            break;
        };
        if pivots >= limit || !sides.change(i, side) {
            break;
        }
        pivots += 1;
        if sides.sides == mark {
            break;
        }
        if pivots.is_power_of_two() {
            mark.clone_from(&sides.sides);
        }
        if pivots % 100 == 0 && !sides.refactor(boxed) {
            break;
        }
    }
    Outcome { x: sides.x(boxed), status, pivots, iterations: pivots }
}

/// Where a row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Lo,
    Hi,
    Free,
}

struct Sides {
    tableau: Tableau,
    sides: Vec<Side>,
    noise: f64,
}

impl Sides {
    fn new(boxed: &Boxed, start: Option<&[f64]>) -> Sides {
        let n = boxed.rows();
        let mut tableau = Tableau::new(&boxed.m, &boxed.q);
        let free = |i: usize| {
            let inside = start.is_some_and(|x| x[i] > boxed.lo[i] && x[i] < boxed.hi[i]);
            boxed.is_free(i) || inside
        };
        let wanted: Vec<usize> = (0..n).filter(|&i| free(i)).collect();
        tableau.pivot_all(&wanted);
        let side = |i: usize| {
            if tableau.basic[i] {
                Side::Free
            } else if boxed.lo[i].is_finite() && start.is_none_or(|x| x[i] < boxed.hi[i]) {
                Side::Lo
            } else {
                Side::Hi
            }
        };
        let sides = (0..n).map(side).collect();
        Sides { tableau, sides, noise: 1e-13 * greatest(&boxed.q) }
    }

    fn at(&self, boxed: &Boxed, i: usize) -> f64 {
        let bound = if self.sides[i] == Side::Lo { boxed.lo[i] } else { boxed.hi[i] };
        if bound.is_finite() { bound } else { 0.0 }
    }

    fn values(&self, boxed: &Boxed) -> Option<Vec<f64>> {
        let at: Vec<f64> = (0..boxed.rows()).map(|i| self.at(boxed, i)).collect();
        let values = self.tableau.values(&at);
        values.iter().all(|x| x.is_finite()).then_some(values)
    }

    /// The side that row `i` belongs to, if that is another one than it is on; `value` is its x if it is
    /// free, else its w.
    fn wrong(&self, boxed: &Boxed, i: usize, value: f64, noise: f64) -> Option<Side> {
        let (lo, hi) = (boxed.lo[i], boxed.hi[i]);
        match self.sides[i] {
            Side::Free => {
                let noise = noise / boxed.scale(i);
                if value < lo - noise {
                    Some(Side::Lo)
                } else if value > hi + noise {
                    Some(Side::Hi)
                } else {
                    None
                }
            }
            // A redundant row, which can't be free, has no w.
            _ if lo == hi => None,
            Side::Lo if value < -noise => Some(Side::Free),
            Side::Hi if value > noise || boxed.is_free(i) && value < -noise => Some(Side::Free),
            _ => None,
        }
    }

    fn change(&mut self, i: usize, side: Side) -> bool {
        if !self.tableau.can_pivot(i) {
            return false;
        }
        self.tableau.pivot(i);
        self.sides[i] = side;
        true
    }

    fn refactor(&mut self, boxed: &Boxed) -> bool {
        let free: Vec<usize> = (0..boxed.rows()).filter(|&i| self.sides[i] == Side::Free).collect();
        let mut again = Tableau::new(&boxed.m, &boxed.q);
        again.pivot_all(&free);
        if again.basic != self.tableau.basic {
            return false;
        }
        self.tableau = again;
        true
    }

    /// x of these sides, computed anew.
    fn x(&self, boxed: &Boxed) -> Vec<f64> {
        let n = boxed.rows();
        let at: Vec<f64> = (0..n).map(|i| self.at(boxed, i)).collect();
        let values = self.tableau.values(&at);
        let free: Vec<usize> = (0..n).filter(|&i| self.tableau.basic[i]).collect();
        let rough = || (0..n).map(|i| if self.tableau.basic[i] { values[i] } else { at[i] }).collect();
        let x = boxed.with_free(&free, &at).unwrap_or_else(rough);
        (0..n)
            .map(|i| {
                if x[i].is_finite() { nearest_within(x[i], boxed.lo[i], boxed.hi[i]) } else { boxed.bound(i) }
            })
            .collect()
    }
}
