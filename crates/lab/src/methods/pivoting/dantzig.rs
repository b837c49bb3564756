//! Dantzig's incremental pivoting, as Baraff used it for contacts.

use super::principal::{Driven, Principal};
use crate::methods::forms::{Boxed, groups};
use crate::methods::linear::greatest;
use crate::methods::rounds::{Outcome, by_boxes};
use crate::methods::run::run;
use crate::methods::{Effort, Solution, Status};
use crate::problem::Problem;

/// Dantzig's method (Cottle, Dantzig 1968; Baraff 1994) for `lo <= x <= hi`: one row after the other is
/// driven until it obeys its law, while those before it keep theirs and change sides as they must. Rows
/// without bounds come first, then the others in their order, friction last.
///
/// A pivot costs n², there are about 2 n; exact, and finite where M is positive semidefinite and no two rows
/// block at once. A row that is redundant, as those of a box on four points are, has no pivot: it stays
/// nonbasic with `w = 0`, which remains so for such a matrix; the other rows move, until one of them reaches
/// its bound.
///
/// Friction: the bounds `±mu N` are those of the previous round (staggered, Panagiotopoulos 1975); the first
/// round is frictionless. Axes follow the slip, and Newton's method on the exact cone finishes (see
/// [`newton_fb`](crate::methods::newton_fb)); with `Friction::Box` the axes stay and there is no Newton,
/// with `Friction::Pyramid` it solves the pyramid's linear complementarity problem. A start gives the first
/// bounds only. It fails for indefinite M, for which no pivot may be found.
pub fn dantzig(problem: &Problem, effort: &Effort) -> Solution {
    run(problem, effort, |run| by_boxes(run, groups(&run.problem), effort.friction, solve_boxed))
}

fn solve_boxed(boxed: &Boxed, _: Option<&[f64]>, limit: u32) -> Outcome {
    let mut state = Principal::new(boxed);
    let n = boxed.rows();
    let noise = 1e-14 * greatest(&boxed.q);
    // Bounds that are finite on both sides are friction's as a rule.
    let rank = |i: usize| (!boxed.is_free(i), boxed.lo[i].is_finite() && boxed.hi[i].is_finite());
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by_key(|&i| rank(i));
    let mut status = Status::Solved;
    for i in order {
        if state.violation(i) <= noise {
            state.settle(i);
            continue;
        }
        match state.drive(i, limit) {
            Driven::Done => {}
            Driven::Ray => status = Status::Ray,
            Driven::Limit => status = Status::Limit,
        }
        if state.pivots >= limit {
            break;
        }
        // A row that could not be driven is skipped; the others may still be solved.
        if !state.done[i] && state.tableau.basic[i] {
            break;
        }
    }
    Outcome { x: state.refined(), status, pivots: state.pivots, iterations: 1 }
}
