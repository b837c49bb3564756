//! Nonsmooth nonlinear conjugate gradients.

use super::gs_cone::Blocks;
use super::sweep::{Best, is_checked, project};
use crate::methods::{Effort, Solution};
use crate::problem::Problem;

/// Nonsmooth nonlinear conjugate gradients (Silcowitz, Niebe and Erleben 2010): the change by a sweep of
/// [`gs_cone`](crate::methods::gs_cone) counts as minus the gradient g, and the next sweep starts further
/// along, `r += beta p`, `p <- beta p - g`, with Fletcher and Reeves's `beta = |g|² / |g_before|²` in units
/// of energy. It restarts where beta is above one, and projects impulses that left the cones.
///
/// A sweep costs one of `gs_cone` and some vector work; once the set of sticking and sliding contacts has
/// settled, it takes a quarter of the sweeps or less. The residual does not fall in every sweep, so the best
/// impulses are kept, taken before the move along `p`. Fails where `gs_cone` does. All laws are exact at the
/// fixed point.
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
        let checked = is_checked(number) || number == effort.iterations;
        if checked && (best.offer(&r, number).is_infinite() || r == before || best.stagnates(number)) {
            return best.finish(number);
        }
        let change: Vec<f64> = r.iter().zip(&before).map(|(r, before)| r - before).collect();
        let square: f64 = change.iter().zip(&weights).map(|(change, weight)| weight * change * change).sum();
        let beta = square / last;
        last = square;
        if beta > 1.0 || !beta.is_finite() {
            direction.fill(0.0);
            continue;
        }
        for ((r, direction), change) in r.iter_mut().zip(&mut direction).zip(change) {
            let step = beta * *direction;
            *direction = step + change;
            *r += step;
        }
        project(problem, &mut r);
    }
    best.finish(effort.iterations)
}

#[cfg(test)]
mod tests {
    use crate::methods::tests::{check_contacts, check_rows};

    #[test]
    fn it_finds_what_is_known() {
        check_rows(super::nncg);
        check_contacts(super::nncg);
    }
}
