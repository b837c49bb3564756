//! The command line.

use crate::trade::TradeOptions;
use crate::view::Look;
use backstop::glam::{DVec3, Vec3};
use backstop::lab::WorldMethod;
use backstop::lab::methods::{Friction, Method};
use backstop::lab::simbench::Test;
use backstop::lab::structures::Structure;
use backstop::{Continuous, ContinuousMethod, FrictionCone, FrictionModel, LoadLimits};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Rigid-body physics with continuous collision in one pass.
#[derive(Debug, Parser)]
#[command(name = "cargo backstop", bin_name = "cargo backstop", version, about)]
pub(crate) struct Options {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a scene and say what came of it.
    Run(Box<RunOptions>),
    /// What continuous collision costs, frame by frame and in bytes.
    Profile(ProfileOptions),
    /// Predict the memory that a scene takes, run it, and compare.
    Plan(PlanOptions),
    /// Shoot bodies of every shape at thin targets and count those that get through.
    Shots(ShotOptions),
    /// Run methods of continuous collision side by side on six scenes (docs/continuous.md).
    Compare(CompareOptions),
    /// Whether what rests is stable: modes of the linearised step that grow (docs/stability.md).
    Stability(StabilityOptions),
    /// Measure what speed costs in accuracy, over a grid of settings, and pick one (docs/trade.md).
    Trade(Box<TradeOptions>),
    /// Run small scenes under extreme conditions and map what holds (docs/envelope.md).
    Extremes(ExtremesOptions),
    /// Run cases of mechanics whose answer is known, by several methods and settings, and print what each is off by
    /// (docs/cases.md).
    Cases(CaseOptions),
    /// Compare measured tosses of a cube with the same tosses simulated (docs/tosses.md).
    Tosses(TossOptions),
    /// Run four tests of SimBenchmark beside the numbers that it published for other engines (docs/simbench.md).
    Simbench(SimbenchOptions),
    /// Solve a linear complementarity or contact problem out of a file by one of many methods (docs/methods.md).
    Solve(SolveOptions),
    /// Run a pyramid, an arch, a card house and a chain under every method of contact resolution (docs/methods.md).
    Methods(MethodsOptions),
    /// Play a recorded run again, compare every step, and name the first that goes another way.
    Replay(ReplayOptions),
    /// Scenes that come with backstop.
    Scenes {
        #[command(subcommand)]
        command: ScenesCommand,
    },
}

