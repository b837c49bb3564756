//! The command line.

#[cfg(test)]
mod documented;
mod lab;
mod methods;
#[cfg(test)]
mod tests;
mod values;

pub(crate) use lab::*;
pub(crate) use methods::{MethodArgs, ReturnArgs};
pub(crate) use values::*;

use crate::commands::trade::TradeOptions;
use backstop::glam::Vec3;
use backstop::{ContinuousMethod, ContinuousMode, LoadLimits};
use backstop_lab::WorldMethod;
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use serde_json::Value;
use std::path::PathBuf;

/// Rigid-body physics with continuous collision in one pass.
#[derive(Debug, Parser)]
#[command(name = "backstop", version, about)]
pub(crate) struct Options {
    #[command(subcommand)]
    pub(crate) command: Command,
}

impl Options {
    /// Those of this process; ends it where they are wrong, with the usage under the name by which it was
    /// called.
    pub(crate) fn of_process() -> Options {
        // Cargo passes its name to the program that it runs, also by the alias `cargo backstop`.
        let by_cargo = std::env::var_os("CARGO").is_some();
        let command = Options::command().bin_name(if by_cargo { "cargo backstop" } else { "backstop" });
        let matches = command.get_matches();
        Options::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
    }
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a scene and say what came of it.
    Run(Box<RunOptions>),
    /// Show samples and builtin scenes in the browser: to step back and forth, to grab and to throw.
    Testbed(TestbedOptions),
    /// What continuous collision costs, frame by frame and in bytes.
    Profile(ProfileOptions),
    /// Predict the memory that a scene takes, run it, and compare.
    Plan(PlanOptions),
    /// Shoot bodies of every shape at thin targets and count those that get through.
    Shots(ShotOptions),
    /// Run methods of continuous collision side by side on six scenes (docs/continuous.md).
    Compare(CompareOptions),
    /// Whether structures at rest are stable: modes of the linearised step that grow (docs/stability.md).
    Stability(StabilityOptions),
    /// Measure what speed costs in accuracy, over a grid of settings, and pick one (docs/trade.md).
    Trade(Box<TradeOptions>),
    /// Run small scenes under extreme conditions and map the results (docs/envelope.md).
    Extremes(ExtremesOptions),
    /// Run cases of mechanics whose answer is known, by several methods and settings, and print what each is
    /// off by (docs/cases.md).
    Cases(CaseOptions),
    /// Compare measured tosses of a cube with the same tosses simulated (docs/tosses.md).
    Tosses(TossOptions),
    /// Compare measured impacts of a body on a plate with the same impacts simulated (docs/tosses.md).
    Impacts(ImpactOptions),
    /// Run seven tests of SimBenchmark beside the numbers that it published for other engines
    /// (docs/simbench.md).
    Simbench(SimbenchOptions),
    /// Solve a linear complementarity or contact problem out of a file by one of many methods
    /// (docs/methods.md).
    Solve(SolveOptions),
    /// Run a pyramid, an arch, a card house and a chain under every method of contact resolution
    /// (docs/methods.md).
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

/// Options of all commands that read a scene or a recording.
#[derive(Args, Debug)]
pub(crate) struct CommonOptions {
    /// Read a file however much it asks for: by default more than any game's scene has is refused
    /// (`LoadLimits`).
    #[arg(long)]
    no_limits: bool,
    /// Print one JSON document instead of text (docs/json.md).
    #[arg(long)]
    pub(crate) json: bool,
    /// No text, no progress, no notes.
    #[arg(long)]
    pub(crate) quiet: bool,
}

impl CommonOptions {
    /// Limits of what files may ask for.
    pub(crate) fn limits(&self) -> LoadLimits {
        if self.no_limits { LoadLimits::NONE } else { LoadLimits::default() }
    }
}

#[derive(Args, Debug)]
pub(crate) struct RunOptions {
    /// A .gltf or .glb file, with physics or as static ground; an .obj file as static ground; or the name of
    /// a builtin scene (`scenes list` names them).
    #[arg(value_name = "FILE")]
    pub(crate) scene: String,
    /// Steps to run [default: as many as make 10 s, or what the builtin scene asks for].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) steps: Option<u32>,
    /// Take the settings of this file, as `trade --out` writes it; options given beside it count more
    /// (docs/trade.md).
    #[arg(long, value_name = "FILE")]
    pub(crate) settings: Option<PathBuf>,
    /// Any setting by its name, as docs/json.md lists them; counts more than a file, less than an option.
    #[arg(long, value_name = "NAME=VALUE", value_parser = setting)]
    pub(crate) set: Vec<(String, Value)>,
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
    #[arg(long, value_name = "MODE", value_parser = named::<ContinuousMode>)]
    pub(crate) continuous: Option<ContinuousMode>,
    /// By which method: one-pass, speculative, talk, linear-cast or conservative-advancement
    /// (docs/continuous.md) [default: one-pass].
    #[arg(long, value_name = "NAME", value_parser = named::<ContinuousMethod>)]
    pub(crate) method: Option<ContinuousMethod>,
    /// Let bodies at rest fall asleep.
    #[arg(long)]
    pub(crate) sleep: bool,
    /// Gravity in m/s²: X,Y,Z, or one number for downwards [default: the scene's].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = gravity)]
    pub(crate) gravity: Option<Vec3>,
    /// Rain this many bodies of mixed shapes onto the scene from above.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = crowd)]
    pub(crate) drop: usize,
    /// Seed of the rain.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Bytes that the world may reserve: a number, or one with KiB, MiB or GiB. Contacts beyond are left out
    /// [default: no limit].
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    pub(crate) budget: Option<usize>,
    /// Write the scene with its motion as a glTF animation.
    #[arg(long, value_name = "FILE.glb")]
    pub(crate) out: Option<PathBuf>,
    /// Write a page with the scene in motion and charts: index.html and its pictures.
    #[arg(long, value_name = "DIR")]
    pub(crate) report: Option<PathBuf>,
    /// Show the scene on a page of the browser, as `testbed` does, until it is stopped.
    #[arg(long, conflicts_with_all = ["out", "report", "json", "record", "steps", "accuracy"])]
    pub(crate) view: bool,
    #[command(flatten)]
    pub(crate) serve: ServeOptions,
    /// Write a recording of the run: for `replay`.
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// Solve islands by a method of the lab instead of the engine's own (docs/methods.md).
    #[arg(long, value_name = "NAME", value_parser = world_method, conflicts_with = "record")]
    pub(crate) solver: Option<WorldMethod>,
    /// Islands with more rows than this are left to the engine's own.
    #[arg(long, value_name = "N", default_value_t = 400, requires = "solver")]
    pub(crate) solver_rows: usize,
    #[command(flatten)]
    pub(crate) methods: MethodArgs,
    #[command(flatten)]
    pub(crate) returns: ReturnArgs,
    /// Measure how accurately each step was solved (docs/accuracy.md).
    #[arg(long)]
    pub(crate) accuracy: bool,
    /// Write the contact problem of one step, counted from 1, as text (docs/accuracy.md).
    #[arg(long, value_names = ["STEP", "FILE.dat"], num_args = 2, conflicts_with = "view")]
    pub(crate) export_problem: Option<Vec<String>>,
    #[command(flatten)]
    pub(crate) common: CommonOptions,
}

impl RunOptions {
    /// The step whose problem is written, and the file.
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
    #[arg(long, value_name = "MODE", default_value = "segment", value_parser = named::<ContinuousMode>)]
    pub(crate) continuous: ContinuousMode,
    /// Let bodies at rest fall asleep.
    #[arg(long)]
    pub(crate) sleep: bool,
    /// Rain this many bodies of mixed shapes onto the scene from above.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = crowd)]
    pub(crate) drop: usize,
    /// Seed of the rain.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// A budget to try: bytes, or a number with KiB, MiB or GiB. Says whether the scene fits and what is
    /// shed.
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    pub(crate) budget: Option<usize>,
    #[command(flatten)]
    pub(crate) common: CommonOptions,
}

/// Where the page of the testbed is.
#[derive(Args, Debug)]
pub(crate) struct ServeOptions {
    /// Port of the page on this machine [default: any that is free].
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) port: u16,
    /// Open the page in the browser.
    #[arg(long)]
    pub(crate) open: bool,
}

