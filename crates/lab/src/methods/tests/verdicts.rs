//! Whether a status is true: every method on problems made at random, judged by a residual that is computed
//! here, from sums without rounding errors.
//!
//! `COUNT=500 cargo test --release -p backstop-lab --lib -- verdicts --nocapture` makes that many of each
//! kind and prints a table.

use super::generated::{KINDS, Known};
use crate::methods::{Effort, Method, Status};
use crate::problem::{Law, Problem, project_cone, project_disc};
use crate::random::Random;

const EXACT: [&str; 8] =
    ["lemke", "dantzig", "keller", "murty", "block-pivoting", "newton-min", "newton-fb", "path"];

/// The velocity of a row, rounded once: products are split into two numbers, and all of these are added up
/// in an expansion (Shewchuk 1997).
fn velocity(problem: &Problem, row: usize, r: &[f64]) -> f64 {
    let mut parts: Vec<f64> = Vec::new();
    let mut add = |mut x: f64| {
        let mut kept = Vec::new();
        for &part in &parts {
            let (big, small) = if x.abs() < part.abs() { (part, x) } else { (x, part) };
            let sum = big + small;
            let rest = small - (sum - big);
            if rest != 0.0 {
                kept.push(rest);
            }
            x = sum;
        }
        kept.push(x);
        parts = kept;
    };
    for (column, w) in problem.w().row(row) {
        let product = w * r[column];
        add(product);
        add(libm::fma(w, r[column], -product));
    }
    add(problem.q()[row]);
    parts.iter().sum()
}

/// The natural map's residual relative to q, and what of it may be rounding of the map itself.
fn residual(problem: &Problem, r: &[f64]) -> [f64; 2] {
    let u: Vec<f64> = (0..problem.rows()).map(|row| velocity(problem, row, r)).collect();
    let scale = |row: usize| {
        let most = problem.w().row(row).fold(0.0_f64, |most, (_, w)| most.max(w.abs()));
        match problem.w().at(row, row) {
            diagonal if diagonal > 1e-12 * most => diagonal,
            _ if most > 0.0 => most,
            _ => 1.0,
        }
    };
    let (mut sum, mut noise) = (0.0_f64, 0.0_f64);
    for (first, law) in problem.laws() {
        let s = scale(first);
        let error = match law {
            // Between the bounds the velocity itself, which must not be lost beside a great impulse.
            Law::Bounds { min, max } => s * (u[first] / s).max(r[first] - max).min(r[first] - min).abs(),
            Law::Contact { mu } => {
                let slip = u[first + 1].hypot(u[first + 2]);
                let moved = [u[first] + mu * slip, u[first + 1], u[first + 2]];
                let to = [0, 1, 2].map(|k| r[first + k] - moved[k] / s);
                let at = project_cone(to, mu);
                if at == to {
                    moved[0].hypot(moved[1]).hypot(moved[2])
                } else {
                    let off = [0, 1, 2].map(|k| r[first + k] - at[k]);
                    s * off[0].hypot(off[1]).hypot(off[2])
                }
            }
            Law::Patch { mu, arm, first: normals, count } => {
                let most = mu * r[normals..normals + count].iter().map(|x| x.max(0.0)).sum::<f64>();
                let at = project_disc([r[first] - u[first] / s, r[first + 1] - u[first + 1] / s], most);
                let (t, turn) = (scale(first + 2), r[first + 2] - u[first + 2] / scale(first + 2));
                let off = r[first + 2] - turn.max(-arm * most).min(arm * most);
                s * (r[first] - at[0]).hypot(r[first + 1] - at[1]) + arm * t * off.abs()
            }
        };
        sum = sum.hypot(error);
        let most = r[first..first + law.rows()].iter().fold(0.0_f64, |most, r| most.max(r.abs()));
        noise = noise.hypot(4.0 * f64::EPSILON * s * most);
    }
    let size = problem.q().iter().fold(0.0_f64, |sum, q| sum.hypot(*q)).max(1e-12);
    [sum / size, noise / size]
}

/// What is wrong with a status, if anything is.
fn lie(problem: &Problem, known: &Known, method: &Method, tolerance: f64) -> (Status, Option<String>) {
    let effort = Effort { tolerance, iterations: 2000, ..Effort::default() };
    let found = (method.solve)(problem, &effort);
    let [left, noise] = residual(problem, &found.r);
    let wrong = match (found.status, known) {
        (Status::Solved, Known::None) => Some("a solution where there is none".to_string()),
        (Status::Solved, _) if left > tolerance * 1.001 + noise => Some(format!("a residual of {left:.1e}")),
        (Status::Solved, Known::One(r)) => {
            let off = r.iter().zip(&found.r).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            (off > 1e-5 && tolerance < 1e-7).then(|| format!("off by {off:.1e}"))
        }
        (Status::NoSolution, Known::One(_) | Known::Some) => Some("a denied solution".to_string()),
        (Status::Limit | Status::Ray, _) if left <= tolerance * 0.999 - noise => {
            Some("a solution unseen".to_string())
        }
        _ => None,
    };
    (found.status, wrong)
}

#[test]
fn no_status_is_a_lie() {
    let count: u64 = std::env::var("COUNT").ok().and_then(|count| count.parse().ok()).unwrap_or(8);
    let mut lies = Vec::new();
    println!("of {count} problems: solved, proved to have no solution, neither, wrong");
    for kind in KINDS {
        println!("{}", kind.name);
        let problems: Vec<_> = (0..count).map(|seed| (kind.make)(&mut Random(seed * 7919 + 1))).collect();
        for method in Method::ALL {
            let mut counts = [0; 4];
            for (seed, (problem, known)) in problems.iter().enumerate() {
                let tolerance = [1e-8, 1e-10, 1e-4][seed % 3];
                let (status, wrong) = lie(problem, known, method, tolerance);
                if let Some(wrong) = wrong {
                    counts[3] += 1;
                    lies.push(format!("{} of {} {seed}: {status:?}, {wrong}", method.name, kind.name));
                    continue;
                }
                counts[match status {
                    Status::Solved => 0,
                    Status::NoSolution => 1,
                    Status::Ray | Status::Limit => 2,
                }] += 1;
                // Exact methods prove what can be proved, and solve what has to be solvable for them.
                let exact = EXACT.contains(&method.name);
                if exact && *known == Known::None && status != Status::NoSolution {
                    lies.push(format!("{} of {} {seed}: not proved, {status:?}", method.name, kind.name));
                }
                if exact && matches!(known, Known::One(_)) && status != Status::Solved {
                    lies.push(format!("{} of {} {seed}: not solved, {status:?}", method.name, kind.name));
                }
            }
            println!("  {:15} {:4} {:4} {:4} {:4}", method.name, counts[0], counts[1], counts[2], counts[3]);
        }
    }
    assert!(lies.is_empty(), "{}\n{} of them", lies.join("\n"), lies.len());
}
