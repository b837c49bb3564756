//! A system as a problem: W and q.

use super::*;
use crate::problem::{Law, Matrix, Problem};
use backstop::Error;

/// How overlap is pushed apart, beyond not letting it grow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Stabilisation {
    /// Nothing: no row demands a separating velocity.
    #[default]
    Rest,
    /// Overlap beyond `slop` is pushed apart by this share per second, no faster than `most`.
    Push {
        /// [1/s]
        rate: f64,
        /// [m]
        slop: f64,
        /// [m/s]
        most: f64,
        /// Share of the errors of joint locks that is corrected per second, with no limit [1/s].
        joint_rate: f64,
    },
}

/// See [`SystemProblems::problem`].
pub(crate) fn problem(system: &System, stabilisation: Stabilisation) -> Result<Problem, Error> {
    let all: Vec<usize> = (0..system.laws.len()).collect();
    problem_of(system, &all, stabilisation)
}

/// See [`SystemProblems::problem_of`].
pub(crate) fn problem_of(
    system: &System,
    laws: &[usize],
    stabilisation: Stabilisation,
) -> Result<Problem, Error> {
    let mut place = vec![usize::MAX; system.rows.len()];
    let (mut rows, mut kept) = (Vec::new(), Vec::new());
    for &i in laws {
        let SystemLaw { law, first, .. } = system.laws[i];
        let own = first..first + law.rows();
        place[own.clone()].iter_mut().zip(rows.len()..).for_each(|(place, row)| *place = row);
        rows.extend(own);
        kept.push(match law {
            Law::Patch { mu, arm, first, count } => Law::Patch { mu, arm, first: place[first], count },
            other => other,
        });
    }
    let mut q = vec![0.0; rows.len()];
    for &i in laws {
        let law = &system.laws[i];
        for row in law.first..law.first + law.law.rows() {
            q[place[row]] = system.speed(&system.rows[row], |body| body.free) + system.rows[row].bias;
        }
        q[place[law.first]] += offset(system, law, stabilisation);
    }
    Problem::new(kept, matrix(system, &rows), q)
}

/// Whether a stabilisation changes the problem of an island.
pub(crate) fn needs_push(system: &System, island: &SystemIsland, stabilisation: Stabilisation) -> bool {
    let mut laws = island.laws.iter().map(|&i| &system.laws[i]);
    laws.any(|law| offset(system, law, stabilisation) != offset(system, law, Stabilisation::Rest))
}

/// The term added to the velocity of a law's first row.
fn offset(system: &System, law: &SystemLaw, stabilisation: Stabilisation) -> f64 {
    match (bounce(system, law), stabilisation) {
        (Some([end, _]), Stabilisation::Rest) => -end,
        (Some([_, mean]), Stabilisation::Push { .. }) => -mean,
        (None, _) => target(system, law, stabilisation),
    }
}

/// For a point that bounces within the step, its velocity at the end of the step and the mean over the
/// step. It closes with its initial velocity, gravity and forces, separates at `e` times its closing
/// speed, and is accelerated for the rest of the step.
pub(crate) fn bounce(system: &System, law: &SystemLaw) -> Option<[f64; 2]> {
    let gap = law.gap?;
    let row = &system.rows[law.first];
    let start = system.speed(row, |body| body.start) + row.bias;
    if law.restitution <= 0.0 || -start <= system.threshold || gap + start * system.dt > 0.0 {
        return None;
    }
    let pull = (system.speed(row, |body| body.free) + row.bias - start) / system.dt;
    let gap = gap.max(0.0);
    // The first root of gap + start t + pull t² / 2; there is none if an acceleration away reverses it
    // before it closes.
    let root = (start * start - 2.0 * pull * gap).max(0.0).sqrt();
    let time = (2.0 * gap / (root - start)).min(system.dt);
    let left = system.dt - time;
    let part = -law.restitution * (start + pull * time);
    // A point that would come down again within the step is at rest.
    let end = (part + pull * left).max(0.0);
    let way = (part * left + 0.5 * pull * left * left).max(0.0) - gap;
    Some([end, way / system.dt])
}

/// The same without restitution.
pub(crate) fn target(system: &System, law: &SystemLaw, stabilisation: Stabilisation) -> f64 {
    match (law.gap, stabilisation) {
        (Some(gap), _) if gap > 0.0 => gap / system.dt,
        (Some(gap), Stabilisation::Push { rate, slop, most, .. }) if gap < -slop => {
            ((gap + slop) * rate).max(-most)
        }
        (None, Stabilisation::Push { joint_rate, .. }) => law.off * joint_rate,
        _ => 0.0,
    }
}

/// W of some rows.
fn matrix(system: &System, rows: &[usize]) -> Matrix {
    let mut of_body: Vec<Vec<(usize, usize)>> = vec![Vec::new(); system.bodies.len()];
    for (at, &row) in rows.iter().enumerate() {
        for (side, body) in system.rows[row].bodies.iter().enumerate() {
            if let Some(body) = body.filter(|&body| system.bodies[body].dynamic) {
                of_body[body].push((at, side));
            }
        }
    }
    let mut entries = Vec::new();
    for (at, &row) in rows.iter().enumerate() {
        let compliance = system.rows[row].compliance;
        if compliance > 0.0 {
            entries.push((at, at, compliance));
        }
    }
    for (body, touching) in system.bodies.iter().zip(&of_body) {
        for &(i, side) in touching {
            let row = &system.rows[rows[i]];
            let (p, l) = (body.inverse_mass * row.linear[side], body.inverse_inertia * row.angular[side]);
            entries.extend(touching.iter().map(|&(j, side)| {
                let other = &system.rows[rows[j]];
                (i, j, p.dot(other.linear[side]) + l.dot(other.angular[side]))
            }));
        }
    }
    Matrix::from_entries(rows.len(), entries)
}
/// Whether the bodies of an island have more kinetic energy with velocities `end` than they would without
/// any row, although nothing in it can supply any: no bounce, motor, spring, moving surface or kinematic
/// body. A solution never does (it is the nearest to the free velocities, in the energy norm, of all that
/// the rows allow, and rest is allowed); wrong impulses may.
pub(crate) fn gains(system: &System, island: &SystemIsland, end: &[Velocity]) -> bool {
    let gives = |&i: &usize| {
        let law = &system.laws[i];
        let rows = &system.rows[law.first..law.first + law.law.rows()];
        let moved = |i: &usize| !system.bodies[*i].dynamic;
        let given = |row: &SystemRow| row.bias != 0.0 || row.bodies.iter().flatten().any(moved);
        law.restitution > 0.0 || law.yields || law.drives || rows.iter().any(given)
    };
    if island.laws.iter().any(gives) {
        return false;
    }
    let energy = |body: &SystemBody, [v, w]: Velocity| {
        // Locked axes have no mass.
        let inverse = body.inverse_mass.max_element();
        let linear = if inverse > 0.0 { v.length_squared() / inverse } else { 0.0 };
        let turning = body.inverse_inertia.determinant();
        linear + if turning > 0.0 { w.dot(body.inverse_inertia.inverse() * w) } else { 0.0 }
    };
    let bodies = island.bodies.iter().map(|&i| &system.bodies[i]);
    let free: f64 = bodies.clone().map(|body| energy(body, body.free)).sum();
    let after: f64 = bodies.zip(end).map(|(body, &end)| energy(body, end)).sum();
    after > free * (1.0 + GAIN)
}

/// Share of its energy that an island may gain by the inexactness of its solution.
const GAIN: f64 = 1e-3;
