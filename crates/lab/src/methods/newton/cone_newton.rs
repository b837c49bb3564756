//! Newton's method on the exact laws, and the search that gives it a start.
//!
//! The equations are those of Alart and Curnier (1991) for Coulomb's law and the minimum map for bounds, each
//! of them an impulse: `r_n = max(0, r_n - rho_n u_n)` and `r_t = P(r_t - rho_t u_t)` with `P` onto the disc
//! of radius `mu max(0, r_n - rho_n u_n)`, where `rho_n = 1 / W_nn` and `rho_t` is one over the greatest
//! eigenvalue of `W_tt`: without that scaling they converge badly (Acary, Brémond, Huber 2018).

use crate::methods::linear;
use crate::methods::run::Run;
use crate::problem::{Law, Problem, nearest_within, project_cone, project_disc};
use nalgebra::{DMatrix, DVector};

/// A row of the linearised equations: factors of single impulse changes and of single velocity changes, and
/// the value.
#[derive(Default)]
struct Equation {
    by_r: Vec<(usize, f64)>,
    by_u: Vec<(usize, f64)>,
    value: f64,
    /// The factor that turns the value into a velocity.
    scale: f64,
}

impl Equation {
    /// `r_i` has a value.
    fn set(i: usize, off: f64, scale: f64) -> Equation {
        Equation { by_r: vec![(i, 1.0)], by_u: Vec::new(), value: off, scale }
    }

    /// `u_i` is zero.
    fn still(i: usize, u: f64, scale: f64) -> Equation {
        Equation { by_r: Vec::new(), by_u: vec![(i, 1.0 / scale)], value: u / scale, scale }
    }
}

/// The greatest eigenvalue of the tangents' own block of W, by its symmetric part; the scale of the normal if
/// that is zero.
fn tangent_scale(problem: &Problem, t: usize, other: f64) -> f64 {
    let w = problem.w();
    let (a, d, b) = (w.at(t, t), w.at(t + 1, t + 1), 0.5 * (w.at(t, t + 1) + w.at(t + 1, t)));
    let most = 0.5 * (a + d) + (0.5 * (a - d)).hypot(b);
    if most > 0.0 { most } else { other }
}

/// The equations of all laws at impulses r.
fn equations(problem: &Problem, r: &[f64], u: &[f64]) -> Vec<Equation> {
    let mut all = Vec::with_capacity(problem.rows());
    for (i, law) in problem.laws() {
        let s = problem.scale(i);
        match law {
            Law::Bounds { min, max } => all.push(bounds(i, min, max, s, r, u)),
            Law::Contact { mu } => {
                let normal = r[i] - u[i] / s;
                let st = tangent_scale(problem, i + 1, s);
                if normal > 0.0 {
                    all.push(Equation::still(i, u[i], s));
                    let radius = Radius { value: mu * normal, by_r: vec![(i, mu)], by_u: vec![(i, -mu / s)] };
                    all.extend(disc(i + 1, &radius, st, r, u));
                } else {
                    all.extend((0..3).map(|k| Equation::set(i + k, r[i + k], if k == 0 { s } else { st })));
                }
            }
            Law::Patch { mu, arm, first, count } => {
                let load: f64 = r[first..first + count].iter().map(|x| x.max(0.0)).sum();
                let by_r = (first..first + count).filter(|&k| r[k] > 0.0).map(|k| (k, mu)).collect();
                let radius = Radius { value: mu * load, by_r, by_u: Vec::new() };
                all.extend(disc(i, &radius, tangent_scale(problem, i, s), r, u));
                let s = problem.scale(i + 2);
                let wanted = r[i + 2] - u[i + 2] / s;
                let most = arm * mu * load;
                if wanted.abs() <= most && most > 0.0 {
                    all.push(Equation::still(i + 2, u[i + 2], s));
                } else {
                    let side = if wanted < 0.0 { -1.0 } else { 1.0 };
                    let mut equation = Equation::set(i + 2, r[i + 2] - side * most, s);
                    equation.by_r.extend(radius.by_r.iter().map(|&(k, f)| (k, -side * arm * f)));
                    all.push(equation);
                }
            }
        }
    }
    all
}

fn bounds(i: usize, min: f64, max: f64, s: f64, r: &[f64], u: &[f64]) -> Equation {
    let wanted = r[i] - u[i] / s;
    if wanted <= min {
        Equation::set(i, r[i] - min, s)
    } else if wanted >= max {
        Equation::set(i, r[i] - max, s)
    } else {
        Equation::still(i, u[i], s)
    }
}

/// The radius of a friction disc with its derivatives.
struct Radius {
    value: f64,
    by_r: Vec<(usize, f64)>,
    by_u: Vec<(usize, f64)>,
}

