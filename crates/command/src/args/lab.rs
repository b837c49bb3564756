//! Options of commands that measure: stability, extremes, methods of the lab, cases and published
//! measurements.

use super::values::*;
use super::{MethodArgs, ReturnArgs};
use backstop::{FrictionCone, FrictionModel, Settings};
use backstop_lab::impacts::{Body, Law};
use backstop_lab::methods::{Friction, Method};
use backstop_lab::simbench::Test;
use backstop_lab::structures::Structure;
use backstop_lab::{WorldMethod, WorldSolver};
use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub(crate) struct StabilityOptions {
    /// tower, pyramid, wall, high_wall, barrels, coins, light, crib, edge or layers, with a size (`tower_30`)
    /// or without; or a scene, as for `run` [default: the whole set of structures and settings that have to
    /// be stable].
    #[arg(value_name = "SCENE")]
    pub(crate) scene: Option<String>,
    /// Boxes, rows or levels; for `light` how many times lighter the lower box is.
    #[arg(long, value_name = "N", value_parser = crowd)]
    pub(crate) size: Option<usize>,
    /// Only structures of the set whose names begin like this.
    #[arg(long, value_name = "NAME", conflicts_with = "scene")]
    pub(crate) only: Option<String>,
    /// Steps per second; of the set several [default: 60, of the set 30,60,120].
    #[arg(long, value_name = "HZ,...", value_delimiter = ',', value_parser = hertz)]
    pub(crate) hz: Vec<f32>,
    /// Substeps of the solver in a step [default: 4, of the set 1, 2, 4 and 8].
    #[arg(long, value_name = "N")]
    pub(crate) substeps: Option<u32>,
    /// Solver iterations in each substep [default: 1, of the set 1, 2, 4 and 8 with one substep].
    #[arg(long, value_name = "N")]
    pub(crate) iterations: Option<u32>,
    /// Where friction acts: patch or point [default: patch, of the set both].
    #[arg(long, value_name = "MODEL", value_parser = named::<FrictionModel>)]
    pub(crate) friction_model: Option<FrictionModel>,
    /// Metres of a unit of the structure, and the world's length unit.
    #[arg(long, value_name = "M", default_value_t = 1.0, value_parser = positive)]
    pub(crate) scale: f32,
    /// Density of the structure in kg/m³.
    #[arg(long, value_name = "D", default_value_t = 1000.0, value_parser = positive)]
    pub(crate) density: f32,
    /// Seconds to come to rest in, of which the calmest moment is taken.
    #[arg(long, value_name = "S", default_value_t = 15.0, value_parser = positive)]
    pub(crate) settle: f32,
    /// Seconds that the linearised map spans [default: 2].
    #[arg(long, value_name = "S", value_parser = positive)]
    pub(crate) horizon: Option<f32>,
    /// How far the state is displaced, in length units [default: 5e-5].
    #[arg(long, value_name = "D")]
    pub(crate) displacement: Option<f64>,
    /// Dimension of the Krylov space [default: 30].
    #[arg(long, value_name = "N")]
    pub(crate) dimension: Option<usize>,
    /// Print one JSON document instead of the table (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct ExtremesOptions {
    /// Only cells with this in their names, which are like `stack/gravity/100-g`.
    #[arg(long, value_name = "TEXT")]
    pub(crate) only: Option<String>,
    /// Name the cells and run none.
    #[arg(long)]
    pub(crate) list: bool,
    /// Seconds that each cell is watched for.
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = positive)]
    pub(crate) seconds: f32,
    /// Cells that run at once.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = threads)]
    pub(crate) jobs: usize,
    /// Keep each cell's figures in this file as it ends, and leave out those that are in it already, of the
    /// same build.
    #[arg(long, value_name = "FILE")]
    pub(crate) results: Option<PathBuf>,
    /// Show another engine's results, of a file in the same format, beside these; it is an error if a cell is
    /// lost here and stable there.
    #[arg(long, value_name = "FILE")]
    pub(crate) beside: Vec<PathBuf>,
    /// It is an error if a cell is worse than in this file of results.
    #[arg(long, value_name = "FILE")]
    pub(crate) guard: Option<PathBuf>,
    /// Write the map as an HTML page.
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
    /// Print one JSON document instead of the map.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct MethodsOptions {
    /// Only this structure: pyramid, arch, card-house or chain; may be given again.
    #[arg(long, value_name = "NAME", value_parser = structure)]
    pub(crate) structure: Vec<Structure>,
    /// Only this method, or backstop for the engine's own; may be given again [default: all].
    #[arg(long, value_name = "NAME", value_parser = any_method)]
    pub(crate) method: Vec<AnyMethod>,
    /// Seconds that each structure is watched for.
    #[arg(long, value_name = "S", default_value_t = 2.0, value_parser = positive)]
    pub(crate) seconds: f32,
    /// Length of a step in seconds: a number or a fraction.
    #[arg(long, value_name = "SECONDS", default_value = "1/60", value_parser = seconds)]
    pub(crate) dt: f32,
    /// The most sweeps, iterations or pivots of an island in a step.
    #[arg(long, value_name = "N", default_value_t = 1000)]
    pub(crate) iterations: u32,
    /// Unit-free residual to be reached.
    #[arg(long, value_name = "R", default_value_t = 1e-8, value_parser = tolerance)]
    pub(crate) tolerance: f64,
    #[command(flatten)]
    pub(crate) methods: MethodArgs,
    #[command(flatten)]
    pub(crate) returns: ReturnArgs,
    /// Print one JSON document instead of a table (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct SolveOptions {
    /// A .dat file of Siconos, with a linear complementarity problem or a contact problem; with the feature
    /// hdf5 also an .hdf5 file of FCLIB.
    #[arg(value_name = "FILE", required_unless_present = "list")]
    pub(crate) file: Option<PathBuf>,
    /// By which method (--list names them).
    #[arg(long, value_name = "NAME", required_unless_present = "list", value_parser = solver)]
    pub(crate) method: Option<&'static Method>,
    /// The most iterations, sweeps or pivots.
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    pub(crate) iterations: u32,
    /// Residual to be reached, without unit.
    #[arg(long, value_name = "T", default_value_t = 1e-10, value_parser = tolerance)]
    pub(crate) tolerance: f64,
    /// Friction of contacts, where the method has a choice: cone, pyramid or box.
    #[arg(long, value_name = "SHAPE", default_value = "cone", value_parser = friction)]
    pub(crate) friction: Friction,
    /// Over-relaxation of psor.
    #[arg(long, value_name = "W", default_value_t = 1.3, value_parser = relaxation)]
    pub(crate) relaxation: f64,
    /// Impulses that the method starts from: zero, or the solution in a document of `solve --json`.
    #[arg(long, value_name = "FILE.json", default_value = "zero")]
    pub(crate) guess: PathBuf,
    /// Describe the methods and solve nothing.
    #[arg(long)]
    pub(crate) list: bool,
    /// Print one JSON document instead of the summary (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
}

