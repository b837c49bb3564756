//! Common parts of all iterations: the start, checks of the residual, the best iterate, and when to give up.

use crate::methods::linear::greatest;
use crate::methods::pivoting::certificate;
use crate::methods::verdict::Claim;
use crate::methods::{Effort, Friction, Solution};
use crate::problem::{Law, Problem, nearest_within, project_cone, project_disc};

/// An iteration stagnates if the residual has not improved for as many sweeps as there were before, plus this
/// many.
const PATIENCE: u32 = 1000;

/// Sweeps have come to a halt if the residual has not improved for this many of them, and an eighth of those
/// before: sooner than they stagnate.
const HALT: u32 = 128;

/// Impulses that as velocities are this many times as great as q are a reason to search for a proof that
/// there is no solution: then they grow with each sweep.
const GROWTH: f64 = 300.0;

/// The best impulses that were seen.
pub(super) struct Best<'a> {
    problem: &'a Problem,
    effort: &'a Effort,
    r: Vec<f64>,
    residual: f64,
    /// When it was found.
    at: u32,
    /// The last residual that was a substantial improvement, and its sweep.
    gain: (f64, u32),
    /// The greatest impulse that was offered, as a velocity [m/s].
    greatest: f64,
}

impl<'a> Best<'a> {
    /// The start of `effort`, or zero if there is none that fits the problem.
    pub(super) fn start(problem: &'a Problem, effort: &'a Effort) -> Best<'a> {
        let fits = |r: &&Vec<f64>| r.len() == problem.rows() && r.iter().all(|x| x.is_finite());
        let zero = || vec![0.0; problem.rows()];
        let start = effort.start.as_ref().filter(fits).filter(|r| problem.residual(r).relative.is_finite());
        let r = start.cloned().unwrap_or_else(zero);
        let residual = problem.residual(&r).relative;
        Best { problem, effort, r, residual, at: 0, gain: (residual, 0), greatest: 0.0 }
    }

    pub(super) fn impulses(&self) -> &[f64] {
        &self.r
    }

    /// The sweep that the best impulses are from.
    pub(super) fn sweep(&self) -> u32 {
        self.at
    }

    pub(super) fn is_solved(&self) -> bool {
        self.residual <= self.effort.tolerance
    }

    /// Keeps `r` if it is better than all before, and returns its residual, infinite if it is not finite.
    pub(super) fn offer(&mut self, r: &[f64], sweep: u32) -> f64 {
        self.offer_at(r, &self.problem.velocities(r), sweep)
    }

    /// The same where the velocities are known.
    pub(super) fn offer_at(&mut self, r: &[f64], u: &[f64], sweep: u32) -> f64 {
        let mut residual = self.problem.residual_at(r, u).relative;
        if residual <= self.effort.tolerance {
            // What rounding may have hidden counts.
            residual = self.problem.residual(r).relative;
        }
        let size = (0..r.len()).fold(0.0_f64, |most, i| most.max(self.problem.scale(i) * r[i].abs()));
        self.greatest = self.greatest.max(size);
        if residual < self.residual {
            self.r.copy_from_slice(r);
            (self.residual, self.at) = (residual, sweep);
            if residual < 0.9 * self.gain.0 {
                self.gain = (residual, sweep);
            }
        }
        residual
    }

    /// Keeps `r` even if it is worse; returns false, and keeps nothing, if its residual is not finite.
    fn replace(&mut self, r: &[f64], sweep: u32) -> bool {
        let residual = self.problem.residual_at(r, &self.problem.velocities(r)).relative;
        let finite = residual.is_finite();
        if finite {
            self.r.copy_from_slice(r);
            (self.residual, self.at) = (residual, sweep);
        }
        finite
    }

    /// Whether the last improvement is long ago.
    pub(super) fn stagnates(&self, sweep: u32) -> bool {
        sweep - self.gain.1 > self.gain.1.saturating_add(PATIENCE)
    }

    /// The solution after `sweeps`; if it is solved, it counts only the sweeps up to the best iterate.
    pub(super) fn finish(self, sweeps: u32) -> Solution {
        let solved = self.problem.residual(&self.r).relative <= self.effort.tolerance;
        let grown = !solved && self.greatest > GROWTH * greatest(self.problem.q());
        let proof = if grown { certificate::contradiction(self.problem) } else { None };
        let iterations = if solved { self.at } else { sweeps };
        Claim { r: self.r, ray: false, proof, iterations, pivots: 0 }.judged(self.problem, self.effort)
    }
}

/// Whether the residual is computed after this sweep: it costs as much as a sweep.
pub(super) fn is_checked(sweep: u32) -> bool {
    match sweep {
        0..=16 => true,
        17..=128 => sweep.is_multiple_of(4),
        129.. => sweep.is_multiple_of(16),
    }
}

/// Sweeps until the tolerance is met, or the sweeps have run out, or they change nothing any more.
pub(super) fn iterate(problem: &Problem, effort: &Effort, mut sweep: impl FnMut(&mut [f64])) -> Solution {
    iterate_counting(problem, effort, |r, _| sweep(r))
}

