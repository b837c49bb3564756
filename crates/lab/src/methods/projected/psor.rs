//! Projected successive over-relaxation.

use super::pgs::Rows;
use super::sweep::iterate_shaped;
use crate::methods::{Effort, Solution};
use crate::problem::Problem;

/// Projected successive over-relaxation: [`pgs`](crate::methods::pgs) whose rows go
/// [`Effort::relaxation`] times as far, kept in 0.01..=1.99.
///
/// Converges for symmetric, positive semidefinite W and a relaxation in (0, 2) without friction (Cryer 1971);
/// with friction and a relaxation much above 1 it often does not. Cost and laws are those of `pgs`.
pub fn psor(problem: &Problem, effort: &Effort) -> Solution {
    let relaxation = if effort.relaxation.is_nan() { 1.0 } else { effort.relaxation.clamp(0.01, 1.99) };
    let rows = Rows::new(problem, effort.friction);
    iterate_shaped(problem, effort, |r| rows.sweep(r, relaxation))
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