/// The equations of two tangent rows.
fn disc(t: usize, radius: &Radius, s: f64, r: &[f64], u: &[f64]) -> [Equation; 2] {
    let wanted = [r[t] - u[t] / s, r[t + 1] - u[t + 1] / s];
    let length = wanted[0].hypot(wanted[1]);
    if length <= radius.value && radius.value > 0.0 {
        return [0, 1].map(|k| Equation::still(t + k, u[t + k], s));
    }
    let d = if length > 0.0 { wanted.map(|x| x / length) } else { [0.0; 2] };
    let share = if length > 0.0 { radius.value / length } else { 0.0 };
    [0, 1].map(|k| {
        let mut equation = Equation::set(t + k, r[t + k] - radius.value * d[k], s);
        equation.by_r.extend(radius.by_r.iter().map(|&(j, f)| (j, -d[k] * f)));
        equation.by_u.extend(radius.by_u.iter().map(|&(j, f)| (j, -d[k] * f)));
        for j in 0..2 {
            // The direction rotates with the unprojected impulse.
            let f = -share * (f64::from(j == k) - d[j] * d[k]);
            equation.by_r.push((t + j, f));
            equation.by_u.push((t + j, -f / s));
        }
        equation
    })
}

/// The Newton step with `alpha` added to the diagonal of W in proportion to the scales: a proximal term,
/// without which the system is singular where supports are redundant. None if it still is.
fn step(problem: &Problem, equations: &[Equation], alpha: f64) -> Option<Vec<f64>> {
    let n = problem.rows();
    // Impulses whose equation gives their value are known.
    let mut known = vec![None; n];
    for equation in equations {
        if let ([(i, 1.0)], []) = (&equation.by_r[..], &equation.by_u[..]) {
            known[*i] = Some(-equation.value);
        }
    }
    let is_set = |e: &Equation| matches!((&e.by_r[..], &e.by_u[..]), ([(_, 1.0)], []));
    let mut place = vec![usize::MAX; n];
    let unknown: Vec<usize> = (0..n).filter(|&i| known[i].is_none()).collect();
    unknown.iter().enumerate().for_each(|(k, &i)| place[i] = k);
    let rows: Vec<&Equation> = equations.iter().filter(|e| !is_set(e)).collect();
    if rows.len() != unknown.len() {
        return None;
    }
    let size = unknown.len();
    let (mut a, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
    for (k, equation) in rows.iter().enumerate() {
        // Scaled to velocities, so that pivots can be compared.
        let s = equation.scale;
        right[k] = -s * equation.value;
        let mut add = |i: usize, f: f64| match known[i] {
            Some(change) => right[k] -= s * f * change,
            None => a[(k, place[i])] += s * f,
        };
        for &(i, f) in &equation.by_r {
            add(i, f);
        }
        for &(i, f) in &equation.by_u {
            problem.w().row(i).for_each(|(j, w)| add(j, f * w));
            if alpha > 0.0 {
                add(i, f * alpha * problem.scale(i));
            }
        }
    }
    let x = if size == 0 {
        right
    } else {
        let lu = a.clone().lu();
        let x = lu.solve(&right)?;
        let rest = &right - &a * &x;
        x + lu.solve(&rest)?
    };
    let mut change: Vec<f64> = known.iter().map(|known| known.unwrap_or(0.0)).collect();
    unknown.iter().zip(x.iter()).for_each(|(&i, &x)| change[i] = x);
    change.iter().all(|x| x.is_finite()).then_some(change)
}

/// The sum of squares of the equations as velocities.
fn merit(equations: &[Equation]) -> f64 {
    equations.iter().map(|e| (e.value * e.scale).powi(2)).sum::<f64>().sqrt()
}

/// Newton's method from impulses `r`: whole steps with a proximal term that falls with the residual; a step
/// that makes the equations much worse is halved. True once solved.
pub(in crate::methods) fn newton(run: &mut Run, r: &[f64], most: u32) -> bool {
    let mut r = r.to_vec();
    let mut seen = Vec::new();
    let mut floor = 1e-12;
    let (mut last_best, mut idle) = (run.residual, 0);
    for _ in 0..most {
        if run.iterations_left() == 0 {
            break;
        }
        let u = run.problem.velocities(&r);
        let all = equations(&run.problem, &r, &u);
        let now = merit(&all);
        if !now.is_finite() {
            break;
        }
        seen.push(now);
        run.iterations += 1;
        let relative = now / linear::greatest(run.problem.q()).max(f64::MIN_POSITIVE);
        let alpha = nearest_within(1e-3 * relative, floor, 1e-3);
        let Some(change) = step(&run.problem, &all, alpha) else {
            floor *= 100.0;
            if floor > 1e-4 {
                break;
            }
            continue;
        };
        // A watchdog: a step has to improve on the worst of the last few merits only, since the path to the
        // solution often leads uphill.
        let bar = seen.iter().rev().take(5).fold(0.0_f64, |most, x| most.max(*x));
        let mut share = 1.0;
        let mut next = r.clone();
        for _ in 0..5 {
            next = r.iter().zip(&change).map(|(r, c)| r + share * c).collect();
            let u = run.problem.velocities(&next);
            if merit(&equations(&run.problem, &next, &u)) <= 10.0 * bar {
                break;
            }
            share *= 0.5;
        }
        r = next;
        if run.consider(&r) || run.consider(&admitted(&run.problem, &r)) {
            return true;
        }
        idle = if run.residual < 0.9 * last_best { 0 } else { idle + 1 };
        last_best = run.residual;
        if idle > 15 {
            break;
        }
    }
    false
}

/// The impulses projected onto those that the laws allow.
pub(super) fn admitted(problem: &Problem, r: &[f64]) -> Vec<f64> {
    let mut r = r.to_vec();
    for (i, law) in problem.laws() {
        match law {
            Law::Bounds { min, max } => r[i] = nearest_within(r[i], min, max),
            Law::Contact { mu } => {
                r[i] = r[i].max(0.0);
                let t = project_disc([r[i + 1], r[i + 2]], mu * r[i]);
                (r[i + 1], r[i + 2]) = (t[0], t[1]);
            }
            Law::Patch { mu, arm, first, count } => {
                let load: f64 = r[first..first + count].iter().map(|x| x.max(0.0)).sum();
                let t = project_disc([r[i], r[i + 1]], mu * load);
                (r[i], r[i + 1]) = (t[0], t[1]);
                r[i + 2] = nearest_within(r[i + 2], -mu * arm * load, mu * arm * load);
            }
        }
    }
    r
}

/// Sweeps of projected Gauss-Seidel by whole laws, De Saxcé's shift included: slow, but they make progress
/// from anywhere.
pub(super) fn sweeps(problem: &Problem, r: &mut [f64], count: u32, damp: f64) {
    let scales: Vec<f64> = problem.laws().map(|(i, law)| damp * law_scale(problem, i, law)).collect();
    for _ in 0..count {
        for ((i, law), &s) in problem.laws().zip(&scales) {
            let inner = if law.rows() == 3 { 3 } else { 1 };
            for _ in 0..inner {
                let u: Vec<f64> =
                    (i..i + law.rows()).map(|k| problem.w().dot(k, r) + problem.q()[k]).collect();
                match law {
                    Law::Bounds { min, max } => r[i] = nearest_within(r[i] - u[0] / s, min, max),
                    Law::Contact { mu } => {
                        let shift = mu * u[1].hypot(u[2]);
                        let to = [r[i] - (u[0] + shift) / s, r[i + 1] - u[1] / s, r[i + 2] - u[2] / s];
                        r[i..i + 3].copy_from_slice(&project_cone(to, mu));
                    }
                    Law::Patch { mu, arm, first, count } => {
                        let load: f64 = r[first..first + count].iter().map(|x| x.max(0.0)).sum();
                        let twist = problem.scale(i + 2);
                        let t = project_disc([r[i] - u[0] / s, r[i + 1] - u[1] / s], mu * load);
                        (r[i], r[i + 1]) = (t[0], t[1]);
                        r[i + 2] = nearest_within(r[i + 2] - u[2] / twist, -mu * arm * load, mu * arm * load);
                    }
                }
            }
        }
    }
}

/// A bound of the eigenvalues of a law's own block.
fn law_scale(problem: &Problem, i: usize, law: Law) -> f64 {
    let rows = match law {
        Law::Bounds { .. } => return problem.scale(i),
        Law::Contact { .. } => 3,
        Law::Patch { .. } => 2,
    };
    let sums = (i..i + rows).map(|k| (i..i + rows).map(|j| problem.w().at(k, j).abs()).sum::<f64>());
    let most = sums.fold(0.0, f64::max);
    if most > 0.0 { most } else { problem.scale(i) }
}

/// Newton's method from the best impulses so far, then after more and more sweeps, as long as iterations are
/// left.
pub(in crate::methods) fn search(run: &mut Run) -> bool {
    let start = run.best.clone();
    if newton(run, &start, 50) {
        return true;
    }
    let mut r = admitted(&run.problem, &start);
    let mut count = 50;
    for round in 0..12 {
        let count_now = run.iterations_left().min(count);
        if count_now == 0 || round == 2 && run.is_contradicted() {
            return false;
        }
        // Alternately with smaller steps, which converge where whole ones cycle.
        let damp = if round % 3 == 2 { 4.0 } else { 1.0 };
        sweeps(&run.problem, &mut r, count_now, damp);
        run.iterations += count_now;
        if r.iter().any(|x| !x.is_finite()) {
            r = admitted(&run.problem, &run.best);
            continue;
        }
        if run.consider(&r) || newton(run, &r.clone(), 50) {
            return true;
        }
        count = count * 3 / 2;
    }
    false
}
