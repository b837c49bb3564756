//! `compare`: methods of continuous collision side by side on six scenes (docs/continuous.md).

mod table;

pub(crate) use table::{HEAD, rows, text};

use crate::args::CompareOptions;
use crate::report::output;
use crate::report::trace::Times;
use crate::threads::with_threads;
use anyhow::{Context, bail};
use backstop::{ContinuousMethod, ContinuousMode};
use backstop_lab::comparison::{Contest, METHODS, SCENES, Verdict};
use indicatif::ProgressBar;
use serde::Serialize;

/// All results.
#[derive(Debug, Serialize)]
pub(crate) struct Comparison {
    pub(crate) threads: usize,
    pub(crate) rounds: u32,
    pub(crate) scenes: Vec<SceneResult>,
}

/// A scene under all methods.
#[derive(Debug, Serialize)]
pub(crate) struct SceneResult {
    pub(crate) scene: &'static str,
    pub(crate) steps: u32,
    pub(crate) methods: Vec<MethodResult>,
}

/// A method on a scene.
#[derive(Debug, Serialize)]
pub(crate) struct MethodResult {
    pub(crate) name: &'static str,
    pub(crate) continuous: ContinuousMode,
    pub(crate) method: ContinuousMethod,
    /// Times of steps, each the median of its rounds.
    pub(crate) time_us: Times,
    #[serde(flatten)]
    pub(crate) verdict: Verdict,
}

/// Runs `cargo backstop compare`.
pub(crate) fn print(options: &CompareOptions) -> anyhow::Result<()> {
    let comparison = compare(options)?;
    if options.json {
        return output::print_json(&comparison);
    }
    output::print(&text(&comparison))
}

/// Runs the scenes.
pub(crate) fn compare(options: &CompareOptions) -> anyhow::Result<Comparison> {
    let mut scenes = SCENES.to_vec();
    if let Some(wanted) = &options.scene {
        scenes.retain(|name| name == wanted);
        if scenes.is_empty() {
            bail!("there is no scene \"{wanted}\" to compare on, but {}", SCENES.join(", "));
        }
    }
    let bar = output::progress(!options.json, scenes.len() as u64 * u64::from(options.rounds), "rounds");
    let run = || scenes.iter().map(|name| scene(name, options, &bar)).collect::<anyhow::Result<_>>();
    let scenes = with_threads(options.threads, run)?;
    bar.finish_and_clear();
    Ok(Comparison { threads: options.threads, rounds: options.rounds, scenes })
}

fn scene(name: &'static str, options: &CompareOptions, bar: &ProgressBar) -> anyhow::Result<SceneResult> {
    // By method and step, the times of all rounds.
    let mut times: Vec<Vec<Vec<f32>>> = Vec::new();
    let mut last = None;
    for _ in 0..options.rounds {
        let contest = Contest::new(name, options.threads)?;
        let mut contest = contest.with_context(|| format!("there is no scene \"{name}\""))?;
        let steps = options.steps.unwrap_or(contest.steps());
        times.resize(METHODS.len(), vec![Vec::new(); steps as usize]);
        for step in 0..steps as usize {
            for (all, time) in times.iter_mut().zip(contest.step()?) {
                all[step].push(time);
            }
        }
        last = Some((steps, contest.verdicts()));
        bar.inc(1);
    }
    // The same in every round.
    let (steps, verdicts) = last.context("no rounds")?;
    let methods = METHODS.iter().zip(verdicts).zip(&times).map(|((method, verdict), times)| MethodResult {
        name: method.name,
        continuous: method.continuous,
        method: method.method,
        time_us: Times::of(times.iter().map(|rounds| Times::of(rounds.iter().copied()).median as f32)),
        verdict,
    });
    Ok(SceneResult { scene: name, steps, methods: methods.collect() })
}
