//! Projected Gauss-Seidel.

use super::sweep::{iterate_shaped, pressure, tangent_scale};
use crate::methods::{Effort, Friction, Solution};
use crate::problem::{Law, Problem, nearest_within, project_disc};

/// Projected Gauss-Seidel, which game engines call sequential impulses: row by row
/// `r_i <- P(r_i - u_i / W_ii)` with the newest velocities. The friction of a contact is projected onto what
/// its normal impulse allows at the moment: a disc (the exact law at rest of the iteration), an inscribed
/// square ([`Friction::Pyramid`]) or a box of two tangents ([`Friction::Box`]).
///
/// Converges linearly for symmetric, positive semidefinite W; a stack of N bodies needs O(N²) sweeps. A sweep
/// costs a multiplication by W. Source: Cottle, Pang and Stone 1992, 5.2; Catto 2005.
pub fn pgs(problem: &Problem, effort: &Effort) -> Solution {
    let rows = Rows::new(problem, effort.friction);
    iterate_shaped(problem, effort, |r| rows.sweep(r, 1.0))
}

/// The factors that turn velocities of a law's rows into impulses.
pub(super) struct Rows<'a> {
    problem: &'a Problem,
    friction: Friction,
    /// For each law that of the first row, and that of its tangents or twist [1/kg].
    scales: Vec<[f64; 2]>,
}

impl<'a> Rows<'a> {
    pub(super) fn new(problem: &'a Problem, friction: Friction) -> Rows<'a> {
        let scales = problem.laws().map(|(first, law)| match law {
            Law::Bounds { .. } => [problem.scale(first); 2],
            Law::Contact { .. } => [problem.scale(first), tangent_scale(problem, first + 1)],
            Law::Patch { .. } => [tangent_scale(problem, first), problem.scale(first + 2)],
        });
        Rows { problem, friction, scales: scales.collect() }
    }

    /// All rows in their order, each moved `relaxation` times as far as its own velocity asks for.
    pub(super) fn sweep(&self, r: &mut [f64], relaxation: f64) {
        let velocity = |row: usize, r: &[f64]| self.problem.w().dot(row, r) + self.problem.q()[row];
        for ((first, law), scale) in self.problem.laws().zip(&self.scales) {
            let step = scale.map(|scale| relaxation / scale);
            match law {
                Law::Bounds { min, max } => {
                    r[first] = nearest_within(r[first] - step[0] * velocity(first, r), min, max);
                }
                Law::Contact { mu } => {
                    r[first] = (r[first] - step[0] * velocity(first, r)).max(0.0);
                    let most = mu * r[first];
                    if self.friction == Friction::Box {
                        for row in first + 1..first + 3 {
                            let step = relaxation / self.problem.scale(row);
                            r[row] = nearest_within(r[row] - step * velocity(row, r), -most, most);
                        }
                    } else {
                        let [a, b] = [first + 1, first + 2].map(|row| r[row] - step[1] * velocity(row, r));
                        let own = limit([a, b], most, self.friction);
                        r[first + 1..first + 3].copy_from_slice(&own);
                    }
                }
                Law::Patch { mu, arm, first: normals, count } => {
                    let most = mu * pressure(r, normals, count);
                    let own = [first, first + 1].map(|row| r[row] - step[0] * velocity(row, r));
                    r[first..first + 2].copy_from_slice(&limit(own, most, self.friction));
                    let twist = first + 2;
                    r[twist] =
                        nearest_within(r[twist] - step[1] * velocity(twist, r), -arm * most, arm * most);
                }
            }
        }
    }
}

/// The nearest friction that is allowed.
pub(super) fn limit(friction: [f64; 2], most: f64, shape: Friction) -> [f64; 2] {
    let [x, y] = friction;
    match shape {
        Friction::Cone => project_disc(friction, most),
        Friction::Box => friction.map(|x| nearest_within(x, -most, most)),
        // |x| + |y| <= most: a box in the directions of its sides.
        Friction::Pyramid => {
            let [sum, difference] = [x + y, x - y].map(|x| nearest_within(x, -most, most));
            [0.5 * (sum + difference), 0.5 * (sum - difference)]
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::methods::tests::{check_contacts, check_rows};

    #[test]
    fn it_finds_what_is_known() {
        check_rows(super::pgs);
        check_contacts(super::pgs);
    }
}
