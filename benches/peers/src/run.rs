//! `run`: one scene in one engine, in this process.

use crate::engines::{self, content::Meshes};
use crate::judge::{Figures, Judge};
use crate::memory::{status_kib, trim};
use crate::scenes::{self, DT, Subject};
use anyhow::Context;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// After so many steps memory is read.
const MEMORY_STEP: u32 = 100;

/// What is run, and how.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct Args {
    /// An engine of this program, as `peers list` has them.
    pub(crate) engine: String,
    /// A scene, as `peers list` has them, or one of a scaling, as bodies_10000.
    pub(crate) scene: String,
    /// Threads that a step may use.
    #[arg(long, default_value_t = 1)]
    pub(crate) threads: usize,
    /// Steps of 1/60 s; by default as many as are timed of this scene.
    #[arg(long)]
    pub(crate) steps: Option<u32>,
    /// How many times the engine's default number of substeps, or whatever it counts instead.
    #[arg(long, default_value_t = 1)]
    pub(crate) effort: u32,
    /// Lets bodies sleep, and ends when all do.
    #[arg(long)]
    pub(crate) sleep: bool,
    /// Does not judge the motion.
    #[arg(long)]
    pub(crate) blind: bool,
}

/// Times of steps [ms].
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Times {
    pub(crate) mean: f64,
    pub(crate) median: f64,
    pub(crate) p95: f64,
    pub(crate) max: f64,
}

/// How a run went: a line of JSON.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Outcome {
    pub(crate) engine: String,
    pub(crate) version: String,
    pub(crate) scene: String,
    pub(crate) threads: usize,
    pub(crate) effort: u32,
    /// Dynamic bodies.
    pub(crate) bodies: usize,
    pub(crate) steps: u32,
    pub(crate) ms: Times,
    /// To make the world [ms].
    pub(crate) build_ms: f64,
    /// How much the resident set grew from before the world was made to step 100, and its peak [KiB].
    pub(crate) grown_kib: Option<u64>,
    pub(crate) peak_kib: Option<u64>,
    pub(crate) figures: Figures,
    /// With `--sleep`: when all were asleep [s], and how many are at the end.
    pub(crate) asleep_after: Option<f64>,
    pub(crate) asleep: usize,
}

/// Runs it and prints a line of JSON.
pub(crate) fn main(args: &Args) -> anyhow::Result<()> {
    let subject = scenes::build(&args.scene)?;
    let outcome = run(args, &subject)?;
    println!("{}", serde_json::to_string(&outcome)?);
    Ok(())
}

fn run(args: &Args, subject: &Subject) -> anyhow::Result<Outcome> {
    let entry = engines::find(&args.engine)
        .with_context(|| format!("no engine \"{}\" in this program", args.engine))?;
    anyhow::ensure!((1..=16).contains(&args.effort), "--effort is in 1..=16");
    let steps = args.steps.unwrap_or(subject.steps);
    let bodies = subject.scene.dynamic_bodies();
    let mut judge = (!args.blind).then(|| Judge::new(subject));
    let config = subject.config(args.threads, args.effort, args.sleep);

    let meshes = Meshes::of(&subject.scene);
    trim();
    let before = status_kib("VmRSS");
    let start = Instant::now();
    let mut engine = (entry.build)(&subject.scene, &meshes, &config)?;
    let build_ms = start.elapsed().as_secs_f64() * 1e3;
    // Bytes used only to make the world are no part of it.
    trim();

    let (mut after, mut asleep_after, mut each) = (None, None, Vec::with_capacity(steps as usize));
    for step in 1..=steps {
        let start = Instant::now();
        engine.step(DT).with_context(|| format!("step {step}"))?;
        each.push(start.elapsed().as_secs_f64() * 1e3);
        if step <= MEMORY_STEP {
            after = status_kib("VmRSS");
        }
        if let Some(judge) = &mut judge {
            judge.after_step(step, engine.as_ref());
        }
        if args.sleep && engine.asleep() == bodies {
            asleep_after = Some(f64::from(step) * f64::from(DT));
            break;
        }
    }
    // Before the last look, which needs memory of its own.
    let peak_kib = status_kib("VmHWM");
    Ok(Outcome {
        engine: entry.name.into(),
        version: entry.version.into(),
        scene: args.scene.clone(),
        threads: args.threads,
        effort: args.effort,
        bodies,
        steps: each.len() as u32,
        ms: times(&each),
        build_ms,
        grown_kib: after.zip(before).map(|(after, before)| after.saturating_sub(before)),
        peak_kib,
        asleep: engine.asleep(),
        asleep_after,
        figures: judge.map(|judge| judge.finish(engine.as_ref())).unwrap_or_default(),
    })
}

fn times(each: &[f64]) -> Times {
    let mut sorted = each.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let index = (sorted.len().saturating_sub(1)) as f64 * share;
        sorted.get(index.round() as usize).copied().unwrap_or_default()
    };
    Times {
        mean: each.iter().sum::<f64>() / each.len().max(1) as f64,
        median: at(0.5),
        p95: at(0.95),
        max: at(1.0),
    }
}
