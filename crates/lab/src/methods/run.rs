//! Common parts of the exact methods: a problem scaled to numbers near one, and the best impulses so far.

use super::pivoting::certificate;
use super::verdict::Claim;
use super::{Effort, Solution, Status};
use crate::problem::{Law, Matrix, Problem, power_of_two};

/// Stands in for a finite bound that scaling would make infinite.
const MAX_MAGNITUDE: f64 = 1e290;

/// The state of a method at work.
pub(super) struct Run {
    /// The problem with W and q divided by powers of two, so that their greatest numbers are in [1, 2).
    pub(super) problem: Problem,
    pub(super) tolerance: f64,
    /// The best impulses so far, and their residual.
    pub(super) best: Vec<f64>,
    pub(super) residual: f64,
    /// The limit of iterations, or of pivots.
    pub(super) limit: u32,
    pub(super) iterations: u32,
    pub(super) pivots: u32,
    /// The status at the end unless the residual says that it is solved.
    pub(super) status: Status,
    /// Whether impulses to start from were given.
    pub(super) warm: bool,
    /// A proof that there is no solution; none within if none was found.
    proof: Option<Option<Vec<f64>>>,
}

impl Run {
    /// Keeps impulses that are better than the best. True once the tolerance is met.
    pub(super) fn consider(&mut self, r: &[f64]) -> bool {
        if r.len() == self.best.len() && r.iter().all(|x| x.is_finite()) {
            let residual = self.problem.residual(r).relative;
            if residual < self.residual {
                self.residual = residual;
                self.best.copy_from_slice(r);
            }
        }
        self.solved()
    }

    pub(super) fn solved(&self) -> bool {
        self.residual <= self.tolerance
    }

    /// Whether there is a proof that there is no solution. It is searched for once.
    pub(super) fn is_contradicted(&mut self) -> bool {
        self.proof.get_or_insert_with(|| certificate::contradiction(&self.problem)).is_some()
    }

    /// Pivots that are left.
    pub(super) fn pivots_left(&self) -> u32 {
        self.limit.saturating_sub(self.pivots)
    }

    /// Iterations that are left.
    pub(super) fn iterations_left(&self) -> u32 {
        self.limit.saturating_sub(self.iterations)
    }
}

/// Lets `method` solve each independent part of the problem (parts that no entry of W and no friction
/// couples), scaled, and returns the solution of the original problem. Each part may spend the whole effort;
/// pivots are summed, iterations are the maximum.
pub(super) fn run(problem: &Problem, effort: &Effort, method: impl Fn(&mut Run)) -> Solution {
    let size = norm(problem.q());
    let parts = parts(problem);
    let share = (parts.len().max(1) as f64).sqrt();
    let start = effort.start.as_deref().filter(|start| start.len() == problem.rows());
    let mut r = vec![0.0; problem.rows()];
    let (mut ray, mut proof, mut iterations, mut pivots) = (false, None, 0, 0);
    for rows in &parts {
        let part = if parts.len() == 1 { problem.clone() } else { restricted(problem, rows) };
        // The share of a common tolerance: parts that are nearly at rest needn't be more exact than the
        // others.
        let fair = (size / norm(part.q()).max(f64::MIN_POSITIVE) / share).max(1.0);
        let tolerance = effort.tolerance * if parts.len() == 1 { 1.0 } else { 0.7 * fair };
        let start = start.map(|start| rows.iter().map(|&i| start[i]).collect::<Vec<f64>>());
        let run = run_part(&part, tolerance, start, effort.iterations, &method);
        rows.iter().zip(run.best).for_each(|(&i, x)| r[i] = x);
        iterations = iterations.max(run.iterations);
        pivots += run.pivots;
        ray |= run.status == Status::Ray;
        // That a part has no solution proves that the whole has none.
        if let (None, Some(part)) = (&proof, run.proof.flatten()) {
            let mut y = vec![0.0; problem.rows()];
            rows.iter().zip(part).for_each(|(&i, part)| y[i] = part);
            proof = Some(y);
        }
    }
    Claim { r, ray, proof, iterations, pivots }.judged(problem, effort)
}

