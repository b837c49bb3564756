//! Principal pivoting for positive semidefinite matrices.

use super::principal::{Driven, Principal};
use crate::methods::forms::{Boxed, groups};
use crate::methods::linear::greatest;
use crate::methods::rounds::{Outcome, by_boxes};
use crate::methods::run::run;
use crate::methods::{Effort, Solution, Status};
use crate::problem::Problem;

/// The principal pivoting method of Dantzig, Cottle and Keller (Keller 1973; Cottle, Pang, Stone 1992, 4.2):
/// the most violated `w_r` is raised to zero by its `x_r`. A row that blocks on the way is exchanged by a 1x1
/// pivot on its diagonal entry, or if that is zero by a 2x2 pivot together with r, after which `w_r` itself
/// is raised. All rows that are not violated can block.
///
/// A pivot costs n², there are about n; finite for positive semidefinite M, symmetric or not, unless rows
/// block at once again and again. Where nothing blocks the inequalities contradict each other, which a
/// certificate then proves ([`Status::NoSolution`]); for an indefinite M a ray proves nothing. Friction as
/// for [`dantzig`](crate::methods::dantzig).
pub fn keller(problem: &Problem, effort: &Effort) -> Solution {
    run(problem, effort, |run| by_boxes(run, groups(&run.problem), effort.friction, solve_boxed))
}

fn solve_boxed(boxed: &Boxed, _: Option<&[f64]>, limit: u32) -> Outcome {
    let mut state = Principal::new(boxed);
    let n = boxed.rows();
    let noise = 1e-14 * greatest(&boxed.q);
    let mut status = Status::Solved;
    let mut major = 0;
    let mut given_up = vec![false; n];
    for i in (0..n).filter(|&i| boxed.is_free(i)) {
        if state.violation(i) <= noise {
            state.settle(i);
        }
    }
    while state.pivots < limit && major <= 20 * n as u32 + 20 {
        major += 1;
        let mut worst: Option<usize> = None;
        for (i, &given_up) in given_up.iter().enumerate() {
            let violation = state.violation(i);
            state.done[i] = state.tableau.basic[i] || violation <= noise;
            let more = worst.is_none_or(|worst| violation > state.violation(worst));
            if !state.done[i] && !given_up && more {
                worst = Some(i);
            }
        }
        let Some(i) = worst else { break };
        match state.drive(i, limit) {
            Driven::Done => continue,
            Driven::Ray => status = Status::Ray,
            Driven::Limit => status = Status::Limit,
        }
        given_up[i] = true;
        if state.tableau.basic[i] {
            break;
        }
    }
    if (0..n).any(|i| state.violation(i) > noise && !state.tableau.basic[i]) && status == Status::Solved {
        status = Status::Limit;
    }
    Outcome { x: state.refined(), status, pivots: state.pivots, iterations: major }
}
