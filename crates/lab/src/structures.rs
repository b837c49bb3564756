//! The same few structures under every method: time of a step, and how well structures stay up.

use super::WorldSolver;
use super::envelope::{Conditions, Trial};
use super::retroactive::Retroactive;
use crate::LabWorld;
use backstop::BodyHandle;
use backstop::ContinuousMode;
use backstop::Error;
use backstop::Settings;
use backstop::World;
use backstop::limits::within;
use backstop_scene::Standing;
use glam::DVec3;
use std::time::Instant;

/// The structure to build.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Structure {
    /// Seven rows of boxes, 28 of them.
    Pyramid,
    /// Eleven wedges without mortar.
    Arch,
    /// Three storeys of leaning cards.
    CardHouse,
    /// Ten links and a ball, let go level.
    Chain,
}

impl Structure {
    /// All of them.
    pub const ALL: [Structure; 4] =
        [Structure::Pyramid, Structure::Arch, Structure::CardHouse, Structure::Chain];

    /// Lower case, with hyphens.
    pub fn name(self) -> &'static str {
        match self {
            Structure::Pyramid => "pyramid",
            Structure::Arch => "arch",
            Structure::CardHouse => "card-house",
            Structure::Chain => "chain",
        }
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<Structure> {
        Structure::ALL.into_iter().find(|one| one.name() == name)
    }

    fn build(self) -> Result<(World, Vec<BodyHandle>), Error> {
        let trial = match self {
            Structure::Pyramid => return Standing::Pyramid(7).build(Settings::default(), 1000.0),
            Structure::Arch => Trial::Arch,
            Structure::CardHouse => Trial::CardHouse,
            Structure::Chain => Trial::Chain,
        };
        let scene = trial.scene(&Conditions::default());
        let mut world = World::new(Settings::default().with_gravity(scene.gravity))?;
        let bodies = scene.add_to(&mut world)?.bodies;
        Ok((world, bodies))
    }

    /// Runs it under a method, or under the fast path alone, with steps of `dt` seconds. Islands are solved
    /// as `solver` says; with retroactive detection there is no continuous collision.
    ///
    /// # Errors
    /// If `dt` can't be a step's, or `seconds` is not in 0..=3600.
    pub fn run(
        self,
        solver: Option<WorldSolver>,
        retroactive: Option<Retroactive>,
        dt: f32,
        seconds: f32,
    ) -> Result<Outcome, Error> {
        within("seconds", seconds, 0.0, 3600.0, "in 0..=3600")?;
        backstop::limits::step(dt)?;
        let (mut world, bodies) = self.build()?;
        if retroactive.is_some() {
            world.set_settings(world.settings().clone().with_continuous(ContinuousMode::Discrete))?;
        }
        world.solve_with(solver);
        world.measure_accuracy(true);
        let start: Vec<DVec3> = bodies.iter().map(|&body| world.position(body)).collect::<Result<_, _>>()?;
        let (mut times, mut residuals) = (Vec::new(), Vec::new());
        let mut outcome = Outcome::default();
        let mut energy = None;
        for _ in 0..(seconds / dt).round().max(1.0) as u32 {
            let begin = Instant::now();
            match retroactive {
                Some(way) => drop(way.step(&mut world, dt)?),
                None => drop(world.step(dt)?),
            }
            times.push(begin.elapsed().as_secs_f64());
            if let Some(accuracy) = world.accuracy() {
                let measures = &accuracy.whole;
                residuals.push(measures.residual.worst);
                let before = *energy.get_or_insert(measures.energy_before);
                outcome.gained = outcome.gained.max(measures.energy_after - before);
                outcome.joint_error = outcome.joint_error.max(measures.joint_length);
            }
            if let Some(report) = world.solver_report() {
                outcome.refused += report.refused;
            }
        }
        let median = |values: &mut Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(0.0)
        };
        outcome.time = median(&mut times);
        outcome.residual = median(&mut residuals);
        if self != Structure::Chain {
            for (&body, start) in bodies.iter().zip(start) {
                outcome.drift = outcome.drift.max((world.position(body)? - start).length());
            }
        }
        Ok(outcome)
    }
}

/// The outcome of a structure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Time of a step, measuring included: the median [s].
    pub time: f64,
    /// Velocity by which the law that is obeyed worst is broken: the median over the steps [m/s].
    pub residual: f64,
    /// How far bodies of standing structures moved from their initial positions [m].
    pub drift: f64,
    /// The greatest joint error [m].
    pub joint_error: f64,
    /// The greatest energy in excess of that at the start [J].
    pub gained: f64,
    /// Islands that the method could not solve, summed over all steps: they kept the fast path's result.
    pub refused: usize,
}