/// How a step is solved where measured motion is followed.
#[derive(Args, Debug)]
pub(crate) struct StepOptions {
    /// Substeps of a step.
    #[arg(long, value_name = "N", default_value_t = 4)]
    pub(crate) substeps: u32,
    /// Iterations of a substep.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) iterations: u32,
    /// Where friction acts: patch or point.
    #[arg(long, value_name = "MODEL", default_value = "patch", value_parser = named::<FrictionModel>)]
    pub(crate) friction_model: FrictionModel,
    /// Solve each step by a method of the lab instead (docs/methods.md).
    #[arg(long, value_name = "NAME", value_parser = world_method)]
    pub(crate) solver: Option<WorldMethod>,
    #[command(flatten)]
    pub(crate) methods: MethodArgs,
}

impl StepOptions {
    /// The method of the lab, with its options.
    pub(crate) fn solver(&self) -> anyhow::Result<Option<WorldSolver>> {
        self.methods.of(self.solver.map(WorldSolver::new))
    }

    /// Settings with these, and the defaults.
    pub(crate) fn settings(&self) -> Settings {
        Settings::default()
            .with_substeps(self.substeps)
            .with_iterations(self.iterations)
            .with_friction_model(self.friction_model)
    }
}

#[derive(Args, Debug)]
pub(crate) struct TossOptions {
    /// A folder of CSV files, one a toss: t_s, px_m, py_m, pz_m, qw, qx, qy, qz, vx_m_s, vy_m_s, vz_m_s,
    /// wbx_rad_s, wby_rad_s, wbz_rad_s.
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
    /// Steps between two samples.
    #[arg(long, value_name = "N", default_value_t = 1)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) parts: u32,
    #[command(flatten)]
    pub(crate) step: StepOptions,
    /// Coefficient of friction of cube and plate.
    #[arg(long, value_name = "MU", default_value_t = 0.18)]
    pub(crate) friction: f32,
    /// Restitution of cube and plate.
    #[arg(long, value_name = "E", default_value_t = 0.125)]
    pub(crate) restitution: f32,
    /// How far the plate is lowered [m].
    #[arg(long, value_name = "M", default_value_t = 0.0)]
    pub(crate) lowered: f64,
    /// Print one JSON document instead of a table (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct ImpactOptions {
    /// A CSV file with a line for each impact: rx_m, ry_m, vx_m_s, vy_m_s, w_rad_s, vx_after_m_s,
    /// vy_after_m_s, w_after_rad_s.
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Steps a second.
    #[arg(long, value_name = "N", default_value_t = 240.0, value_parser = hertz)]
    pub(crate) hz: f32,
    #[command(flatten)]
    pub(crate) step: StepOptions,
    /// Radius of gyration of the body [m].
    #[arg(long, value_name = "M", default_value_t = Body::default().gyration)]
    pub(crate) gyration: f64,
    /// Coefficient of friction of body and plate.
    #[arg(long, value_name = "MU", default_value_t = Body::default().friction)]
    pub(crate) friction: f64,
    /// Restitution of body and plate.
    #[arg(long, value_name = "E", default_value_t = Body::default().restitution)]
    pub(crate) restitution: f64,
    /// Compute each impact by a law instead of simulating it: newton, poisson or stronge.
    #[arg(long, value_name = "NAME", value_parser = law, conflicts_with = "solver")]
    pub(crate) law: Option<Law>,
    /// Print one JSON document instead of a table (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct CaseOptions {
    /// Only cases with this in their names; may be given several times.
    #[arg(long = "case", value_name = "NAME")]
    pub(crate) cases: Vec<String>,
    /// What solves the steps: backstop or a method of the lab (`solve --list`); may be given several times
    /// [default: backstop, gs-cone, admm and sequential].
    #[arg(long = "method", value_name = "NAME", value_parser = any_method)]
    pub(crate) methods: Vec<AnyMethod>,
    /// Rates of the steps, with commas between them [default: six settings, see docs/cases.md].
    #[arg(long, value_name = "HZ,...", value_delimiter = ',', value_parser = hertz)]
    pub(crate) hz: Vec<f32>,
    /// Substeps of the solver in a step [default: 4].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) substeps: Option<u32>,
    /// Solver iterations in each substep [default: 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=256))]
    pub(crate) iterations: Option<u32>,
    /// Where friction acts: patch or point.
    #[arg(long, value_name = "MODEL", value_parser = named::<FrictionModel>)]
    pub(crate) friction_model: Option<FrictionModel>,
    #[command(flatten)]
    pub(crate) lab: MethodArgs,
    #[command(flatten)]
    pub(crate) returns: ReturnArgs,
    /// Runs at once [default: one per core].
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) jobs: Option<usize>,
    /// Name the cases with their formulas and bars, and run none.
    #[arg(long)]
    pub(crate) list: bool,
    /// Print one JSON document instead of tables (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
    /// No progress.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Args, Debug)]
