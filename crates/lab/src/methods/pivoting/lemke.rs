//! Lemke's complementary pivoting.

use super::certificate;
use super::dictionary::{Dictionary, End};
use crate::methods::forms;
use crate::methods::forms::{Lcp, groups};
use crate::methods::rounds::{Outcome, by_pyramids};
use crate::methods::run::run;
use crate::methods::{Effort, Solution, Status};
use crate::problem::Problem;

/// Lemke's method (1965) in the form of Cottle, Pang, Stone, *The Linear Complementarity Problem* (1992),
/// 4.4: in `w = M z + q + d t` the artificial `t` covers the negative entries of q, and complementary pivots
/// lower it until it leaves the basis.
///
/// Ties go to `t`, else by the lexicographic rule, so it does not cycle. A pivot costs n², there are 1 to 3 n
/// as a rule and 2ⁿ at worst; the solution is computed anew from its basis with one step of refinement. With
/// friction the problem is a pyramid (`Friction::Box`: bounds of the round before) whose axes turn to the
/// direction of slip round by round, and Newton's method on the exact cone starts from there (see
/// [`newton_fb`](crate::methods::newton_fb)).
///
/// Rays: where M is copositive-plus (positive semidefinite for instance) they mean that the inequalities
/// contradict each other. Then a linear programme finds a proof by Farkas' lemma, and the status is
/// [`Status::NoSolution`]. Else other covering vectors are tried, then `M + eps I`, and at last the status is
/// [`Status::Ray`], which says nothing about solutions. It fails with indefinite M such as those of bimatrix
/// games with the wrong signs, and rounding accumulates over some hundred pivots, so it refactors.
///
/// With a start, the pairs that are positive there are pivoted in first, and `d` covers only what remains
/// negative.
pub fn lemke(problem: &Problem, effort: &Effort) -> Solution {
    run(problem, effort, |run| by_pyramids(run, groups(&run.problem), effort.friction, solve_lcp))
}

/// Solves a linear complementarity problem from a start.
pub(super) fn solve_lcp(lcp: &Lcp, start: Option<&[f64]>, limit: u32) -> Outcome {
    let (even, _, factors) = lcp.equilibrated();
    let n = lcp.q.len();
    let active: Vec<usize> = start.map_or(Vec::new(), |start| (0..n).filter(|&i| start[i] > 0.0).collect());
    let mut outcome = Outcome { x: vec![0.0; n], status: Status::Limit, pivots: 0, iterations: 0 };
    let mut least = f64::INFINITY;
    let tries = std::iter::once(active).chain(std::iter::repeat_n(Vec::new(), COVERS + 3)).enumerate();
    for (attempt, active) in tries {
        if attempt == 1 && start.is_none() {
            continue;
        }
        // Rounding can make a path cycle, so one attempt does not get all pivots.
        let left = limit.saturating_sub(outcome.pivots).min(5000 + 10 * n as u32);
        let shift = if attempt > COVERS { [1e-10, 1e-8, 1e-6][attempt - COVERS - 1] } else { 0.0 };
        let mut shifted = even.clone();
        (0..n).for_each(|i| shifted.m[(i, i)] += shift);
        let mut dictionary = Dictionary::covered(&shifted, &active, &cover(&even, attempt));
        let end = dictionary.descend(left);
        outcome.pivots += dictionary.pivots;
        outcome.iterations += 1;
        let mut z = dictionary.z();
        if shift > 0.0 {
            let active: Vec<usize> = (0..n).filter(|&i| z[i] > 0.0).collect();
            let mut again = Dictionary::covered(&even, &active, &cover(&even, 0));
            again.descend(limit.saturating_sub(outcome.pivots));
            outcome.pivots += again.pivots;
            z = again.z();
        }
        let error = even.error(&z);
        if error < least {
            least = error;
            outcome.x = z.iter().zip(&factors).map(|(z, f)| z * f).collect();
        }
        if least <= 1e-12 {
            outcome.status = Status::Solved;
            return outcome;
        }
        match end {
            End::Ray(_) => outcome.status = Status::Ray,
            _ if outcome.pivots >= limit => return outcome,
            _ => {}
        }
        // The linear programme costs as much as an attempt: it is solved once, before all other covers.
        if attempt <= 1 && outcome.status == Status::Ray && certificate::infeasible(&even) {
            outcome.status = Status::NoSolution;
            return outcome;
        }
    }
    if outcome.status == Status::Ray {
        along_unit_rays(&even, &factors, limit, &mut outcome);
    }
    outcome
}

/// Lemke and Howson's start (1964), for matrices without a diagonal such as those of bimatrix games, whose
/// path from the ray of `t` leads nowhere: from two positive variables, `z_k` and the one whose w it keeps at
/// zero, only the pair k is not complementary.
fn along_unit_rays(lcp: &Lcp, factors: &[f64], limit: u32, outcome: &mut Outcome) {
    let n = lcp.q.len();
    // The least z_k that makes all w positive that it raises, and the row that is zero then.
    let least = |k: usize| {
        let ratios = (0..n).filter(|&i| lcp.m[(i, k)] > 0.0).map(|i| (i, -lcp.q[i] / lcp.m[(i, k)]));
        ratios.fold((k, 0.0), |most: (usize, f64), ratio| if ratio.1 > most.1 { ratio } else { most })
    };
    for k in 0..n.min(20) {
        let mut z = vec![0.0; n];
        let (l, value) = least(k);
        z[k] = value;
        if l == k || lcp.m[(l, l)] != 0.0 {
            continue;
        }
        z[l] = least(l).1;
        let mut w = forms::times(&lcp.m, &z, &lcp.q);
        (w[k], w[l]) = (0.0, 0.0);
        if z[l] <= 0.0 || w.iter().any(|&w| w < 0.0) {
            continue;
        }
        let Some(mut dictionary) = Dictionary::through(lcp, &[k, l], &z, &w) else { continue };
        let end = dictionary.descend(limit.saturating_sub(outcome.pivots));
        outcome.pivots += dictionary.pivots;
        outcome.iterations += 1;
        let z = dictionary.z();
        if end == End::Solved && lcp.error(&z) <= 1e-12 {
            outcome.x = z.iter().zip(factors).map(|(z, f)| z * f).collect();
            outcome.status = Status::Solved;
            return;
        }
    }
}

/// Covering vectors that are tried.
const COVERS: usize = 8;

/// The covering vector of an attempt: ones, then `1 + |q|`, then random numbers in [1, 2), then one row far
/// above the others.
fn cover(lcp: &Lcp, attempt: usize) -> Vec<f64> {
    match attempt {
        0 | 1 => vec![1.0; lcp.q.len()],
        2 => lcp.q.iter().map(|q| 1.0 + q.abs()).collect(),
        _ => {
            let mut state = attempt as u64;
            let mut next = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            };
            let steep = attempt >= 6;
            lcp.q.iter().map(|_| if steep { 1.0 / (0.01 + next()) } else { 1.0 + next() }).collect()
        }
    }
}
