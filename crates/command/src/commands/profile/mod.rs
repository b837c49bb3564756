//! `profile`: the cost of continuous collision, by frame and in bytes, as Vincent Robert's talk measured
//! it (GDC 2012).

mod charts;
mod each;
mod ledger;
mod measure;
mod page;

use crate::args::{CompareOptions, ProfileOptions};
use crate::commands::{compare, run};
use crate::files::{self, Kind};
use crate::report::output;
use crate::report::table::list;
use crate::threads::with_threads;
use anyhow::{Context, bail};
use backstop::Settings;
use backstop_scene::{self as scene, Scene};
use ledger::{Ledger, Memory, ProfileSettings, Run};
use measure::{Measured, Way, measure};
use std::path::{Path, PathBuf};

/// The scene unless another is asked for; away from the repository it is made anew.
const TALK: &str = "scenes/talk.glb";

pub(crate) fn profile(options: &ProfileOptions) -> anyhow::Result<()> {
    // Checked first, so that it fails before the work is done.
    let page = options.report.as_ref().map(|folder| folder.join("index.html"));
    let outputs = [options.csv.as_deref(), page.as_deref()];
    output::refuse_inputs(&outputs, options.scene.iter().map(Path::new))?;
    let scene = open(options)?;
    output::refuse_inputs(&outputs, scene.parts.iter().map(PathBuf::as_path))?;
    options.csv.as_deref().map_or(Ok(()), |file| files::expect_place(file, Kind::Csv))?;
    let charts = page::charts(&options.threads);
    options.report.as_deref().map_or(Ok(()), |folder| output::make_report(folder, &charts))?;
    options.csv.as_deref().map_or(Ok(()), output::make_folder_of)?;
    if !options.common.quiet {
        output::notes(&scene);
    }
    let ledger = measure_all(options, &scene)?;
    if let Some(path) = &options.csv {
        ledger::write_csv(path, &ledger.runs)?;
    }
    let written = options.report.as_ref().map(|folder| page::write(folder, &ledger)).transpose()?;
    if options.common.json {
        output::print_json(&ledger)?;
    } else if !options.common.quiet {
        let files = written.iter().chain(&options.csv).map(|path| output::written(path));
        let mut text = list(page::rows(&ledger).into_iter().chain(files));
        if let Some(comparison) = &ledger.comparison {
            text += &format!("\n{}", compare::text(comparison));
        }
        output::print(&text)?;
    }
    Ok(())
}

fn open(options: &ProfileOptions) -> anyhow::Result<Scene> {
    match &options.scene {
        Some(name) => output::open(name, &options.common.limits()),
        None if Path::new(TALK).exists() => Ok(scene::open(TALK)?),
        None => scene::shipped("talk.glb").context("there is no talk.glb"),
    }
}

fn measure_all(options: &ProfileOptions, scene: &Scene) -> anyhow::Result<Ledger> {
    let steps = options.steps.unwrap_or_else(|| run::default_steps(scene, options.dt));
    let default = Settings::default();
    let settings = default
        .clone()
        .with_gravity(scene.gravity)
        .with_substeps(options.substeps.unwrap_or(default.substeps))
        .with_iterations(options.iterations.unwrap_or(default.iterations))
        .with_continuous(options.continuous)
        .with_continuous_method(options.method);
    let bar =
        output::progress(!options.common.quiet, u64::from(steps) * options.threads.len() as u64, "frames");
    let mut runs = Vec::new();
    let mut last: Option<Measured> = None;
    for &threads in &options.threads {
        let settings = settings.clone().with_threads(threads);
        let way = Way { dt: options.dt, steps, repeats: options.repeats as usize, settings };
        let measured = with_threads(threads, || measure(scene, &way, || bar.inc(1)))?;
        if last.as_ref().is_some_and(|last| last.hash != measured.hash) {
            bail!("with {threads} threads the run went another way; please report this");
        }
        runs.push(Run::new(threads, measured.clone()));
        last = Some(measured);
    }
    bar.finish_and_clear();
    let bar = output::progress(!options.common.quiet, each::PAIRS, "shapes over grounds");
    let each = with_threads(1, || each::measure(&settings, options.dt, options.repeats as usize, &bar))?;
    bar.finish_and_clear();
    let compared = CompareOptions {
        scene: None,
        steps: None,
        threads: 1,
        rounds: options.rounds,
        json: options.common.quiet,
    };
    let last = last.context("no number of threads is given")?;
    Ok(Ledger {
        scene: scene.name.clone(),
        settings: ProfileSettings { dt: options.dt, repeats: options.repeats as usize, world: settings },
        steps: steps as usize,
        dynamic_bodies: scene.dynamic_bodies(),
        runs,
        each,
        memory: Memory::new(&last.memory, scene.dynamic_bodies()),
        hash: format!("{:016x}", last.hash),
        comparison: (!options.no_compare).then(|| compare::compare(&compared)).transpose()?,
    })
}