pub(crate) struct SimbenchOptions {
    /// Only this test: rolling, bouncing, 666 or kapla; may be given again.
    #[arg(long, value_name = "NAME", value_parser = simbench_test)]
    pub(crate) test: Vec<Test>,
    /// Solve steps by this method of the lab instead (docs/methods.md); may be given again [default: the
    /// engine's own].
    #[arg(long, value_name = "NAME", value_parser = world_method)]
    pub(crate) method: Vec<WorldMethod>,
    /// The most rows of an island that a method solves; larger ones are left to the engine's own.
    #[arg(long, value_name = "N", default_value_t = 400, requires = "method")]
    pub(crate) rows: usize,
    /// Lengths of a step in seconds: numbers or fractions [default: the test's curve].
    #[arg(long, value_name = "SECONDS,...", value_delimiter = ',', value_parser = seconds)]
    pub(crate) dt: Vec<f32>,
    /// Substeps of a step [default: the test's curve, or 4].
    #[arg(long, value_name = "N")]
    pub(crate) substeps: Option<u32>,
    /// Iterations of a substep [default: the test's curve, or 1].
    #[arg(long, value_name = "N")]
    pub(crate) iterations: Option<u32>,
    /// Bounds of friction: cone or box.
    #[arg(long, value_name = "SHAPE", default_value = "cone", value_parser = named::<FrictionCone>)]
    pub(crate) friction: FrictionCone,
    /// Simulated time [default: as SimBenchmark has it: 4, 20, 10 and 600 s].
    #[arg(long, value_name = "S", value_parser = positive)]
    pub(crate) seconds: Option<f32>,
    /// Print one JSON document instead of tables (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
}
