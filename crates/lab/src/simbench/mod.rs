//! Four tests of SimBenchmark (ETH Zürich, <https://leggedrobotics.github.io/SimBenchmark/>), rebuilt from
//! the description: the same scenes, the same metrics, and the numbers that were published for other engines
//! ([`Test::published`]). `docs/simbench.md` says where each number comes from and what was found.
//!
//! As there, a metric is taken before each step, at the times 0, `dt`, 2 `dt` and so on, and averaged over
//! the run.
//!
//! ```
//! use backstop_lab::simbench::{Setting, Test};
//!
//! # fn main() -> Result<(), backstop::Error> {
//! let setting = Setting { seconds: Some(2.0), ..Setting::default() };
//! // Balls that fall by 5 m and bounce with restitution 1.
//! assert!(Test::Bouncing.run(&setting)?.relative < 1e-3);
//! # Ok(())
//! # }
//! ```

mod bouncing;
mod published;
mod rolling;
mod spheres;
mod tower;

pub use published::Published;
pub use rolling::accelerations;

use super::WorldSolver;
use crate::LabWorld;
use backstop::BodyDesc;
use backstop::Error;
use backstop::World;
use backstop::limits::within;
use backstop::{FrictionCone, Settings};
use backstop::{Geometry, Material, ShapeDesc};
use std::ops::ControlFlow;
use std::time::Instant;

/// The most steps of a run.
const MAX_STEPS: f32 = 1e7;

/// Which test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Test {
    /// A box with 25 balls on it is pushed over the ground; the metric is the squared error of velocities
    /// [m²/s²].
    Rolling,
    /// 49 balls bounce with restitution 1; the metric is the squared error of their energy [J²].
    Bouncing,
    /// 216 balls in a cube collapse; the metric is the sum of squared penetrations [m²].
    Spheres,
    /// A tower of 102 bricks; the metric is how long it stands [s].
    Tower,
}

impl Test {
    /// All of them.
    pub const ALL: [Test; 4] = [Test::Rolling, Test::Bouncing, Test::Spheres, Test::Tower];

    /// SimBenchmark's name.
    pub fn name(self) -> &'static str {
        match self {
            Test::Rolling => "rolling",
            Test::Bouncing => "bouncing",
            Test::Spheres => "666",
            Test::Tower => "kapla",
        }
    }

    /// The test with that name.
    pub fn named(name: &str) -> Option<Test> {
        Test::ALL.into_iter().find(|one| one.name() == name)
    }

    /// Unit of the metric.
    pub fn unit(self) -> &'static str {
        match self {
            Test::Rolling => "m2/s2",
            Test::Bouncing => "J2",
            Test::Spheres => "m2",
            Test::Tower => "s",
        }
    }

    /// SimBenchmark's step, where it does not vary it [s].
    pub fn dt(self) -> f32 {
        if self == Test::Rolling { 0.001 } else { 0.01 }
    }

    /// Simulated time [s].
    pub fn seconds(self) -> f32 {
        match self {
            Test::Rolling => 4.0,
            Test::Bouncing => 20.0,
            Test::Spheres => 10.0,
            Test::Tower => 600.0,
        }
    }

    /// The settings of its curve: different step lengths, or different effort if SimBenchmark varies that.
    pub fn curve(self) -> Vec<Setting> {
        let with = |dt, substeps, iterations| Setting { dt, substeps, iterations, ..Setting::default() };
        let steps = |dts: &[f32]| dts.iter().map(|&dt| with(dt, 4, 1)).collect();
        let efforts = |efforts: &[(u32, u32)]| efforts.iter().map(|&(s, i)| with(self.dt(), s, i)).collect();
        match self {
            Test::Rolling => {
                let mut all: Vec<Setting> = efforts(&[(1, 1), (1, 10), (1, 40), (1, 100), (4, 1)]);
                all.extend::<Vec<_>>(steps(&[0.004, 0.01, 1.0 / 60.0, 0.04]));
                all
            }
            Test::Bouncing => steps(&[0.0001, 0.001, 0.004, 0.01, 1.0 / 60.0, 0.04, 0.1]),
            Test::Spheres => steps(&[0.001, 0.004, 0.01, 1.0 / 60.0, 0.04]),
            Test::Tower => efforts(&[(1, 1), (1, 10), (1, 40), (1, 100), (4, 1), (8, 1)]),
        }
    }

    /// Runs it.
    ///
    /// # Errors
    /// If a number of the setting is out of range, or there would be more than ten million steps.
    pub fn run(self, setting: &Setting) -> Result<Outcome, Error> {
        backstop::limits::step(setting.dt)?;
        let seconds = setting.seconds.unwrap_or(self.seconds());
        within("steps", seconds / setting.dt, 1.0, MAX_STEPS, "in 1..=10000000")?;
        match self {
            Test::Rolling => rolling::run(setting, seconds),
            Test::Bouncing => bouncing::run(setting, seconds),
            Test::Spheres => spheres::run(setting, seconds),
            Test::Tower => tower::run(setting, seconds),
        }
    }

    /// What SimBenchmark published about other engines.
    pub fn published(self) -> &'static [Published] {
        published::of(self)
    }
}

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
    /// What solves the steps, if not the engine's own solver. Default none.
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
    /// SimBenchmark's metric, in [`Test::unit`].
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
struct Run {
    world: World,
    dt: f32,
    steps: u32,
    times: Vec<f64>,
    left: usize,
}

impl Run {
    /// A world for bodies with this typical length [m].
    fn new(setting: &Setting, seconds: f32, length_unit: f32) -> Result<Run, Error> {
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
    fn ground(&mut self, material: Material) -> Result<(), Error> {
        let plane = ShapeDesc::new(Geometry::Plane).with_material(material);
        self.world.add_body(&BodyDesc::fixed().with_shape(plane)).map(drop)
    }

    /// Steps; `before` sees the world before each step and may end the run.
    fn go(
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

    fn outcome(mut self, metric: f64, relative: f64, fell: bool) -> Outcome {
        let steps = self.times.len();
        self.times.sort_by(f64::total_cmp);
        let step_time = self.times.get(steps / 2).copied().unwrap_or(0.0);
        Outcome { metric, relative, fell, step_time, steps: steps as u32, left: self.left }
    }
}

/// Mass in a sphere's density [kg/m³].
fn sphere_density(mass: f32, radius: f32) -> f32 {
    mass / (4.0 / 3.0 * std::f32::consts::PI * radius * radius * radius)
}
