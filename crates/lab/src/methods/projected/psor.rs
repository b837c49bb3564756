//! Projected successive over-relaxation.

use super::pgs::Rows;
use super::sweep::{iterate_counting, iterate_shaped};
use crate::methods::{Effort, Friction, Solution};
use crate::problem::Problem;

/// Projected successive over-relaxation: [`pgs`](crate::methods::pgs) whose rows go
/// [`Effort::relaxation`] times as far, kept in 0.01..=1.99.
///
/// Converges for symmetric, positive semidefinite W and a relaxation in (0, 2) without friction (Cryer 1971);
/// with friction and a relaxation much above 1 it often does not: then the impulses swing, and where the
/// residual does not improve for more than a hundred sweeps, what is above 1 of the relaxation is halved.
/// Cost and laws are those of `pgs`.
pub fn psor(problem: &Problem, effort: &Effort) -> Solution {
    let relaxation = if effort.relaxation.is_nan() { 1.0 } else { effort.relaxation.clamp(0.01, 1.99) };
    let rows = Rows::new(problem, effort.friction);
    if effort.friction != Friction::Cone {
        return iterate_shaped(problem, effort, |r| rows.sweep(r, relaxation));
    }
    let beyond = (relaxation - 1.0).max(0.0);
    iterate_counting(problem, effort, |r, halts| {
        // After a thousand halvings nothing is left.
        rows.sweep(r, relaxation - beyond * (1.0 - 0.5_f64.powi(halts.min(1000) as i32)));
    })
}

#[cfg(test)]
mod tests {
    use crate::methods::tests::{check_contacts, check_rows};

    #[test]
    fn it_finds_what_is_known() {
        check_rows(super::psor);
        check_contacts(super::psor);
    }
}
