//! Nonsmooth nonlinear conjugate gradients.

use super::gs_cone::Blocks;
use super::sweep::{Best, is_checked, project};
use super::{Effort, Solution};
use crate::lab::problem::Problem;

/// Nonsmooth nonlinear conjugate gradients (Silcowitz, Niebe and Erleben 2010): what a sweep of Gauss-Seidel changes counts as
/// minus the gradient, and Fletcher and Reeves's formula carries on in the direction of the sweeps before.
pub fn nncg(problem: &Problem, effort: &Effort) -> Solution {
    let mut blocks = Blocks::new(problem);
    let mut best = Best::start(problem, effort);
    let mut r = best.impulses().to_vec();
    let mut direction = vec![0.0; r.len()];
    let weights: Vec<f64> = (0..r.len()).map(|i| problem.scale(i)).collect();
    let mut last = f64::INFINITY;
    for number in 1..=effort.iterations {
        if best.is_solved() {
            return best.finish(number - 1);
        }
        let before = r.clone();
        blocks.sweep(&mut r);
        if is_checked(number) || number == effort.iterations {
            if best.offer(&r, number).is_infinite() || r == before || best.stagnates(number) {
                return best.finish(number);
            }
        }
        let change = |i: usize| r[i] - before[i];
        let square: f64 = (0..r.len()).map(|i| weights[i] * change(i) * change(i)).sum();
        let beta = square / last;
        last = square;
        if beta > 1.0 || !beta.is_finite() {
            direction.fill(0.0);
            continue;
        }
        for i in 0..r.len() {
            let step = beta * direction[i];
            direction[i] = step + change(i);
        }
        for i in 0..r.len() {
            r[i] += direction[i] - (r[i] - before[i]);
        }
        project(problem, &mut r);
    }
    best.finish(effort.iterations)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_contacts, check_rows};

    #[test]
    fn it_finds_what_is_known() {
        check_rows(super::nncg);
        check_contacts(super::nncg);
    }
}
