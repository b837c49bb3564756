//! The proximal map as a fixed point.

use super::sweep::{iterate, pressure};
use crate::methods::{Effort, Solution};
use crate::problem::{Law, Problem, nearest_within, project_cone, project_disc};

/// The least and the greatest step, relative to that of the diagonal of W.
const STEPS: (f64, f64) = (1e-3, 1.5);

/// The proximal fixed point (Erleben 2017; Studer 2009) in Gauss-Seidel's order:
/// `r_c <- P(r_c - R_c (u_c + s_c))`, with P onto the cone and s De Saxcé's shift `mu |u_t|`. Each law has a
/// step R of its own that shrinks when the law swings, that is, when its change points against that of the
/// sweep before, and grows slowly otherwise.
///
/// Robust and slow; a sweep costs a multiplication by W. All laws are exact at the fixed point.
pub fn prox(problem: &Problem, effort: &Effort) -> Solution {
    let weight = reach(problem);
    let mut step = vec![STEPS.1; problem.laws().len()];
    let mut last = vec![0.0; problem.rows()];
    iterate(problem, effort, |r| {
        for (index, (first, law)) in problem.laws().enumerate() {
            let (mut old, mut u) = ([0.0; 3], [0.0; 3]);
            for i in 0..law.rows() {
                old[i] = r[first + i];
                u[i] = problem.w().dot(first + i, r) + problem.q()[first + i];
            }
            solve(first, law, step[index], &weight, u, r);
            let mut turned = 0.0;
            for (row, old) in (first..first + law.rows()).zip(old) {
                turned += (r[row] - old) * last[row];
                last[row] = r[row] - old;
            }
            let factor = if turned < 0.0 { 0.8 } else { 1.05 };
            step[index] = nearest_within(step[index] * factor, STEPS.0, STEPS.1);
        }
    })
}

/// For each row the greatest absolute row sum within the block of its law, an upper bound of the block's
/// eigenvalues [1/kg].
fn reach(problem: &Problem) -> Vec<f64> {
    let mut reach = vec![0.0; problem.rows()];
    for (first, law) in problem.laws() {
        let rows = first..first + law.rows();
        let sum = |i: usize| rows.clone().map(|j| problem.w().at(i, j).abs()).sum::<f64>();
        let most = rows.clone().map(sum).fold(0.0, f64::max);
        let usable = most > 0.0 && most.is_finite();
        reach[rows].fill(if usable { most } else { problem.scale(first) });
    }
    reach
}

fn solve(first: usize, law: Law, step: f64, weight: &[f64], u: [f64; 3], r: &mut [f64]) {
    let moved = |row: usize, u: f64, r: &[f64]| r[row] - step * u / weight[row];
    match law {
        Law::Bounds { min, max } => r[first] = nearest_within(moved(first, u[0], r), min, max),
        Law::Contact { mu } => {
            let normal = u[0] + mu * (u[1] * u[1] + u[2] * u[2]).sqrt();
            let own = [moved(first, normal, r), moved(first + 1, u[1], r), moved(first + 2, u[2], r)];
            r[first..first + 3].copy_from_slice(&project_cone(own, mu));
        }
        Law::Patch { mu, arm, first: normals, count } => {
            let most = mu * pressure(r, normals, count);
            let own = project_disc([moved(first, u[0], r), moved(first + 1, u[1], r)], most);
            r[first..first + 2].copy_from_slice(&own);
            r[first + 2] = nearest_within(moved(first + 2, u[2], r), -arm * most, arm * most);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::methods::tests::{check_contacts, check_rows};

    #[test]
    fn it_finds_what_is_known() {
        check_rows(super::prox);
        check_contacts(super::prox);
    }
}
