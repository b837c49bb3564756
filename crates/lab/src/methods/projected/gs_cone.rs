//! Block Gauss-Seidel with exact contacts.

use super::sweep::{Damping, iterate, pressure};
use crate::methods::cone::{ContactBlock, solve_disc};
use crate::methods::{Effort, Solution};
use crate::problem::{Law, Problem, nearest_within};

/// Nonsmooth Gauss-Seidel (Jean and Moreau 1992): one contact after another gets the impulses that solve its
/// own three rows exactly, with friction on the round cone, while all others stay; a proximal term of 2 %
/// keeps those of contacts that touch others from overshooting.
///
/// Converges linearly, more slowly the longer the chains of bodies that carry one another; the most robust of
/// the methods without a matrix factor. A sweep costs a multiplication by W. Rows with bounds are solved as
/// such, and patches as a disc whose size is that of their normals at the moment. It does not converge, and
/// its status says so, if W is far from symmetric and positive semidefinite.
pub fn gs_cone(problem: &Problem, effort: &Effort) -> Solution {
    let mut blocks = Blocks::new(problem);
    iterate(problem, effort, |r| blocks.sweep(r))
}

/// What keeps a contact near its present impulses while its block is solved, as a share of the mean of its
/// diagonal. With friction near 1 the impulses of a block respond to its neighbours by far more than the
/// neighbours moved, and exact sweeps then swing for ever: at 1e-3 (`OneObject-499`) or 2e-4 (`RockPile`).
/// From 0.02 to 0.1 both converge; more makes other sweeps slower.
const HOLD: f64 = 0.02;

/// Each law with the block of W that is its own.
pub(super) struct Blocks<'a> {
    problem: &'a Problem,
    own: Vec<(usize, Own)>,
    damping: Damping,
}

enum Own {
    Row { min: f64, max: f64, scale: f64 },
    Contact(ContactBlock),
    Patch { mu: f64, arm: f64, normals: usize, count: usize, w: [[f64; 2]; 2], twist: f64 },
}

impl<'a> Blocks<'a> {
    pub(super) fn new(problem: &'a Problem) -> Blocks<'a> {
        let w = problem.w();
        let own = problem.laws().map(|(first, law)| {
            let own = match law {
                Law::Bounds { min, max } => Own::Row { min, max, scale: problem.scale(first) },
                Law::Contact { mu } => {
                    let block = [0, 1, 2].map(|i| [0, 1, 2].map(|j| w.at(first + i, first + j)));
                    let alone = (first..first + 3)
                        .all(|row| w.row(row).all(|(column, _)| (first..first + 3).contains(&column)));
                    let hold = if alone { 0.0 } else { HOLD };
                    Own::Contact(ContactBlock::new(block, mu, problem.scale(first), hold))
                }
                Law::Patch { mu, arm, first: normals, count } => {
                    let block = [0, 1].map(|i| [0, 1].map(|j| w.at(first + i, first + j)));
                    Own::Patch { mu, arm, normals, count, w: block, twist: problem.scale(first + 2) }
                }
            };
            (first, own)
        });
        Blocks { problem, own: own.collect(), damping: Damping::new(problem) }
    }

    /// All laws in the order of their rows.
    pub(super) fn sweep(&mut self, r: &mut [f64]) {
        for law in 0..self.own.len() {
            let (first, ref own) = self.own[law];
            let rows = match own {
                Own::Row { .. } => 1,
                Own::Patch { .. } => 3,
                // The proximal term does for these what damping does for the others.
                Own::Contact(_) => {
                    self.solve(&self.own[law], r);
                    continue;
                }
            };
            let old = self.damping.before(first, r);
            self.solve(&self.own[law], r);
            self.damping.after(law, rows, old, r);
        }
    }

    fn solve(&self, &(first, ref own): &(usize, Own), r: &mut [f64]) {
        let velocity = |row: usize, r: &[f64]| self.problem.w().dot(row, r) + self.problem.q()[row];
        match *own {
            Own::Row { min, max, scale } => {
                r[first] = nearest_within(r[first] - velocity(first, r) / scale, min, max);
            }
            Own::Contact(ref block) => {
                let u = [0, 1, 2].map(|i| velocity(first + i, r));
                let solved = block.solve([r[first], r[first + 1], r[first + 2]], u);
                r[first..first + 3].copy_from_slice(&solved);
            }
            Own::Patch { mu, arm, normals, count, w, twist } => {
                let normal = pressure(r, normals, count);
                let u = [0, 1].map(|i| velocity(first + i, r));
                let solved = solve_disc(w, mu * normal, [r[first], r[first + 1]], u);
                r[first..first + 2].copy_from_slice(&solved);
                let most = mu * arm * normal;
                r[first + 2] = nearest_within(r[first + 2] - velocity(first + 2, r) / twist, -most, most);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::methods::tests::{check_contacts, check_rows};

    #[test]
    fn it_finds_what_is_known() {
        check_rows(super::gs_cone);
        check_contacts(super::gs_cone);
    }
}
