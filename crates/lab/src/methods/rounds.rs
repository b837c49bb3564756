//! Leads from a method for one of the [`super::forms`] to the exact cone, by rounds: each takes the bounds
//! and axes of friction from the previous one.

use super::forms::{Boxed, Group, Lcp, boxed, from_axes, pyramid, reduce, to_axes};
use super::newton::cone_newton;
use super::run::Run;
use super::{Friction, Status};

/// The solution of a method for one form.
pub(super) struct Outcome {
    pub(super) x: Vec<f64>,
    pub(super) status: Status,
    pub(super) pivots: u32,
    pub(super) iterations: u32,
}

pub(super) type SolveBox = fn(&Boxed, Option<&[f64]>, u32) -> Outcome;
pub(super) type SolveLcp = fn(&Lcp, Option<&[f64]>, u32) -> Outcome;

/// The form that a method is written for.
#[derive(Clone, Copy)]
enum Core {
    Box(SolveBox),
    Lcp(SolveLcp),
}

/// Rounds of bounds and axes.
const ROUNDS: u32 = 12;
/// Slip slower than this share of q has no meaningful direction.
const STILL: f64 = 1e-9;

impl Core {
    fn on_box(self, boxed: &Boxed, start: Option<&[f64]>, limit: u32) -> Outcome {
        match self {
            Core::Box(solve) => solve(boxed, start, limit),
            Core::Lcp(solve) => {
                let reduced = reduce(boxed, &[]);
                let start = start.map(|start| reduced.forth(start));
                let outcome = solve(&reduced.lcp, start.as_deref(), limit);
                Outcome { x: reduced.back(&outcome.x), ..outcome }
            }
        }
    }

    fn on_lcp(self, lcp: &Lcp, start: Option<&[f64]>, limit: u32) -> Outcome {
        match self {
            Core::Lcp(solve) => solve(lcp, start, limit),
            Core::Box(_) => {
                let n = lcp.q.len();
                let (m, q) = (lcp.m.clone(), lcp.q.clone());
                self.regular(&Boxed { m, q, lo: vec![0.0; n], hi: vec![f64::INFINITY; n] }, start, limit)
            }
        }
    }

    /// [`Core::on_box`]; if that fails, which singular principal minors cause in many methods, proximal
    /// rounds: `M + eps D` has no such minors, and each round takes the previous solution as its centre, so
    /// that for a positive semidefinite M the limit solves the problem itself (Rockafellar 1976).
    fn regular(self, boxed: &Boxed, start: Option<&[f64]>, limit: u32) -> Outcome {
        let mut best = self.on_box(boxed, start, limit);
        let mut least = boxed.error(&best.x);
        let goal = 1e-13 * super::linear::greatest(&boxed.q);
        if matches!(self, Core::Lcp(_)) || best.status == Status::Solved && least <= 1e3 * goal {
            return best;
        }
        for eps in [1e-6, 1e-4, 1e-2, 1.0] {
            let mut x = best.x.clone();
            let mut idle = 0;
            for _ in 0..50 {
                let left = limit.saturating_sub(best.pivots.max(best.iterations));
                if least <= goal || left == 0 || idle > 3 {
                    break;
                }
                let outcome = self.on_box(&boxed.proximal(eps, &x), Some(&x), left);
                best.pivots += outcome.pivots;
                best.iterations += outcome.iterations;
                idle += 1;
                x = outcome.x;
                for candidate in std::iter::once(x.clone()).chain(boxed.snapped(&x)) {
                    let error = boxed.error(&candidate);
                    if error < 0.5 * least {
                        idle = 0;
                    }
                    if error < least {
                        least = error;
                        best.x = candidate;
                    }
                }
            }
        }
        if least <= 1e3 * goal {
            best.status = Status::Solved;
        }
        best
    }
}

/// Rounds of a method for the boxed form.
pub(super) fn by_boxes(run: &mut Run, groups: Vec<Group>, friction: Friction, solve: SolveBox) {
    let with_pyramid = friction == Friction::Pyramid;
    by_rounds(run, groups, Core::Box(solve), with_pyramid, friction == Friction::Cone);
}

/// Rounds of a method for linear complementarity problems.
pub(super) fn by_pyramids(run: &mut Run, groups: Vec<Group>, friction: Friction, solve: SolveLcp) {
    let with_pyramid = friction != Friction::Box;
    by_rounds(run, groups, Core::Lcp(solve), with_pyramid, friction == Friction::Cone);
}

fn by_rounds(run: &mut Run, mut groups: Vec<Group>, core: Core, with_pyramid: bool, refine: bool) {
    if groups.is_empty() {
        return without_friction(run, core);
    }
    let mut r = run.best.clone();
    for round in 0..ROUNDS {
        if run.pivots_left() == 0 || run.iterations_left() == 0 {
            break;
        }
        let warm = run.warm || round > 0;
        let limit = run.pivots_left().min(run.iterations_left());
        let (outcome, next) = if with_pyramid {
            let reduced = pyramid(&run.problem, &groups);
            let start = warm.then(|| reduced.forth(&r));
            let outcome = core.on_lcp(&reduced.lcp, start.as_deref(), limit);
            let next = reduced.back(&outcome.x);
            (outcome, next)
        } else {
            let boxed = boxed(&run.problem, &groups, &r);
            let start = warm.then(|| to_axes(&groups, &r));
            let outcome = core.regular(&boxed, start.as_deref(), limit);
            let next = from_axes(&groups, &outcome.x);
            (outcome, next)
        };
        run.pivots += outcome.pivots;
        run.iterations += 1;
        // That the relaxation has no solution proves nothing about the problem.
        let ended_on_ray = matches!(outcome.status, Status::Ray | Status::NoSolution);
        run.status = if ended_on_ray { Status::Ray } else { Status::Limit };
        if run.consider(&next) || with_pyramid && !refine || ended_on_ray && run.is_contradicted() {
            return;
        }
        let start = next.clone();
        if refine && (round % 4 == 1 || with_pyramid && round == 0) && cone_newton::newton(run, &start, 30) {
            return;
        }
        let change = r.iter().zip(&next).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        r = next;
        if refine {
            turn(run, &mut groups, &r);
        }
        if round > 0 && change <= 1e-14 * super::linear::greatest(&r) {
            break;
        }
    }
    if refine {
        cone_newton::search(run);
    }
}

fn without_friction(run: &mut Run, core: Core) {
    let boxed = boxed(&run.problem, &[], &run.best);
    let start = run.warm.then(|| run.best.clone());
    let outcome = core.regular(&boxed, start.as_deref(), run.limit);
    run.pivots = outcome.pivots;
    run.iterations = outcome.iterations;
    let ended_on_ray = matches!(outcome.status, Status::Ray | Status::NoSolution);
    run.status = if ended_on_ray { Status::Ray } else { Status::Limit };
    run.consider(&outcome.x);
}

/// Rotates the first axis of each group into the direction of slip, or of friction if it sticks.
fn turn(run: &Run, groups: &mut [Group], r: &[f64]) {
    let u = run.problem.velocities(r);
    for group in groups {
        let t = group.tangent;
        let (slip, force) = (u[t].hypot(u[t + 1]), r[t].hypot(r[t + 1]));
        if slip > STILL {
            group.axis = [u[t] / slip, u[t + 1] / slip];
        } else if force > f64::MIN_POSITIVE && force.is_finite() {
            group.axis = [r[t] / force, r[t + 1] / force];
        }
    }
}
