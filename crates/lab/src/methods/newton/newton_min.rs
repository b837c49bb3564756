//! Newton's method on the minimum map.

use crate::methods::forms;
use crate::methods::forms::{Boxed, groups, submatrix};
use crate::methods::linear::greatest;
use crate::methods::pivoting::block_pivoting::{Side, sides};
use crate::methods::rounds::{Outcome, by_boxes};
use crate::methods::run::run;
use crate::methods::{Effort, Solution, Status};
use crate::problem::{Problem, nearest_within};
use nalgebra::DVector;

/// Semismooth Newton on `H(x) = x - P(x - w / s) = 0`, which for `x >= 0` is `min(x, w / s)` with the
/// diagonal as `s`: where `w / s` is the lesser `w = 0` is linearised, elsewhere x goes to its bound. This is
/// the primal-dual active set method (Hintermüller, Ito, Kunisch 2002), globalised by halving the step while
/// `|H|²` does not fall (Erleben 2013).
///
/// Each iteration factorises the free rows, k³/3; 5 to 20 of them, the last few quadratic (for a linear
/// problem the last one is exact). It may cycle between active sets, or end in a minimum of `|H|` that is no
/// solution, and singular rows break it. For positive semidefinite M, proximal rounds with `M + eps D` repair
/// all of that. Friction as for [`dantzig`](crate::methods::dantzig). It begins at the start, if one is
/// given.
pub fn newton_min(problem: &Problem, effort: &Effort) -> Solution {
    run(problem, effort, |run| by_boxes(run, groups(&run.problem), effort.friction, solve_boxed))
}

/// The minimum map, as a velocity, and the side of each row.
fn map(boxed: &Boxed, x: &[f64], sides: &mut [Side]) -> Vec<f64> {
    let w = boxed.w(x);
    let entry = |i: usize| {
        let s = boxed.scale(i);
        let to = x[i] - w[i] / s;
        if to <= boxed.lo[i] {
            (Side::Lo, s * (x[i] - boxed.lo[i]))
        } else if to >= boxed.hi[i] {
            (Side::Hi, s * (x[i] - boxed.hi[i]))
        } else {
            (Side::Free, w[i])
        }
    };
    let entries = (0..x.len()).map(|i| {
        let (side, h) = entry(i);
        sides[i] = side;
        h
    });
    entries.collect()
}

fn size(h: &[f64]) -> f64 {
    h.iter().fold(0.0, |sum: f64, h| sum.hypot(*h))
}

/// The step that solves the linearised map; none if singular.
fn step(boxed: &Boxed, x: &[f64], h: &[f64], sides: &[Side]) -> Option<Vec<f64>> {
    let mut dx: Vec<f64> =
        (0..x.len()).map(|i| if sides[i] == Side::Free { 0.0 } else { -h[i] / boxed.scale(i) }).collect();
    let free: Vec<usize> = (0..x.len()).filter(|&i| sides[i] == Side::Free).collect();
    let zeros = vec![0.0; x.len()];
    let moved = forms::times(&boxed.m, &dx, &zeros);
    let right = DVector::from_iterator(free.len(), free.iter().map(|&i| -h[i] - moved[i]));
    if !free.is_empty() {
        let lu = submatrix(&boxed.m, &free).lu();
        let found = lu.solve(&right)?;
        free.iter().zip(found.iter()).for_each(|(&i, &value)| dx[i] = value);
    }
    dx.iter().all(|x| x.is_finite()).then_some(dx)
}

/// Projected Gauss-Seidel.
fn sweep(boxed: &Boxed, x: &mut [f64], count: u32) {
    for _ in 0..count {
        for i in 0..x.len() {
            let w: f64 = boxed.q[i] + boxed.m.row(i).iter().zip(x.iter()).map(|(m, x)| m * x).sum::<f64>();
            x[i] = nearest_within(x[i] - w / boxed.scale(i), boxed.lo[i], boxed.hi[i]);
        }
    }
}

fn solve_boxed(boxed: &Boxed, start: Option<&[f64]>, limit: u32) -> Outcome {
    let n = boxed.rows();
    let mut sides = sides(boxed, start);
    let bound = |i: usize| boxed.bound(i);
    let mut x: Vec<f64> = start.map_or_else(|| (0..n).map(bound).collect(), <[f64]>::to_vec);
    let goal = 1e-14 * greatest(&boxed.q);
    let mut outcome = Outcome { x: x.clone(), status: Status::Limit, pivots: 0, iterations: 0 };
    let mut least = f64::INFINITY;
    let (mut idle, mut restarts) = (0, 5);
    while outcome.iterations < limit {
        let h = map(boxed, &x, &mut sides);
        let now = size(&h);
        if now < least {
            idle = if now < 0.9 * least { 0 } else { idle + 1 };
            least = now;
            outcome.x.clone_from(&x);
        } else {
            idle += 1;
        }
        if now <= goal {
            break;
        }
        outcome.iterations += 1;
        let dx = if idle > 15 { None } else { step(boxed, &x, &h, &sides) };
        let Some(dx) = dx else {
            // A cycle, a local minimum or a singular block: continue from the result of some sweeps.
            if restarts == 0 {
                break;
            }
            restarts -= 1;
            idle = 0;
            x.clone_from(&outcome.x);
            sweep(boxed, &mut x, 20);
            continue;
        };
        let mut share = 1.0;
        let mut other = sides.clone();
        let mut next: Vec<f64> = Vec::new();
        // Full steps find the active set of most problems although the map grows at first, so steps are
        // halved only later.
        let tries = if outcome.iterations <= 10 { 1 } else { 20 };
        for _ in 0..tries {
            next = x.iter().zip(&dx).map(|(x, dx)| x + share * dx).collect();
            if size(&map(boxed, &next, &mut other)) <= (1.0 - 1e-3 * share) * now {
                break;
            }
            share *= 0.5;
        }
        x = next;
        if x.iter().any(|x| !x.is_finite()) {
            break;
        }
    }
    if least <= 1e3 * goal {
        outcome.status = Status::Solved;
    }
    outcome
}
