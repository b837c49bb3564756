//! A path search in the manner of PATH.

use super::dictionary::{Dictionary, End};
use super::lemke::solve_lcp as by_lemke;
use crate::methods::forms::{Lcp, groups, times};
use crate::methods::rounds::{Outcome, by_pyramids};
use crate::methods::run::run;
use crate::methods::{Effort, Solution, Status};
use crate::methods::{forms, linear};
use crate::problem::Problem;

/// Newton steps that may be tried from the start, and how many of them may make things worse (the watchdog).
const CRASH: u32 = 20;
const WATCH: u32 = 4;

/// The path search of Ralph (1994) and of Dirkse and Ferris (PATH, 1995) on the normal map
/// `F(x) = M x⁺ + q + x - x⁺`: from a point x the path `F(x(t)) = t F(x)` is followed from `t = 1` to `t = 0`
/// by pivots like Lemke's, with `F(x)` as covering vector.
///
/// For a linear problem the first complete path ends at the solution. Projected Newton steps on the normal
/// map (PATH's crash) approach it first; the watchdog lets a few of them raise the merit `|F|` and then
/// returns to the best point. If a path ends in a ray it is tried again from zero, then by Lemke's method,
/// whose status it then returns. With friction each major iteration linearises it as a pyramid whose axes are
/// those of the slip, and starts from the impulses of the one before; finally Newton's method on the exact
/// cone (see [`newton_fb`](crate::methods::newton_fb)). n² a pivot, few of them after a good start.
pub fn path(problem: &Problem, effort: &Effort) -> Solution {
    run(problem, effort, |run| by_pyramids(run, groups(&run.problem), effort.friction, solve_lcp))
}

/// A point of the normal map as z and w, of which one is zero in each pair, and the rest `F`.
struct Point {
    z: Vec<f64>,
    w: Vec<f64>,
    rest: f64,
}

impl Point {
    fn new(lcp: &Lcp, x: &[f64]) -> Point {
        let z: Vec<f64> = x.iter().map(|x| x.max(0.0)).collect();
        let w: Vec<f64> = x.iter().map(|x| (-x).max(0.0)).collect();
        let moved = times(&lcp.m, &z, &lcp.q);
        let rest = moved.iter().zip(&w).fold(0.0_f64, |sum, (a, b)| sum.hypot(a - b));
        Point { z, w, rest }
    }

    fn active(&self) -> Vec<usize> {
        (0..self.z.len()).filter(|&i| self.z[i] > 0.0).collect()
    }
}

/// The solution of the equations that hold where x is: a Newton step on the normal map.
fn newton(lcp: &Lcp, active: &[usize]) -> Option<Vec<f64>> {
    let right: Vec<f64> = active.iter().map(|&i| -lcp.q[i]).collect();
    let found = linear::solve(&forms::submatrix(&lcp.m, active), &right)?;
    let mut z = vec![0.0; lcp.q.len()];
    active.iter().zip(found).for_each(|(&i, value)| z[i] = value);
    let w = times(&lcp.m, &z, &lcp.q);
    let mut x: Vec<f64> = w.iter().map(|w| -w).collect();
    active.iter().for_each(|&i| x[i] = z[i]);
    Some(x)
}

/// Newton steps from a point: the best that was seen, and how many.
fn crash(lcp: &Lcp, start: &[f64]) -> (Point, u32) {
    let w = times(&lcp.m, start, &lcp.q);
    // z - w is the point whose pair (z, w) this would be if it were complementary.
    let x: Vec<f64> = start.iter().zip(&w).map(|(z, w)| if *z > *w { *z } else { -w }).collect();
    let mut best = Point::new(lcp, &x);
    let (mut active, mut worse, mut steps) = (best.active(), 0, 0);
    while steps < CRASH && worse < WATCH && best.rest > 0.0 {
        let Some(x) = newton(lcp, &active) else { break };
        steps += 1;
        let point = Point::new(lcp, &x);
        let next = point.active();
        let still = next == active;
        active = next;
        if point.rest < best.rest {
            best = point;
            worse = 0;
        } else {
            worse += 1;
        }
        if still {
            break;
        }
    }
    (best, steps)
}

fn solve_lcp(lcp: &Lcp, start: Option<&[f64]>, limit: u32) -> Outcome {
    let (even, _, factors) = lcp.equilibrated();
    let n = lcp.q.len();
    let zeros = vec![0.0; n];
    let start =
        start.map(|start| start.iter().zip(&factors).map(|(z, f)| (z / f).max(0.0)).collect::<Vec<_>>());
    let mut outcome = Outcome { x: zeros.clone(), status: Status::Limit, pivots: 0, iterations: 0 };
    for from in start.iter().chain(std::iter::once(&zeros)) {
        let (point, steps) = crash(&even, from);
        outcome.iterations += steps;
        let active = point.active();
        let Some(mut dictionary) = Dictionary::through(&even, &active, &point.z, &point.w) else { continue };
        outcome.iterations += 1;
        let end = dictionary.descend(limit.saturating_sub(outcome.pivots));
        outcome.pivots += dictionary.pivots;
        let z = dictionary.z();
        if end == End::Solved && even.error(&z) <= 1e-12 {
            outcome.x = z.iter().zip(&factors).map(|(z, f)| z * f).collect();
            outcome.status = Status::Solved;
            return outcome;
        }
    }
    let last = by_lemke(lcp, None, limit.saturating_sub(outcome.pivots));
    Outcome { pivots: outcome.pivots + last.pivots, iterations: outcome.iterations + last.iterations, ..last }
}
