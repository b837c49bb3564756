//! Dense linear systems.

use super::forms::times;
use nalgebra::{DMatrix, DVector};

/// The solution of `M x = right` by LU with partial pivoting and one step of refinement; none if M is
/// singular, that is, if the result does not solve the system.
pub(super) fn solve(m: &DMatrix<f64>, right: &[f64]) -> Option<Vec<f64>> {
    if right.is_empty() {
        return Some(Vec::new());
    }
    let lu = m.clone().lu();
    let minus: Vec<f64> = right.iter().map(|x| -x).collect();
    let mut x = lu.solve(&DVector::from_column_slice(right))?;
    let rest = times(m, x.as_slice(), &minus);
    let step = lu.solve(&DVector::from_vec(rest))?;
    x -= step;
    let rest = times(m, x.as_slice(), &minus);
    let (most, of) = (greatest(&rest), greatest(right));
    let size = greatest(x.as_slice()) * greatest(m.as_slice());
    // A wrong solution is recognised by its residual, which for a nearly singular system is huge.
    let fits = most <= 1e-9 * of.max(f64::MIN_POSITIVE) || most <= 1e-13 * size && size <= 1e12 * of;
    (x.iter().all(|x| x.is_finite()) && fits).then(|| x.as_slice().to_vec())
}

/// The greatest absolute value.
pub(super) fn greatest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, x| if x.is_nan() { f64::INFINITY } else { x.abs().max(most) })
}
