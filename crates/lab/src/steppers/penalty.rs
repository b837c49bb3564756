//! Penalty methods: a spring and a damper at every point that overlaps, and in every joint.
//!
//! A point of depth d that approaches at speed s is pushed by `k d + c s`, never pulled; friction is a damper
//! as strong as the cone lets it be. Springs have a frequency, not a stiffness: `k = m ω²`, `c = 2 m ω ζ`
//! with the effective mass m of the row, so that one number suits all sizes. The explicit form takes forces
//! at the start of the step, and is stable up to `ω dt` of 2 for one point without damping, less where points
//! share bodies; the implicit one takes them at the end, as a system of all points, and is stable for any.

use super::moving::Moving;
use super::sequential::resolution;
use super::step::{Resolution, Step};
use crate::methods::{Effort, Solution, Status, gs_cone};
use crate::problem::{Law, Matrix, Problem, project_disc};
use crate::system::System;

/// Springs and dampers with the forces of the start of the step; [`limit`](super::limit) says how stiff they
/// may be.
pub fn penalty(step: &Step<'_>, effort: &Effort) -> Resolution {
    let system = step.system;
    let mut impulses = vec![0.0; system.rows.len()];
    let speed = |row: usize| system.speed(&system.rows[row], |body| body.start) + system.rows[row].bias;
    let [k, c] = spring(effort, system.dt);
    for &i in &step.island.laws {
        let law = &system.laws[i];
        let mass = |row: usize| effective_mass(system, row);
        // The strongest damping that does not reverse the slip.
        let brake =
            |row: usize, most: f64| (-speed(row) * mass(row) * (system.dt * c).min(1.0)).clamp(-most, most);
        let push = || {
            let off = law.gap.unwrap_or(law.off);
            -(system.dt * mass(law.first)) * (k * off + c * speed(law.first))
        };
        match law.law {
            Law::Bounds { min, max } if law.gap.is_none() => {
                let r = if law.yields || law.drives { brake(law.first, f64::INFINITY) } else { push() };
                impulses[law.first] = r.max(min).min(max);
            }
            Law::Bounds { .. } | Law::Contact { .. } => {
                let touches = law.gap.is_some_and(|gap| gap < 0.0);
                impulses[law.first] = if touches { push().max(0.0) } else { 0.0 };
                if let Law::Contact { mu } = law.law {
                    let most = mu * impulses[law.first];
                    let t = [1, 2].map(|k| brake(law.first + k, f64::INFINITY));
                    impulses[law.first + 1..law.first + 3].copy_from_slice(&project_disc(t, most));
                }
            }
            Law::Patch { mu, arm, first, count } => {
                let normal: f64 = impulses[first..first + count].iter().sum();
                let t = [0, 1].map(|k| brake(law.first + k, f64::INFINITY));
                impulses[law.first..law.first + 2].copy_from_slice(&project_disc(t, mu * normal));
                impulses[law.first + 2] = brake(law.first + 2, mu * arm * normal);
            }
        }
    }
    let mut moving = Moving::new(system, |body| body.free);
    for (row, &r) in impulses.iter().enumerate().filter(|(_, r)| **r != 0.0) {
        moving.push(row, r);
    }
    resolution(step, &moving, &impulses, 1)
}

/// The same springs with the forces of the end of the step. The system is solved by `gs-cone`.
pub fn penalty_implicit(step: &Step<'_>, effort: &Effort) -> Resolution {
    let system = step.system;
    let [k, c] = spring(effort, system.dt);
    let mut q = step.problem.q().to_vec();
    let mut entries: Vec<(usize, usize, f64)> = Vec::new();
    for i in 0..step.problem.rows() {
        entries.extend(step.problem.w().row(i).map(|(j, value)| (i, j, value)));
    }
    for (&i, (first, _)) in step.island.laws.iter().zip(step.problem.laws()) {
        let law = &system.laws[i];
        let row = &system.rows[law.first];
        if law.yields || law.drives || matches!(law.law, Law::Patch { .. }) {
            continue;
        }
        // r = -dt (k (gap + dt u) + c u), as a compliance and a target velocity of the row.
        let mass = effective_mass(system, law.first);
        let d = mass * (system.dt * k + c);
        let free = system.speed(row, |body| body.free) + row.bias;
        let gap = law.gap.unwrap_or(law.off);
        q[first] = free + mass * k * gap / d;
        entries.push((first, first, 1.0 / (system.dt * d)));
    }
    let laws = step.problem.laws().map(|(_, law)| law).collect();
    let soft = Problem::new(laws, Matrix::from_entries(q.len(), entries), q);
    let solution =
        soft.map(|soft| gs_cone(&soft, &Effort { tolerance: effort.tolerance.max(1e-12), ..effort.clone() }));
    let solution = solution.unwrap_or_else(|_| Solution {
        status: Status::Limit,
        r: vec![0.0; step.problem.rows()],
        iterations: 0,
        pivots: 0,
        residual: f64::MAX,
    });
    let end = system.velocities_with(step.island, &solution.r);
    Resolution { solution, end, moving: None }
}

/// Stiffness [1/s²] and damping [1/s] per effective mass.
fn spring(effort: &Effort, dt: f64) -> [f64; 2] {
    let frequency = if effort.frequency > 0.0 { effort.frequency } else { FREQUENCY / dt };
    let omega = std::f64::consts::TAU * frequency;
    [omega * omega, 2.0 * omega * effort.damping]
}

/// Frequency of springs unless one is given, as a share of the rate of steps: `ω dt` is 0.3.
const FREQUENCY: f64 = 0.3 / std::f64::consts::TAU;

fn effective_mass(system: &System, row: usize) -> f64 {
    let mobility = system.mobility(&system.rows[row]);
    if mobility > 0.0 { 1.0 / mobility } else { 0.0 }
}