/// One part, with the impulses as they are in the problem.
fn run_part(
    problem: &Problem,
    tolerance: f64,
    start: Option<Vec<f64>>,
    limit: u32,
    method: impl Fn(&mut Run),
) -> Run {
    let rows = problem.rows();
    let (by_w, by_q) = (power_of_two(matrix_entries(problem)), power_of_two(problem.q().iter().copied()));
    let near_one = scaled(problem, by_w, by_q).unwrap_or_else(|| problem.clone());
    let mut run = Run {
        problem: near_one,
        // A tolerance of one would be met by zero impulses.
        tolerance: tolerance.min(0.5),
        best: vec![0.0; rows],
        residual: f64::INFINITY,
        limit,
        iterations: 0,
        pivots: 0,
        status: Status::Limit,
        warm: false,
        proof: None,
    };
    let start: Vec<f64> = start.unwrap_or_default().iter().map(|x| x * by_w / by_q).collect();
    run.warm = start.len() == rows && start.iter().any(|&x| x != 0.0) && start.iter().all(|x| x.is_finite());
    run.consider(&vec![0.0; rows]);
    let cold = run.residual;
    if run.warm {
        run.residual = f64::INFINITY;
        run.consider(&start);
        // From a start far worse than zero no method recovers, because of rounding.
        run.warm = run.residual <= 1e3 * cold.max(run.tolerance);
        if !run.warm {
            run.best.fill(0.0);
            run.residual = cold;
        }
    }
    if !run.solved() {
        method(&mut run);
    }
    if run.solved() {
        run.status = Status::Solved;
    } else if limit > 0 {
        run.is_contradicted();
    }
    run.best.iter_mut().for_each(|x| *x = *x * by_q / by_w);
    if run.best.iter().any(|x| !x.is_finite()) {
        run.best.fill(0.0);
    }
    run
}

fn norm(values: &[f64]) -> f64 {
    values.iter().fold(0.0_f64, |norm, x| norm.hypot(*x))
}

/// The rows of each part of a problem, in ascending order.
fn parts(problem: &Problem) -> Vec<Vec<usize>> {
    let n = problem.rows();
    let mut parent: Vec<usize> = (0..n).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    let mut join = |a: usize, b: usize| {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        // The least row is the root.
        parent[a.max(b)] = a.min(b);
    };
    for i in 0..n {
        problem.w().row(i).filter(|entry| entry.1 != 0.0).for_each(|(j, _)| join(i, j));
    }
    for (first, law) in problem.laws() {
        (first..first + law.rows()).for_each(|i| join(first, i));
        if let Law::Patch { first: normals, count, .. } = law {
            (normals..normals + count).for_each(|i| join(first, i));
        }
    }
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let mut place = vec![usize::MAX; n];
    for i in 0..n {
        let root = root(&mut parent, i);
        if root == i {
            place[i] = parts.len();
            parts.push(Vec::new());
        }
        parts[place[root]].push(i);
    }
    parts
}

/// The problem of one part. The normals of a patch remain in sequence, as all of them are of its part.
fn restricted(problem: &Problem, rows: &[usize]) -> Problem {
    let place = |i: usize| rows.binary_search(&i).ok();
    let laws = problem.laws().filter(|(first, _)| place(*first).is_some()).map(|(_, law)| match law {
        Law::Patch { mu, arm, first, count } => {
            Law::Patch { mu, arm, first: place(first).unwrap_or(0), count }
        }
        law => law,
    });
    let entries = rows
        .iter()
        .enumerate()
        .flat_map(|(k, &i)| problem.w().row(i).filter_map(move |(j, value)| place(j).map(|j| (k, j, value))));
    let w = Matrix::from_entries(rows.len(), entries.collect::<Vec<_>>());
    let q = rows.iter().map(|&i| problem.q()[i]).collect();
    Problem::new(laws.collect(), w, q).unwrap_or_else(|_| problem.clone())
}

fn matrix_entries(problem: &Problem) -> impl Iterator<Item = f64> + '_ {
    (0..problem.rows()).flat_map(|i| problem.w().row(i).map(|(_, value)| value))
}

fn scaled(problem: &Problem, by_w: f64, by_q: f64) -> Option<Problem> {
    let bound =
        |x: f64| if x.is_finite() { (x * by_w / by_q).clamp(-MAX_MAGNITUDE, MAX_MAGNITUDE) } else { x };
    let laws = problem.laws().map(|(_, law)| match law {
        Law::Bounds { min, max } => Law::Bounds { min: bound(min), max: bound(max) },
        law => law,
    });
    let entries =
        (0..problem.rows()).flat_map(|i| problem.w().row(i).map(move |(j, value)| (i, j, value / by_w)));
    let w = Matrix::from_entries(problem.rows(), entries);
    Problem::new(laws.collect(), w, problem.q().iter().map(|x| x / by_q).collect()).ok()
}
