//! Drake's convex formulation, SAP (Castro, Permenter and Han, *An unconstrained convex formulation of
//! compliant contact*, 2022; Castro, Han and Masterjohn 2023 for joints).
//!
//! All is rigid as far as a step can tell: the period of a contact's spring is [`CONTACT`] steps, that of a
//! lock's [`LOCK`], and both dissipate within that time. So `R = (β / 2π)² w` with w the row's own mobility,
//! and `v̂ = -φ / (dt + τ)` with `τ = β dt / π`. Tangents have `R = σ w`: instead of sticking a contact
//! creeps, at most by [`SLIP`] times the velocity that its friction could stop. A point that is still open
//! may close within the step. There is no restitution.

use super::convex::{Convex, Soft};
use super::points::{Found, Points};
use crate::methods::Effort;
use crate::problem::Law;
use crate::steppers::step::{Resolution, Step};
use crate::system::{System, SystemLaw};
use std::f64::consts::{PI, TAU};

/// β of contacts, limits and drives.
const CONTACT: f64 = 1.0;
/// β of locks.
const LOCK: f64 = 0.1;
/// σ.
const SLIP: f64 = 1e-3;

/// The convex problem of compliant contacts and joints, as stiff as a step can tell.
pub fn sap(step: &Step<'_>, effort: &Effort) -> Resolution {
    let points = Points::new(step);
    solve(step, &points, soft(&points.system), effort)
}

/// The answer of the convex problem.
pub(super) fn solve(step: &Step<'_>, points: &Points, soft: Vec<Soft>, effort: &Effort) -> Resolution {
    let bodies = &step.island.bodies;
    let found = Convex::new(&points.system, bodies, soft).minimise(effort);
    let changes = points.system.velocity_changes(&found.impulses);
    let end = |&i: &usize| [0, 1].map(|k| points.system.bodies[i].free[k] + changes[i][k]);
    let found = Found {
        status: found.status,
        impulses: &found.impulses,
        iterations: found.iterations,
        end: bodies.iter().map(end).collect(),
        moving: None,
    };
    points.resolution(step, found)
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
    let w = mobility(system, law, k);
    if row.compliance > 0.0 {
        return Soft { r: row.compliance, target: 0.0, acts: true };
    }
    if k > 0 {
        return Soft { r: SLIP * w, target: 0.0, acts: true };
    }
    let lock = law.law == Law::LOCKED && !law.drives;
    let beta = if lock { LOCK } else { CONTACT };
    let delay = beta / PI * system.dt;
    let target = match law.gap {
        // Springs do not reach further than their rest.
        Some(gap) if gap > 0.0 => -gap / system.dt,
        Some(gap) => -gap / (system.dt + delay),
        None => -law.off / (system.dt + delay),
    };
    Soft { r: (beta / TAU).powi(2) * w, target, acts: true }
}

/// The mobility of a row, the same for both tangents [1/kg].
pub(super) fn mobility(system: &System, law: &SystemLaw, k: usize) -> f64 {
    let of = |k: usize| system.mobility(&system.rows[law.first + k]);
    let own = if k == 0 { of(0) } else { 0.5 * (of(1) + of(2)) };
    // A row whose bodies are all locked moves nothing, and any positive number does.
    if own > 0.0 { own } else { 1.0 }
}
