//! MuJoCo's soft constraints (Todorov, *Convex and analytically-invertible dynamics with contacts and
//! constraints*, 2014; MuJoCo's documentation, "Computation").
//!
//! Each constraint has an acceleration that it strives for, that of a damped spring with its error r,
//! `a_ref = -b v - k d r`, and an impedance `d` in 0..1 that grows with the error: the constraint gets
//! `R = (1 - d) / d` times its own mobility as regularisation, so that it accelerates at a mean of `a_ref`
//! and of the acceleration without it. Defaults are MuJoCo's: a time constant of 20 ms, but at least two
//! steps, a damping ratio of 1, and `d` from 0.9 to 0.95 over the first millimetre. Friction is on the
//! elliptic cone, damped and not held, with the normal's regularisation (`impratio` 1).
//!
//! A contact acts once bodies overlap, not before, and nothing bounces.

use super::convex::Soft;
use super::points::Points;
use super::sap::{mobility, solve};
use crate::methods::Effort;
use crate::steppers::step::{Resolution, Step};
use crate::system::{System, SystemLaw};

/// Time constant [s] (`solref`), whose damping ratio is 1.
const TIME: f64 = 0.02;
/// Impedance without error and from [`WIDTH`] on (`solimp`).
const IMPEDANCE: [f64; 2] = [0.9, 0.95];
/// [m]
const WIDTH: f64 = 1e-3;

/// The convex problem of constraints that strive for the acceleration of a damped spring.
pub fn mujoco(step: &Step<'_>, effort: &Effort) -> Resolution {
    let points = Points::new(step);
    let soft = soft(&points.system);
    solve(step, &points, soft, effort)
}

/// What rows are asked for.
pub(super) fn soft(system: &System) -> Vec<Soft> {
    let mut soft = Vec::with_capacity(system.rows.len());
    for law in &system.laws {
        soft.extend((0..law.law.rows()).map(|k| row(system, law, k)));
    }
    soft
}

fn row(system: &System, law: &SystemLaw, k: usize) -> Soft {
    let row = &system.rows[law.first + k];
    if row.compliance > 0.0 {
        return Soft { r: row.compliance, target: 0.0, acts: true };
    }
    let error = law.gap.unwrap_or(law.off);
    let d = impedance(error);
    // Friction has the regularisation of the normal, in terms of its mobility.
    let w = mobility(system, law, 0);
    let time = TIME.max(2.0 * system.dt);
    let damping = 2.0 / (IMPEDANCE[1] * time);
    let stiffness = d / (IMPEDANCE[1] * time).powi(2);
    let speed = system.speed(row, |body| body.start) + row.bias;
    let spring = if k == 0 { stiffness * error } else { 0.0 };
    let target = speed - system.dt * (damping * speed + spring);
    let acts = law.gap.is_none_or(|gap| gap < 0.0);
    Soft { r: (1.0 - d) / d * w, target, acts }
}

/// The impedance at an error: a curve of two parabolas.
fn impedance(error: f64) -> f64 {
    let x = (error.abs() / WIDTH).min(1.0);
    let y = if x < 0.5 { 2.0 * x * x } else { 1.0 - 2.0 * (1.0 - x) * (1.0 - x) };
    IMPEDANCE[0] + (IMPEDANCE[1] - IMPEDANCE[0]) * y
}
