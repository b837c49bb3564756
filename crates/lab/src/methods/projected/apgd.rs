//! Accelerated projected gradients.

use super::sweep::{Best, pressure, project};
use crate::methods::{Effort, Solution};
use crate::problem::{Law, Problem, nearest_within, project_cone, project_disc};

/// Accelerated projected gradient descent (Mazhar, Heyn, Negrut and Tasora 2015, after Nesterov): on
/// `1/2 rᵀ W r + (q + s)ᵀ r` over the cones, with an adaptive step length and momentum that restarts when it
/// leads uphill.
///
/// The authors solve the convex problem, s = 0; here `s = mu |u_t|` follows the velocities from round to
/// round (De Saxcé), and the discs of patches their normals, so that the fixed point of the iteration obeys
/// Coulomb's law. Error O(1/k²) for symmetric, positive semidefinite W; a round costs a multiplication by W,
/// and one more when the step was too long.
pub fn apgd(problem: &Problem, effort: &Effort) -> Solution {
    let mut best = Best::start(problem, effort);
    let mut state = State::new(problem, best.impulses().to_vec());
    for number in 1..=effort.iterations {
        if best.is_solved() {
            return best.finish(number - 1);
        }
        let moved = state.round();
        let residual = best.offer_at(&state.r, &state.u, number);
        if residual.is_infinite() || !moved || best.stagnates(number) {
            return best.finish(number);
        }
    }
    best.finish(effort.iterations)
}

struct State<'a> {
    problem: &'a Problem,
    /// The weight of each row [1/kg]: the same within a cone.
    weight: Vec<f64>,
    r: Vec<f64>,
    /// Velocities of `r`.
    u: Vec<f64>,
    /// Where the gradient is taken, and its velocities.
    ahead: Vec<f64>,
    ahead_u: Vec<f64>,
    /// Added to the velocities.
    shift: Vec<f64>,
    /// How large the friction of a patch may be.
    radius: Vec<f64>,
    theta: f64,
    /// Lipschitz constant of the weighted gradient, and its upper bound.
    lipschitz: f64,
    most: f64,
}

impl<'a> State<'a> {
    fn new(problem: &'a Problem, mut r: Vec<f64>) -> State<'a> {
        project(problem, &mut r);
        let weight = weights(problem);
        let u = problem.velocities(&r);
        let row = |i: usize| {
            let sum: f64 = problem.w().row(i).map(|(j, x)| x.abs() / (weight[i] * weight[j]).sqrt()).sum();
            sum
        };
        let most = (0..r.len()).map(row).fold(f64::MIN_POSITIVE, f64::max).min(1e200);
        let (ahead, ahead_u) = (r.clone(), u.clone());
        let (shift, radius) = (vec![0.0; r.len()], vec![0.0; problem.laws().len()]);
        let mut state =
            State { problem, weight, r, u, ahead, ahead_u, shift, radius, theta: 1.0, lipschitz: 1.0, most };
        state.lipschitz = state.lipschitz.min(most);
        state.follow();
        state
    }

    /// Updates shifts and radii, which the laws depend on, from the present impulses and velocities.
    fn follow(&mut self) {
        for (law_index, (first, law)) in self.problem.laws().enumerate() {
            match law {
                Law::Contact { mu } => self.shift[first] = mu * length(self.u[first + 1], self.u[first + 2]),
                Law::Patch { mu, first: normals, count, .. } => {
                    self.radius[law_index] = mu * pressure(&self.r, normals, count);
                }
                Law::Bounds { .. } => {}
            }
        }
    }

    /// One round; whether anything moved.
    fn round(&mut self) -> bool {
        let n = self.r.len();
        let gradient: Vec<f64> = (0..n).map(|i| self.ahead_u[i] + self.shift[i]).collect();
        let (mut next, mut next_u);
        loop {
            next = (0..n)
                .map(|i| self.ahead[i] - gradient[i] / (self.lipschitz * self.weight[i]))
                .collect::<Vec<_>>();
            self.project(&mut next);
            next_u = self.problem.velocities(&next);
            // f is quadratic, so it exceeds its tangent by 1/2 dᵀ W d.
            let (mut bend, mut square) = (0.0, 0.0);
            for i in 0..n {
                let d = next[i] - self.ahead[i];
                bend += d * (next_u[i] - self.ahead_u[i]);
                square += self.weight[i] * d * d;
            }
            let too_long = bend > self.lipschitz * square;
            if !too_long || self.lipschitz >= self.most {
                break;
            }
            self.lipschitz = (2.0 * self.lipschitz).min(self.most);
        }
        let along: f64 = (0..n).map(|i| gradient[i] * (next[i] - self.r[i])).sum();
        let moved = next != self.r || next != self.ahead;
        let theta = self.theta;
        let next_theta = 0.5 * (theta * (theta * theta + 4.0).sqrt() - theta * theta);
        let beta = if along > 0.0 { 0.0 } else { theta * (1.0 - theta) / (theta * theta + next_theta) };
        self.theta = if along > 0.0 { 1.0 } else { next_theta };
        for i in 0..n {
            self.ahead[i] = next[i] + beta * (next[i] - self.r[i]);
            self.ahead_u[i] = next_u[i] + beta * (next_u[i] - self.u[i]);
        }
        (self.r, self.u) = (next, next_u);
        self.lipschitz *= 0.9;
        self.follow();
        moved
    }

    fn project(&self, r: &mut [f64]) {
        for ((first, law), &radius) in self.problem.laws().zip(&self.radius) {
            project_law(first, law, radius, r);
        }
    }
}

/// As [`project`] does it for one law, with a given size of the friction of a patch.
pub(super) fn project_law(first: usize, law: Law, radius: f64, r: &mut [f64]) {
    match law {
        Law::Bounds { min, max } => r[first] = nearest_within(r[first], min, max),
        Law::Contact { mu } => {
            let own = project_cone([r[first], r[first + 1], r[first + 2]], mu);
            r[first..first + 3].copy_from_slice(&own);
        }
        Law::Patch { arm, .. } => {
            let own = project_disc([r[first], r[first + 1]], radius);
            r[first..first + 2].copy_from_slice(&own);
            r[first + 2] = nearest_within(r[first + 2], -arm * radius, arm * radius);
        }
    }
}

/// A positive diagonal [1/kg] that is about that of W, and the same within each cone or disc.
pub(super) fn weights(problem: &Problem) -> Vec<f64> {
    let mut weight: Vec<f64> = (0..problem.rows()).map(|i| problem.scale(i)).collect();
    for (first, law) in problem.laws() {
        let shared = match law {
            Law::Bounds { .. } => continue,
            Law::Contact { .. } => first..first + 3,
            Law::Patch { .. } => first..first + 2,
        };
        let mean = weight[shared.clone()].iter().map(|x| x / shared.len() as f64).sum();
        weight[shared].fill(mean);
    }
    weight
}

fn length(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use crate::methods::tests::{check_contacts, check_rows};

    #[test]
    fn it_finds_what_is_known() {
        check_rows(super::apgd);
        check_contacts(super::apgd);
    }
}
