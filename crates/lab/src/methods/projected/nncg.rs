//! Nonsmooth nonlinear conjugate gradients.

use super::gs_cone::Blocks;
use super::sweep::{Best, is_checked, project};
use crate::methods::{Effort, Solution};
use crate::problem::Problem;

/// Sweeps without a better residual after which the moves along p pause, and how long they do at first.
const WAIT: u32 = 32;

/// Nonsmooth nonlinear conjugate gradients (Silcowitz, Niebe and Erleben 2010): the change by a sweep of
/// [`gs_cone`](crate::methods::gs_cone) counts as minus the gradient g, and the next sweep starts further
/// along, `r += beta p`, `p <- beta p - g`, with Fletcher and Reeves's `beta = |g|² / |g_before|²` in units
/// of energy. It restarts where beta is above one or p opposes the sweep, and projects impulses that left the
/// cones.
///
/// A sweep costs one of `gs_cone` and some vector work; once the set of sticking and sliding contacts has
/// settled, it takes a quarter of the sweeps or less. The residual does not fall in every sweep, so the best
/// impulses are kept, taken before the move along `p`. A sweep is no gradient of a symmetric form, so the
/// moves can keep each other up for ever, as for `W = I + 1 1ᵀ`: where the residual has not improved for
/// long, sweeps go on alone from the best impulses, each time for twice as long. All laws are exact at the
/// fixed point.
pub fn nncg(problem: &Problem, effort: &Effort) -> Solution {
    let mut blocks = Blocks::new(problem);
    let mut best = Best::start(problem, effort);
    let mut r = best.impulses().to_vec();
    let mut direction = vec![0.0; r.len()];
    let weights: Vec<f64> = (0..r.len()).map(|i| problem.scale(i)).collect();
    let mut last = f64::INFINITY;
    // Sweeps that are left of a pause, the length of the next one, and the sweep at which moves began.
    let (mut rest, mut pause, mut began) = (0_u32, WAIT, 0);
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
        if rest > 0 {
            rest -= 1;
            continue;
        }
        if number - best.sweep() > WAIT + best.sweep().saturating_sub(began) / 2 {
            r.copy_from_slice(best.impulses());
            direction.fill(0.0);
            last = f64::INFINITY;
            (rest, pause) = (pause, pause.saturating_mul(2));
            began = number.saturating_add(rest);
            continue;
        }
        let change: Vec<f64> = r.iter().zip(&before).map(|(r, before)| r - before).collect();
        let dot = |other: &[f64]| -> f64 {
            change.iter().zip(&weights).zip(other).map(|((change, weight), x)| weight * change * x).sum()
        };
        let square = dot(&change);
        let beta = square / last;
        last = square;
        if beta > 1.0 || !beta.is_finite() || dot(&direction) < -square {
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
