//! Block principal pivoting.

use crate::methods::forms::{Boxed, groups};
use crate::methods::linear::greatest;
use crate::methods::rounds::{Outcome, by_boxes};
use crate::methods::run::run;
use crate::methods::{Effort, Solution, Status};
use crate::problem::{Problem, nearest_within};

/// Rounds that may flip all violated rows without reducing their number.
const PATIENCE: u32 = 10;

/// Block principal pivoting (Júdice, Pires 1994): all rows that violate their law change sides at once, each
/// time with a factorisation of those that are free. If the least number of violated rows does not fall for
/// ten rounds, only the row with the least index changes (Murty's rule) until it does, so that the method is
/// finite for P-matrices.
///
/// 5 to 20 factorisations of k³/3 for k free rows, the cheapest of the exact methods where it works. A
/// singular principal minor breaks it: then `M + eps D` is solved in proximal rounds. Friction as for
/// [`dantzig`](crate::methods::dantzig). A start says which rows begin free.
pub fn block_pivoting(problem: &Problem, effort: &Effort) -> Solution {
    run(problem, effort, |run| by_boxes(run, groups(&run.problem), effort.friction, solve_boxed))
}

/// Where a row is: at its lower bound, at its upper bound, or between with w = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::methods) enum Side {
    Lo,
    Hi,
    Free,
}

/// The initial sides.
pub(in crate::methods) fn sides(boxed: &Boxed, start: Option<&[f64]>) -> Vec<Side> {
    let side = |i: usize| {
        let (lo, hi) = (boxed.lo[i], boxed.hi[i]);
        match start {
            _ if boxed.is_free(i) => Side::Free,
            Some(x) if x[i] > lo && x[i] < hi => Side::Free,
            Some(x) if x[i] >= hi => Side::Hi,
            _ if lo.is_finite() => Side::Lo,
            _ => Side::Hi,
        }
    };
    (0..boxed.rows()).map(side).collect()
}

/// x of these sides; none if singular.
pub(super) fn values(boxed: &Boxed, sides: &[Side]) -> Option<Vec<f64>> {
    let at = |i: usize| match sides[i] {
        Side::Lo => boxed.lo[i],
        Side::Hi => boxed.hi[i],
        Side::Free => 0.0,
    };
    let x: Vec<f64> = (0..boxed.rows()).map(at).collect();
    let free: Vec<usize> = (0..boxed.rows()).filter(|&i| sides[i] == Side::Free).collect();
    boxed.with_free(&free, &x)
}

/// The side that a row belongs to by its values, if it is on another one.
pub(super) fn wrong(boxed: &Boxed, side: Side, i: usize, x: f64, w: f64, noise: f64) -> Option<Side> {
    match side {
        Side::Free if x < boxed.lo[i] - noise / boxed.scale(i) => Some(Side::Lo),
        Side::Free if x > boxed.hi[i] + noise / boxed.scale(i) => Some(Side::Hi),
        Side::Lo if w < -noise && boxed.lo[i] < boxed.hi[i] => Some(Side::Free),
        Side::Hi if w > noise && boxed.lo[i] < boxed.hi[i] => Some(Side::Free),
        _ => None,
    }
}

fn solve_boxed(boxed: &Boxed, start: Option<&[f64]>, limit: u32) -> Outcome {
    let n = boxed.rows();
    let noise = 1e-13 * greatest(&boxed.q);
    let mut sides = sides(boxed, start);
    let (mut patience, mut fewest) = (PATIENCE, usize::MAX);
    let mut outcome = Outcome {
        x: (0..n).map(|i| boxed.bound(i)).collect(),
        status: Status::Limit,
        pivots: 0,
        iterations: 0,
    };
    // Brent's detection of a cycle of Murty's rule, which occurs only if the matrix is not a P-matrix.
    let (mut mark, mut singles) = (Vec::new(), 0_u32);
    while outcome.iterations < limit {
        outcome.iterations += 1;
        let Some(x) = values(boxed, &sides) else { break };
        let w = boxed.w(&x);
        let moves: Vec<(usize, Side)> = (0..n)
            .filter_map(|i| wrong(boxed, sides[i], i, x[i], w[i], noise).map(|side| (i, side)))
            .collect();
        outcome.x = (0..n).map(|i| nearest_within(x[i], boxed.lo[i], boxed.hi[i])).collect();
        if moves.is_empty() {
            outcome.status = Status::Solved;
            break;
        }
        if moves.len() < fewest {
            fewest = moves.len();
            patience = PATIENCE;
            singles = 0;
            mark.clear();
        } else {
            patience = patience.saturating_sub(1);
        }
        let taken = if patience > 0 { &moves[..] } else { &moves[..1] };
        if patience == 0 {
            if sides == mark {
                break;
            }
            singles += 1;
            if singles.is_power_of_two() {
                mark.clone_from(&sides);
            }
        }
        for &(i, side) in taken {
            sides[i] = side;
            outcome.pivots += 1;
        }
    }
    outcome
}
