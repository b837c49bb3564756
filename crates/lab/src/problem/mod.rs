//! One problem statement for all methods of contact resolution: find impulses `r` and velocities
//! `u = W r + q` such that each [`Law`] holds between its rows of both.
//!
//! `W = J M⁻¹ Jᵀ` says how fast each constraint moves per unit of impulse on each other one; `q` is their
//! velocity without impulses, plus terms for gap, restitution and stabilisation. A linear complementarity
//! problem is a [`Problem`] all of whose laws are [`Law::AT_LEAST_ZERO`]; then `W` may be any square matrix.

mod contradiction;
#[cfg(feature = "hdf5")]
mod fclib;
mod global;
mod matrix;
mod read;
mod residual;
mod twice;
mod write;

#[cfg(feature = "hdf5")]
pub use fclib::{FclibError, read_fclib};
pub use matrix::Matrix;
pub use read::{File, Form, ReadError, read_problem};
pub use residual::{Residual, project_cone, project_disc};
pub(crate) use residual::{nearest_within, power_of_two};
pub use write::write_problem;

pub use backstop::observe::Law;

use backstop::Error;

/// The problem of finding impulses `r` that obey every law with `u = W r + q`.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Laws in the order of their rows.
    laws: Vec<Law>,
    /// The first row of each law.
    starts: Vec<usize>,
    /// W [1/kg].
    w: Matrix,
    /// Velocities without any impulse [m/s].
    q: Vec<f64>,
    /// The [scale](Problem::scale) of each row.
    scales: Vec<f64>,
}

impl Problem {
    /// Refused unless all numbers but infinite bounds are finite, sizes agree, `min <= max`, `mu` and `arm`
    /// are not negative and the normals of a patch are rows of their own before it.
    pub fn new(laws: Vec<Law>, w: Matrix, q: Vec<f64>) -> Result<Problem, Error> {
        let mut starts = Vec::with_capacity(laws.len());
        let mut rows = 0;
        for law in &laws {
            starts.push(rows);
            let fits = match *law {
                Law::Bounds { min, max } => min <= max,
                Law::Contact { mu } => (0.0..f64::INFINITY).contains(&mu),
                Law::Patch { mu, arm, first, count } => {
                    let range = 0.0..f64::INFINITY;
                    range.contains(&mu) && range.contains(&arm) && first.saturating_add(count) <= rows
                }
            };
            if !fits {
                return Err(Error::Incomplete {
                    what: "a law",
                    expected: "ordered bounds, friction that is not negative, and normals before it",
                });
            }
            rows += law.rows();
        }
        if q.len() != rows || w.size() != rows {
            return Err(Error::Incomplete { what: "W and q", expected: "as many rows as the laws take" });
        }
        if let Some(&value) = q.iter().chain(w.values()).find(|x| !x.is_finite()) {
            return Err(Error::NotFinite { what: "a number of W or q", value });
        }
        let scales = (0..rows).map(|row| residual::scale(&w, row)).collect();
        Ok(Problem { laws, starts, w, q, scales })
    }

    /// A linear complementarity problem: `z >= 0`, `w = M z + q >= 0`, `z w = 0`.
    pub fn lcp(m: Matrix, q: Vec<f64>) -> Result<Problem, Error> {
        Problem::new(vec![Law::AT_LEAST_ZERO; q.len()], m, q)
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.q.len()
    }

    /// Each law and its first row.
    pub fn laws(&self) -> impl ExactSizeIterator<Item = (usize, Law)> + Clone + '_ {
        self.starts.iter().copied().zip(self.laws.iter().copied())
    }

    /// W [1/kg].
    pub fn w(&self) -> &Matrix {
        &self.w
    }

    /// Velocities without any impulse [m/s].
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// `u = W r + q`. Panics if `r` has another number of rows.
    pub fn velocities(&self, r: &[f64]) -> Vec<f64> {
        (0..self.rows()).map(|i| self.w.dot(i, r) + self.q[i]).collect()
    }
}
