//! `plan`: the memory of a scene, as planned and as measured in a run.

use crate::args::PlanOptions;
use crate::commands::run;
use crate::report::output;
use crate::report::table::table;
use anyhow::Context;
use backstop::{Budget, Category, Error, MemoryReport, Settings, World};
use backstop_scene::Scene;
use serde::Serialize;
use std::fmt::Write;

/// Length of a step [s].
const DT: f32 = 1.0 / 60.0;

/// What is printed; docs/json.md says what its fields mean.
#[derive(Debug, Serialize)]
struct Document {
    scene: String,
    steps: u32,
    categories: Vec<Line>,
    planned: usize,
    /// The most that was held at one time.
    measured: usize,
    budget: Option<Trial>,
}

#[derive(Debug, Serialize)]
struct Line {
    name: &'static str,
    planned: usize,
    measured: usize,
}

/// A run within a budget.
#[derive(Debug, Serialize)]
struct Trial {
    bytes: usize,
    /// Why the scene's bodies and joints themselves are refused.
    refused: Option<String>,
    held: usize,
    shed: u64,
    /// The first step that shed something, counted from 1.
    first: Option<u32>,
}

pub(crate) fn plan(options: &PlanOptions) -> anyhow::Result<()> {
    let mut scene = output::open(&options.scene, &options.common.limits())?;
    if options.drop > 0 {
        scene.rain(options.drop, options.seed);
    }
    if !options.common.quiet {
        output::notes(&scene);
    }
    let steps = options.steps.unwrap_or_else(|| run::default_steps(&scene, DT));
    // With a budget, memory for bodies is reserved when they are added: use the largest possible budget.
    let free = settings(options, &scene, usize::MAX);
    let plan = scene.plan(&free);
    let ran = simulate(&scene, free, steps, options.common.quiet)?
        .with_context(|| format!("scene {} is refused", scene.name))?;
    let budget = match options.budget {
        None => None,
        Some(bytes) => Some(attempt(options, &scene, bytes, steps)?),
    };
    let line = |(category, planned): (Category, usize)| Line {
        name: category.name(),
        planned,
        measured: ran.peaks.category(category).peak,
    };
    let document = Document {
        scene: scene.name.clone(),
        steps,
        categories: plan.iter().map(line).collect(),
        planned: plan.total(),
        measured: ran.most,
        budget,
    };
    if options.common.json { output::print_json(&document) } else { output::print(&text(&document)) }
}

fn settings(options: &PlanOptions, scene: &Scene, budget: usize) -> Settings {
    Settings::default()
        .with_gravity(scene.gravity)
        .with_continuous(options.continuous)
        .with_sleeping(options.sleep)
        .with_budget(Budget::total(budget))
}

/// The result of a run.
struct Ran {
    peaks: MemoryReport,
    most: usize,
    shed: u64,
    first: Option<u32>,
}

/// The inner error: the world refuses the scene.
fn simulate(
    scene: &Scene,
    settings: Settings,
    steps: u32,
    quiet: bool,
) -> anyhow::Result<Result<Ran, Error>> {
    let mut world = World::new(settings).context("these settings are refused")?;
    if let Err(error) = scene.add_to(&mut world) {
        return Ok(Err(error));
    }
    let (mut most, mut shed, mut first) = (world.memory().total(), 0, None);
    let bar = output::progress(!quiet, steps.into(), "steps");
    for step in 1..=steps {
        let now = world.step(DT)?.shed;
        shed += u64::from(now);
        first = first.or((now > 0).then_some(step));
        most = most.max(world.memory().total());
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(Ok(Ran { peaks: world.memory(), most, shed, first }))
}

fn attempt(options: &PlanOptions, scene: &Scene, bytes: usize, steps: u32) -> anyhow::Result<Trial> {
    Ok(match simulate(scene, settings(options, scene, bytes), steps, options.common.quiet)? {
        Ok(ran) => Trial { bytes, refused: None, held: ran.most, shed: ran.shed, first: ran.first },
        Err(error) => Trial { bytes, refused: Some(error.to_string()), held: 0, shed: 0, first: None },
    })
}

fn text(document: &Document) -> String {
    let Document { scene, steps, categories, planned, measured, budget } = document;
    let mut text = format!("{scene}, {} [bytes]\n", output::plural((*steps).into(), "step", "steps"));
    let row = |name: &str, planned: usize, measured: usize| {
        let difference = match measured {
            0 if planned == 0 => String::new(),
            0 => "-".into(),
            _ => format!("{:+.1} %", (planned as f64 / measured as f64 - 1.0) * 100.0),
        };
        let [planned, measured] = [planned, measured].map(|n| output::count(n as u64));
        vec![name.replace('_', " "), planned, measured, difference]
    };
    let all = row("in all", *planned, *measured);
    let rows = categories.iter().map(|l| row(l.name, l.planned, l.measured)).chain([all]);
    text += &table(&["category", "planned", "measured", "difference"], 1, rows);
    if let Some(trial) = budget {
        let size = output::bytes(trial.bytes);
        let _ = match (&trial.refused, trial.first) {
            (Some(error), _) => writeln!(text, "budget {size}: the scene does not fit: {error}"),
            (None, None) => {
                writeln!(text, "budget {size}: fits; {} held, nothing shed", output::bytes(trial.held))
            }
            (None, Some(first)) => writeln!(
                text,
                "budget {size}: bodies fit; {} held, {} points and pairs shed, first in step {first}",
                output::bytes(trial.held),
                output::count(trial.shed),
            ),
        };
    }
    text
}