#[derive(Debug, Subcommand)]
pub(crate) enum ScenesCommand {
    /// Name the builtin and the shipped scenes.
    List,
    /// Write the shipped scenes as glTF files.
    Write {
        /// Where to; made if it is not there.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
}

/// The load limits that `--no-limits` switches off.
pub(crate) fn limits(none: bool) -> LoadLimits {
    if none { LoadLimits::NONE } else { LoadLimits::default() }
}

#[derive(Args, Debug)]
pub(crate) struct RunOptions {
    /// A .gltf or .glb file, with physics or as static ground; an .obj file as static ground; or the name of a
    /// builtin scene (`cargo backstop scenes list`).
    #[arg(value_name = "FILE")]
    pub(crate) scene: String,
    /// Steps to run [default: as many as make 10 s, or what the builtin scene asks for].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) steps: Option<u32>,
    /// Take the settings of this file, as `trade --out` writes it; options given beside it count more (docs/trade.md).
    #[arg(long, value_name = "FILE")]
    pub(crate) settings: Option<PathBuf>,
    /// Length of a step in seconds: a number or a fraction [default: 1/60].
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub(crate) dt: Option<f32>,
    /// Threads that work on a step [default: 1].
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// Substeps of the solver in a step [default: 4].
    #[arg(long, value_name = "N")]
    pub(crate) substeps: Option<u32>,
    /// Solver iterations in each substep [default: 1].
    #[arg(long, value_name = "N")]
    pub(crate) iterations: Option<u32>,
    /// How fast bodies are kept from passing through others: discrete (not at all), segment or volume
    /// [default: segment].
    #[arg(long, value_name = "MODE", value_parser = continuous)]
    pub(crate) continuous: Option<Continuous>,
    /// By which method: one-pass, speculative, linear-cast or conservative-advancement (docs/continuous.md)
    /// [default: one-pass].
    #[arg(long, value_name = "NAME", value_parser = method)]
    pub(crate) method: Option<ContinuousMethod>,
    /// Let bodies at rest fall asleep.
    #[arg(long)]
    pub(crate) sleep: bool,
    /// Gravity in m/s²: X,Y,Z, or one number for downwards [default: the scene's].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = gravity)]
    pub(crate) gravity: Option<Vec3>,
    /// Rain this many bodies of mixed shapes onto the scene from above.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) drop: usize,
    /// Seed of the rain.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Bytes that the world may reserve: a number, or one with KiB, MiB or GiB. Contacts beyond are left out [default: no
    /// limit].
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    pub(crate) budget: Option<usize>,
    /// Write the scene with its motion as a glTF animation.
    #[arg(long, value_name = "FILE.glb")]
    pub(crate) out: Option<PathBuf>,
    /// Write a page with charts: index.html and its pictures.
    #[arg(long, value_name = "DIR")]
    pub(crate) report: Option<PathBuf>,
    /// Show the scene in a window until it is closed; without a display, write pictures to SCENE-frames/ instead.
    #[arg(long, conflicts_with_all = ["out", "report", "json", "frames"])]
    pub(crate) view: bool,
    /// Write pictures of the scene as PNG files.
    #[arg(long, value_name = "DIR")]
    pub(crate) frames: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) pictures: PictureOptions,
    /// Write a recording of the run: for `cargo backstop replay`.
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// Solve islands by a method of the lab instead of the engine's own (docs/methods.md).
    #[arg(long, value_name = "NAME", value_parser = world_method, conflicts_with = "record")]
    pub(crate) solver: Option<WorldMethod>,
    /// Islands with more rows than this are left to the engine's own.
    #[arg(long, value_name = "N", default_value_t = 400, requires = "solver")]
    pub(crate) solver_rows: usize,
    /// Measure how accurately each step was solved (docs/accuracy.md).
    #[arg(long)]
    pub(crate) accuracy: bool,
    /// Write the contact problem of one step, counted from 1, as text (docs/accuracy.md).
    #[arg(long, value_names = ["STEP", "FILE.dat"], num_args = 2, conflicts_with = "view")]
    pub(crate) export_problem: Option<Vec<String>>,
    /// Read a file however much it asks for: by default more than any game's scene has is refused (`LoadLimits`).
    #[arg(long)]
    pub(crate) no_limits: bool,
    /// Print one JSON document instead of the summary (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
    /// No summary, no progress, no notes.
    #[arg(long)]
    pub(crate) quiet: bool,
}

impl RunOptions {
    /// Of which step the problem is written, and where to.
    pub(crate) fn export(&self) -> anyhow::Result<Option<(u32, PathBuf)>> {
        let Some([step, path]) = self.export_problem.as_deref() else { return Ok(None) };
        match step.parse() {
            Ok(step @ 1..) => Ok(Some((step, path.into()))),
            _ => anyhow::bail!("--export-problem wants the number of a step, from 1, not {step}"),
        }
    }
}

