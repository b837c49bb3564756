//! The status of a result: what every method's outcome passes through.

use super::{Effort, Solution, Status};
use crate::problem::Problem;

/// What a method found, before it is checked.
pub(super) struct Claim {
    pub(super) r: Vec<f64>,
    /// How the method ended, [`Status::Ray`] or not.
    pub(super) ray: bool,
    /// What may prove that there is no solution.
    pub(super) proof: Option<Vec<f64>>,
    pub(super) iterations: u32,
    pub(super) pivots: u32,
}

impl Claim {
    /// The solution with the status that the problem itself confirms: `Solved` only by the residual of the
    /// impulses that are returned, in twice the precision of `f64`, and `NoSolution` only by a proof that
    /// holds.
    pub(super) fn judged(self, problem: &Problem, effort: &Effort) -> Solution {
        let residual = problem.residual(&self.r).relative.min(f64::MAX);
        let status = if residual <= effort.tolerance {
            Status::Solved
        } else if self.proof.is_some_and(|proof| problem.is_contradicted_by(&proof)) {
            Status::NoSolution
        } else if self.ray {
            Status::Ray
        } else {
            Status::Limit
        };
        Solution { status, r: self.r, iterations: self.iterations, pivots: self.pivots, residual }
    }
}
