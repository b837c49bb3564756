//! `simbench`: tests of SimBenchmark, rebuilt, beside the numbers that it published.

use crate::args::SimbenchOptions;
use crate::report::output;
use crate::report::table::table;
use anyhow::Context;
use backstop_lab::simbench::{Outcome, Published, Setting, Test};
use backstop_lab::{WorldMethod, WorldSolver};
use serde::Serialize;
use std::fmt::Write;

/// Name of the engine's own solver in tables.
const OWN: &str = "backstop";

/// What is printed of a test; docs/json.md says what its fields mean.
#[derive(Serialize)]
struct Document {
    test: &'static str,
    unit: &'static str,
    seconds: f32,
    rows: Vec<Row>,
    published: Vec<Other>,
}

#[derive(Serialize)]
struct Row {
    method: &'static str,
    dt: f32,
    substeps: u32,
    iterations: u32,
    metric: f64,
    relative: f64,
    fell: bool,
    steps: u32,
    time_us: f64,
    relative_time: f64,
    left: usize,
}

#[derive(Serialize)]
struct Other {
    engine: &'static str,
    solver: &'static str,
    error_reduction: bool,
    dt: f64,
    iterations: Option<u32>,
    metric: f64,
    time_us: f64,
}

pub(crate) fn simbench(options: &SimbenchOptions) -> anyhow::Result<()> {
    let tests = if options.test.is_empty() { Test::ALL.to_vec() } else { options.test.clone() };
    let methods: Vec<Option<WorldMethod>> = if options.method.is_empty() {
        vec![None]
    } else {
        options.method.iter().copied().map(Some).collect()
    };
    let runs = tests.iter().map(|&test| settings(test, options).len() * methods.len()).sum::<usize>();
    let bar = output::progress(!options.json, runs as u64, "runs");
    let mut documents = Vec::new();
    for &test in &tests {
        let mut rows = Vec::new();
        let default = Setting { dt: test.dt(), seconds: options.seconds, ..Setting::default() };
        let mut reference = None;
        for &method in &methods {
            for setting in settings(test, options) {
                let solver = method.map(|m| WorldSolver { most_rows: options.rows, ..WorldSolver::new(m) });
                let setting = Setting { solver, ..setting };
                let found = test
                    .run(&setting)
                    .with_context(|| format!("can't run {} at steps of {} s", test.name(), setting.dt))?;
                let is_default = method.is_none()
                    && (setting.dt, setting.substeps, setting.iterations)
                        == (default.dt, default.substeps, default.iterations);
                if is_default {
                    reference.get_or_insert(found.step_time);
                }
                rows.push(row(method, &setting, &found));
                bar.inc(1);
            }
        }
        let reference = match reference {
            Some(time) => time,
            None => step_time(test, default).with_context(|| format!("can't run {}", test.name()))?,
        };
        for row in &mut rows {
            row.relative_time = row.time_us / (reference * 1e6).max(f64::MIN_POSITIVE);
        }
        let seconds = options.seconds.unwrap_or(test.seconds());
        let published = test.published().iter().map(|one| other(test, one)).collect();
        documents.push(Document { test: test.name(), unit: test.unit(), seconds, rows, published });
    }
    bar.finish_and_clear();
    if options.json { output::print_json(&documents) } else { output::print(&text(&documents)) }
}

/// Time of a step of the engine's own solver with its defaults [s], over no more than 500 steps.
fn step_time(test: Test, default: Setting) -> Result<f64, backstop::Error> {
    let seconds = default.seconds.unwrap_or(test.seconds()).min(500.0 * default.dt);
    Ok(test.run(&Setting { seconds: Some(seconds), ..default })?.step_time)
}

/// The test's curve, or the settings of the options.
fn settings(test: Test, options: &SimbenchOptions) -> Vec<Setting> {
    let SimbenchOptions { dt, substeps, iterations, friction, seconds, .. } = options;
    let mut all = if dt.is_empty() && substeps.is_none() && iterations.is_none() {
        test.curve()
    } else {
        let dts = if dt.is_empty() { vec![test.dt()] } else { dt.clone() };
        dts.into_iter().map(|dt| Setting { dt, ..Setting::default() }).collect()
    };
    for setting in &mut all {
        (setting.friction_cone, setting.seconds) = (*friction, *seconds);
        setting.substeps = substeps.unwrap_or(setting.substeps);
        setting.iterations = iterations.unwrap_or(setting.iterations);
    }
    all
}

fn row(method: Option<WorldMethod>, setting: &Setting, found: &Outcome) -> Row {
    Row {
        method: method.map_or(OWN, |method| method.name()),
        dt: setting.dt,
        substeps: setting.substeps,
        iterations: setting.iterations,
        metric: found.metric,
        relative: found.relative,
        fell: found.fell,
        steps: found.steps,
        time_us: found.step_time * 1e6,
        relative_time: 0.0,
        left: found.left,
    }
}

fn other(test: Test, one: &Published) -> Other {
    let Published { engine, solver, error_reduction, dt, iterations, metric, time } = *one;
    // A tower's run ends when it falls.
    let seconds = if test == Test::Tower { metric } else { f64::from(test.seconds()) };
    Other {
        engine,
        solver,
        error_reduction,
        dt,
        iterations,
        metric,
        time_us: time * 1e6 / (seconds / dt).max(1.0),
    }
}

fn text(documents: &[Document]) -> String {
    let mut text = String::new();
    for document in documents {
        let Document { test, unit, seconds, rows, published } = document;
        let _ = writeln!(text, "{test}: metric in {unit}, over {seconds} s");
        let own = |row: &Row| {
            vec![
                row.method.to_string(),
                output::seconds(row.dt),
                row.substeps.to_string(),
                row.iterations.to_string(),
                format!("{:.3e}", row.metric),
                format!("{:.2e}", row.relative),
                output::micros(row.time_us),
                format!("{:.2}", row.relative_time),
                row.left.to_string(),
                if row.fell { "fell".into() } else { String::new() },
            ]
        };
        let headings = [
            "method",
            "dt",
            "substeps",
            "iterations",
            "metric",
            "relative",
            "time a step",
            "of default",
            "left",
            "",
        ];
        text += &table(&headings, 1, rows.iter().map(own));
        let other = |one: &Other| {
            vec![
                format!("{}, {}", one.engine, short(one.solver)),
                output::seconds(one.dt as f32),
                one.iterations.map_or_else(|| "-".into(), |n| n.to_string()),
                format!("{:.3e}", one.metric),
                output::micros(one.time_us),
                if one.error_reduction { "with error reduction".into() } else { String::new() },
            ]
        };
        text.push('\n');
        let headings = ["published (docs/simbench.md)", "dt", "iterations", "metric", "time a step", ""];
        text += &table(&headings, 1, published.iter().map(other));
        text.push('\n');
    }
    text
}

/// A solver's name, shortened to the width of the table.
fn short(solver: &str) -> &str {
    if solver == "sequential impulse" { "SI" } else { solver }
}