#[derive(Args, Debug)]
pub(crate) struct PlanOptions {
    /// A file or the name of a builtin scene, as for `run`.
    #[arg(value_name = "FILE")]
    pub(crate) scene: String,
    /// Steps to run [default: as many as make 10 s, or what the builtin scene asks for].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) steps: Option<u32>,
    /// How fast bodies are kept from passing through others: discrete (not at all), segment or volume.
    #[arg(long, value_name = "MODE", default_value = "segment", value_parser = continuous)]
    pub(crate) continuous: Continuous,
    /// Let bodies at rest fall asleep.
    #[arg(long)]
    pub(crate) sleep: bool,
    /// Rain this many bodies of mixed shapes onto the scene from above.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) drop: usize,
    /// Seed of the rain.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// A budget to try: bytes, or a number with KiB, MiB or GiB. Says whether the scene fits and what is shed.
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    pub(crate) budget: Option<usize>,
    /// Read a file however much it asks for: by default more than any game's scene has is refused (`LoadLimits`).
    #[arg(long)]
    pub(crate) no_limits: bool,
    /// Print one JSON document instead of the table (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
    /// No progress.
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// Of the window and of pictures.
#[derive(Args, Debug)]
pub(crate) struct PictureOptions {
    /// A picture every so many steps.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) every: u32,
    /// Pixels across and down.
    #[arg(long, value_name = "WxH", default_value = "960x540", value_parser = size)]
    pub(crate) size: (usize, usize),
    /// What is shown, with commas: shapes, contacts, normals, impulses, joints, aabbs, fat-aabbs, motion, centres,
    /// colours, wireframe, grid, walls [default: shapes,contacts,joints, and the grid where there is no ground].
    #[arg(long, value_name = "LIST", value_parser = Look::parse)]
    pub(crate) show: Option<Look>,
    /// Where the eye is [default: where it sees most of what moves].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = place)]
    pub(crate) eye: Option<DVec3>,
    /// What it looks at [default: the middle of what moves].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = place)]
    pub(crate) look_at: Option<DVec3>,
}

#[derive(Args, Debug)]
pub(crate) struct ProfileOptions {
    /// A scene, as for `run` [default: the shipped talk.glb].
    #[arg(value_name = "FILE")]
    pub(crate) scene: Option<String>,
    /// Frames to measure [default: as many steps as `run` would].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) steps: Option<u32>,
    /// Length of a step in seconds: a number or a fraction.
    #[arg(long, value_name = "SECONDS", default_value = "1/60", value_parser = seconds)]
    pub(crate) dt: f32,
    /// Times that each frame is stepped each way; the medians count.
    #[arg(long, value_name = "N", default_value_t = 31, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) repeats: u32,
    /// Numbers of threads, each measured in a run of its own.
    #[arg(long, value_name = "N,...", default_value = "1,2", value_delimiter = ',', value_parser = threads)]
    pub(crate) threads: Vec<usize>,
    /// Substeps of the solver in a step [default: 4].
    #[arg(long, value_name = "N")]
    pub(crate) substeps: Option<u32>,
    /// Solver iterations in each substep [default: 1].
    #[arg(long, value_name = "N")]
    pub(crate) iterations: Option<u32>,
    /// What is compared with discrete: segment or volume.
    #[arg(long, value_name = "MODE", default_value = "segment", value_parser = continuous)]
    pub(crate) continuous: Continuous,
    /// Leave out the comparison of methods on their six scenes (`compare`).
    #[arg(long)]
    pub(crate) no_compare: bool,
    /// How often these are run; a step's time is the median of its rounds.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) rounds: u32,
    /// Write a page with charts: index.html and its pictures.
    #[arg(long, value_name = "DIR")]
    pub(crate) report: Option<PathBuf>,
    /// Write all frames as a table.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) csv: Option<PathBuf>,
    /// Read a file however much it asks for: by default more than any game's scene has is refused (`LoadLimits`).
    #[arg(long)]
    pub(crate) no_limits: bool,
    /// Print one JSON document instead of the summary (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
    /// No summary, no progress, no notes.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Args, Debug)]
pub(crate) struct StabilityOptions {
    /// tower, pyramid, wall, high_wall, barrels, coins, light, crib, edge or layers, with a size (`tower_30`) or without; or a
    /// scene, as for `run` [default: the whole set of structures and settings that have to be stable].
    #[arg(value_name = "SCENE")]
    pub(crate) scene: Option<String>,
    /// Boxes, rows or levels; for `light` how many times lighter the lower box is.
    #[arg(long, value_name = "N")]
    pub(crate) size: Option<usize>,
    /// Of the set only structures whose names begin so.
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
    #[arg(long, value_name = "MODEL", value_parser = friction_model)]
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
    /// Keep each cell's figures in this file as it ends, and leave out those that are in it already, of the same build.
    #[arg(long, value_name = "FILE")]
    pub(crate) results: Option<PathBuf>,
    /// Show another engine's results, of a file in the same format, beside these; it is an error if a cell is lost here and
    /// stable there.
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
    /// Print one JSON document instead of a table (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct SolveOptions {
    /// A .dat file of Siconos, with a linear complementarity problem or a contact problem; with the feature hdf5 also an .hdf5
    /// file of FCLIB.
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
    /// Describe the methods and solve nothing.
    #[arg(long)]
    pub(crate) list: bool,
    /// Print one JSON document instead of the summary (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct ReplayOptions {
    /// A recording, by `run --record` or by a game (docs/replay.md).
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Threads that work on a step, whatever their number was.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads)]
    pub(crate) threads: usize,
    /// Read a file however much it asks for: by default more than any game's scene has is refused (`LoadLimits`).
    #[arg(long)]
    pub(crate) no_limits: bool,
    /// Print one JSON document instead of the summary (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
    /// No summary, no notes.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Args, Debug)]
pub(crate) struct ShotOptions {
    /// How many; each is run under all three modes.
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    pub(crate) count: u64,
    /// Which: the same seed gives the same shots.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Threads, each with shots of its own [default: one per core].
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// Run one shot alone and describe it.
    #[arg(long, value_name = "NUMBER", conflicts_with_all = ["count", "json"])]
    pub(crate) only: Option<u64>,
    /// Print one JSON document instead of tables (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
    /// No progress.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Args, Debug)]
pub(crate) struct TossOptions {
    /// A folder of CSV files, one a toss: t_s, px_m, py_m, pz_m, qw, qx, qy, qz, vx_m_s, vy_m_s, vz_m_s, wbx_rad_s, wby_rad_s,
    /// wbz_rad_s.
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
    /// Steps between two samples.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) parts: u32,
    /// Substeps of a step.
    #[arg(long, value_name = "N", default_value_t = 4)]
    pub(crate) substeps: u32,
    /// Iterations of a substep.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) iterations: u32,
    /// Where friction acts: patch or point.
    #[arg(long, value_name = "MODEL", default_value = "patch", value_parser = friction_model)]
    pub(crate) friction_model: FrictionModel,
    /// Coefficient of friction of cube and plate.
    #[arg(long, value_name = "MU", default_value_t = 0.18)]
    pub(crate) friction: f32,
    /// Restitution of cube and plate.
    #[arg(long, value_name = "E", default_value_t = 0.125)]
    pub(crate) restitution: f32,
    /// How far the plate is lowered [m].
    #[arg(long, value_name = "M", default_value_t = 0.0)]
    pub(crate) lowered: f64,
    /// Solve each step by a method of the lab instead (docs/methods.md).
    #[arg(long, value_name = "NAME", value_parser = world_method)]
    pub(crate) solver: Option<WorldMethod>,
    /// Print one JSON document instead of a table (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct CaseOptions {
    /// Only cases with this in their names; may be given several times.
    #[arg(long = "case", value_name = "NAME")]
    pub(crate) cases: Vec<String>,
    /// What solves the steps: backstop or a method of the lab (`solve --list`); may be given several times [default:
    /// backstop, gs-cone, admm and sequential].
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
    #[arg(long, value_name = "MODEL", value_parser = friction_model)]
    pub(crate) friction_model: Option<FrictionModel>,
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
    /// Solve steps by this method of the lab instead (docs/methods.md); may be given again [default: the engine's own].
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
    #[arg(long, value_name = "SHAPE", default_value = "cone", value_parser = friction_cone)]
    pub(crate) friction: FrictionCone,
    /// Simulated time [default: as SimBenchmark has it: 4, 20, 10 and 600 s].
    #[arg(long, value_name = "S", value_parser = positive)]
    pub(crate) seconds: Option<f32>,
    /// Print one JSON document instead of tables (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct CompareOptions {
    /// Only this scene: talk, posts, blades, deflector, head_on or ragdoll_wall.
    #[arg(long, value_name = "NAME")]
    pub(crate) scene: Option<String>,
    /// Steps of 1/60 s [default: what each scene is made for].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) steps: Option<u32>,
    /// Threads that work on a step.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads)]
    pub(crate) threads: usize,
    /// How often each scene is run; a step's time is the median of its rounds.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) rounds: u32,
    /// Print one JSON document instead of tables (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
}

fn number(text: &str) -> Result<f32, String> {
    let value: f32 = text.trim().parse().map_err(|_| format!("\"{text}\" is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("\"{text}\" is not finite")) }
}

pub(crate) fn positive(text: &str) -> Result<f32, String> {
    let value = number(text)?;
    if value > 0.0 { Ok(value) } else { Err("must be above zero".into()) }
}

fn hertz(text: &str) -> Result<f32, String> {
    let value = number(text)?;
    if (1.0..=1e6).contains(&value) { Ok(value) } else { Err("must be in 1..=1000000".into()) }
}

fn friction_model(text: &str) -> Result<FrictionModel, String> {
    match text {
        "patch" => Ok(FrictionModel::Patch),
        "point" => Ok(FrictionModel::Point),
        _ => Err("must be patch or point".into()),
    }
}

fn solver(text: &str) -> Result<&'static Method, String> {
    let names = || Method::ALL.iter().map(|method| method.name).collect::<Vec<_>>().join(", ");
    Method::by_name(text).ok_or_else(|| format!("must be one of {}", names()))
}