#[derive(Args, Debug)]
pub(crate) struct TestbedOptions {
    /// What is open at first: a sample or a builtin scene [default: the first sample].
    #[arg(long, value_name = "NAME")]
    pub(crate) scene: Option<String>,
    /// Threads that work on a step, until the page says another number.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads)]
    pub(crate) threads: usize,
    #[command(flatten)]
    pub(crate) serve: ServeOptions,
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
    #[arg(long, value_name = "N", default_value_t = 31)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=100_000))]
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
    #[arg(long, value_name = "MODE", default_value = "segment", value_parser = named::<ContinuousMode>)]
    pub(crate) continuous: ContinuousMode,
    /// By which method: one-pass, speculative, talk, linear-cast or conservative-advancement
    /// (docs/continuous.md).
    #[arg(long, value_name = "NAME", default_value = "one-pass", value_parser = named::<ContinuousMethod>)]
    pub(crate) method: ContinuousMethod,
    /// Leave out the comparison of methods on their six scenes (`compare`).
    #[arg(long)]
    pub(crate) no_compare: bool,
    /// How often these are run; a step's time is the median of its rounds.
    #[arg(long, value_name = "N", default_value_t = 5)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) rounds: u32,
    /// Write a page with charts: index.html and its pictures.
    #[arg(long, value_name = "DIR")]
    pub(crate) report: Option<PathBuf>,
    /// Write all frames as a table.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) csv: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) common: CommonOptions,
}

#[derive(Args, Debug)]
pub(crate) struct ReplayOptions {
    /// A recording, by `run --record` or by a game (docs/replay.md).
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Threads that work on a step, whatever their number was.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads)]
    pub(crate) threads: usize,
    #[command(flatten)]
    pub(crate) common: CommonOptions,
}

#[derive(Args, Debug)]
pub(crate) struct ShotOptions {
    /// How many; each is run under all three modes.
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = shots)]
    pub(crate) count: u64,
    /// How many more are shot at bodies that can move: plates, doors, stacks and crowds [default: a tenth of
    /// `--count`].
    #[arg(long, value_name = "N", value_parser = shots)]
    pub(crate) moving: Option<u64>,
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
