//! Newton's method on the Fischer-Burmeister function, and on Alart and Curnier's equations.

use super::cone_newton;
use crate::methods::forms::{Boxed, groups};
use crate::methods::linear::greatest;
use crate::methods::rounds::{Outcome, by_boxes};
use crate::methods::run::run;
use crate::methods::{Effort, Friction, Solution, Status};
use crate::problem::Problem;
use nalgebra::{DMatrix, DVector};

/// Semismooth Newton on `phi(x - lo, phi(hi - x, -w))` with `phi(a, b) = a + b - hypot(a, b)` (Fischer 1992;
/// bounds: Billups 1995) for problems without friction. Globalised: Armijo's rule on `|phi|² / 2` (halving,
/// 1e-3), the steepest descent where Newton's step does not descend or there is none. n³/3 an iteration, 5 to
/// 20 of them, quadratic at the end; once the sides of all rows are clear one solve with them gives the exact
/// values. If M is not a P0-matrix it may end in a stationary point that is no solution.
///
/// With friction: Alart's and Curnier's equations (1991) with `rho_n = 1/W_nn`, `rho_t = 1/lambda_max(W_tt)`
/// instead, from the start or from some sweeps of projected Gauss-Seidel. W is singular wherever a body has
/// redundant supports, so that a proximal term is added to it which falls with the residual. Newton's steps
/// are not shortened unless the equations get ten times worse; if they stagnate, more sweeps give another
/// start. With `Friction::Box` or `Friction::Pyramid` as for [`dantzig`](crate::methods::dantzig).
pub fn newton_fb(problem: &Problem, effort: &Effort) -> Solution {
    run(problem, effort, |run| {
        let groups = groups(&run.problem);
        if groups.is_empty() || effort.friction != Friction::Cone {
            return by_boxes(run, groups, effort.friction, solve_boxed);
        }
        if !run.warm {
            let mut r = run.best.clone();
            let count = run.iterations_left().min(10);
            cone_newton::sweeps(&run.problem, &mut r, count, 1.0);
            run.iterations += count;
            run.consider(&r);
        }
        cone_newton::search(run);
    })
}

/// Fischer and Burmeister's function and its two derivatives; at the kink, the derivatives in the direction
/// in which both grow.
fn phi(a: f64, b: f64) -> (f64, f64, f64) {
    if a == f64::INFINITY {
        return (b, 0.0, 1.0);
    }
    let length = a.hypot(b);
    if length < 1e-14 {
        let part = 1.0 - std::f64::consts::FRAC_1_SQRT_2;
        return (a + b - length, part, part);
    }
    // Without cancellation where both are positive.
    let value = if a + b > 0.0 { 2.0 * a * b / (a + b + length) } else { a + b - length };
    (value, 1.0 - a / length, 1.0 - b / length)
}

/// phi of all rows as velocities, with its derivatives by s x and by w.
fn values(boxed: &Boxed, x: &[f64], w: &[f64]) -> Vec<(f64, f64, f64)> {
    let row = |i: usize| {
        let s = boxed.scale(i);
        let (lo, hi) = (s * (x[i] - boxed.lo[i]), s * (boxed.hi[i] - x[i]));
        if boxed.lo[i] == boxed.hi[i] {
            return (lo, 1.0, 0.0);
        }
        // With the lower bound infinite phi(a, b) is b.
        let (inner, by_hi, by_w) = phi(hi, -w[i]);
        let (value, by_lo, by_inner) = phi(lo, -inner);
        (value, by_lo + by_inner * by_hi, by_inner * by_w)
    };
    (0..x.len()).map(row).collect()
}

fn merit(values: &[(f64, f64, f64)]) -> f64 {
    0.5 * values.iter().map(|v| v.0 * v.0).sum::<f64>()
}

fn jacobian(boxed: &Boxed, values: &[(f64, f64, f64)]) -> DMatrix<f64> {
    let n = boxed.rows();
    let mut j = DMatrix::from_fn(n, n, |i, k| values[i].2 * boxed.m[(i, k)]);
    (0..n).for_each(|i| j[(i, i)] += values[i].1 * boxed.scale(i));
    j
}

fn solve_boxed(boxed: &Boxed, start: Option<&[f64]>, limit: u32) -> Outcome {
    let n = boxed.rows();
    let bound = |i: usize| boxed.bound(i);
    let mut x: Vec<f64> = start.map_or_else(|| (0..n).map(bound).collect(), <[f64]>::to_vec);
    let goal = 1e-13 * greatest(&boxed.q);
    let mut outcome = Outcome { x: x.clone(), status: Status::Limit, pivots: 0, iterations: 0 };
    let mut least = boxed.error(&x);
    while outcome.iterations < limit.min(200) {
        let w = boxed.w(&x);
        for candidate in
            std::iter::once(x.clone()).chain((outcome.iterations > 0).then(|| boxed.snapped(&x)).flatten())
        {
            let error = boxed.error(&candidate);
            if error < least {
                least = error;
                outcome.x = candidate;
            }
        }
        if least <= goal {
            break;
        }
        outcome.iterations += 1;
        let all = values(boxed, &x, &w);
        let now = merit(&all);
        let j = jacobian(boxed, &all);
        let f = DVector::from_iterator(n, all.iter().map(|v| v.0));
        let gradient = j.transpose() * &f;
        let newton = j.lu().solve(&(-&f)).filter(|dx| dx.iter().all(|x| x.is_finite()));
        let descends = |dx: &DVector<f64>| gradient.dot(dx) < -1e-12 * gradient.norm() * dx.norm();
        let dx = newton.filter(descends).unwrap_or_else(|| -&gradient);
        let slope = gradient.dot(&dx);
        if slope.is_nan() || slope > -1e-28 * now.max(f64::MIN_POSITIVE) {
            break;
        }
        let mut share = 1.0;
        let mut found = false;
        for _ in 0..50 {
            let next: Vec<f64> = x.iter().zip(dx.iter()).map(|(x, dx)| x + share * dx).collect();
            if merit(&values(boxed, &next, &boxed.w(&next))) <= now + 1e-3 * share * slope {
                x = next;
                found = true;
                break;
            }
            share *= 0.5;
        }
        if !found {
            break;
        }
    }
    if least <= 10.0 * goal {
        outcome.status = Status::Solved;
    }
    outcome
}
