//! A case, how its world is stepped, and its outcome.

use crate::LabWorld;
use crate::retroactive::Retroactive;
use crate::{MethodOptions, WorldMethod, WorldSolver};
use backstop::Error;
use backstop::World;
use backstop::{ContinuousMode, FrictionModel, Settings};
use glam::Vec3;

/// One case: its bodies, the exact answer, and the error that is accepted.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Lower case, with hyphens.
    pub name: &'static str,
    /// Sentence about the case and the measured number.
    pub about: &'static str,
    /// The exact answer as a formula.
    pub formula: &'static str,
    /// Unit of the measured number.
    pub unit: &'static str,
    /// The greatest error that a good engine has at 60 Hz with 4 to 8 substeps, relative to the exact answer;
    /// if that is zero, in `unit`.
    pub bar: f64,
    /// Builds the bodies, steps the world and measures.
    pub(super) measure: fn(&Setting) -> Result<Outcome, Error>,
}

impl Case {
    /// Runs it.
    ///
    /// # Errors
    /// If the world refuses a setting, or a step fails.
    pub fn run(&self, setting: &Setting) -> Result<Outcome, Error> {
        (self.measure)(setting)
    }
}

/// How the world of a case is stepped.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Length of a step [s].
    pub dt: f32,
    /// Substeps of the engine's solver; methods of the lab solve a step as one.
    pub substeps: u32,
    /// Iterations of each substep.
    pub iterations: u32,
    /// Where friction acts.
    pub friction: FrictionModel,
    /// The solver of the rows of a step: a method of the lab, or, if there is none, the engine's own solver.
    pub method: Option<WorldMethod>,
    /// What that method leaves to choose; none: its defaults.
    pub options: Option<MethodOptions>,
    /// Retroactive detection, in the place of continuous collision.
    pub retroactive: Option<Retroactive>,
}

impl Setting {
    /// The setting for which the bars hold: 60 Hz, and the defaults of [`Settings`].
    pub const REFERENCE: Setting = Setting {
        dt: 1.0 / 60.0,
        substeps: 4,
        iterations: 1,
        friction: FrictionModel::Patch,
        method: None,
        options: None,
        retroactive: None,
    };

    /// The settings of the table: the reference, then one thing changed in each; the steps are halved twice.
    /// Methods of the lab know no substeps.
    pub fn usual(method: Option<WorldMethod>) -> Vec<Setting> {
        let reference = Setting { method, ..Setting::REFERENCE };
        let mut settings = vec![
            reference,
            Setting { dt: 1.0 / 120.0, ..reference },
            Setting { dt: 1.0 / 240.0, ..reference },
            Setting { friction: FrictionModel::Point, ..reference },
        ];
        if method.is_none() {
            settings.push(Setting { substeps: 16, ..reference });
            settings.push(Setting { substeps: 1, iterations: 8, ..reference });
        }
        settings
    }

    /// Name of the method: `backstop` is the engine's own solver.
    pub fn method_name(&self) -> &'static str {
        self.method.map_or("backstop", |method| method.name())
    }

    /// Rate, and substeps and iterations of the engine's solver, as `60 Hz 4x1`; with `point` if friction
    /// acts at points.
    pub fn name(&self) -> String {
        let passes = if self.method.is_none() {
            format!(" {}x{}", self.substeps, self.iterations)
        } else {
            String::new()
        };
        let point = if self.friction == FrictionModel::Point { " point" } else { "" };
        format!("{:.0} Hz{passes}{point}", 1.0 / self.dt)
    }

    /// An empty world with these settings.
    pub(super) fn world(&self, settings: Settings) -> Result<World, Error> {
        let Setting { substeps, iterations, friction: friction_model, .. } = *self;
        let settings = match self.retroactive {
            Some(_) => settings.with_continuous(ContinuousMode::Discrete),
            None => settings,
        };
        let mut world = World::new(
            settings.with_substeps(substeps).with_iterations(iterations).with_friction_model(friction_model),
        )?;
        let options = self.options.unwrap_or_default();
        world.solve_with(self.method.map(|method| WorldSolver::new(method).with_options(options)));
        Ok(world)
    }

    /// The defaults with this gravity [m/s²].
    pub(super) fn settings(gravity: Vec3) -> Settings {
        Settings::default().with_gravity(gravity)
    }
}

/// The exact answer and the measured one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The formula's value for the bodies that were built.
    pub expected: f64,
    /// NaN if the event to be measured never happened.
    pub measured: f64,
    /// The divisor of the difference.
    pub scale: f64,
}

impl Outcome {
    /// An outcome whose error is relative to the exact answer.
    pub(super) fn of(expected: f64, measured: f64) -> Outcome {
        Outcome { expected, measured, scale: expected.abs() }
    }

    /// The exact answer is zero: the error is the measured number.
    pub(super) fn zero(measured: f64) -> Outcome {
        Outcome { expected: 0.0, measured, scale: 1.0 }
    }

    /// The error of the measured answer; infinite if there is none.
    pub fn error(&self) -> f64 {
        let error = (self.measured - self.expected).abs() / self.scale;
        if error.is_nan() { f64::INFINITY } else { error }
    }
}
