//! Solves islands anew and replaces the results of the fast path.

use super::{Guess, SolverReport, WorldMethod, WorldSolver};
use crate::methods::{Effort, Status};
use crate::steppers::{Memory, Resolution, Step};
use crate::system::{
    Owner, Stabilisation, System, SystemIsland, SystemProblems, Velocity, gains, needs_push, reduced,
    with_impacts,
};
use backstop::World;
use backstop::observe::Solved;
use std::collections::BTreeMap;

/// State of the previous step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Last {
    /// Impulses of contact rows, in the order of the prepared rows.
    contacts: Vec<f64>,
    /// Impulses of joint rows.
    joints: BTreeMap<JointRowKey, f64>,
    /// Length of the previous step [s].
    dt: f64,
    /// The directions in which bodies entered each other, for penalty methods.
    directions: Memory,
}

impl Last {
    /// Takes the warm starting impulses of contact rows.
    pub(crate) fn take(&mut self, system: &System) {
        let rows = system.contact_rows();
        self.contacts = system.rows[..rows].iter().map(|row| row.impulse).collect();
    }

    /// Impulses of all rows to start from.
    fn guess(&self, system: &System) -> Vec<f64> {
        let mut start = self.contacts.clone();
        start.resize(system.rows.len(), 0.0);
        let warm = if self.dt > 0.0 { system.dt / self.dt } else { 0.0 };
        for (key, row) in joint_rows(system) {
            // New rows start from zero.
            start[row] = self.joints.get(&key).copied().unwrap_or(0.0) * warm;
        }
        start
    }

    fn keep(&mut self, system: &System) {
        self.joints = joint_rows(system).map(|(key, row)| (key, system.rows[row].impulse)).collect();
        self.dt = system.dt;
    }
}

/// A joint or a coupling, by its handle, and which of its rows: it has as many, in the same
/// order, in every step.
type JointRowKey = (bool, u64, u32);

/// Each row of a joint, and its place in the system. Locks of all joints come before their other rows.
fn joint_rows(system: &System) -> impl Iterator<Item = (JointRowKey, usize)> + '_ {
    let mut counts: BTreeMap<(bool, u64), u32> = BTreeMap::new();
    system.laws[system.contacts..].iter().filter_map(move |law| {
        let (couples, handle) = match law.owner {
            Owner::Joint(joint) => (false, joint.to_bits()),
            Owner::Coupling(coupling) => (true, coupling.to_bits()),
            Owner::Contact(_) => return None,
        };
        let count = counts.entry((couples, handle)).or_default();
        *count += 1;
        Some(((couples, handle, *count), law.first))
    })
}

/// Velocities for the end of the step, and those with which bodies move within it.
struct Found {
    impulses: Vec<f64>,
    end: Vec<Velocity>,
    moving: Vec<Velocity>,
}

impl WorldSolver {
    /// Solves the islands of a system whose rows have the fast path's impulses, and replaces its results.
    pub(crate) fn apply(&self, solved: &mut Solved<'_>, last: &mut Last) -> SolverReport {
        let system = &*solved.system;
        let mut report = SolverReport { islands: system.islands.len(), ..SolverReport::default() };
        let start = match self.guess {
            Guess::Zero => Vec::new(),
            Guess::LastStep => last.guess(system),
            Guess::FastPath => system.impulses(),
        };
        let (mut own, mut of) = with_impacts(system);
        if self.direction_memory && self.pushes_itself() {
            last.directions.apply(&mut own);
        }
        if let Some(keep) = self.reduce {
            (own, of) = reduced(&own, &of, keep);
        }
        let begin = |row: &Option<usize>| row.map_or(0.0, |row| start.get(row).copied().unwrap_or(0.0));
        let start: Vec<f64> = if start.is_empty() { start } else { of.iter().map(begin).collect() };
        let chosen: Option<Vec<usize>> = (!self.only.is_empty()).then(|| {
            let handles = system.bodies.iter().enumerate();
            handles.filter(|(_, body)| self.only.contains(&body.body)).map(|(i, _)| i).collect()
        });
        let mut replaced = vec![false; system.rows.len()];
        for (i, island) in own.islands.iter().enumerate() {
            let is_chosen = |of: &Vec<usize>| island.bodies.iter().any(|i| of.contains(i));
            if chosen.as_ref().is_none_or(is_chosen)
                && let Some(found) = self.island(solved.world(), &own, island, &start, &mut report)
            {
                if self.reduce.is_some() {
                    // Points that were left out bear nothing.
                    for row in rows_of(solved.system, &solved.system.islands[i]).collect::<Vec<_>>() {
                        solved.system.rows[row].impulse = 0.0;
                        replaced[row] = true;
                    }
                }
                for (row, &impulse) in rows_of(&own, island).zip(&found.impulses) {
                    if let Some(row) = of[row] {
                        solved.system.rows[row].impulse = impulse;
                        replaced[row] = true;
                    }
                }
                found.put(solved, island);
            }
        }
        if report.solved > 0 {
            solved.keep_impulses(&replaced);
        }
        last.keep(solved.system);
        report
    }

