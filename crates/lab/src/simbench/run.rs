//! How a test is run, by which solver, and its result.

use crate::LabWorld;
use crate::WorldSolver;
use backstop::BodyDesc;
use backstop::Error;
use backstop::World;
use backstop::{FrictionCone, Settings};
use backstop::{Geometry, Material, ShapeDesc};
use std::ops::ControlFlow;
use std::time::Instant;

/// How a test is run.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Length of a step [s]. Default 0.01.
    pub dt: f32,
    /// Substeps of a step. Default 4.
    pub substeps: u32,
    /// Iterations of a substep. Default 1.
    pub iterations: u32,
    /// Cone or box. Default cone.
    pub friction_cone: FrictionCone,
    /// The method that solves the steps, if not the engine's own solver. Default none.
    pub solver: Option<WorldSolver>,
    /// Simulated time [s]; none: that of SimBenchmark, which is the default.
    pub seconds: Option<f32>,
}

impl Default for Setting {
    fn default() -> Setting {
        let Settings { substeps, iterations, friction_cone, .. } = Settings::default();
        Setting { dt: 0.01, substeps, iterations, friction_cone, solver: None, seconds: None }
    }
}

/// The result of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// SimBenchmark's metric, in [`Test::unit`](super::Test::unit).
    pub metric: f64,
    /// The same without unit: rolling: root of the mean squared error over that of the velocities; bouncing:
    /// the same of the energy; 666: root of the mean squared penetration of a ball over its radius; kapla:
    /// the furthest that a brick is from its place at the end, over its height.
    pub relative: f64,
    /// Whether the tower fell.
    pub fell: bool,
    /// Wall-clock time of a step: the median [s].
    pub step_time: f64,
    /// Steps that were taken.
    pub steps: u32,
    /// Islands that the setting's solver left to the engine's own, summed over all steps.
    pub left: usize,
}

/// A world that is run step by step.
pub(super) struct Run {
    pub(super) world: World,
    dt: f32,
    pub(super) steps: u32,
    times: Vec<f64>,
    left: usize,
}

impl Run {
    /// A world for bodies with this typical length [m].
    pub(super) fn new(setting: &Setting, seconds: f32, length_unit: f32) -> Result<Run, Error> {
        let world = World::new(
            Settings::default()
                .with_length_unit(length_unit)
                .with_substeps(setting.substeps)
                .with_iterations(setting.iterations)
                .with_friction_cone(setting.friction_cone),
        )?;
        let steps = (seconds / setting.dt).round() as u32;
        Ok(Run { world, dt: setting.dt, steps, times: Vec::new(), left: 0 })
    }

    /// The ground: the plane y = 0.
    pub(super) fn ground(&mut self, material: Material) -> Result<(), Error> {
        let plane = ShapeDesc::new(Geometry::Plane).with_material(material);
        self.world.add_body(&BodyDesc::fixed().with_shape(plane)).map(drop)
    }

    /// Steps; `before` sees the world before each step and may end the run.
    pub(super) fn go(
        &mut self,
        setting: &Setting,
        mut before: impl FnMut(&mut World, u32) -> Result<ControlFlow<()>, Error>,
    ) -> Result<(), Error> {
        self.world.solve_with(setting.solver.clone());
        for step in 0..self.steps {
            if before(&mut self.world, step)?.is_break() {
                break;
            }
            let begin = Instant::now();
            self.world.step(self.dt)?;
            self.times.push(begin.elapsed().as_secs_f64());
            if let Some(report) = self.world.solver_report() {
                self.left += report.refused + report.too_large;
            }
        }
        Ok(())
    }

    /// Steps a world whose energy should stay the same: the metric is its mean squared error.
    pub(super) fn energy(mut self, setting: &Setting) -> Result<Outcome, Error> {
        let (start, steps) = (self.world.energy(), f64::from(self.steps.max(1)));
        let mut errors = 0.0;
        self.go(setting, |world, _| {
            errors += (world.energy() - start).powi(2);
            Ok(ControlFlow::Continue(()))
        })?;
        let mean = errors / steps;
        Ok(self.outcome(mean, mean.sqrt() / start, false))
    }

    pub(super) fn outcome(mut self, metric: f64, relative: f64, fell: bool) -> Outcome {
        let steps = self.times.len();
        self.times.sort_by(f64::total_cmp);
        let step_time = self.times.get(steps / 2).copied().unwrap_or(0.0);
        Outcome { metric, relative, fell, step_time, steps: steps as u32, left: self.left }
    }
}

/// Mass in a sphere's density [kg/m³].
pub(super) fn sphere_density(mass: f32, radius: f32) -> f32 {
    mass / (4.0 / 3.0 * std::f32::consts::PI * radius * radius * radius)
}
