//! Proofs that a linear complementarity problem has no solution.

use super::dictionary::{Dictionary, End};
use crate::methods::forms::{Lcp, times};
use crate::methods::linear::greatest;
use nalgebra::DMatrix;

/// No certificate is searched for larger problems.
const MAX_ROWS: usize = 400;

/// Whether `y >= 0` proves that no `z >= 0` has `M z + q >= 0`: `M^T y <= 0` and `q y < 0` (Farkas). `M^T y`
/// may be positive by rounding only.
pub(super) fn proves(lcp: &Lcp, y: &[f64]) -> bool {
    let size = greatest(y);
    if !(size > 0.0 && size.is_finite()) || y.iter().any(|&y| y < 0.0) {
        return false;
    }
    let y: Vec<f64> = y.iter().map(|y| y / size).collect();
    let against: f64 = lcp.q.iter().zip(&y).map(|(q, y)| q * y).sum();
    let sum: f64 = lcp.q.iter().zip(&y).map(|(q, y)| (q * y).abs()).sum();
    let zeros = vec![0.0; y.len()];
    let pressed = times(&lcp.m.transpose(), &y, &zeros);
    let fits = lcp.m.column_iter().zip(&pressed).all(|(column, p)| *p <= 1e-13 * greatest(column.as_slice()));
    fits && against < -1e-9 * sum
}

/// Whether the inequalities of a linear complementarity problem contradict each other: Lemke's method on the
/// pair of linear programmes, `0 <= z`, `M z + q >= 0` and its dual, whose matrix is positive semidefinite,
/// so that it ends at a point or at a proof.
pub(in crate::methods) fn infeasible(lcp: &Lcp) -> bool {
    let n = lcp.q.len();
    if n == 0 || n > MAX_ROWS {
        return false;
    }
    let (lcp, _) = lcp.equilibrated();
    let mut m = DMatrix::zeros(2 * n, 2 * n);
    m.view_mut((n, 0), (n, n)).copy_from(&lcp.m);
    m.view_mut((0, n), (n, n)).copy_from(&-lcp.m.transpose());
    let mut q = vec![0.0; 2 * n];
    q[n..].copy_from_slice(&lcp.q);
    let both = Lcp { m, q };
    let mut dictionary = Dictionary::covered(&both, &[], &vec![1.0; 2 * n]);
    match dictionary.descend(20 * n as u32 + 100) {
        End::Ray(ray) => {
            let tidy =
                |least: f64| ray[n..].iter().map(|&y| if y > least { y } else { 0.0 }).collect::<Vec<_>>();
            proves(&lcp, &ray[n..]) || proves(&lcp, &tidy(1e-12 * greatest(&ray)))
        }
        _ => false,
    }
}
