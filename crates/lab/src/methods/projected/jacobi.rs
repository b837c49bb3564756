//! Projected Jacobi.

use super::pgs::limit;
use super::sweep::{iterate_shaped, pressure};
use crate::methods::{Effort, Solution};
use crate::problem::{Law, Problem, nearest_within};

/// Projected Jacobi: all rows move at once, by the velocities before the sweep. A step is `1 / sum_j |W_ij|`:
/// the more contacts a body has, the less each of them may do alone (mass splitting does the same: Tonge,
/// Benevolenski and Voroshilov 2012).
///
/// Converges for symmetric, positive semidefinite W, several times slower than
/// [`pgs`](crate::methods::pgs); its rows are independent, so that it can run on as many lanes or
/// threads as there are. A sweep costs a multiplication by W. Friction as for `pgs`.
pub fn jacobi(problem: &Problem, effort: &Effort) -> Solution {
    let scale: Vec<f64> = (0..problem.rows()).map(|i| row_sum(problem, i)).collect();
    let mut u = vec![0.0; problem.rows()];
    iterate_shaped(problem, effort, |r| {
        for (i, u) in u.iter_mut().enumerate() {
            *u = problem.w().dot(i, r) + problem.q()[i];
        }
        for (first, law) in problem.laws() {
            match law {
                Law::Bounds { min, max } => {
                    r[first] = nearest_within(r[first] - u[first] / scale[first], min, max);
                }
                Law::Contact { mu } => {
                    r[first] = (r[first] - u[first] / scale[first]).max(0.0);
                    let scale = scale[first + 1].max(scale[first + 2]);
                    let own = [first + 1, first + 2].map(|row| r[row] - u[row] / scale);
                    let own = limit(own, mu * r[first], effort.friction);
                    r[first + 1..first + 3].copy_from_slice(&own);
                }
                Law::Patch { mu, arm, first: normals, count } => {
                    let most = mu * pressure(r, normals, count);
                    let both = scale[first].max(scale[first + 1]);
                    let own = [first, first + 1].map(|row| r[row] - u[row] / both);
                    r[first..first + 2].copy_from_slice(&limit(own, most, effort.friction));
                    let twist = first + 2;
                    r[twist] = nearest_within(r[twist] - u[twist] / scale[twist], -arm * most, arm * most);
                }
            }
        }
    })
}

/// The sum of a row's absolute values [1/kg], or one for a row without any.
fn row_sum(problem: &Problem, row: usize) -> f64 {
    let sum: f64 = problem.w().row(row).map(|(_, x)| x.abs()).sum();
    if sum > 0.0 && sum.is_finite() { sum } else { problem.scale(row) }
}

#[cfg(test)]
mod tests {
    use crate::methods::tests::{check_contacts, check_rows};

    #[test]
    fn it_finds_what_is_known() {
        check_rows(super::jacobi);
        check_contacts(super::jacobi);
    }
}
