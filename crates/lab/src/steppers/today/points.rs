//! The contacts of an island as points with Coulomb's cone, and its joints as they are: the rows that the
//! methods of today know.
//!
//! Friction of a patch is shared by its points, each of which has two tangents of its own. None of these
//! methods has friction against rolling and spinning.

use crate::methods::{Solution, Status};
use crate::problem::Law;
use crate::steppers::step::{Resolution, Step};
use crate::system::{System, SystemLaw, SystemRow, Velocity, with_points};

/// An island as points and joints.
pub(super) struct Points {
    /// Its laws: points first, then those of joints.
    pub(super) system: System,
    /// For each law, its first row in the step's system, and that of its friction.
    of: Vec<(usize, Option<usize>)>,
    /// For each row, whether it is of a point whose friction is shared.
    patches: Vec<bool>,
    /// Whether a contact resists rolling or spinning.
    rolls: bool,
}

impl Points {
    pub(super) fn new(step: &Step<'_>) -> Points {
        let Step { system, island, .. } = *step;
        let (mut points, mut of) = with_points(system, island);
        let mut patches = Vec::new();
        for law in island.laws.iter().map(|&i| &system.laws[i]).filter(|law| law.gap.is_some()) {
            // As `with_points` takes them.
            patches.extend([!matches!(law.law, Law::Contact { .. }); 3]);
        }
        for law in island.laws.iter().filter(|&&i| i >= system.contacts).map(|&i| &system.laws[i]) {
            of.push((law.first, None));
            points.push(*law, &system.rows[law.first..law.first + law.law.rows()]);
        }
        let rolls = island.laws.iter().any(|&i| system.laws[i].resists);
        Points { system: points, of, patches, rolls }
    }

    /// The rows of a law.
    pub(super) fn rows_of(&self, law: &SystemLaw) -> &[SystemRow] {
        &self.system.rows[law.first..law.first + law.law.rows()]
    }

    /// Impulses to start with by the rows of the points, from those of the problem, if there are any: points
    /// share the friction of a patch by their normal impulses.
    pub(super) fn start(&self, step: &Step<'_>, start: Option<&[f64]>) -> Option<Vec<f64>> {
        let mut all = vec![0.0; step.system.rows.len()];
        let start = start.filter(|start| start.len() == step.problem.rows())?;
        for (row, r) in rows(step).zip(start) {
            all[row] = *r;
        }
        let mut loads = vec![0.0; all.len()];
        for &(normal, friction) in &self.of {
            friction.iter().for_each(|&friction| loads[friction] += all[normal]);
        }
        let mut own = vec![0.0; self.system.rows.len()];
        for (law, &(normal, friction)) in self.system.laws.iter().zip(&self.of) {
            own[law.first] = all[normal];
            if let Some(friction) = friction.filter(|&friction| loads[friction] > 0.0) {
                let share = all[normal] / loads[friction];
                (0..2).for_each(|k| own[law.first + 1 + k] = share * all[friction + k]);
            }
        }
        Some(own)
    }

    /// The answer of a method, from the impulses of the points over the step and the velocities of the bodies
    /// of the island. An island with friction against rolling is refused ([`Status::NoSolution`]).
    pub(super) fn resolution(&self, step: &Step<'_>, found: Found<'_>) -> Resolution {
        let mut all = vec![0.0; step.system.rows.len()];
        for (law, &(normal, friction)) in self.system.laws.iter().zip(&self.of) {
            all[normal] += found.impulses[law.first];
            let Some(friction) = friction.filter(|_| matches!(law.law, Law::Contact { .. })) else {
                continue;
            };
            for k in 0..2 {
                let r = found.impulses[law.first + 1 + k];
                all[friction + k] += r;
                // Tangents of a patch act at its middle: the rest is its twist.
                if self.patches[law.first] {
                    let (own, patch) = (&self.rows_of(law)[1 + k], &step.system.rows[friction + k]);
                    let side = usize::from(own.bodies[0].is_none());
                    let axis = step.system.rows[friction + 2].angular[side];
                    all[friction + 2] += (own.angular[side] - patch.angular[side]).dot(axis) * r;
                }
            }
        }
        let r: Vec<f64> = rows(step).map(|row| all[row]).collect();
        let residual = step.problem.residual(&r).relative.min(f64::MAX);
        let status = if self.rolls { Status::NoSolution } else { found.status };
        let solution = Solution { status, r, iterations: found.iterations, pivots: 0, residual };
        Resolution { solution, end: found.end, moving: found.moving }
    }
}

/// The outcome of a method on points.
pub(super) struct Found<'a> {
    pub(super) status: Status,
    /// By the rows of the points.
    pub(super) impulses: &'a [f64],
    pub(super) iterations: u32,
    pub(super) end: Vec<Velocity>,
    pub(super) moving: Option<Vec<Velocity>>,
}

/// The rows of a step's problem, as rows of its system.
fn rows<'a>(step: &Step<'a>) -> impl Iterator<Item = usize> + 'a {
    let system = step.system;
    step.island.laws.iter().flat_map(move |&i| {
        let law = &system.laws[i];
        law.first..law.first + law.law.rows()
    })
}
