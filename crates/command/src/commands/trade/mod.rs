//! `trade`: speed against accuracy, over a grid of settings (docs/trade.md).

mod charts;
mod lines;
mod options;
mod outcome;
mod page;
mod sweep;
mod text;

pub(crate) use options::TradeOptions;

use crate::files::{self, Kind};
use crate::interrupt;
use crate::json_lines;
use crate::report::output;
use crate::settings_file;
use anyhow::{Context, bail};
use backstop_scene::Scene;
use lines::{Header, Results, STARTS};
use outcome::Outcome;
use std::path::{Path, PathBuf};
use sweep::{Candidate, Sweep};

pub(crate) fn trade(options: &TradeOptions) -> anyhow::Result<()> {
    // Checked first, so that it fails before the work is done.
    let page = options.report.as_ref().map(|folder| folder.join("index.html"));
    let outputs = [options.out.as_deref(), options.results.as_deref(), page.as_deref()];
    let inputs = options.scene.as_ref().map(Path::new).into_iter();
    output::refuse_inputs(
        &outputs,
        inputs.chain(options.settings.as_deref()).chain(options.merge.iter().map(PathBuf::as_path)),
    )?;
    options.out.as_deref().map_or(Ok(()), |file| files::expect_place(file, Kind::Settings))?;
    options.results.as_deref().map(|file| json_lines::expect(file, &STARTS)).transpose()?;
    options.report.as_deref().map_or(Ok(()), |folder| output::make_report(folder, &page::charts()))?;
    for file in [&options.out, &options.results].into_iter().flatten() {
        output::make_folder_of(file)?;
    }
    if !options.merge.is_empty() {
        let (header, candidates, results) = merged(&options.merge)?;
        return finish(options, &Outcome::new(options, header, &candidates, &results)?);
    }
    let name = options.scene.as_deref().context("a scene is needed")?;
    let scene = output::open(name, &options.common.limits())?;
    output::refuse_inputs(&outputs, scene.parts.iter().map(PathBuf::as_path))?;
    if !options.common.quiet {
        output::notes(&scene);
    }
    if scene.dynamic_bodies() == 0 {
        bail!("nothing moves in {name}, so there is nothing to trade");
    }
    let sweep = Sweep::new(options, &scene)?;
    let results = sweep.run(options)?;
    if options.cell.is_some() || interrupt::asked() {
        return Ok(());
    }
    finish(options, &Outcome::new(options, sweep.header, &sweep.candidates, &results)?)
}

/// Merges files of results.
fn merged(files: &[PathBuf]) -> anyhow::Result<(Header, Vec<Candidate>, Results)> {
    let mut all: Option<(Header, Vec<Candidate>, Results)> = None;
    for file in files {
        let about = || format!("can't merge {}", file.display());
        let read = lines::read(file).with_context(about)?;
        let header = read.header.context("it is empty").with_context(about)?;
        let (first, _, results) = match &mut all {
            Some(all) => all,
            None => {
                let grid = header.grid.as_ref().context("it has no grid").with_context(about)?;
                grid.frame_rate().with_context(about)?;
                let scene = Scene::new(header.scene.as_str());
                let candidates: Vec<_> =
                    grid.cells().iter().map(|cell| Candidate::of(cell, &scene)).collect();
                let results = Results::none(candidates.len());
                all.insert((header.clone(), candidates, results))
            }
        };
        first.expect(&header).with_context(about)?;
        for line in read.lines {
            results.take(line).with_context(about)?;
        }
    }
    all.context("there is nothing to merge")
}

/// Prints and writes the requested results.
fn finish(options: &TradeOptions, outcome: &Outcome) -> anyhow::Result<()> {
    if options.common.json {
        output::print_json(outcome)?;
    } else if !options.common.quiet {
        output::print(&text::text(outcome))?;
    }
    if let Some(folder) = &options.report {
        page::write(folder, outcome)?;
    }
    if let Some(warning) = outcome.warning.as_ref().filter(|_| !options.common.quiet) {
        eprintln!("warning: {warning}");
    }
    if let Some(most) = options.max_error.filter(|&most| most < outcome.certain_to && !options.common.quiet) {
        eprintln!(
            "note: the reference itself is certain to {} {} only, not {most}",
            text::number(Some(outcome.certain_to)),
            outcome.unit
        );
    }
    let asked = options.max_error.is_some() || options.budget_us.is_some() || options.out.is_some();
    if !asked {
        return Ok(());
    }
    let picked = outcome.expect_pick(options.max_error.is_some())?;
    if let Some(path) = &options.out {
        let error = text::number(picked.error);
        let about = format!(
            "{}, {:.1} s: {}; {} {error} {}",
            outcome.header.scene,
            outcome.seconds,
            outcome.rule,
            outcome.error.name(),
            outcome.unit
        );
        settings_file::write(path, &picked.settings, &about)?;
    }
    Ok(())
}
