//! The command line of `trade`.

use crate::args::{CommonOptions, positive, threads};
use backstop_lab::WorldMethod;
use backstop_lab::trade::{ContinuousChoice, FrictionLaw, Grid, Limits, Measure};
use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub(crate) struct TradeOptions {
    /// A scene, as for `run`.
    #[arg(value_name = "FILE", required_unless_present = "merge")]
    pub(crate) scene: Option<String>,
    /// By what settings are judged: trajectory or worst [body widths], rotation [rad], penetration [m],
    /// residual [m/s], joint [m], energy [of the kinetic energy], heap, or another condition (docs/trade.md).
    #[arg(long, value_name = "NAME", default_value = "trajectory", value_parser = measure)]
    pub(crate) error: Measure,
    /// Pick the cheapest setting whose error is no greater, in the error's unit [default: the error of the
    /// default setting].
    #[arg(long, value_name = "E", value_parser = error)]
    pub(crate) max_error: Option<f64>,
    /// Pick the most accurate setting that takes no more than this for 1/60 s [us].
    #[arg(long, value_name = "US", value_parser = error, conflicts_with = "max_error")]
    pub(crate) budget_us: Option<f64>,
    #[command(flatten)]
    pub(crate) conditions: Conditions,
    /// Seconds that are simulated [default: 4, with --quick 2].
    #[arg(long, value_name = "S", value_parser = positive)]
    pub(crate) seconds: Option<f32>,
    /// A coarse grid.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Steps per second, instead of those of the grid; 60 and all of them need a common divisor of 10 at
    /// least.
    #[arg(long, value_name = "HZ,...", value_delimiter = ',')]
    pub(crate) hz: Vec<u32>,
    /// Substeps of a step.
    #[arg(long, value_name = "N,...", value_delimiter = ',')]
    pub(crate) substeps: Vec<u32>,
    /// Iterations of a substep.
    #[arg(long, value_name = "N,...", value_delimiter = ',')]
    pub(crate) iterations: Vec<u32>,
    /// Friction models: patch, patch-box, point or point-box.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = friction)]
    pub(crate) friction: Vec<FrictionLaw>,
    /// Continuous collision: discrete, segment, volume, speculative, talk-method, linear-cast or
    /// conservative-advancement.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = continuous)]
    pub(crate) continuous: Vec<ContinuousChoice>,
    /// Recycling of contacts: on or off.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = recycling)]
    pub(crate) recycling: Vec<Switch>,
    /// Joints that make trees: exact or rows.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = joints)]
    pub(crate) joints: Vec<Switch>,
    /// Methods of the lab that solve steps, beside the engine's own solver (docs/methods.md), or none.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = solver)]
    pub(crate) solver: Vec<String>,
    /// Measure the default and the settings of this file alone. The grid gives only the rates: with those of
    /// the sweep that the file is from, it has the very same error.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["cell", "merge"])]
    pub(crate) settings: Option<PathBuf>,
    /// Steps per second of the reference; rounded up to what has times in common with the grid.
    #[arg(long, value_name = "HZ", default_value_t = 1920)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) reference_hz: u32,
    /// Threads that measure errors, a cell each [default: all]. Times are always taken one after another.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// Rounds in which each cell is timed; the median counts [default: 3, with --quick 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) rounds: Option<u32>,
    /// Keep results in this file, a line of JSON each, and leave out what is in it already [default: one in
    /// the working folder, which is removed at the end].
    #[arg(long, value_name = "FILE")]
    pub(crate) results: Option<PathBuf>,
    /// Run a share of the grid alone, the I-th of N, and write results: to --results, or as JSON lines to
    /// standard output.
    #[arg(long, value_name = "I/N", value_parser = share, conflicts_with_all = [
        "max_error", "budget_us", "merge", "out", "report", "json",
    ])]
    pub(crate) cell: Option<Share>,
    /// Run nothing: put files of results together.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = [
        "scene", "seconds", "quick", "hz", "substeps", "iterations", "friction", "continuous", "recycling", "joints", "solver", "threads",
        "results",
    ])]
    pub(crate) merge: Vec<PathBuf>,
    /// Write what was picked, for `run --settings`.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Write a page with the curves: index.html and its pictures.
    #[arg(long, value_name = "DIR")]
    pub(crate) report: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) common: CommonOptions,
}

/// What a setting has to keep to be picked, whatever it is picked by.
#[derive(Args, Debug)]
#[command(next_help_heading = "Conditions of a pick")]
pub(crate) struct Conditions {
    /// Deepest overlap of an instant, as a share of the thinner shape from its middle to its surface
    /// [default: 0.5].
    #[arg(long, value_name = "SHARE", value_parser = limit)]
    max_overlap: Option<f64>,
    /// Deepest overlap that lasts a tenth of a second, as such a share [default: 0.1].
    #[arg(long, value_name = "SHARE", value_parser = limit)]
    max_lasting: Option<f64>,
    /// Greatest error of a joint, by the width of the narrowest body that has joints [default: 0.05].
    #[arg(long, value_name = "WIDTHS", value_parser = limit)]
    max_opening: Option<f64>,
    /// Greatest gain of energy from nothing, by the greatest kinetic energy of the reference [default: 0.1].
    #[arg(long, value_name = "SHARE", value_parser = limit)]
    max_gain: Option<f64>,
    /// Bodies that leave the region of the reference [default: 0].
    #[arg(long, value_name = "N", value_parser = limit)]
    max_lost: Option<f64>,
    /// Speed in the end of bodies that rest in the reference, by the square root of gravity times width
    /// [default: 0.05].
    #[arg(long, value_name = "SHARE", value_parser = limit)]
    max_unrest: Option<f64>,
    /// Greatest distance of a body from the reference while its path can be compared, by its width
    /// [default: 1].
    #[arg(long, value_name = "WIDTHS", value_parser = limit)]
    max_deviation: Option<f64>,
    /// Difference of the statistics of all bodies from the reference's [default: 1].
    #[arg(long, value_name = "X", value_parser = limit)]
    max_heap: Option<f64>,
}

