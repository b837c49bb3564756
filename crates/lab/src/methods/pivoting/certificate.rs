//! The search for proofs that a problem has no solution.

use super::dictionary::{Dictionary, End};
use crate::methods::forms::Lcp;
use crate::methods::linear::greatest;
use crate::problem::{Law, Matrix, Problem};
use nalgebra::{DMatrix, DVector};

/// No proof is searched for more inequalities.
const MAX_ROWS: usize = 400;
/// Entries of a ray below this share of the greatest are rounding.
const TINY: f64 = 1e-9;

/// A proof that a problem has no solution ([`Problem::is_contradicted_by`]), if one is found: from the
/// inequalities `u >= 0` of normals and rows with one bound, and the equations of rows without bounds, in
/// impulses of these rows alone. Where W is positive semidefinite this finds all proofs that there are, since
/// then `W y = 0`, and friction does not matter.
pub(in crate::methods) fn contradiction(problem: &Problem) -> Option<Vec<f64>> {
    let mut at = vec![0.0; problem.rows()];
    let mut signed: Vec<(usize, f64)> = Vec::new();
    for (row, law) in problem.laws() {
        match law {
            Law::Bounds { min, max } => {
                at[row] = if min.is_finite() { min } else { max };
                match (min.is_finite(), max.is_finite()) {
                    (true, false) => signed.push((row, 1.0)),
                    (false, true) => signed.push((row, -1.0)),
                    (false, false) => {
                        at[row] = 0.0;
                        signed.extend([(row, 1.0), (row, -1.0)]);
                    }
                    (true, true) => {}
                }
            }
            Law::Contact { .. } => signed.push((row, 1.0)),
            Law::Patch { .. } => {}
        }
    }
    let n = signed.len();
    if n == 0 || n > MAX_ROWS {
        return None;
    }
    let u = problem.velocities(&at);
    let m = DMatrix::from_fn(n, n, |a, b| {
        let ((i, left), (j, right)) = (signed[a], signed[b]);
        left * right * problem.w().at(i, j)
    });
    let lcp = Lcp { m, q: signed.iter().map(|&(i, sign)| sign * u[i]).collect() };
    candidates(&lcp).into_iter().find_map(|ray| {
        let mut y = vec![0.0; problem.rows()];
        signed.iter().zip(ray).for_each(|(&(i, sign), part)| y[i] += sign * part);
        problem.is_contradicted_by(&y).then_some(y)
    })
}

/// Whether the inequalities of a linear complementarity problem contradict each other.
pub(super) fn infeasible(lcp: &Lcp) -> bool {
    let problem = Problem::lcp(Matrix::from_dense(&lcp.m), lcp.q.clone());
    lcp.q.len() <= MAX_ROWS && problem.is_ok_and(|problem| contradiction(&problem).is_some())
}

/// What may be a proof: Lemke's method on the pair of linear programmes, `0 <= z`, `M z + q >= 0` and its
/// dual, whose matrix is positive semidefinite, so that it ends at a point or at a ray.
fn candidates(lcp: &Lcp) -> Vec<Vec<f64>> {
    let n = lcp.q.len();
    let (even, rows, _) = lcp.equilibrated();
    let mut m = DMatrix::zeros(2 * n, 2 * n);
    m.view_mut((n, 0), (n, n)).copy_from(&even.m);
    m.view_mut((0, n), (n, n)).copy_from(&-even.m.transpose());
    let mut q = vec![0.0; 2 * n];
    q[n..].copy_from_slice(&even.q);
    let both = Lcp { m, q };
    let mut dictionary = Dictionary::covered(&both, &[], &vec![1.0; 2 * n]);
    let End::Ray(ray) = dictionary.descend(20 * n as u32 + 100) else { return Vec::new() };
    let ray = &ray[n..];
    let least = TINY * greatest(ray);
    let tidy: Vec<f64> = ray.iter().map(|&y| if y > least { y } else { 0.0 }).collect();
    let polished = polished(&even, &tidy);
    let back = |y: &[f64]| y.iter().zip(&rows).map(|(y, by)| y * by).collect::<Vec<_>>();
    [Some(ray.to_vec()), Some(tidy), polished].into_iter().flatten().map(|y| back(&y)).collect()
}

/// The nearest `y` for which those entries of `Mᵀ y` that are small are zero.
fn polished(lcp: &Lcp, y: &[f64]) -> Option<Vec<f64>> {
    let support: Vec<usize> = (0..y.len()).filter(|&i| y[i] > 0.0).collect();
    let small = |j: &usize| {
        let terms = support.iter().map(|&i| lcp.m[(i, *j)] * y[i]);
        terms.clone().sum::<f64>().abs() <= TINY * terms.map(f64::abs).sum::<f64>()
    };
    let columns: Vec<usize> = (0..y.len()).filter(small).collect();
    if support.is_empty() || columns.is_empty() {
        return None;
    }
    let a = DMatrix::from_fn(columns.len(), support.len(), |j, i| lcp.m[(support[i], columns[j])]);
    let mut part = DVector::from_iterator(support.len(), support.iter().map(|&i| y[i]));
    let factors = a.clone().svd(true, true);
    let threshold = TINY * factors.singular_values.max();
    for _ in 0..2 {
        part -= factors.solve(&(&a * &part), threshold).ok()?;
    }
    let mut y = vec![0.0; y.len()];
    support.iter().zip(part.iter()).for_each(|(&i, &part)| y[i] = part.max(0.0));
    Some(y)
}