fn structure(text: &str) -> Result<Structure, String> {
    let names = || Structure::ALL.map(Structure::name).join(", ");
    Structure::named(text).ok_or_else(|| format!("must be one of {}", names()))
}

/// A method of the lab, or the engine's own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AnyMethod(pub(crate) Option<WorldMethod>);

impl AnyMethod {
    /// What the engine's own is called.
    pub(crate) const OWN: &str = "backstop";

    pub(crate) fn name(self) -> &'static str {
        self.0.map_or(AnyMethod::OWN, |method| method.name())
    }
}

fn any_method(text: &str) -> Result<AnyMethod, String> {
    if text == AnyMethod::OWN {
        Ok(AnyMethod(None))
    } else {
        let method = world_method(text).map_err(|why| why.replacen("one of", "backstop or one of", 1))?;
        Ok(AnyMethod(Some(method)))
    }
}

fn simbench_test(text: &str) -> Result<Test, String> {
    let names = || Test::ALL.map(Test::name).join(", ");
    Test::named(text).ok_or_else(|| format!("must be one of {}", names()))
}

fn friction_cone(text: &str) -> Result<FrictionCone, String> {
    match text {
        "cone" => Ok(FrictionCone::Cone),
        "box" => Ok(FrictionCone::Box),
        _ => Err("must be cone or box".into()),
    }
}