impl Conditions {
    pub(crate) fn limits(&self) -> Limits {
        [
            (Measure::Overlap, self.max_overlap),
            (Measure::Lasting, self.max_lasting),
            (Measure::Opening, self.max_opening),
            (Measure::Gain, self.max_gain),
            (Measure::Lost, self.max_lost),
            (Measure::Unrest, self.max_unrest),
            (Measure::Deviation, self.max_deviation),
            (Measure::Heap, self.max_heap),
        ]
        .into_iter()
        .filter_map(|(measure, limit)| Some((measure, limit?)))
        .fold(Limits::default(), |limits, (measure, limit)| limits.with(measure, limit))
    }
}

/// Yes or no, in the words of its axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Switch(bool);

/// Which cells of a grid: those whose number leaves `first` when divided by `of`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Share {
    pub(crate) first: usize,
    pub(crate) of: usize,
}

impl TradeOptions {
    pub(crate) fn seconds(&self) -> f64 {
        self.seconds.map_or(if self.quick { 2.0 } else { 4.0 }, f64::from)
    }

    pub(crate) fn rounds(&self) -> u32 {
        self.rounds.unwrap_or(if self.quick { 1 } else { 3 })
    }

    /// The grid for a scene with or without joints.
    pub(crate) fn grid(&self, joints: bool) -> Grid {
        let mut grid = if self.quick { Grid::quick(joints) } else { Grid::full(joints) };
        if !(self.substeps.is_empty() && self.iterations.is_empty()) {
            // Values that were asked for are not limited.
            grid.most_passes = u32::MAX;
        }
        instead(&mut grid.hz, &self.hz);
        instead(&mut grid.substeps, &self.substeps);
        instead(&mut grid.iterations, &self.iterations);
        instead(&mut grid.friction, &self.friction);
        instead(&mut grid.continuous, &self.continuous);
        let values = |switches: &[Switch]| switches.iter().map(|switch| switch.0).collect::<Vec<_>>();
        instead(&mut grid.recycling, &values(&self.recycling));
        instead(&mut grid.joint_trees, &values(&self.joints));
        instead(&mut grid.solvers, &self.solver);
        grid.solvers.retain(|name| name != NONE);
        grid
    }
}

/// No method of the lab.
const NONE: &str = "none";

fn solver(text: &str) -> Result<String, String> {
    if text == NONE || WorldMethod::by_name(text).is_some() {
        return Ok(text.into());
    }
    Err(format!("must be {NONE} or one of {}", WorldMethod::names().collect::<Vec<_>>().join(", ")))
}

fn instead<T: Clone>(axis: &mut Vec<T>, given: &[T]) {
    if !given.is_empty() {
        *axis = given.to_vec();
    }
}

fn error(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|x: &f64| *x > 0.0 && x.is_finite());
    value.ok_or_else(|| "must be a number above 0".into())
}

fn limit(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|x: &f64| *x >= 0.0 && x.is_finite());
    value.ok_or_else(|| "must be a number, at least 0".into())
}

/// The item with this name.
fn named<T: Copy>(all: &[T], name: fn(T) -> &'static str, text: &str) -> Result<T, String> {
    all.iter().copied().find(|&one| name(one) == text).ok_or_else(|| {
        let names: Vec<_> = all.iter().map(|&one| name(one)).collect();
        format!("must be one of {}", names.join(", "))
    })
}

fn measure(text: &str) -> Result<Measure, String> {
    named(&Measure::ALL, Measure::name, text)
}

fn friction(text: &str) -> Result<FrictionLaw, String> {
    named(&FrictionLaw::ALL, FrictionLaw::name, text)
}

fn continuous(text: &str) -> Result<ContinuousChoice, String> {
    named(&ContinuousChoice::ALL, ContinuousChoice::name, text)
}

fn recycling(text: &str) -> Result<Switch, String> {
    named(&[true, false], |on| if on { "on" } else { "off" }, text).map(Switch)
}

fn joints(text: &str) -> Result<Switch, String> {
    named(&[true, false], |exact| if exact { "exact" } else { "rows" }, text).map(Switch)
}

fn share(text: &str) -> Result<Share, String> {
    let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    match parts {
        Some((i, of)) if (1..=of).contains(&i) => Ok(Share { first: i - 1, of }),
        _ => Err("must be like 1/8, the first of eight".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_counted_from_one() {
        assert_eq!(share("1/8"), Ok(Share { first: 0, of: 8 }));
        assert_eq!(share("8/8"), Ok(Share { first: 7, of: 8 }));
        assert!(["0/8", "9/8", "1/0", "1", "a/b"].iter().all(|text| share(text).is_err()));
    }
}
