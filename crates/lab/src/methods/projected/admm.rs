//! The alternating direction method of multipliers.

use super::apgd::{project_law, weights};
use super::sweep::{Best, is_checked, pressure};
use crate::methods::envelope::Envelope;
use crate::methods::{Effort, Solution};
use crate::problem::{Law, Problem, nearest_within};
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Rounds between two checks of the penalty, since each change of it costs a factorisation.
const PATIENCE: u32 = 10;
/// More rows than this are not factorised densely.
const DENSE: usize = 1500;
/// A skew part smaller than this share of W is applied with the impulses of the previous round.
const SKEW: f64 = 2e-2;
/// Over-relaxation of the steps after the linear solve (Eckstein and Bertsekas 1992).
const RELAXATION: f64 = 1.6;

/// The alternating direction method of multipliers (Carpentier, Le Lidec and Montaut 2024; Tasora, Mangoni,
/// Benatti and Garziera 2021; Acary): `(W + rho I) r = rho z - y - q - s`, `z = P(r + y / rho)`,
/// `y += rho (r - z)`, with s De Saxcé's shift `mu |u_t|` of the round before, and -y the velocities.
///
/// One Cholesky factor serves all rounds with the same penalty rho, which follows the ratio of both errors;
/// each round is a solve with it. W may be singular. A skew part goes into the right hand side, or where it
/// is large, the factor is a dense LU. Exact for all laws at the fixed point; slow at first if W is badly
/// conditioned, and without guarantee if W is indefinite.
pub fn admm(problem: &Problem, effort: &Effort) -> Solution {
    let mut best = Best::start(problem, effort);
    let Some(mut state) = State::new(problem, best.impulses().to_vec()) else { return best.finish(0) };
    for number in 1..=effort.iterations {
        if best.is_solved() {
            return best.finish(number - 1);
        }
        let errors = state.round();
        if is_checked(number) || number == effort.iterations {
            let residual = best.offer(&state.impulses(), number);
            if residual.is_infinite() || best.stagnates(number) {
                return best.finish(number);
            }
        }
        if number.is_multiple_of(PATIENCE) && !state.adapt(errors) {
            return best.finish(number);
        }
    }
    best.finish(effort.iterations)
}

/// All quantities are in units in which the diagonal of W is about one: impulses times `root`, velocities
/// divided by it.
struct State<'a> {
    problem: &'a Problem,
    root: Vec<f64>,
    inverse_root: Vec<f64>,
    factor: Factor,
    rho: f64,
    r: Vec<f64>,
    z: Vec<f64>,
    y: Vec<f64>,
    radius: Vec<f64>,
}

enum Factor {
    Symmetric { envelope: Envelope, skew: bool },
    Dense { matrix: DMatrix<f64>, lu: Option<LU<f64, Dyn, Dyn>> },
}