fn world_method(text: &str) -> Result<WorldMethod, String> {
    let names = || WorldMethod::names().collect::<Vec<_>>().join(", ");
    WorldMethod::by_name(text).ok_or_else(|| format!("must be one of {}", names()))
}

fn friction(text: &str) -> Result<Friction, String> {
    match text {
        "cone" => Ok(Friction::Cone),
        "pyramid" => Ok(Friction::Pyramid),
        "box" => Ok(Friction::Box),
        _ => Err("must be cone, pyramid or box".into()),
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|x: &f64| *x >= 0.0 && x.is_finite())
        .ok_or_else(|| "must be a number that is at least 0".into())
}

fn relaxation(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x| (0.01..=1.99).contains(x)).ok_or_else(|| "must be in 0.01..=1.99".into())
}

pub(crate) fn seconds(text: &str) -> Result<f32, String> {
    let value = match text.split_once('/') {
        Some((over, under)) => number(over)? / number(under)?,
        None => number(text)?,
    };
    // A step of more than a second is no simulation, one below a microsecond never gets anywhere.
    if (1e-6..=1.0).contains(&value) { Ok(value) } else { Err("must be in 0.000001..=1".into()) }
}

pub(crate) fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n @ 1..=1024) => Ok(n),
        _ => Err("must be a whole number in 1..=1024".into()),
    }
}

fn gravity(text: &str) -> Result<Vec3, String> {
    let parts: Vec<f32> = text.split(',').map(number).collect::<Result<_, _>>()?;
    match parts[..] {
        // The strength of the pull, whichever sign one gives it.
        [down] => Ok(Vec3::new(0.0, -down.abs(), 0.0)),
        [x, y, z] => Ok(Vec3::new(x, y, z)),
        _ => Err("wants one number or three, with commas between them".into()),
    }
}