/// The same for sweeps that take shorter steps the more often they have come to a halt ([`HALT`]).
pub(super) fn iterate_counting(
    problem: &Problem,
    effort: &Effort,
    mut sweep: impl FnMut(&mut [f64], u32),
) -> Solution {
    let mut best = Best::start(problem, effort);
    let mut r = best.impulses().to_vec();
    let (mut halts, mut since) = (0, 0);
    for number in 1..=effort.iterations {
        if best.is_solved() {
            return best.finish(number - 1);
        }
        if !is_checked(number) && number != effort.iterations {
            sweep(&mut r, halts);
            continue;
        }
        let before = r.clone();
        sweep(&mut r, halts);
        // No iteration recovers from numbers that are not finite.
        if best.offer(&r, number).is_infinite() || r == before || best.stagnates(number) {
            return best.finish(number);
        }
        if number - best.gain.1.max(since) > HALT + best.gain.1 / 8 {
            (halts, since) = (halts + 1, number);
        }
    }
    best.finish(effort.iterations)
}

/// The same for a method that supports all models of friction. For the cone the best iterate is returned; a
/// pyramid or a box is another law, whose solution is the fixed point of the sweeps, however far that is from
/// the cone's.
pub(super) fn iterate_shaped(
    problem: &Problem,
    effort: &Effort,
    mut sweep: impl FnMut(&mut [f64]),
) -> Solution {
    if effort.friction == Friction::Cone {
        return iterate(problem, effort, sweep);
    }
    let mut last = Best::start(problem, effort);
    let mut r = last.impulses().to_vec();
    let still = 0.1 * effort.tolerance * problem.q().iter().fold(0.0_f64, |norm, x| norm.hypot(*x));
    for number in 1..=effort.iterations {
        if last.is_solved() {
            return last.finish(number - 1);
        }
        let before = r.clone();
        sweep(&mut r);
        if is_checked(number) || number == effort.iterations {
            let change = |i: usize| problem.scale(i) * (r[i] - before[i]);
            let change = (0..r.len()).fold(0.0_f64, |norm, i| norm.hypot(change(i)));
            if !last.replace(&r, number) || change <= still {
                return last.finish(number);
            }
        }
    }
    last.finish(effort.iterations)
}

/// Damps oscillating laws: if the change of a law opposes that of the previous sweep, smaller shares of its
/// next changes are applied, down to a tenth, and larger ones again once it no longer does. Sweeps over rows
/// of a W that is far from symmetric can cycle, which this breaks; it hardly affects sweeps that converge.
pub(super) struct Damping {
    share: Vec<f64>,
    /// The change of the last sweep.
    change: Vec<f64>,
}

impl Damping {
    pub(super) fn new(problem: &Problem) -> Damping {
        Damping { share: vec![1.0; problem.laws().len()], change: vec![0.0; problem.rows()] }
    }

    /// Call it with the first row of a law before its impulses change.
    pub(super) fn before(&self, first: usize, r: &[f64]) -> Old {
        let at = |i: usize| r.get(first + i).copied().unwrap_or(0.0);
        Old { first, r: [at(0), at(1), at(2)] }
    }

    /// Call it after; `rows` of the law.
    pub(super) fn after(&mut self, law: usize, rows: usize, old: Old, r: &mut [f64]) {
        let own = old.first..old.first + rows;
        let (r, last) = (&mut r[own.clone()], &mut self.change[own]);
        let mut turned = 0.0;
        for ((r, old), last) in r.iter().zip(old.r).zip(last.iter_mut()) {
            let change = r - old;
            turned += change * *last;
            *last = change;
        }
        let share = &mut self.share[law];
        *share = if turned < 0.0 { (0.9 * *share).max(0.1) } else { (1.05 * *share).min(1.0) };
        if *share < 1.0 {
            r.iter_mut().zip(old.r).for_each(|(r, old)| *r = old + *share * (*r - old));
        }
    }
}

/// Impulses of a law before it was solved.
pub(super) struct Old {
    first: usize,
    r: [f64; 3],
}

/// Projects impulses onto those that their laws allow; patches use the projected normals.
pub(super) fn project(problem: &Problem, r: &mut [f64]) {
    for (first, law) in problem.laws() {
        match law {
            Law::Bounds { min, max } => r[first] = nearest_within(r[first], min, max),
            Law::Contact { mu } => {
                let own = project_cone([r[first], r[first + 1], r[first + 2]], mu);
                r[first..first + 3].copy_from_slice(&own);
            }
            Law::Patch { mu, arm, first: normals, count } => {
                let normal = pressure(r, normals, count);
                let own = project_disc([r[first], r[first + 1]], mu * normal);
                r[first..first + 2].copy_from_slice(&own);
                r[first + 2] = nearest_within(r[first + 2], -mu * arm * normal, mu * arm * normal);
            }
        }
    }
}

/// The sum of the normal impulses that a patch shares.
pub(super) fn pressure(r: &[f64], first: usize, count: usize) -> f64 {
    r[first..first + count].iter().map(|x| x.max(0.0)).sum()
}

/// The greatest eigenvalue of the symmetric part of the block of two rows, or their scale if it is not
/// positive.
pub(super) fn tangent_scale(problem: &Problem, first: usize) -> f64 {
    let w = problem.w();
    let (a, d) = (w.at(first, first), w.at(first + 1, first + 1));
    let b = 0.5 * (w.at(first, first + 1) + w.at(first + 1, first));
    let half = 0.5 * (a - d);
    let greatest = 0.5 * (a + d) + (half * half + b * b).sqrt();
    if greatest > 0.0 && greatest.is_finite() {
        greatest
    } else {
        problem.scale(first).max(problem.scale(first + 1))
    }
}