impl<'a> State<'a> {
    fn new(problem: &'a Problem, start: Vec<f64>) -> Option<State<'a>> {
        let root: Vec<f64> = weights(problem).iter().map(|x| x.sqrt()).collect();
        let inverse_root: Vec<f64> = root.iter().map(|x| 1.0 / x).collect();
        let factor = Factor::new(problem, &inverse_root)?;
        let z: Vec<f64> = start.iter().zip(&root).map(|(r, root)| r * root).collect();
        let u = problem.velocities(&start);
        let y = u.iter().zip(&inverse_root).map(|(u, root)| -u * root).collect();
        let radius = vec![0.0; problem.laws().len()];
        let mut state = State { problem, root, inverse_root, factor, rho: 1.0, r: z.clone(), z, y, radius };
        state.refactorise(0.3).then_some(state)
    }

    fn impulses(&self) -> Vec<f64> {
        self.z.iter().zip(&self.inverse_root).map(|(z, root)| z * root).collect()
    }

    /// Factorises with a new penalty, or with a greater one if the matrix is not positive definite.
    fn refactorise(&mut self, rho: f64) -> bool {
        self.rho = rho;
        for _ in 0..40 {
            if self.factor.with(self.problem, &self.inverse_root, self.rho) {
                return true;
            }
            self.rho *= 4.0;
        }
        false
    }

    /// Primal and dual error.
    fn round(&mut self) -> [f64; 2] {
        let n = self.r.len();
        let mut shift = vec![0.0; n];
        for (index, (first, law)) in self.problem.laws().enumerate() {
            match law {
                Law::Contact { mu } => {
                    let [x, w] = [first + 1, first + 2].map(|i| self.y[i]);
                    shift[first] = mu * (x * x + w * w).sqrt();
                }
                Law::Patch { mu, first: normals, count, .. } => {
                    self.radius[index] = mu * pressure(&self.impulses(), normals, count) * self.root[first];
                }
                Law::Bounds { .. } => {}
            }
        }
        let skew = self.factor.skew(self.problem, &self.inverse_root, &self.r);
        let rho = self.rho;
        let mut r: Vec<f64> = (0..n)
            .map(|i| {
                rho * self.z[i] - self.y[i] - self.problem.q()[i] * self.inverse_root[i] - shift[i] - skew[i]
            })
            .collect();
        self.factor.solve(&mut r);
        let old = self.z.clone();
        let relaxed: Vec<f64> = (0..n).map(|i| RELAXATION * r[i] + (1.0 - RELAXATION) * old[i]).collect();
        self.z = (0..n).map(|i| relaxed[i] + self.y[i] / rho).collect();
        self.project();
        let mut errors = [0.0; 2];
        for i in 0..n {
            self.y[i] += rho * (relaxed[i] - self.z[i]);
            errors[0] += (r[i] - self.z[i]) * (r[i] - self.z[i]);
            errors[1] += rho * rho * (self.z[i] - old[i]) * (self.z[i] - old[i]);
        }
        self.r = r;
        errors.map(f64::sqrt)
    }

    fn project(&mut self) {
        for ((first, law), &radius) in self.problem.laws().zip(&self.radius) {
            let law = match law {
                // Bounds are those of the impulse; the arm turns tangents' units into those of the twist.
                Law::Bounds { min, max } => {
                    Law::Bounds { min: min * self.root[first], max: max * self.root[first] }
                }
                Law::Patch { mu, arm, first: normals, count } => {
                    let arm = arm * self.root[first + 2] / self.root[first];
                    Law::Patch { mu, arm, first: normals, count }
                }
                contact => contact,
            };
            project_law(first, law, radius, &mut self.z);
        }
    }

    /// Follows the ratio of both errors; false if there is no factor any more.
    fn adapt(&mut self, [primal, dual]: [f64; 2]) -> bool {
        let ratio = (primal / dual).sqrt();
        if !ratio.is_finite() || (0.4..2.5).contains(&ratio) {
            return true;
        }
        self.refactorise(nearest_within(self.rho * nearest_within(ratio, 0.1, 10.0), 1e-8, 1e8))
    }
}

impl Factor {
    fn new(problem: &Problem, scale: &[f64]) -> Option<Factor> {
        let w = problem.w();
        let (mut skew, mut greatest) = (0.0_f64, 0.0_f64);
        for i in 0..w.size() {
            for (j, x) in w.row(i) {
                greatest = greatest.max((x * scale[i] * scale[j]).abs());
                skew = skew.max(((x - w.at(j, i)) * scale[i] * scale[j]).abs());
            }
        }
        if skew > SKEW * greatest && w.size() <= DENSE {
            let mut matrix = w.dense();
            for i in 0..w.size() {
                (0..w.size()).for_each(|j| matrix[(i, j)] *= scale[i] * scale[j]);
            }
            return Some(Factor::Dense { matrix, lu: None });
        }
        Some(Factor::Symmetric { envelope: Envelope::new(w)?, skew: skew > 0.0 })
    }

    fn with(&mut self, problem: &Problem, scale: &[f64], rho: f64) -> bool {
        match self {
            Factor::Symmetric { envelope, .. } => envelope.factorise(problem.w(), scale, rho),
            Factor::Dense { matrix, lu } => {
                let mut shifted = matrix.clone();
                (0..shifted.nrows()).for_each(|i| shifted[(i, i)] += rho);
                let fresh = shifted.lu();
                let regular = fresh.is_invertible();
                *lu = Some(fresh);
                regular
            }
        }
    }

    fn solve(&self, x: &mut [f64]) {
        match self {
            Factor::Symmetric { envelope, .. } => envelope.solve(x),
            Factor::Dense { lu, .. } => {
                let solved = lu.as_ref().and_then(|lu| lu.solve(&DVector::from_column_slice(x)));
                if let Some(solved) = solved {
                    x.copy_from_slice(solved.as_slice());
                }
            }
        }
    }

    /// The contribution to the velocities of the skew part of W, which is not in the factor.
    fn skew(&self, problem: &Problem, scale: &[f64], r: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; r.len()];
        if matches!(self, Factor::Symmetric { skew: true, .. }) {
            for i in 0..r.len() {
                for (j, x) in problem.w().row(i) {
                    let half = 0.5 * x * scale[i] * scale[j];
                    sum[i] += half * r[j];
                    sum[j] -= half * r[i];
                }
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use crate::methods::tests::{check_contacts, check_rows};

    #[test]
    fn it_finds_what_is_known() {
        check_rows(super::admm);
        check_contacts(super::admm);
    }
}