fn bytes(text: &str) -> Result<usize, String> {
    let text = text.trim();
    let units = [("KiB", 10), ("MiB", 20), ("GiB", 30)];
    let unit = units.into_iter().find_map(|(name, shift)| text.strip_suffix(name).map(|rest| (rest, shift)));
    let (number, shift) = unit.unwrap_or((text, 0));
    let number = number.trim();
    let wrong = || format!("\"{text}\" is no number of bytes, like 4096, 512KiB or 1.5MiB");
    if shift == 0 {
        return number.parse().map_err(|_| wrong());
    }
    let value: f64 = number.parse().map_err(|_| wrong())?;
    let value = value * f64::from(1u32 << shift);
    if (0.0..=1e15).contains(&value) { Ok(value as usize) } else { Err(wrong()) }
}

fn place(text: &str) -> Result<DVec3, String> {
    let parts: Vec<f32> = text.split(',').map(number).collect::<Result<_, _>>()?;
    match parts[..] {
        [x, y, z] => Ok(Vec3::new(x, y, z).as_dvec3()),
        _ => Err("wants three numbers, with commas between them".into()),
    }
}

fn size(text: &str) -> Result<(usize, usize), String> {
    let side = |text: &str| text.parse().ok().filter(|n| (1..=8192).contains(n));
    let sides = text.split_once('x').and_then(|(width, height)| Some((side(width)?, side(height)?)));
    sides.ok_or_else(|| "must be like 960x540, with sides in 1..=8192".into())
}

fn continuous(text: &str) -> Result<Continuous, String> {
    match text {
        "discrete" => Ok(Continuous::Discrete),
        "segment" => Ok(Continuous::Segment),
        "volume" => Ok(Continuous::Volume),
        _ => Err("must be discrete, segment or volume".into()),
    }
}

fn method(text: &str) -> Result<ContinuousMethod, String> {
    match text {
        "one-pass" => Ok(ContinuousMethod::OnePass),
        "speculative" => Ok(ContinuousMethod::Speculative),
        "linear-cast" => Ok(ContinuousMethod::LinearCast),
        "conservative-advancement" => Ok(ContinuousMethod::ConservativeAdvancement),
        _ => Err("must be one-pass, speculative, linear-cast or conservative-advancement".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory;
        Options::command().debug_assert();
    }

    #[test]
    fn numbers_are_read_as_people_write_them() {
        assert_eq!(seconds("1/60").unwrap(), 1.0 / 60.0);
        assert_eq!(seconds("0.02").unwrap(), 0.02);
        assert!(seconds("0").is_err() && seconds("1/0").is_err() && seconds("x").is_err());
        assert_eq!(gravity("1.62").unwrap(), Vec3::new(0.0, -1.62, 0.0));
        assert_eq!(gravity("1,-2,0.5").unwrap(), Vec3::new(1.0, -2.0, 0.5));
        assert_eq!(bytes("4096").unwrap(), 4096);
        assert_eq!(bytes("1.5 KiB").unwrap(), 1536);
        assert_eq!(bytes("12MiB").unwrap(), 12 << 20);
        assert!(bytes("12MB").is_err() && bytes("-1KiB").is_err() && bytes("1.5").is_err());
        assert_eq!(size("64x48").unwrap(), (64, 48));
        assert!(size("64").is_err() && size("0x9").is_err() && size("9x99999").is_err());
        assert_eq!(place("1,-2,0.5").unwrap(), DVec3::new(1.0, -2.0, 0.5));
        assert!(place("1,2").is_err());
        let look = Look::parse("shapes, motion").unwrap();
        assert!(look.draw.shapes && look.draw.motion && !look.draw.contacts && !look.grid);
        assert!(Look::parse("shape").is_err());
        assert!(Look::NAMES.iter().all(|name| Look::nothing().switch(name).is_some()));
        assert!(gravity("1,2").is_err() && gravity("inf").is_err());
    }
}