    fn island(
        &self,
        world: &World,
        system: &System,
        island: &SystemIsland,
        start: &[f64],
        report: &mut SolverReport,
    ) -> Option<Found> {
        let rows: Vec<usize> = rows_of(system, island).collect();
        if rows.len() > self.most_rows {
            report.too_large += 1;
            return None;
        }
        let start = (!start.is_empty()).then(|| rows.iter().map(|&row| start[row]).collect());
        let effort = Effort { start, ..self.effort.clone() };
        let Some(Resolution { solution, end, moving }) =
            self.solve(system, island, Stabilisation::Rest, &effort)
        else {
            report.refused += 1;
            return None;
        };
        let settings = world.settings();
        let push = Stabilisation::Push {
            rate: self.overlap_share / system.dt,
            slop: f64::from(settings.slop * settings.length_unit),
            most: f64::from(settings.push_speed * settings.length_unit),
            joint_rate: self.joint_share / system.dt,
        };
        let mut moving = moving.unwrap_or_else(|| end.clone());
        if !self.pushes_itself() && needs_push(system, island, push) {
            let effort = Effort { start: Some(solution.r.clone()), ..self.effort.clone() };
            match self.solve(system, island, push, &effort) {
                Some(pushed) => moving = pushed.end,
                None => report.not_pushed += 1,
            }
        }
        report.solved += 1;
        report.rows += rows.len();
        report.iterations += u64::from(solution.iterations);
        report.pivots += u64::from(solution.pivots);
        report.residual = report.residual.max(solution.residual);
        Some(Found { impulses: solution.r, end, moving })
    }

    /// Whether the method corrects overlap itself.
    fn pushes_itself(&self) -> bool {
        matches!(self.method, WorldMethod::Step(stepper) if stepper.pushes)
    }

    /// The solution of an island; none if it is not acceptable.
    fn solve(
        &self,
        system: &System,
        island: &SystemIsland,
        stabilisation: Stabilisation,
        effort: &Effort,
    ) -> Option<Resolution> {
        // A problem with NaN is left to the fast path.
        let problem = system.problem_of(&island.laws, stabilisation).ok()?;
        let found = match self.method {
            WorldMethod::Problem(method) => {
                let solution = (method.solve)(&problem, effort);
                let end = system.velocities_with(island, &solution.r);
                Resolution { solution, end, moving: None }
            }
            WorldMethod::Step(stepper) => {
                (stepper.resolve)(&Step { system, island, problem: &problem, stabilisation }, effort)
            }
        };
        let Resolution { solution, end, moving } = &found;
        let good = match (self.method, solution.status) {
            (WorldMethod::Step(_), Status::Solved | Status::Limit) | (_, Status::Solved) => true,
            (_, Status::Limit) => solution.residual <= self.most_residual,
            // The laws may have no solution, so the impulses are not one.
            (_, Status::Ray | Status::NoSolution) => false,
        };
        let sound = solution.r.iter().all(|r| r.is_finite())
            && is_finite(end)
            && moving.as_ref().is_none_or(|moving| is_finite(moving));
        // Pushing overlap apart adds energy, and so does a penalty method.
        let is_passive =
            stabilisation == Stabilisation::Rest && matches!(self.method, WorldMethod::Problem(_));
        let gains = || is_passive && gains(system, island, end);
        (good && sound && !gains()).then_some(found)
    }
}

impl Found {
    /// Writes the solution into the step.
    fn put(self, solved: &mut Solved<'_>, island: &SystemIsland) {
        let system = &mut *solved.system;
        for law in &island.laws {
            system.laws[*law].bouncing = false;
        }
        let impulses: Vec<f64> = rows_of(system, island).map(|row| system.rows[row].impulse).collect();
        let explained = system.velocities_with(island, &impulses);
        for ((&i, end), explained) in island.bodies.iter().zip(&self.end).zip(explained) {
            // By friction of points that touched within this step.
            system.bodies[i].given = [0, 1].map(|k| end[k] - explained[k]);
            system.bodies[i].turned = Velocity::default();
        }
        solved.set_motion(island, &self.end, &self.moving);
    }
}

fn rows_of<'a>(system: &'a System, island: &'a SystemIsland) -> impl Iterator<Item = usize> + 'a {
    island.laws.iter().flat_map(|&law| {
        let law = &system.laws[law];
        law.first..law.first + law.law.rows()
    })
}

/// Whether all velocities are within the range that can be stored.
fn is_finite(velocities: &[Velocity]) -> bool {
    let most = f64::from(backstop::limits::MAX_LEFT_SPEED);
    velocities.iter().flatten().all(|v| v.is_finite() && v.abs().max_element() <= most)
}
