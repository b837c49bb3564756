//! What every exact method shares: a problem of numbers near one, and the best impulses that were seen.

use super::{Effort, Solution, Status};
use crate::lab::problem::{Law, Matrix, Problem};

/// Stands in for a finite bound that scaling would make infinite.
const MOST: f64 = 1e290;

/// The state of a method at work.
pub(super) struct Run {
    /// The problem with W and q divided by powers of two, so that their greatest numbers are in [1, 2).
    pub problem: Problem,
    pub tolerance: f64,
    /// The norm of q.
    size: f64,
    /// The best impulses that were seen, and their residual.
    pub best: Vec<f64>,
    pub residual: f64,
    /// What may be spent in iterations, or in pivots.
    pub limit: u32,
    pub iterations: u32,
    pub pivots: u32,
    /// How it ends unless the residual says that it is solved.
    pub status: Status,
    /// Whether impulses to start from were given.
    pub warm: bool,
}

impl Run {
    /// Keeps impulses that are better than the best. True once the tolerance is met.
    pub fn consider(&mut self, r: &[f64]) -> bool {
        if r.len() == self.best.len() && r.iter().all(|x| x.is_finite()) {
            // Impulses so great that rounding hides the velocities prove nothing.
            let residual = self.problem.residual(r).relative.max(self.noise(r));
            if residual < self.residual {
                self.residual = residual;
                self.best.copy_from_slice(r);
            }
        }
        self.solved()
    }

    /// What rounding makes of the velocities `W r`, relative to q.
    fn noise(&self, r: &[f64]) -> f64 {
        let rows = (0..r.len()).map(|i| self.problem.w().row(i).map(|(j, w)| (w * r[j]).abs()).sum::<f64>());
        let size = rows.fold(0.0_f64, f64::hypot);
        0.5 * f64::EPSILON * size / self.size
    }

    pub fn solved(&self) -> bool {
        self.residual <= self.tolerance
    }

    /// Pivots that are left.
    pub fn pivots_left(&self) -> u32 {
        self.limit.saturating_sub(self.pivots)
    }

    /// Iterations that are left.
    pub fn iterations_left(&self) -> u32 {
        self.limit.saturating_sub(self.iterations)
    }
}

/// Scales the problem, lets `method` work on it, and tells what it found for the problem as it was.
pub(super) fn run(problem: &Problem, effort: &Effort, method: impl FnOnce(&mut Run)) -> Solution {
    let rows = problem.rows();
    let (by_w, by_q) = (power_of_two(matrix_entries(problem)), power_of_two(problem.q().iter().copied()));
    let zeros = vec![0.0; rows];
    let near_one = scaled(problem, by_w, by_q).unwrap_or_else(|| problem.clone());
    let mut run = Run {
        size: near_one.q().iter().fold(0.0_f64, |size, q| size.hypot(*q)).max(f64::MIN_POSITIVE),
        problem: near_one,
        tolerance: effort.tolerance,
        best: zeros.clone(),
        residual: f64::INFINITY,
        limit: effort.iterations,
        iterations: 0,
        pivots: 0,
        status: Status::Limit,
        warm: false,
    };
    run.consider(&zeros);
    let start = effort.start.as_deref().unwrap_or_default();
    let start: Vec<f64> = start.iter().map(|x| x * by_w / by_q).collect();
    run.warm = start.len() == rows && start.iter().any(|&x| x != 0.0) && start.iter().all(|x| x.is_finite());
    let solved = if run.warm {
        // The caller's start is where the method begins even if zero were better.
        run.residual = f64::INFINITY;
        run.consider(&start)
    } else {
        run.solved()
    };
    if !solved {
        method(&mut run);
    }
    let mut r: Vec<f64> = run.best.iter().map(|x| x * by_q / by_w).collect();
    if r.iter().any(|x| !x.is_finite()) {
        r = zeros;
    }
    let residual = problem.residual(&r).relative;
    let status = if residual <= effort.tolerance && run.solved() { Status::Solved } else { run.status };
    Solution { status, r, iterations: run.iterations, pivots: run.pivots, residual }
}

fn matrix_entries(problem: &Problem) -> impl Iterator<Item = f64> + '_ {
    (0..problem.rows()).flat_map(|i| problem.w().row(i).map(|(_, value)| value))
}

/// The greatest power of two that is not above the greatest absolute value, or one where all are zero.
pub(super) fn power_of_two(values: impl Iterator<Item = f64>) -> f64 {
    let most = values.fold(0.0_f64, |most, x| most.max(x.abs()));
    if most == 0.0 || !most.is_finite() {
        return 1.0;
    }
    f64::from_bits(most.max(f64::MIN_POSITIVE).to_bits() & 0x7ff0_0000_0000_0000)
}

fn scaled(problem: &Problem, by_w: f64, by_q: f64) -> Option<Problem> {
    let bound = |x: f64| if x.is_finite() { (x * by_w / by_q).clamp(-MOST, MOST) } else { x };
    let laws = problem.laws().map(|(_, law)| match law {
        Law::Bounds { min, max } => Law::Bounds { min: bound(min), max: bound(max) },
        law => law,
    });
    let entries =
        (0..problem.rows()).flat_map(|i| problem.w().row(i).map(move |(j, value)| (i, j, value / by_w)));
    let w = Matrix::from_entries(problem.rows(), entries);
    Problem::new(laws.collect(), w, problem.q().iter().map(|x| x / by_q).collect()).ok()
}
